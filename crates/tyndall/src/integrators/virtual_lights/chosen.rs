//! Which lights a query visits.

/// Lights with the probability of each.
#[derive(Debug, Default)]
pub(super) struct Choice {
    /// Sums of the weights up to each light.
    cumulative: Vec<f64>,
    /// The light that each of so many equal steps of the whole sum begins in: where a search begins (Chen and Asau 1974).
    guide: Vec<u32>,
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
        self.guide.clear();
        let all = self.cumulative.len();
        let mut light = 0;
        self.guide.extend((0..all).map(|i| {
            let begin = i as f64 * (sum / all as f64);
            while light + 1 < all && self.cumulative[light] <= begin {
                light += 1;
            }
            light as u32
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
        let per_step = all as f64 / f64::from(count);
        for i in 0..count {
            let place = f64::from(i) + f64::from(u);
            let x = place * step;
            // One step early, whatever the rounding.
            let guide = ((place * per_step) as usize).saturating_sub(1).min(all - 1);
            let mut light = self.guide[guide] as usize;
            while light + 1 < all && self.cumulative[light] <= x {
                light += 1;
            }
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

    /// The guide leads to the light that a search through all sums finds.
    #[test]
    fn the_guide_changes_nothing() {
        let mut rng = Rng::keyed(2, 0, 0);
        for all in [1, 2, 7, 100, 1000] {
            let weights: Vec<f32> = (0..all).map(|_| if rng.f32() < 0.3 { 0.0 } else { rng.f32().powi(8) }).collect();
            let mut choice = Choice::default();
            choice.of(weights.iter().copied());
            let total = choice.cumulative[all - 1];
            for count in [1_u32, 2, 5, 64] {
                if count as usize >= all || total == 0.0 {
                    continue;
                }
                let u = rng.f32();
                let mut i = 0;
                choice.visit(count, u, |light, _| {
                    let x = (f64::from(i) + f64::from(u)) * (total / f64::from(count));
                    assert_eq!(light, choice.cumulative.partition_point(|sum| *sum <= x).min(all - 1));
                    i += 1;
                });
                assert_eq!(i, count);
            }
        }
    }
}
