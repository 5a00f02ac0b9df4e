//! Two phase functions in fixed shares.

use super::{Phase, PhaseError};
use crate::math::{PerSolidAngle, Vec2, Vec3};

/// `(1 - weight) * first + weight * second`.
#[derive(Clone, Debug)]
pub struct Blend {
    weight: f32,
    first: Phase,
    second: Phase,
}

impl Blend {
    /// A blend; `weight` in [0, 1] is the share of `second`.
    pub fn new(weight: f32, first: Phase, second: Phase) -> Result<Self, PhaseError> {
        if !(0.0..=1.0).contains(&weight) {
            return Err(PhaseError::Weight(weight));
        }
        Ok(Self { weight, first, second })
    }

    /// Value, 1/sr.
    pub fn eval(&self, x: Vec3, d_in: Vec3, d_out: Vec3) -> f32 {
        let (first, second) = (self.first.eval(x, d_in, d_out), self.second.eval(x, d_in, d_out));
        first + self.weight * (second - first)
    }

    pub(super) fn at_cosine(&self, cos: f32) -> f32 {
        let (first, second) = (self.first.at_cosine(cos), self.second.at_cosine(cos));
        first + self.weight * (second - first)
    }

    /// Upper bound of [`Phase::contrast`], which is convex in the function.
    pub(super) fn contrast(&self) -> f32 {
        let (first, second) = (self.first.contrast(), self.second.contrast());
        first + self.weight * (second - first)
    }

    /// Upper bound of the value, 1/sr, over a range of cosines.
    pub fn ceiling(&self, cos: [f32; 2]) -> f32 {
        let (first, second) = (self.first.ceiling(cos), self.second.ceiling(cos));
        first + self.weight * (second - first)
    }

    /// A direction with the density of the value; `u1` chooses the function and is stretched for the next blend inside.
    pub fn sample(&self, x: Vec3, d_in: Vec3, u1: f32, u2: Vec2) -> (Vec3, PerSolidAngle) {
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        let w = self.weight;
        if u1 < w {
            let (d_out, pdf) = self.second.sample(x, d_in, (u1 / w).min(BELOW_ONE), u2);
            (d_out, PerSolidAngle((1.0 - w) * self.first.eval(x, d_in, d_out) + w * pdf.0))
        } else {
            let (d_out, pdf) = self.first.sample(x, d_in, ((u1 - w) / (1.0 - w)).min(BELOW_ONE), u2);
            (d_out, PerSolidAngle((1.0 - w) * pdf.0 + w * self.second.eval(x, d_in, d_out)))
        }
    }
}
