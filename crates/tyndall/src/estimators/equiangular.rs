//! Equiangular sampling of a distance along a ray (Kulla and Fajardo 2012, eqs. 4-6).

use crate::math::functions::{angle, sin_cos};
use crate::math::lanes::Lanes;
use crate::math::triples::{along, dot};
use crate::math::{PerLength, Ray, Vec3};

/// Distances on `[0, length]` of a ray with density proportional to 1/d^2, d the distance to a point.
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    /// Distance along the ray of the foot of the perpendicular, metres.
    pub(super) delta: f32,
    /// Distance of the point from the ray's line, metres, never zero.
    pub(super) height: f32,
    /// Angle that the segment spans, seen from the point.
    pub(super) span: f32,
}

impl Equiangular {
    /// For the first `length` metres of `ray` (possibly infinite) and the point `target`.
    #[inline]
    pub fn new(ray: &Ray, length: f32, target: Vec3) -> Self {
        let to_target = target - ray.origin;
        let delta = to_target.dot(ray.direction);
        // The rejection, not sqrt(l^2 - delta^2), which cancels near the line.
        let rejection = to_target - delta * ray.direction;
        let height = rejection.length().max(1e-6 * to_target.length()).max(1e-12);
        // Sine and cosine of the angle between the directions to both ends, times the same factor.
        let (sin, cos) = if length.is_finite() {
            (height * length, height * height - delta * (length - delta))
        } else {
            (height, -delta)
        };
        Self { delta, height, span: sin.atan2(cos).max(1e-12) }
    }

    /// The distance for `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        self.at(u * self.span)
    }

    /// The distance up to which the segment spans `angle`, seen from the point.
    #[inline]
    pub(super) fn at(&self, angle: f32) -> f32 {
        // delta + height tan(start + angle) with tan(start) = -delta / height, by the addition theorem.
        let (sin, cos) = angle.sin_cos();
        let square = self.delta * self.delta + self.height * self.height;
        (square * sin / (self.height * cos + self.delta * sin)).max(0.0)
    }

    /// The angle that the first `t` metres span, seen from the point.
    #[inline]
    pub(super) fn angle(&self, t: f32) -> f32 {
        let (sin, cos) = (self.height * t, self.height * self.height - self.delta * (t - self.delta));
        sin.atan2(cos).clamp(0.0, self.span)
    }

    /// The angle that the whole segment spans, seen from the point.
    #[inline]
    pub(super) fn span(&self) -> f32 {
        self.span
    }

    /// The angles at the ray's origin from the ray to the direction towards the point, and on to that away from it.
    #[inline]
    pub(super) fn angles_at_origin(&self) -> (f32, f32) {
        (self.height.atan2(self.delta), self.height.atan2(-self.delta))
    }

    /// Sine of the angle at the ray's origin between the ray and the direction towards the point.
    #[inline]
    pub(super) fn sin_at_origin(&self) -> f32 {
        self.height / self.height.hypot(self.delta)
    }

    /// Density of the distance `t`.
    #[inline]
    pub fn density(&self, t: f32) -> PerLength {
        let along = t - self.delta;
        PerLength(self.height / (self.span * (self.height * self.height + along * along)))
    }
}

/// The same in lanes: eight rays and points. The density may be softened to 1/(d^2 + radius^2).
#[derive(Clone, Copy, Debug)]
pub(super) struct EquiangularLanes<L> {
    /// As in [`Equiangular`].
    pub(super) delta: L,
    pub(super) height: L,
    pub(super) span: L,
}

impl<L: Lanes> EquiangularLanes<L> {
    /// For the points at `to_target` from the starts of rays of those unit directions and finite lengths, softened by `radius`;
    /// and the way from the points' feet to the points.
    #[inline(always)]
    pub(super) fn new(direction: [L; 3], length: L, to_target: [L; 3], radius: f32) -> (Self, [L; 3]) {
        let delta = dot(to_target, direction);
        let rejection = along(to_target, L::splat(0.0).sub(delta), direction);
        let square = dot(rejection, rejection).add(L::splat(radius * radius));
        let least = dot(to_target, to_target).sqrt().mul(L::splat(1e-6)).max(L::splat(1e-12));
        let height = square.sqrt().max(least);
        let cos = height.mul(height).sub(delta.mul(length.sub(delta)));
        let span = angle(height.mul(length), cos).max(L::splat(1e-12));
        (Self { delta, height, span }, rejection)
    }

    /// As [`Equiangular::sample`].
    #[inline(always)]
    pub(super) fn sample(&self, u: L) -> L {
        let (sin, cos) = sin_cos(u.mul(self.span));
        let square = self.delta.mul(self.delta).add(self.height.mul(self.height));
        let down = self.height.mul(cos).add(self.delta.mul(sin));
        square.mul(sin).div(down).max(L::splat(0.0))
    }

    /// As [`Equiangular::density`].
    #[inline(always)]
    pub(super) fn density(&self, t: L) -> L {
        let off = t.sub(self.delta);
        self.height.div(self.span.mul(self.height.mul(self.height).add(off.mul(off))))
    }

    /// The `u` that gives the distance `t`.
    #[cfg(test)]
    #[inline(always)]
    pub(super) fn position(&self, t: L) -> L {
        let cos = self.height.mul(self.height).sub(self.delta.mul(t.sub(self.delta)));
        angle(self.height.mul(t).max(L::splat(1e-30)), cos).min(self.span).div(self.span)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    fn setup(delta: f32, height: f32) -> (Ray, Vec3) {
        let ray = Ray { origin: Vec3::new(1.0, 2.0, 3.0), direction: Vec3::new(0.48, 0.6, 0.64).normalize() };
        let across = ray.direction.cross(Vec3::X).normalize();
        (ray, ray.at(delta) + height * across)
    }

    #[test]
    fn density_integrates_to_one_and_is_that_of_the_samples() {
        for (delta, height, length) in [(2.0, 0.5, 10.0), (-1.0, 0.2, 3.0), (5.0, 0.01, 6.0), (2.0, 0.5, f32::INFINITY)]
        {
            let (ray, target) = setup(delta, height);
            let sampling = Equiangular::new(&ray, length, target);
            // P(t < x) in closed form from the density's definition, against the counts of samples.
            let mut rng = Rng::keyed(1, 2, 3);
            let n = 200_000;
            let x = (delta + 0.3).max(0.2);
            let below = (0..n).filter(|_| sampling.sample(rng.f32()) < x).count() as f64 / f64::from(n);
            let steps = 2_000_000;
            let expected: f64 = (0..steps)
                .map(|i| {
                    f64::from(sampling.density((i as f32 + 0.5) / steps as f32 * x).0) * f64::from(x) / f64::from(steps)
                })
                .sum();
            let sigma = (expected * (1.0 - expected) / f64::from(n)).sqrt();
            assert!((below - expected).abs() < 4.0 * sigma + 1e-4, "{below} against {expected}");
        }
    }
}
