//! Distances with a density that is constant on each of a few equal cells.

use crate::math::PerLength;

/// How many cells there are.
const COUNT: usize = 32;

/// Share of the probability that is spread evenly, so that no distance is left out.
const EVEN: f32 = 0.1;

/// Distances on a stretch, with a density in proportion to a function that was looked at once in each cell.
#[derive(Clone, Copy, Debug)]
pub struct Cells {
    /// Probability of the cells up to each, the last one included.
    cumulative: [f32; COUNT],
    /// Length of a cell, metres.
    width: f32,
}

impl Cells {
    /// Distances from 0 to `length` (finite), in proportion to `weight` at the middle of each cell.
    #[inline]
    pub fn new(length: f32, weight: impl Fn(f32) -> f32) -> Self {
        let width = length / COUNT as f32;
        let mut sum = 0.0;
        let mut cumulative = std::array::from_fn(|i| {
            sum += weight((i as f32 + 0.5) * width);
            sum
        });
        let scale = if sum > 0.0 { (1.0 - EVEN) / sum } else { 0.0 };
        let even = if sum > 0.0 { EVEN } else { 1.0 } / COUNT as f32;
        for (i, probability) in cumulative.iter_mut().enumerate() {
            *probability = *probability * scale + (i + 1) as f32 * even;
        }
        Self { cumulative, width }
    }

    /// The distance for `u` in [0, 1), metres, and its density.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, PerLength) {
        let cell = self.cumulative.partition_point(|sum| *sum <= u).min(COUNT - 1);
        let below = if cell == 0 { 0.0 } else { self.cumulative[cell - 1] };
        let probability = self.cumulative[cell] - below;
        let within = ((u - below) / probability).min(1.0);
        ((cell as f32 + within) * self.width, PerLength(probability / self.width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_follow_their_density() {
        let weights: [fn(f32) -> f32; 4] =
            [|_| 0.0, |_| 2.0, |t| (-5.0 * t).exp(), |t| if (1.0..1.3).contains(&t) { 1.0 } else { 0.0 }];
        for weight in weights {
            let cells = Cells::new(2.5, weight);
            assert!((cells.cumulative[COUNT - 1] - 1.0).abs() < 1e-5);
            // Evenly spaced numbers, counted in four parts of each cell.
            let n = 100_000;
            let mut counts = [0; 4 * COUNT];
            let mut densities = [0.0; 4 * COUNT];
            for i in 0..n {
                let (t, density) = cells.sample((i as f32 + 0.5) / n as f32);
                let part = (t / 2.5 * (4 * COUNT) as f32) as usize;
                counts[part.min(4 * COUNT - 1)] += 1;
                densities[part.min(4 * COUNT - 1)] = density.0;
            }
            for (count, density) in counts.into_iter().zip(densities) {
                let expected = density * 2.5 / (4 * COUNT) as f32 * n as f32;
                assert!((count as f32 - expected).abs() < 3.0 + 1e-4 * expected, "{count} {expected}");
            }
            // In proportion to the weight, but for the even share.
            let sum: f32 = (0..COUNT).map(|i| weight((i as f32 + 0.5) * cells.width)).sum();
            for (i, density) in densities.into_iter().step_by(4).enumerate() {
                let share = if sum > 0.0 { weight((i as f32 + 0.5) * cells.width) / sum } else { 1.0 / COUNT as f32 };
                let expected = (1.0 - EVEN) * share + EVEN / COUNT as f32;
                assert!((density * cells.width - expected).abs() < 1e-6, "{density}");
            }
        }
    }
}
