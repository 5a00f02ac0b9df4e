//! Which pairs are worth a shadow ray.

use crate::math::Rng;
use std::cell::Cell;

/// Russian roulette over the pairs of a query. What a pair would give if nothing stood between both is known before the shadow
/// ray, which is the dearest part of it: those that would give less than the mean so far survive in proportion.
#[derive(Debug, Default)]
pub(super) struct Roulette {
    sum: Cell<f32>,
    count: Cell<f32>,
}

impl Roulette {
    /// The pairs of the next query begin.
    #[inline(always)]
    pub(super) fn start(&self) {
        self.sum.set(0.0);
        self.count.set(0.0);
    }

    /// The factor by which a pair counts that would give `value`; `None`: it does not survive.
    #[inline(always)]
    pub(super) fn survive(&self, value: f32, rng: &mut Rng) -> Option<f32> {
        // The mean knows nothing of what stands between: the expectation stays what it is.
        let (sum, count) = (self.sum.get() + value, self.count.get() + 1.0);
        self.sum.set(sum);
        self.count.set(count);
        let survival = value * count / sum;
        if survival < 1.0 {
            return (rng.f32() < survival).then(|| 1.0 / survival);
        }
        Some(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_survives_counts_for_what_does_not() {
        let values = [1.0, 0.02, 3.0, 0.5, 0.5, 40.0, 0.1, 7.0];
        let roulette = Roulette::default();
        let (runs, mut sums, mut shots) = (100_000_u64, [0.0; 8], 0);
        for run in 0..runs {
            let mut rng = Rng::keyed(3, 1, run);
            roulette.start();
            for (sum, value) in sums.iter_mut().zip(values) {
                let Some(factor) = roulette.survive(value, &mut rng) else { continue };
                *sum += f64::from(factor);
                shots += 1;
            }
        }
        for (sum, value) in sums.into_iter().zip(values) {
            // A factor is at most 1 / survival, so its variance is less than that.
            let mean = sum / runs as f64;
            assert!((mean - 1.0).abs() < 0.1, "{value} counts {mean}");
        }
        assert!(shots < 5 * runs, "{shots} of {} were looked along", 8 * runs);
        // Nothing so far, and nothing at all.
        roulette.start();
        let mut rng = Rng::keyed(3, 2, 0);
        assert_eq!([roulette.survive(0.0, &mut rng), roulette.survive(f32::NAN, &mut rng)], [Some(1.0); 2]);
    }
}
