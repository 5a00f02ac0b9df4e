//! Gauss-Legendre rules and adaptive integration.

/// Nodes on [-1, 1] of the five-point Gauss-Legendre rule.
pub(crate) const NODES: [f64; 5] =
    [-0.906_179_845_938_664, -0.538_469_310_105_683_1, 0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
/// Weights of the five-point Gauss-Legendre rule, sum 2.
pub(crate) const WEIGHTS: [f64; 5] = [
    0.236_926_885_056_189_1,
    0.478_628_670_499_366_5,
    0.568_888_888_888_888_9,
    0.478_628_670_499_366_5,
    0.236_926_885_056_189_1,
];

fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let (mid, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * NODES.iter().zip(WEIGHTS).map(|(x, w)| w * f(mid + half * x)).sum::<f64>()
}

/// Integral of `f` over [a, b], bisected until two levels agree to `tolerance` (absolute) or 1e-12 of the value.
pub fn integrate(f: &impl Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> f64 {
    fn refine(f: &impl Fn(f64) -> f64, a: f64, b: f64, whole: f64, tolerance: f64, depth: u32) -> f64 {
        let mid = 0.5 * (a + b);
        let (left, right) = (gauss(f, a, mid), gauss(f, mid, b));
        let sum = left + right;
        if depth == 0 || (sum - whole).abs() <= tolerance.max(1e-12 * sum.abs()) {
            return sum;
        }
        refine(f, a, mid, left, 0.5 * tolerance, depth - 1) + refine(f, mid, b, right, 0.5 * tolerance, depth - 1)
    }
    refine(f, a, b, gauss(f, a, b), tolerance, 40)
}

/// A rectangle [x0, x1] x [y0, y1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rect {
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

impl Rect {
    pub(crate) fn centre(&self) -> [f64; 2] {
        [0.5 * (self.min[0] + self.max[0]), 0.5 * (self.min[1] + self.max[1])]
    }

    /// The four quarters; quarter `(x >= centre) + 2 (y >= centre)`.
    pub(crate) fn quarters(&self) -> [Rect; 4] {
        let [cx, cy] = self.centre();
        [0, 1, 2, 3].map(|i| {
            let (x0, x1) = if i & 1 == 0 { (self.min[0], cx) } else { (cx, self.max[0]) };
            let (y0, y1) = if i & 2 == 0 { (self.min[1], cy) } else { (cy, self.max[1]) };
            Rect { min: [x0, y0], max: [x1, y1] }
        })
    }

    fn gauss(&self, f: &impl Fn(f64, f64) -> f64) -> f64 {
        gauss(&|x| gauss(&|y| f(x, y), self.min[1], self.max[1]), self.min[0], self.max[0])
    }

    /// Integral of `f`, quartered until two levels agree to `tolerance`, at most 9 times.
    pub(crate) fn integrate(&self, f: &impl Fn(f64, f64) -> f64, tolerance: f64) -> f64 {
        fn refine(cell: &Rect, f: &impl Fn(f64, f64) -> f64, whole: f64, tolerance: f64, depth: u32) -> f64 {
            let quarters = cell.quarters();
            let parts = quarters.map(|q| q.gauss(f));
            let sum: f64 = parts.iter().sum();
            if depth == 0 || (sum - whole).abs() <= tolerance {
                return sum;
            }
            (0..4).map(|i| refine(&quarters[i], f, parts[i], tolerance, depth - 1)).sum()
        }
        refine(self, f, self.gauss(f), tolerance, 9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_smooth_peaked_and_broken_functions() {
        assert!((integrate(&|x| x.exp(), 0.0, 1.0, 1e-13) - (1f64.exp() - 1.0)).abs() < 1e-12);
        let peak = |x: f64| 1.0 / (1e-6 + (x - 0.3) * (x - 0.3));
        let exact = 1e3 * ((0.7e3f64).atan() + (0.3e3f64).atan());
        assert!((integrate(&peak, 0.0, 1.0, 1e-8) / exact - 1.0).abs() < 1e-9);
        let unit = Rect { min: [0.0, 0.0], max: [1.0, 1.0] };
        let quarter_disc = unit.integrate(&|x, y| if x * x + y * y < 1.0 { 1.0 } else { 0.0 }, 1e-7);
        assert!((quarter_disc - std::f64::consts::FRAC_PI_4).abs() < 1e-5);
    }
}
