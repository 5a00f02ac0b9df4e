//! Sampled irradiance agrees with closed forms.

use super::*;
use std::f64::consts::PI;
use tyndall_testkit::ztest::Moments;

const TESTS: usize = 6;

/// Estimates of the irradiance at `x` of a receiver with the unit normal `n`.
fn irradiance(lights: &Lights, x: Vec3, n: Vec3) -> Moments {
    let mut random = Random::new(5);
    let estimate = |s: EmitterSample| s.radiance[0] * s.direction.dot(n).max(0.0) / s.pdf.0;
    (0..100_000).map(|_| sample(lights, x, &mut random).map_or(0.0, |s| f64::from(estimate(s)))).collect()
}

#[test]
fn sphere() {
    let lights = lights(&[], &[(Form::Sphere(Vec3::new(0.0, 0.0, 3.0), 1.2), [2.0; 3])]);
    let facing = irradiance(&lights, Vec3::ZERO, Vec3::Z);
    facing.assert(2.0 * PI * (1.2_f64 / 3.0).powi(2), SIGNIFICANCE, TESTS);
    // A sphere wholly above the horizon: the cosine of its centre.
    let tilted = irradiance(&lights, Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8));
    tilted.assert(2.0 * PI * (1.2_f64 / 3.0).powi(2) * 0.8, SIGNIFICANCE, TESTS);
}

#[test]
fn rectangle() {
    // Half sizes a, b at distance c above the receiver (Howell's catalogue, C-3), four corners.
    let (a, b, c) = (0.7_f64, 1.1, 0.9);
    let (x, y) = (a / c, b / c);
    let corner =
        (x / x.hypot(1.0) * (y / x.hypot(1.0)).atan() + y / y.hypot(1.0) * (x / y.hypot(1.0)).atan()) / (2.0 * PI);
    let form = Form::Parallelogram(Vec3::new(-0.7, -1.1, 0.9), Vec3::new(0.0, 2.2, 0.0), Vec3::new(1.4, 0.0, 0.0));
    let lights = lights(&[], &[(form, [2.0; 3])]);
    irradiance(&lights, Vec3::ZERO, Vec3::Z).assert(2.0 * PI * 4.0 * corner, SIGNIFICANCE, TESTS);
    assert_eq!(irradiance(&lights, Vec3::new(0.0, 0.0, 2.0), -Vec3::Z).mean(), 0.0, "the back is dark");
}

#[test]
fn disk() {
    // A receiver on the axis: the form factor is 1 / (1 + h^2).
    let lights = lights(&[], &[(Form::Disk, [2.0; 3])]);
    let m = irradiance(&lights, Vec3::new(0.0, 0.0, 1.5), -Vec3::Z);
    m.assert(2.0 * PI / (1.0 + 1.5 * 1.5), SIGNIFICANCE, TESTS);
}

#[test]
fn infinite_emitters() {
    let constant = emitter(EmitterKind::Constant { radiance: [2.0; 3] }, Transform::IDENTITY);
    irradiance(&lights(std::slice::from_ref(&constant), &[]), Vec3::ONE, Vec3::Y).assert(2.0 * PI, SIGNIFICANCE, TESTS);
    // A white picture and a constant: their sum, though each sample is named after one of them.
    let image = Arc::new(ImageDesc { width: 3, height: 2, pixels: vec![[1.0; 3]; 6] });
    let white = emitter(EmitterKind::Envmap { image, scale: 0.5 }, rotation());
    irradiance(&lights(&[constant, white], &[]), Vec3::ONE, Vec3::Y).assert(2.5 * PI, SIGNIFICANCE, TESTS);
}

#[test]
fn delta_emitters_are_exact() {
    let n = Vec3::new(0.0, 0.6, 0.8);
    let lamp = lights(&[point([0.0, 0.0, 2.0], 3.0)], &[]);
    let m = irradiance(&lamp, Vec3::ZERO, n);
    assert!((m.mean() - 3.0 / 4.0 * 0.8).abs() < 1e-6 && m.variance() < 1e-12);
    let down = Transform::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]).unwrap();
    let sun = lights(&[emitter(EmitterKind::Directional { irradiance: [3.0; 3] }, down)], &[]);
    let m = irradiance(&sun, Vec3::ZERO, n);
    assert!((m.mean() - 3.0 * 0.8).abs() < 1e-6 && m.variance() < 1e-12);
}
