use super::*;
use crate::math::{Rng, warp};
use crate::scene::desc::PhaseDesc;
use tyndall_testkit::chi2;
use tyndall_testkit::closed_form::ray_radiance;
use tyndall_testkit::ztest::Moments;

const SIGNIFICANCE: f64 = 0.01;

/// Mean cosines that are tested, with isotropic scattering as the first.
const ANISOTROPIES: [f32; 4] = [0.0, 0.5, 0.8, -0.5];

fn phase(g: f32) -> Phase {
    let desc = if g == 0.0 { PhaseDesc::Isotropic } else { PhaseDesc::HenyeyGreenstein { g } };
    Phase::compile(&desc).unwrap()
}

/// A ray that passes a point at the distance `height`, `delta` metres from its start.
fn passing(delta: f32, height: f32) -> (Ray, Vec3) {
    let ray = Ray { origin: Vec3::new(1.0, 2.0, 3.0), direction: Vec3::new(0.48, 0.6, 0.64).normalize() };
    let across = ray.direction.cross(Vec3::X).normalize();
    (ray, ray.at(delta) + height * across)
}

/// Foot of the perpendicular, its height, and the length of the segment, metres.
const SEGMENTS: [(f32, f32, f32); 5] =
    [(2.0, 0.5, 10.0), (-1.0, 0.2, 3.0), (5.0, 0.01, 6.0), (30.0, 0.5, 0.4), (1.0, 3.0, 20.0)];

#[test]
fn first_point_follows_its_density() {
    for g in ANISOTROPIES {
        let joint = Joint::new(&phase(g));
        for (seed, (delta, height, length)) in (1..).zip(SEGMENTS) {
            let (ray, target) = passing(delta, height);
            let approach = joint.approach(&ray, length, target);
            let density = |t: f64| f64::from(approach.density(t as f32).0);
            let end = f64::from(length);
            let outcome = chi2::interval(|u| Some(approach.sample(u).into()), density, 0.0, end, 200_000, seed);
            assert!((outcome.integral - 1.0).abs() < 1e-3, "{outcome:?}");
            outcome.assert(SIGNIFICANCE, ANISOTROPIES.len() * SEGMENTS.len());
        }
    }
}

#[test]
fn second_point_follows_its_density() {
    for g in ANISOTROPIES {
        let phase = phase(g);
        let joint = Joint::new(&phase);
        for (seed, (delta, height, length)) in (1..).zip(SEGMENTS) {
            let (ray, target) = passing(delta, height);
            let onward = joint.onward(&ray, length, target);
            let density = |t: f64| f64::from(onward.density(t as f32).0);
            let end = f64::from(length);
            let outcome = chi2::interval(|u| Some(onward.sample(u).into()), density, 0.0, end, 200_000, seed);
            assert!((outcome.integral - 1.0).abs() < 2e-3, "{outcome:?}");
            outcome.assert(SIGNIFICANCE, ANISOTROPIES.len() * SEGMENTS.len());
        }
    }
}

/// Counts of samples in cells of polar angle to the light and azimuth against the density's integral over them. (The steps of
/// the tables defeat the rules of [`chi2`].)
#[test]
fn direction_follows_its_density() {
    const CELLS: usize = 16;
    const FINE: [usize; 2] = [2 * super::CELLS / CELLS, 32];
    const SAMPLES: usize = 1_000_000;
    let (b, arriving) = (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.6, 0.0, -0.8));
    let target = b + 1.7 * Vec3::Z;
    for (stream, g) in (1..).zip(ANISOTROPIES) {
        let phase = phase(g);
        let joint = Joint::new(&phase);
        let mut rng = Rng::keyed(2, stream, 0);
        let mut counts = [[0_u32; CELLS]; CELLS];
        let cell = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
        for _ in 0..SAMPLES {
            let d = joint.sample_direction(&phase, b, arriving, target, rng.f32(), rng.vec2());
            let (polar, azimuth) = (d.x.hypot(d.y).atan2(d.z) / PI, (d.y.atan2(d.x) / TAU).rem_euclid(1.0));
            counts[cell(polar)][cell(azimuth)] += 1;
        }
        let density = |polar: f32, azimuth: f32| {
            let ((sin, cos), (y, x)) = ((PI * polar).sin_cos(), (TAU * azimuth).sin_cos());
            let direction = Vec3::new(sin * x, sin * y, cos);
            let value = PerSolidAngle(phase.eval(b, arriving, direction));
            let onward = joint.onward(&Ray { origin: b, direction }, 5.0, target);
            f64::from(onward.direction(value).0 * sin * PI * TAU)
        };
        let at = |i: usize, k: usize, fine: usize| (i as f32 + (k as f32 + 0.5) / fine as f32) / CELLS as f32;
        let (mut chi2, mut total) = (0.0, 0.0);
        for (i, row) in counts.iter().enumerate() {
            for (j, count) in row.iter().enumerate() {
                let column =
                    |k: usize| (0..FINE[1]).map(|l| density(at(i, k, FINE[0]), at(j, l, FINE[1]))).sum::<f64>();
                let mean = (0..FINE[0]).map(column).sum::<f64>() / (FINE[0] * FINE[1]) as f64;
                let expected = mean * SAMPLES as f64 / (CELLS * CELLS) as f64;
                total += expected / SAMPLES as f64;
                chi2 += (f64::from(*count) - expected).powi(2) / expected;
            }
        }
        let degrees = (CELLS * CELLS - 1) as f64;
        println!("g {g}: density integrates to {total}, chi-square {chi2} for {degrees}");
        assert!((total - 1.0).abs() < 1e-4, "g {g}: density integrates to {total}");
        assert!(chi2 < degrees + 4.0 * (2.0 * degrees).sqrt(), "g {g}: chi-square {chi2} for {degrees}");
    }
}

