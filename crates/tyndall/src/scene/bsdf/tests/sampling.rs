//! Samplers follow their densities.

use super::*;
use crate::math::{Rng, warp};
use tyndall_testkit::chi2;

/// The directions from which a model scatters.
fn sides(probe: &Probe, name: &str) -> impl Iterator<Item = Vec3> {
    let both = probe.traits().transmits && !["mask"].contains(&name) || ["twosided", "normalmap"].contains(&name);
    directions().into_iter().filter(move |wo| both || wo.z > 0.0)
}

#[test]
fn directions_follow_their_density() {
    let tests = SMOOTH.len() * 4;
    for (i, name) in SMOOTH.iter().enumerate() {
        let probe = Probe::named(name);
        for (j, wo) in sides(&probe, name).enumerate() {
            let draw = |u1: f32, u2: [f32; 2]| {
                let s = probe.sample(wo, Transport::Radiance, u1, u2.into())?;
                (!s.event.delta).then(|| s.wi.to_array())
            };
            let density = |wi: [f32; 3]| f64::from(probe.eval(wo, wi.into(), Transport::Radiance).1);
            let outcome = chi2::sphere(draw, density, 40_000, (i * 4 + j) as u64);
            assert!(outcome.passes(0.01, tests), "{name} from {wo}: {outcome:?}");
        }
    }
}

#[test]
fn smooth_glass_forks_where_it_reflects_and_refracts() {
    for name in ["dielectric", "diffuse", "conductor", "plastic", "thindielectric"] {
        let probe = Probe::named(name);
        for wo in directions() {
            let Some(reflected) = probe.bsdfs.forks(probe.root, wo) else {
                let inside = wo.z < 0.0;
                assert!(name != "dielectric" || inside && 1.0 - wo.z * wo.z > 1.0 / 1.5_f32.powi(2), "{wo}");
                continue;
            };
            assert_eq!(name, "dielectric");
            let transmits = |u: f32| {
                probe.sample(wo, Transport::Radiance, u, [0.5, 0.5].into()).is_some_and(|s| s.event.transmission)
            };
            assert!(!transmits(0.0) && !transmits(reflected * 0.9999) && transmits(reflected) && transmits(0.9999));
        }
    }
}

#[test]
fn weights_are_value_over_density() {
    for name in SMOOTH {
        let probe = Probe::named(name);
        for wo in sides(&probe, name) {
            for transport in [Transport::Radiance, Transport::Importance] {
                let mut rng = Rng::keyed(7, 0, 0);
                let mut smooth = 0;
                for _ in 0..500 {
                    let Some(s) = probe.sample(wo, transport, rng.f32(), rng.vec2()) else { continue };
                    assert!((s.wi.length() - 1.0).abs() < 1e-3, "{name}: {}", s.wi);
                    // Viewers whom a map's normal faces away from may see the other side's light, unless it is turned round.
                    let faces_away = name == "bump-bare" && transport == Transport::Importance;
                    assert!(faces_away || s.event.transmission == (s.wi.z * wo.z < 0.0), "{name}: {s:?}");
                    if s.event.delta {
                        continue;
                    }
                    smooth += 1;
                    let (value, pdf) = probe.eval(wo, s.wi, transport);
                    let near = |a: f32, b: f32| (a - b).abs() <= 2e-3 * b.abs() + 1e-6;
                    assert!(near(s.pdf.0, pdf), "{name} {wo}: {s:?} but density {pdf}");
                    let carried = s.weight * s.pdf.0;
                    for channel in 0..3 {
                        assert!(near(carried[channel], value[channel]), "{name} {wo}: {s:?} but value {value:?}");
                    }
                }
                assert!(smooth > 0, "{name} {wo}");
            }
        }
    }
}

#[test]
fn the_seen_side_and_the_lobe_choice_leave_no_gap() {
    // The mean weight must be the integral of the value plus the specular part, by an independent quadrature.
    for name in ["roughdielectric-beckmann", "principled-all", "blend", "plastic", "bump"] {
        let probe = Probe::named(name);
        let wo = directions()[0];
        let n = 60_000;
        let (mut sampled, mut uniform) = (0.0, 0.0);
        let mut rng = Rng::keyed(11, 0, 0);
        for _ in 0..n {
            if let Some(s) = probe.sample(wo, Transport::Radiance, rng.f32(), rng.vec2())
                && !s.event.delta
            {
                sampled += f64::from(s.weight[1]);
            }
            let wi = crate::math::warp::square_to_sphere(rng.vec2());
            uniform += f64::from(probe.eval(wo, wi, Transport::Radiance).0[1]) * 4.0 * std::f64::consts::PI;
        }
        let (sampled, uniform) = (sampled / f64::from(n), uniform / f64::from(n));
        assert!((sampled / uniform - 1.0).abs() < 0.03, "{name}: {sampled} sampled, {uniform} integrated");
    }
}

#[test]
fn ceilings_are_above_all_values() {
    let mut known = 0;
    for name in SMOOTH {
        let probe = Probe::named(name);
        let mut rng = Rng::keyed(8, 0, 0);
        for wo in
            directions().into_iter().chain((0..50).map(|_| warp::square_to_sphere(rng.vec2())).collect::<Vec<_>>())
        {
            let Some(ceiling) = probe.bsdfs.ceiling(probe.root, &probe.context(), wo) else { continue };
            known += 1;
            for _ in 0..500 {
                let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
                let near = mirror + 0.3 * rng.f32() * warp::square_to_sphere(rng.vec2());
                let wi = if rng.f32() < 0.5 { near.normalize() } else { warp::square_to_sphere(rng.vec2()) };
                let value = probe.eval(wo, wi, Transport::Radiance).0;
                let swapped = probe.eval(wi, wo, Transport::Radiance).0 * (wi.z / wo.z).abs();
                let cos = if !ceiling.cosine { 1.0 } else { (wi.z * wo.z.signum()).max(0.0) };
                for c in 0..3 {
                    let most = 1.001 * ceiling.value[c] * cos;
                    assert!(value[c] <= most, "{name} {wo} {wi}: {value:?} above {ceiling:?}");
                    assert!(swapped[c] <= most, "{name} {wi} {wo}: {swapped:?} above {ceiling:?}");
                    assert!(
                        !ceiling.exact || value[c] >= 0.999 * most,
                        "{name} {wo} {wi}: {value:?} is not {ceiling:?}"
                    );
                }
            }
        }
    }
    assert!(known > 600, "{known}");
}
