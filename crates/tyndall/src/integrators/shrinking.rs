//! Radii of progressive passes.

/// The radii of progressive passes in units of the first: `r_{i+1}^J = r_i^J (i + alpha) / (i + 1)` for blurs of dimension J
/// (Hachisuka et al. 2008; Knaus and Zwicker 2011, eq. 15).
#[derive(Debug)]
pub(super) struct Shrinking {
    /// Passes so far, counted from 1, and the product up to there for media and for surfaces.
    pass: u32,
    factors: [f64; 2],
}

impl Shrinking {
    /// Before the first pass.
    pub(super) const START: Self = Self { pass: 1, factors: [1.0; 2] };

    /// The factors of pass number `pass`, counted from 0.
    pub(super) fn at(&mut self, pass: u32, dimensions: [u32; 2], alphas: [f64; 2]) -> [f32; 2] {
        if pass + 1 < self.pass {
            *self = Self::START;
        }
        while self.pass < pass + 1 {
            let i = f64::from(self.pass);
            for k in 0..2 {
                self.factors[k] *= ((i + alphas[k]) / (i + 1.0)).powf(1.0 / f64::from(dimensions[k].max(1)));
            }
            self.pass += 1;
        }
        self.factors.map(|f| f as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Logarithm of the gamma function (Stirling's series after a shift).
    fn ln_gamma(x: f64) -> f64 {
        if x < 10.0 {
            return ln_gamma(x + 1.0) - x.ln();
        }
        let tail = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
        (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + tail
    }

    /// The product of (i + alpha) / (i + 1) for i from 1 to n is Gamma(n + 1 + alpha) / (Gamma(1 + alpha) Gamma(n + 2)).
    #[test]
    fn radii_shrink_as_gamma_functions_do() {
        for (dimensions, alphas) in [([1, 2], [0.8, 2.0 / 3.0]), ([3, 2], [4.0 / 7.0, 0.1]), ([2, 2], [0.5, 0.99])] {
            let mut shrinking = Shrinking::START;
            // The last one goes back, as after a checkpoint.
            for n in [0, 1, 2, 10, 1000, 1_000_000, 7] {
                let found = shrinking.at(n, dimensions, alphas);
                for k in 0..2 {
                    let (n, alpha) = (f64::from(n), alphas[k]);
                    let product = ln_gamma(n + 1.0 + alpha) - ln_gamma(1.0 + alpha) - ln_gamma(n + 2.0);
                    let expected = (product / f64::from(dimensions[k])).exp();
                    let error = f64::from(found[k]) / expected - 1.0;
                    assert!(error.abs() < 1e-6, "pass {n}, {dimensions:?}: {} is not {expected}", found[k]);
                }
            }
        }
    }
}
