//! Sampling of a point on each of two rays, for light that goes from one to the other (Novak et al. 2012a, section 4).

use super::equiangular::Equiangular;
use crate::math::Ray;

/// Pairs of distances: `s` on the first `light_length` metres of light's ray, `t` on the first `camera_length` metres of the
/// camera's. The density of `s` is proportional to the integral of 1/d^2 over the camera's whole line, d the distance
/// between the points, that of `t` given `s` to 1/d^2.
#[derive(Clone, Copy, Debug)]
pub struct RayPair {
    camera: Ray,
    camera_length: f32,
    light: Ray,
    light_length: f32,
    /// Distance on light's ray where the lines are closest, metres.
    foot: f32,
    /// Least distance of the lines over the sine between them, metres; infinite for parallel lines.
    width: f32,
    /// The variable `asinh((s - foot) / width)` at the start of light's ray, and its range.
    start: f32,
    range: f32,
    /// Added to distances, as a square root of the sum of squares, metres.
    radius: f32,
}

/// A pair of distances.
#[derive(Clone, Copy, Debug)]
pub struct PairSample {
    /// On light's ray, metres.
    pub s: f32,
    /// On the camera's ray, metres.
    pub t: f32,
    /// Density of both, 1/m^2.
    pub pdf: f32,
}

/// Lines whose squared sine is less count as parallel.
const PARALLEL: f64 = 1e-8;

impl RayPair {
    /// `radius` bounds the density where the rays come close: 0 for none.
    #[inline]
    pub fn new(camera: &Ray, camera_length: f32, light: &Ray, light_length: f32, radius: f32) -> Self {
        let (d, w) = (camera.direction.as_dvec3(), light.direction.as_dvec3());
        let between = camera.origin.as_dvec3() - light.origin.as_dvec3();
        let cos = d.dot(w);
        let sin2 = d.cross(w).length_squared();
        let mut pair = Self {
            camera: *camera,
            camera_length,
            light: *light,
            light_length,
            foot: 0.0,
            width: f32::INFINITY,
            start: 0.0,
            range: light_length,
            radius,
        };
        if sin2 > PARALLEL {
            let foot = (w.dot(between) - cos * d.dot(between)) / sin2;
            let on_camera = (cos * w.dot(between) - d.dot(between)) / sin2;
            let apart = (between + on_camera * d - foot * w).length_squared() + f64::from(radius).powi(2);
            let width = (apart / sin2).sqrt().max(1e-6 * f64::from(light_length));
            let variable = |s: f64| ((s - foot) / width).asinh();
            pair.foot = foot as f32;
            pair.width = width as f32;
            pair.start = variable(0.0) as f32;
            pair.range = (variable(f64::from(light_length)) - variable(0.0)) as f32;
        }
        pair
    }

    /// The pair for `u` in [0, 1)^2.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> PairSample {
        let s = self.on_light(u[0]);
        let across = self.across(s);
        let t = across.sample(u[1]).min(self.camera_length);
        PairSample { s, t, pdf: self.density_on_light(s) * across.density(t).0 }
    }

    /// Density of the pair, 1/m^2.
    pub fn density(&self, s: f32, t: f32) -> f32 {
        self.density_on_light(s) * self.across(s).density(t).0
    }

    /// The distance on light's ray for `u` in [0, 1).
    #[inline]
    pub(super) fn on_light(&self, u: f32) -> f32 {
        let variable = self.start + u * self.range;
        let s = if self.width.is_finite() { self.foot + self.width * variable.sinh() } else { variable };
        s.clamp(0.0, self.light_length)
    }

    /// The `u` that gives the distance `s` on light's ray.
    pub(super) fn position_on_light(&self, s: f32) -> f32 {
        let variable = if self.width.is_finite() { ((s - self.foot) / self.width).asinh() } else { s };
        (variable - self.start) / self.range
    }

    /// Light's ray and the camera's.
    #[inline]
    pub(super) fn rays(&self) -> [&Ray; 2] {
        [&self.light, &self.camera]
    }

    /// Distances on the camera's ray, seen from the distance `s` on light's.
    #[inline]
    pub(super) fn across(&self, s: f32) -> Equiangular {
        Equiangular::softened(&self.camera, self.camera_length, self.light.at(s), self.radius)
    }

    /// Density of the distance `s` on light's ray, 1/m.
    #[inline]
    pub(super) fn density_on_light(&self, s: f32) -> f32 {
        if self.width.is_finite() { 1.0 / (self.range * self.width.hypot(s - self.foot)) } else { 1.0 / self.range }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rng, Vec3};

    fn rays() -> [(Ray, Ray); 4] {
        let ray = |o: [f32; 3], d: [f32; 3]| Ray { origin: Vec3::from(o), direction: Vec3::from(d).normalize() };
        let camera = ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        [
            (camera, ray([1.0, 0.3, -0.8], [0.3, 0.2, 0.9])),
            (camera, ray([1.0, 0.01, -0.5], [0.1, 0.0, 1.0])),
            (camera, ray([3.0, 0.5, 0.0], [-1.0, 0.0, 0.0])),
            (camera, ray([6.0, 2.0, 1.0], [0.0, 1.0, 0.2])),
        ]
    }

    /// Counts of samples in cells against the density's integral over them.
    #[test]
    fn samples_follow_the_density() {
        const CELLS: usize = 8;
        for radius in [0.0, 0.2] {
            for (case, (camera, light)) in (0..).zip(rays()) {
                let pair = RayPair::new(&camera, 4.0, &light, 3.0, radius);
                let n = 200_000;
                let mut rng = Rng::keyed(5, case, 0);
                let mut counts = [[0_u32; CELLS]; CELLS];
                for _ in 0..n {
                    let PairSample { s, t, pdf } = pair.sample([rng.f32(), rng.f32()]);
                    assert!((0.0..=3.0).contains(&s) && (0.0..=4.0).contains(&t));
                    assert!((pdf / pair.density(s, t) - 1.0).abs() < 1e-3);
                    counts[((s / 3.0 * CELLS as f32) as usize).min(CELLS - 1)]
                        [((t / 4.0 * CELLS as f32) as usize).min(CELLS - 1)] += 1;
                }
                const FINE: usize = 100;
                let (mut chi2, mut used, mut total) = (0.0, 0, 0.0);
                for (i, row) in counts.iter().enumerate() {
                    for (j, count) in row.iter().enumerate() {
                        let mut p = 0.0;
                        for a in 0..FINE {
                            for b in 0..FINE {
                                let s = (i as f32 + (a as f32 + 0.5) / FINE as f32) / CELLS as f32 * 3.0;
                                let t = (j as f32 + (b as f32 + 0.5) / FINE as f32) / CELLS as f32 * 4.0;
                                p += f64::from(pair.density(s, t));
                            }
                        }
                        p *= 12.0 / ((CELLS * FINE) as f64).powi(2);
                        total += p;
                        let expected = p * f64::from(n);
                        if expected > 8.0 {
                            chi2 += (f64::from(*count) - expected).powi(2) / expected;
                            used += 1;
                        }
                    }
                }
                assert!((total - 1.0).abs() < 3e-3, "case {case}: density integrates to {total}");
                let degrees = f64::from(used - 1);
                assert!(chi2 < degrees + 4.0 * (2.0 * degrees).sqrt(), "case {case}: chi-square {chi2} for {degrees}");
            }
        }
    }
}
