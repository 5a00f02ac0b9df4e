//! Energy and reciprocity.

use super::*;
use crate::math::Rng;

/// Share of the light from `wo` that leaves, per channel: as a walk from a light sees it, with importance.
fn albedo(probe: &Probe, transport: Transport, wo: Vec3) -> Spectrum {
    let n = 64;
    let mut sum = Spectrum::ZERO;
    for i in 0..n * n {
        let mut rng = Rng::keyed(3, 0, i);
        let u2 = Vec2::new((i / n) as f32 + rng.f32(), (i % n) as f32 + rng.f32()) / n as f32;
        if let Some(s) = probe.sample(wo, transport, rng.f32(), u2) {
            sum += s.weight;
        }
    }
    sum / (n * n) as f32
}

#[test]
fn no_model_but_burleys_makes_energy() {
    let specular = ["dielectric", "dielectric-inverted", "thindielectric", "conductor"];
    for name in SMOOTH.into_iter().chain(specular).filter(|name| !name.starts_with("principled")) {
        // Normals turned by a map make energy with importance (Veach 1997, section 5.3.4), and squeezed light gains with radiance:
        // of a map on glass nothing can be said.
        let transport = match name {
            "bump-bare" => continue,
            "bump" | "normalmap" => Transport::Radiance,
            _ => Transport::Importance,
        };
        let probe = Probe::named(name);
        for wo in directions() {
            let albedo = albedo(&probe, transport, wo);
            assert!(albedo.max_channel() <= 1.003, "{name} from {wo}: {albedo:?}");
        }
    }
}

#[test]
fn white_glass_loses_what_mitsuba_loses() {
    // Shares of one bounce seen from above and from below, from 400,000 samples of Mitsuba 3.9.1.
    let rows = [
        (GGX, 0.01, [1.0, 0.9995]),
        (BECKMANN, 0.01, [1.0, 0.9999]),
        (GGX, 0.3, [0.9859, 0.8313]),
        (BECKMANN, 0.3, [0.9998, 0.9661]),
    ];
    for (distribution, alpha, expected) in rows {
        for sample_visible in [true, false] {
            let roughness = rough(distribution, alpha, alpha, sample_visible);
            let probe = Probe::new(&[glass(1.5, 1.0, [grey(1.0), grey(1.0)], roughness)]);
            for (wo, expected) in [directions()[0], directions()[2]].into_iter().zip(expected) {
                let share = albedo(&probe, Transport::Importance, wo)[0];
                let near = (share - expected).abs() < 0.006;
                assert!(near, "{distribution:?} {alpha} {sample_visible} {wo}: {share}, expected {expected}");
            }
        }
    }
}

#[test]
fn smooth_white_models_keep_everything() {
    let [dielectric, thin, mirror] = [
        BsdfDesc::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: grey(1.0),
            specular_transmittance: grey(1.0),
        },
        BsdfDesc::ThinDielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: grey(1.0),
            specular_transmittance: grey(1.0),
        },
        BsdfDesc::Conductor { eta: grey(0.0), k: grey(1.0), specular_reflectance: grey(1.0) },
    ];
    for desc in [dielectric, thin, mirror, BsdfDesc::Null] {
        let probe = Probe::new(std::slice::from_ref(&desc));
        for wo in directions() {
            for i in 0..64 {
                for transport in [Transport::Radiance, Transport::Importance] {
                    let Some(s) = probe.sample(wo, transport, i as f32 / 64.0, Vec2::splat(0.5)) else {
                        assert!(matches!(desc, BsdfDesc::Conductor { .. }) && wo.z < 0.0);
                        continue;
                    };
                    // Radiance over the square of the index is what a lossless interface conserves.
                    let eta2 = if transport == Transport::Radiance { s.event.eta * s.event.eta } else { 1.0 };
                    assert!((s.weight[0] * eta2 - 1.0).abs() < 1e-6, "{desc:?} {wo}: {s:?}");
                    assert!(s.event.delta && (s.wi.length() - 1.0).abs() < 1e-5);
                    assert_eq!(s.event.eta != 1.0, s.event.transmission && !s.event.null);
                }
            }
        }
    }
}

#[test]
fn refraction_obeys_snell_and_finds_its_way_back() {
    let probe = Probe::named("dielectric");
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let s = probe.sample(wo, Transport::Radiance, 0.99, Vec2::ZERO).unwrap();
    assert!(s.event.transmission && (s.wi.x + 0.4).abs() < 1e-6, "sin 0.6 / 1.5 = 0.4: {s:?}");
    let back = probe.sample(s.wi, Transport::Radiance, 0.99, Vec2::ZERO).unwrap();
    assert!((back.wi - wo).length() < 1e-5 && (back.event.eta * s.event.eta - 1.0).abs() < 1e-6);
    // Beyond the critical angle everything is reflected.
    let inside = Vec3::new(0.8, 0.0, -0.6);
    assert!(!probe.sample(inside, Transport::Radiance, 0.999_999, Vec2::ZERO).unwrap().event.transmission);
}

#[test]
fn backwards_is_the_adjoint() {
    // f for radiance from wo to wi is f for importance from wi to wo.
    for name in SMOOTH {
        let probe = Probe::named(name);
        let mut rng = Rng::keyed(5, 0, 0);
        let mut tried = 0;
        for wo in directions() {
            for _ in 0..200 {
                let Some(s) = probe.sample(wo, Transport::Radiance, rng.f32(), rng.vec2()) else { continue };
                // Grazing directions lose digits to the division by the cosine, and the thin sheet masks by the
                // direction of travel what it lets through.
                let asymmetric = name == "principledthin-all" && s.event.transmission;
                if s.event.delta || s.wi.z.abs() < 0.02 || asymmetric {
                    continue;
                }
                let there = probe.eval(wo, s.wi, Transport::Radiance).0 / s.wi.z.abs();
                let back = probe.eval(s.wi, wo, Transport::Importance).0 / wo.z.abs();
                tried += 1;
                for channel in 0..3 {
                    let (a, b) = (there[channel], back[channel]);
                    assert!((a - b).abs() <= 2e-3 * a.max(b) + 1e-6, "{name}: {wo} {} {a} {b}", s.wi);
                }
            }
        }
        assert!(tried > 50, "{name}: {tried}");
    }
}

#[test]
fn conductor_and_dielectric_reflectances_agree_where_they_meet() {
    // A conductor that does not absorb is a dielectric.
    for i in 1..=20 {
        let cos = i as f32 / 20.0;
        let (dielectric, _) = fresnel::dielectric(cos, 1.5);
        let conductor = fresnel::conductor(cos, Spectrum::grey(1.5), Spectrum::ZERO)[0];
        assert!((dielectric - conductor).abs() < 1e-6, "{cos}: {dielectric} {conductor}");
    }
    assert!((fresnel::dielectric(1.0, 1.5).0 - 0.04).abs() < 1e-6);
    // The fits against the integral they approximate.
    for eta in [0.6_f32, 0.75, 1.2, 1.5, 2.0] {
        let n = 4096;
        let mean: f32 = (0..n)
            .map(|i| {
                let cos = ((i as f32 + 0.5) / n as f32).sqrt();
                fresnel::dielectric(cos, eta).0 / n as f32
            })
            .sum();
        assert!((fresnel::diffuse_mean(eta) - mean).abs() < 0.004, "{eta}: {mean}");
    }
}
