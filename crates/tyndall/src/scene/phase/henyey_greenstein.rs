//! The function of Henyey and Greenstein (1941): `(1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^1.5)`.

use super::{PhaseError, deflect};
use crate::math::{PerSolidAngle, Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Henyey and Greenstein's function with mean cosine g.
///
/// Inside, g is split into its size and a sign of the axis: the function of -g about an axis is that of g about the
/// opposite axis.
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    sign: f32,
    size: f32,
    /// (1 - |g|)^2
    gap_squared: f32,
    /// (1 - g^2) / (4 pi)
    factor: f32,
}

impl HenyeyGreenstein {
    /// The function with mean cosine `g` in (-1, 1).
    pub fn new(g: f32) -> Result<Self, PhaseError> {
        let size = g.abs();
        if !(size < 1.0) {
            return Err(PhaseError::MeanCosine(g));
        }
        let gap = 1.0 - size;
        Ok(Self {
            sign: 1.0_f32.copysign(g),
            size,
            gap_squared: gap * gap,
            factor: gap * (1.0 + size) * 0.25 * FRAC_1_PI,
        })
    }

    /// The mean cosine.
    #[inline(always)]
    pub fn g(&self) -> f32 {
        self.size * self.sign
    }

    /// Value, 1/sr.
    #[inline(always)]
    pub fn eval(&self, d_in: Vec3, d_out: Vec3) -> f32 {
        // 2 (1 - cos) is the squared chord, which keeps its digits in the peak where 1 - cos has none left.
        self.value((d_out - self.sign * d_in).length_squared())
    }

    /// Value at the cosine between both directions, 1/sr, without the digits that the peak of a function near one needs.
    #[inline(always)]
    pub(super) fn at_cosine(&self, cos: f32) -> f32 {
        self.value((2.0 - 2.0 * self.sign * cos).max(0.0))
    }

    /// As [`Phase::contrast`](super::Phase::contrast): `(1 + g^2) / (1 - g^2)^2`.
    pub(super) fn contrast(&self) -> f32 {
        let g2 = self.size * self.size;
        (1.0 + g2) / ((1.0 - g2) * (1.0 - g2))
    }

    /// Upper bound of the value, 1/sr, over a range of cosines: the function is monotonous.
    #[inline(always)]
    pub fn ceiling(&self, cos: [f32; 2]) -> f32 {
        let cos = if self.sign > 0.0 { cos[1] } else { -cos[0] };
        self.value(2.0 - 2.0 * cos.min(1.0))
    }

    /// Value at the squared chord from the axis to the direction.
    #[inline(always)]
    fn value(&self, chord_squared: f32) -> f32 {
        let s = self.gap_squared + self.size * chord_squared;
        self.factor / (s * s.sqrt())
    }

    /// A direction with the density of the value.
    #[inline(always)]
    pub fn sample(&self, d_in: Vec3, u: Vec2) -> (Vec3, PerSolidAngle) {
        // The inverted cumulative function, solved for 1 - cos: no division by g and no cancellation for any g.
        let d = (1.0 - self.size) + 2.0 * self.size * u.x;
        let one_minus_cos = (2.0 * self.gap_squared * (1.0 - u.x) * (1.0 + self.size * u.x) / (d * d)).min(2.0);
        let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
        let direction = deflect(self.sign * d_in, 1.0 - one_minus_cos, sin, u.y);
        (direction, PerSolidAngle(self.value(2.0 * one_minus_cos)))
    }
}
