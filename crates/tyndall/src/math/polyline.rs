//! Densities on the unit interval that are linear between nodes.

/// A density on [0, 1] given at `N` equidistant nodes and linear in between.
#[derive(Clone, Copy, Debug)]
pub struct Polyline<const N: usize> {
    /// Density at the nodes.
    values: [f32; N],
    /// Probability below each node.
    cumulative: [f32; N],
}

/// Integral over [0, 1] of what is linear between equidistant nodes.
#[inline]
pub fn integral<const N: usize>(values: &[f32; N]) -> f32 {
    let sum: f32 = values.iter().sum();
    (sum - 0.5 * (values[0] + values[N - 1])) / (N - 1) as f32
}

impl<const N: usize> Polyline<N> {
    /// Through `values` (not negative, of any scale), all lifted by `floor` times their mean, so that nothing is out of reach.
    /// Uniform where they are all zero.
    #[inline]
    pub fn new(values: &[f32; N], floor: f32) -> Self {
        const { assert!(N >= 2) }
        let mean = integral(values);
        let (scale, lift) = match mean > 0.0 && mean.is_finite() {
            true => ((1.0 / mean) / (1.0 + floor), floor / (1.0 + floor)),
            false => (0.0, 1.0),
        };
        let values = values.map(|value| value * scale + lift);
        let mut cumulative = [0.0; N];
        for i in 1..N {
            cumulative[i] = cumulative[i - 1] + (values[i - 1] + values[i]) * (0.5 / (N - 1) as f32);
        }
        Self { values, cumulative }
    }

    /// The place for `u` in [0, 1), and its density.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let i = self.cumulative[1..N - 1].iter().filter(|below| **below <= u).count();
        let (a, b) = (self.values[i], self.values[i + 1]);
        let share = (u - self.cumulative[i]) / (self.cumulative[i + 1] - self.cumulative[i]);
        // Solves a t + (b - a) t^2 / 2 = share (a + b) / 2, in the form without cancellation.
        let target = share * (a + b);
        let root = (a * a + target * (b - a)).max(0.0).sqrt();
        let t = if target > 0.0 { (target / (a + root)).min(1.0) } else { 0.0 };
        ((i as f32 + t) / (N - 1) as f32, a + t * (b - a))
    }

    /// Density at `x` in [0, 1].
    #[inline]
    pub fn density(&self, x: f32) -> f32 {
        let position = x.max(0.0) * (N - 1) as f32;
        let i = (position as usize).min(N - 2);
        let t = (position - i as f32).min(1.0);
        self.values[i] + t * (self.values[i + 1] - self.values[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_testkit::chi2;

    #[test]
    fn samples_follow_the_density() {
        let rows = [
            ([1.0, 1.0, 1.0, 1.0, 1.0], 0.0),
            ([0.0, 3.0, 0.5, 0.0, 7.0], 0.0),
            ([0.0, 0.0, 1e-3, 0.0, 0.0], 0.1),
            ([1e-20, 1e-22, 0.0, 2e-20, 4e-19], 0.02),
            ([0.0; 5], 0.1),
        ];
        for (seed, (values, floor)) in (0..).zip(&rows) {
            let line = Polyline::new(values, *floor);
            let sample = |u| {
                let (x, density) = line.sample(u);
                assert!((0.0..=1.0).contains(&x) && (density - line.density(x)).abs() <= 1e-4 * density.max(1.0));
                Some(f64::from(x))
            };
            let outcome = chi2::interval(sample, |x| f64::from(line.density(x as f32)), 0.0, 1.0, 100_000, seed);
            assert!((outcome.integral - 1.0).abs() < 1e-5, "{values:?}: {outcome:?}");
            outcome.assert(0.01, rows.len());
        }
    }
}
