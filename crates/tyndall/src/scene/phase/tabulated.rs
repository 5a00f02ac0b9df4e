//! A table over the cosine, linear in between.

use super::{PhaseError, deflect};
use crate::math::{PerSolidAngle, Vec2, Vec3};
use std::f64::consts::TAU;

/// A phase function given at equidistant cosines from -1 to 1 and linear in between.
#[derive(Clone, Debug)]
pub struct Tabulated {
    /// Normalised values, 1/sr.
    values: Vec<f32>,
    /// Probability that the cosine lies below each node; as long as `values`.
    cumulative: Vec<f32>,
    /// Intervals per unit of the cosine.
    resolution: f32,
}

impl Tabulated {
    /// The function through `values` (any scale).
    pub fn new(values: &[f32]) -> Result<Self, PhaseError> {
        if values.len() < 2 {
            return Err(PhaseError::TableTooShort(values.len()));
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, v)| !(v.is_finite() && **v >= 0.0)) {
            return Err(PhaseError::TableValue { index, value });
        }
        let width = 2.0 / (values.len() - 1) as f64;
        let mut cumulative = vec![0.0];
        for pair in values.windows(2) {
            cumulative.push(cumulative[cumulative.len() - 1] + 0.5 * width * (f64::from(pair[0]) + f64::from(pair[1])));
        }
        let integral = cumulative[cumulative.len() - 1];
        if integral == 0.0 {
            return Err(PhaseError::TableEmpty);
        }
        Ok(Self {
            values: values.iter().map(|&v| (f64::from(v) / (TAU * integral)) as f32).collect(),
            cumulative: cumulative.iter().map(|&c| (c / integral) as f32).collect(),
            resolution: (1.0 / width) as f32,
        })
    }

    /// Value, 1/sr.
    #[inline]
    pub fn eval(&self, cos: f32) -> f32 {
        let position = (cos + 1.0).max(0.0) * self.resolution;
        let i = (position as usize).min(self.values.len() - 2);
        let t = (position - i as f32).min(1.0);
        self.values[i] + t * (self.values[i + 1] - self.values[i])
    }

    /// As [`Phase::contrast`](super::Phase::contrast).
    pub(super) fn contrast(&self) -> f32 {
        // The square of what is linear between a and b has the mean (a^2 + a b + b^2) / 3.
        let squares: f64 =
            self.values.windows(2).map(|v| f64::from(v[0] * v[0] + v[0] * v[1] + v[1] * v[1]) / 3.0).sum();
        (2.0 * TAU * TAU * squares / f64::from(self.resolution)) as f32
    }

    /// Upper bound of the value, 1/sr, over a range of cosines.
    pub fn ceiling(&self, cos: [f32; 2]) -> f32 {
        let node = |cos: f32| ((cos + 1.0).max(0.0) * self.resolution).min((self.values.len() - 1) as f32);
        let (first, last) = (node(cos[0]).ceil() as usize, node(cos[1]).floor() as usize);
        let ends = self.eval(cos[0]).max(self.eval(cos[1]));
        self.values.get(first..=last).into_iter().flatten().copied().fold(ends, f32::max)
    }

    /// A direction with the density of the value.
    #[inline]
    pub fn sample(&self, d_in: Vec3, u: Vec2) -> (Vec3, PerSolidAngle) {
        // The last node not above u: an interval without probability is never the last of its equals.
        let i = self.cumulative.partition_point(|&c| c <= u.x).clamp(1, self.values.len() - 1) - 1;
        let (a, b) = (self.values[i], self.values[i + 1]);
        let share = (u.x - self.cumulative[i]) / (self.cumulative[i + 1] - self.cumulative[i]);
        // Solve a t + (b - a) t^2 / 2 = share (a + b) / 2 in the form without cancellation.
        let target = share * (a + b);
        let root = (a * a + target * (b - a)).max(0.0).sqrt();
        let t = if target > 0.0 { (target / (a + root)).min(1.0) } else { 0.0 };
        let cos = ((i as f32 + t) / self.resolution - 1.0).clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        (deflect(d_in, cos, sin, u.y), PerSolidAngle(a + t * (b - a)))
    }
}
