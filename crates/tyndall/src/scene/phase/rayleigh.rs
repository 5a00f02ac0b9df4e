//! Scattering by particles much smaller than the wavelength: `3 / (16 pi) * (1 + cos^2)`.

use super::deflect;
use crate::math::{PerSolidAngle, Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Value, 1/sr.
#[inline(always)]
pub(super) fn eval(cos: f32) -> f32 {
    3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
}

/// A direction with the density of the value (Frisvad 2011, the real root of the cubic).
#[inline(always)]
pub(super) fn sample(d_in: Vec3, u: Vec2) -> (Vec3, PerSolidAngle) {
    let y = 4.0 * u.x - 2.0;
    // With |y| the sum has no cancellation; the cosine is odd in y.
    let w = (y.abs() + (1.0 + y * y).sqrt()).cbrt();
    let cos = (w - w.recip()).min(1.0).copysign(y);
    let sin = (1.0 - cos * cos).sqrt();
    (deflect(d_in, cos, sin, u.y), PerSolidAngle(eval(cos)))
}
