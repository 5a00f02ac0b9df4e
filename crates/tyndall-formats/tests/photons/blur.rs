//! What an estimator converges to: the exact answer, blurred.

use std::f64::consts::PI;
use tyndall_testkit::closed_form::{henyey_greenstein, ray_radiance, ray_radiance_hg};
use tyndall_testkit::corpus::Infinite;
use tyndall_testkit::quadrature::integrate;

/// Where an estimator looks for light around the place where it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blur {
    /// All around, in three dimensions.
    Ball,
    /// Across the camera's ray, in two.
    AcrossQuery,
    /// Across the light's beam, in two.
    AcrossBeam,
    /// Along the common normal of ray and beam.
    CommonNormal,
}

impl Blur {
    /// Its dimension.
    pub fn dimension(self) -> i32 {
        match self {
            Self::Ball => 3,
            Self::AcrossQuery | Self::AcrossBeam => 2,
            Self::CommonNormal => 1,
        }
    }
}

/// Epanechnikov's kernel as midpoints of equal steps of distance with their shares of the blur, radius 1.
fn shells(dimension: i32) -> impl Iterator<Item = (f64, f64)> {
    const N: u32 = 24;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
    let share = move |x: f64| x.powi(dimension - 1) * (1.0 - x * x);
    let whole: f64 = (0..N).map(at).map(share).sum();
    (0..N).map(at).map(move |x| (x, share(x) / whole))
}

/// `n` midpoints on [0, pi].
fn half_turn(n: u32) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| (f64::from(i) + 0.5) / f64::from(n) * PI)
}

/// The radiance of the infinite medium as an estimator with that blur and Epanechnikov's kernel of radius `radius` sees it
/// in the mean, per channel. Exact for light scattered once. Of light scattered more often, which is smoother, to second
/// order in the radius; not blurred at all where the blur hangs on the light's direction: for that take a small radius.
pub fn blurred(p: &Infinite, blur: Blur, radius: f64) -> [f64; 3] {
    let orders = p.orders.expect("a number of orders");
    let channel = |k: usize| {
        let (q, c) = (p.sigma_t[k], p.albedo[k]);
        let (a, h, r) = (q * p.a, q * p.h, q * radius);
        let once = |a: f64, h: f64| ray_radiance_hg(p.g, a, h);
        let first = match blur {
            Blur::Ball => ball(&once, a, h, r),
            Blur::AcrossQuery => disc(&once, a, h, r),
            Blur::AcrossBeam => across_beam(p.g, a, h, r),
            Blur::CommonNormal => common_normal(p.g, a, h, r),
        };
        let late: f64 =
            (2..=orders).map(|n| c.powi(n as i32) * smoothed(&|a, h| ray_radiance(n, a, h), blur, a, h, r)).sum();
        q * q * (c * first + late)
    };
    if p.sigma_t == [p.sigma_t[0]; 3] && p.albedo == [p.albedo[0]; 3] {
        return [channel(0); 3];
    }
    [0, 1, 2].map(channel)
}

/// Plus half the second moment times the Laplacian over the blurred dimensions.
fn smoothed(exact: &impl Fn(f64, f64) -> f64, blur: Blur, a: f64, h: f64, r: f64) -> f64 {
    let at = exact(a, h);
    if blur.dimension() == 1 || blur == Blur::AcrossBeam {
        return at;
    }
    let e = 0.05;
    let (inner, outer) = (exact(a, h - e), exact(a, h + e));
    let across = (outer - 2.0 * at + inner) / (e * e) + (outer - inner) / (2.0 * e * h);
    let along = (exact(a + e, h) - 2.0 * at + exact(a - e, h)) / (e * e);
    match blur {
        Blur::Ball => at + r * r / 14.0 * (across + along),
        _ => at + r * r / 12.0 * across,
    }
}