/// Points around both ends, each with a density that falls as 1/r^2 (1 + r)^2: independent of what is tested.
fn around(ends: [Vec3; 2], rng: &mut Rng) -> (Vec3, f64) {
    let end = ends[usize::from(rng.f32() < 0.5)];
    let u = rng.f32();
    let c = end + u / (1.0 - u) * warp::square_to_sphere(rng.vec2());
    let density = |end: Vec3| {
        let r = f64::from(c.distance(end));
        0.25 * std::f64::consts::FRAC_1_PI / (r * (1.0 + r)).powi(2)
    };
    (c, 0.5 * (density(ends[0]) + density(ends[1])))
}

#[test]
fn density_in_space_integrates_to_one() {
    let (b, arriving) = (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.6, 0.0, -0.8));
    let target = b + Vec3::new(1.0, 1.2, -0.66);
    for (stream, g) in (1..).zip(ANISOTROPIES) {
        let phase = phase(g);
        let joint = Joint::new(&phase);
        let mut rng = Rng::keyed(3, stream, 0);
        let mut integral = Moments::default();
        for _ in 0..1_000_000 {
            let (c, sampled) = around([b, target], &mut rng);
            let s = c.distance(b);
            let direction = (c - b) / s;
            let onward = joint.onward(&Ray { origin: b, direction }, f32::INFINITY, target);
            let value = PerSolidAngle(phase.eval(b, arriving, direction));
            integral.push(f64::from(onward.in_space(value, s).0) / sampled);
        }
        println!("g {g}: {} +- {}", integral.mean(), integral.standard_error());
        assert!(integral.standard_error() < 0.01);
        integral.assert(1.0, SIGNIFICANCE, ANISOTROPIES.len());
    }
}

/// The density of isotropic scattering in closed form: `D / (pi^3 |bc|^2 |cd|^2)`.
#[test]
fn isotropic_density_in_space() {
    let joint = Joint::new(&Phase::Isotropic);
    let (b, target) = (Vec3::new(0.3, -0.2, 0.1), Vec3::new(1.3, 1.0, -0.56));
    let mut rng = Rng::keyed(4, 0, 0);
    for _ in 0..1000 {
        let (c, _) = around([b, target], &mut rng);
        let s = c.distance(b);
        let onward = joint.onward(&Ray { origin: b, direction: (c - b) / s }, f32::INFINITY, target);
        let found = onward.in_space(PerSolidAngle(0.25 / PI), s).0;
        let expected = b.distance(target) / (PI.powi(3) * c.distance_squared(b) * c.distance_squared(target));
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}

/// Radiance of a point light of 1 W scattered twice, sigma_t and albedo one: a ray that passes it at distance `h`, `a` metres from
/// the eye. One sample.
fn scattered_twice(phase: &Phase, joint: &Joint, [a, h]: [f32; 2], rng: &mut Rng) -> f64 {
    let end = 40.0;
    let ray = Ray { origin: Vec3::new(-a, h, 0.0), direction: Vec3::X };
    let light = Vec3::ZERO;
    let approach = joint.approach(&ray, end, light);
    let t = approach.sample(rng.f32());
    let b = ray.at(t);
    let direction = joint.sample_direction(phase, b, ray.direction, light, rng.f32(), rng.vec2());
    let onward = Ray { origin: b, direction };
    let sampling = joint.onward(&onward, end, light);
    let s = sampling.sample(rng.f32());
    let c = onward.at(s);
    let r = c.distance(light);
    let phase_b = PerSolidAngle(phase.eval(b, ray.direction, direction));
    let phase_c = phase.eval(c, direction, (light - c) / r);
    let pdf = approach.density(t).0 * sampling.direction(phase_b).0 * sampling.density(s).0;
    let arriving = (-t - s - r).exp() / (4.0 * PI * r * r);
    f64::from(phase_b.0 * phase_c * arriving / pdf)
}

/// Answers for Henyey-Greenstein are those of 10^9 random walks.
#[test]
fn double_scattering() {
    let isotropic = |a: f32, h: f32| (0.0, [a, h], ray_radiance(2, a.into(), h.into()));
    let forward = |g: f32, radiance: f64| (g, [2.0, 0.5], radiance);
    let cases = [
        isotropic(2.0, 0.5),
        isotropic(2.0, 0.1),
        forward(0.5, 3.7948e-3),
        forward(0.8, 5.606e-3),
        forward(-0.5, 2.4443e-3),
    ];
    for (stream, (g, place, truth)) in (1..).zip(cases) {
        let phase = phase(g);
        let joint = Joint::new(&phase);
        let mut rng = Rng::keyed(5, stream, 0);
        let mut radiance = Moments::default();
        (0..1_000_000).for_each(|_| radiance.push(scattered_twice(&phase, &joint, place, &mut rng)));
        let spread = radiance.variance().sqrt() / radiance.mean();
        println!(
            "g {g} {place:?}: {} +- {}, expected {truth}, spread {spread}",
            radiance.mean(),
            radiance.standard_error()
        );
        assert!(radiance.standard_error() < 0.005 * truth);
        radiance.assert(truth, SIGNIFICANCE, cases.len());
    }
}
