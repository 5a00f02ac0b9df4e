//! Scattering into all directions alike.

use crate::math::{PerSolidAngle, Vec2, Vec3, warp};

/// 1/(4 pi), 1/sr.
pub(super) const VALUE: f32 = std::f32::consts::FRAC_1_PI / 4.0;

/// A uniform direction.
#[inline(always)]
pub(super) fn sample(u: Vec2) -> (Vec3, PerSolidAngle) {
    (warp::square_to_sphere(u), PerSolidAngle(VALUE))
}