/// A photon that is off by a vector is where it should be for an eye that is off by as much.
fn ball(exact: &impl Fn(f64, f64) -> f64, a: f64, h: f64, r: f64) -> f64 {
    let angles = || half_turn(8);
    shells(3)
        .map(|(x, share)| {
            let mean: f64 = (0..8)
                .map(|i| {
                    let z = (f64::from(i) + 0.5) / 4.0 - 1.0;
                    let across = (1.0 - z * z).sqrt();
                    let at = |phi: f64| (h + r * x * across * phi.cos()).hypot(r * x * across * phi.sin());
                    angles().map(|phi| exact(a - r * x * z, at(phi))).sum::<f64>() / 64.0
                })
                .sum();
            share * mean
        })
        .sum()
}

fn disc(exact: &impl Fn(f64, f64) -> f64, a: f64, h: f64, r: f64) -> f64 {
    let mean =
        |x: f64| half_turn(12).map(|phi| exact(a, (h + r * x * phi.cos()).hypot(r * x * phi.sin()))).sum::<f64>();
    shells(2).map(|(x, share)| share * mean(x) / 12.0).sum()
}

/// The beams of a point light meet the ray at a distance `u` along the common normal where they would meet one at the
/// distance sqrt(h^2 - u^2) from the light; `du` is `h` times the cosine of their azimuth around the ray's direction.
fn common_normal(g: f64, a: f64, h: f64, r: f64) -> f64 {
    shells(1).map(|(x, share)| share * ray_radiance_hg(g, a, (h * h - r * r * x * x).sqrt())).sum()
}

/// From the definition: over the ray, and over the beams that pass a point of it at the distance `u`.
fn across_beam(g: f64, a: f64, h: f64, r: f64) -> f64 {
    let integrand = |theta: f64| {
        let (t, distance) = (a + h * theta.tan(), h / theta.cos());
        // From the light to the point, and back to the eye.
        let cos = (a - t) / distance;
        let seen: f64 = shells(2)
            .map(|(x, share)| {
                let sin_off = r * x / distance;
                let cos_off = (1.0 - sin_off * sin_off).sqrt();
                let phase =
                    |phi: f64| henyey_greenstein(g, cos_off * cos + sin_off * phi.cos() * (1.0 - cos * cos).sqrt());
                let phase = half_turn(12).map(phase).sum::<f64>() / 12.0;
                // Solid angle over area is 1 / (distance^2 cos).
                share * phase * (-distance * cos_off).exp() / cos_off
            })
            .sum();
        (-t).exp() * seen / (4.0 * PI * distance * distance) * distance * distance / h
    };
    integrate(&integrand, (-a).atan2(h), (40.0f64 - a).atan2(h), 1e-9)
}

#[test]
fn blurs_of_no_width_and_of_small_width() {
    let p = Infinite { a: 0.7, h: 0.6, g: 0.4, albedo: [1.0; 3], ..Infinite::default() };
    let exact = ray_radiance_hg(0.4, 0.7, 0.6);
    let l = |a: f64, h: f64| ray_radiance_hg(0.4, a, h);
    let e = 1e-2;
    let (first, second) =
        ((l(0.7, 0.6 + e) - l(0.7, 0.6 - e)) / (2.0 * e), (l(0.7, 0.6 + e) - 2.0 * exact + l(0.7, 0.6 - e)) / (e * e));
    let along = (l(0.7 + e, 0.6) - 2.0 * exact + l(0.7 - e, 0.6)) / (e * e);
    let across = second + first / 0.6;
    // Second moments 1/5, 1/6, 1/7 of the squared radius, halved, times the Laplacian over the blurred dimensions.
    for (blur, expected) in [
        (Blur::Ball, (across + along) / 14.0),
        (Blur::AcrossQuery, across / 12.0),
        (Blur::CommonNormal, -first / 0.6 / 10.0),
    ] {
        let r = 0.05;
        let found = (blurred(&p, blur, r)[0] - exact) / (r * r);
        assert!((found / expected - 1.0).abs() < 0.03, "{blur:?}: {found}, expected {expected}");
    }
    assert!((blurred(&p, Blur::AcrossBeam, 1e-3)[0] / exact - 1.0).abs() < 1e-3);
}
