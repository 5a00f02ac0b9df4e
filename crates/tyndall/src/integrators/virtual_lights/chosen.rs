//! Which lights a query visits.

/// Lights with the probability of each.
#[derive(Debug, Default)]
pub(super) struct Choice {
    /// Sums of the weights up to each light.
    cumulative: Vec<f64>,
}

impl Choice {
    /// Becomes a choice by these weights. Memory is re-used.
    pub(super) fn of(&mut self, weights: impl Iterator<Item = f32>) {
        let mut sum = 0.0;
        self.cumulative.clear();
        self.cumulative.extend(weights.map(|weight| {
            sum += f64::from(weight);
            sum
        }));
    }

    /// How many lights there are.
    pub(super) fn len(&self) -> usize {
        self.cumulative.len()
    }

    /// Visits all lights, or `count` of them at equal steps of the sum of weights, shifted by `u` in [0, 1): `visit` is told
    /// the light and the reciprocal of the expected number of its visits.
    #[inline]
    pub(super) fn visit(&self, count: u32, u: f32, mut visit: impl FnMut(usize, f32)) {
        let all = self.cumulative.len();
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        if count == 0 || count as usize >= all || total <= 0.0 {
            (0..all).for_each(|light| visit(light, 1.0));
            return;
        }
        let step = total / f64::from(count);
        for i in 0..count {
            let x = (f64::from(i) + f64::from(u)) * step;
            let light = self.cumulative.partition_point(|sum| *sum <= x).min(all - 1);
            let below = if light == 0 { 0.0 } else { self.cumulative[light - 1] };
            visit(light, (step / (self.cumulative[light] - below)) as f32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    #[test]
    fn visits_have_the_weights_of_their_frequency() {
        let weights = [1.0, 0.0, 3.0, 0.5, 8.0, 0.0, 2.5];
        let mut choice = Choice::default();
        choice.of(weights.into_iter());
        let mut rng = Rng::keyed(1, 0, 0);
        for count in [0, 1, 3, 6, 7, 20] {
            let mut sums = [0.0; 7];
            let n = 20_000;
            for _ in 0..n {
                choice.visit(count, rng.f32(), |light, weight| sums[light] += f64::from(weight) / f64::from(n));
            }
            for (light, (sum, weight)) in sums.into_iter().zip(weights).enumerate() {
                let expected = if weight == 0.0 && (1..7).contains(&count) { 0.0 } else { 1.0 };
                assert!((sum - expected).abs() < 0.1, "{count} visits: light {light} counts {sum}");
            }
        }
        Choice::default().visit(3, 0.5, |_, _| panic!("there are no lights"));
    }
}
