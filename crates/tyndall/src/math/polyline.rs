//! Densities on the unit interval that are linear between nodes, eight at once.

use super::lanes::{Lanes, Mask};

/// Densities on [0, 1] given at `N` equidistant nodes and linear in between, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Polyline<L, const N: usize> {
    /// Density at the nodes.
    values: [L; N],
    /// Probability below each node.
    cumulative: [L; N],
}

/// Integral over [0, 1] of what is linear between equidistant nodes.
#[inline(always)]
pub fn integral<L: Lanes, const N: usize>(values: &[L; N]) -> L {
    let mut sum = values[0].add(values[N - 1]).mul(L::splat(0.5));
    for value in &values[1..N - 1] {
        sum = sum.add(*value);
    }
    sum.mul(L::splat(1.0 / (N - 1) as f32))
}

impl<L: Lanes, const N: usize> Polyline<L, N> {
    /// Through `values` (not negative, of any scale), all lifted by `floor` times their mean, so that nothing is out of reach.
    /// Uniform where they are all zero.
    #[inline(always)]
    pub fn new(values: &[L; N], floor: f32) -> Self {
        const { assert!(N >= 2) }
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mean = integral(values);
        let usual = zero.lt(mean).and(mean.lt(L::splat(f32::INFINITY)));
        let scale = one.div(mean.select(usual, one)).mul(L::splat(1.0 / (1.0 + floor)));
        let lift = L::splat(floor / (1.0 + floor)).select(usual, one);
        let mut line = Self { values: *values, cumulative: [zero; N] };
        for value in &mut line.values {
            // Values that are no numbers count as zeros.
            *value = value.max(zero).mul(scale).select(usual, zero).add(lift);
        }
        for i in 1..N {
            let step = line.values[i - 1].add(line.values[i]).mul(L::splat(0.5 / (N - 1) as f32));
            line.cumulative[i] = line.cumulative[i - 1].add(step);
        }
        line
    }

    /// The place for `u` in [0, 1), and its density.
    #[inline(always)]
    pub fn sample(&self, u: L) -> (L, L) {
        let zero = L::splat(0.0);
        let (mut node, mut below, mut until) = (zero, self.cumulative[0], self.cumulative[1]);
        let (mut a, mut b) = (self.values[0], self.values[1]);
        for i in 1..N - 1 {
            let beyond = self.cumulative[i].le(u);
            node = L::splat(i as f32).select(beyond, node);
            below = self.cumulative[i].select(beyond, below);
            until = self.cumulative[i + 1].select(beyond, until);
            a = self.values[i].select(beyond, a);
            b = self.values[i + 1].select(beyond, b);
        }
        let share = u.sub(below).div(until.sub(below));
        // Solves a t + (b - a) t^2 / 2 = share (a + b) / 2, in the form without cancellation.
        let target = share.mul(a.add(b));
        let root = a.mul(a).add(target.mul(b.sub(a))).max(zero).sqrt();
        let t = target.div(a.add(root)).min(L::splat(1.0)).select(zero.lt(target), zero);
        (node.add(t).mul(L::splat(1.0 / (N - 1) as f32)), a.add(t.mul(b.sub(a))))
    }

    /// Density at `x` in [0, 1].
    #[inline(always)]
    pub fn density(&self, x: L) -> L {
        let position = x.max(L::splat(0.0)).mul(L::splat((N - 1) as f32));
        let (mut a, mut b, mut node) = (self.values[0], self.values[1], L::splat(0.0));
        for i in 1..N - 1 {
            let beyond = L::splat(i as f32).le(position);
            node = L::splat(i as f32).select(beyond, node);
            a = self.values[i].select(beyond, a);
            b = self.values[i + 1].select(beyond, b);
        }
        a.add(position.sub(node).min(L::splat(1.0)).mul(b.sub(a)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Kernel, Level, Row, WIDTH};
    use tyndall_testkit::chi2;

    const ROWS: [([f32; 5], f32); 5] = [
        ([1.0, 1.0, 1.0, 1.0, 1.0], 0.0),
        ([0.0, 3.0, 0.5, 0.0, 7.0], 0.0),
        ([0.0, 0.0, 1e-3, 0.0, 0.0], 0.1),
        ([1e-20, 1e-22, 0.0, 2e-20, 4e-19], 0.02),
        ([0.0; 5], 0.1),
    ];

    /// A place for `x`, its density, and the density at `x`, of the row in every lane.
    struct Draw([f32; 5], f32, f32);

    impl Kernel for Draw {
        type Output = [Row; 3];

        #[inline(always)]
        fn run<L: Lanes>(self) -> [Row; 3] {
            let Self(values, floor, x) = self;
            let line = Polyline::new(&values.map(L::splat), floor);
            let (place, density) = line.sample(L::splat(x));
            [place.store(), density.store(), line.density(L::splat(x)).store()]
        }
    }

    #[test]
    fn samples_follow_the_density() {
        for (seed, (values, floor)) in (0..).zip(ROWS) {
            let lane = seed as usize % WIDTH;
            let draw = |x| Level::dispatch(Draw(values, floor, x)).map(|row| row.0[lane]);
            let sample = |u| {
                let [x, density, _] = draw(u);
                let there = draw(x)[2];
                assert!((0.0..=1.0).contains(&x) && (density - there).abs() <= 1e-4 * density.max(1.0));
                Some(f64::from(x))
            };
            let outcome = chi2::interval(sample, |x| f64::from(draw(x as f32)[2]), 0.0, 1.0, 100_000, seed);
            assert!((outcome.integral - 1.0).abs() < 1e-5, "{values:?}: {outcome:?}");
            outcome.assert(0.01, ROWS.len());
        }
    }
}
