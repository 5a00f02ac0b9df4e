//! Gauss-Legendre quadrature.

/// `n` nodes in (0, 1) and their weights, which sum to 1: exact for polynomials up to degree `2 n - 1`.
pub fn gauss_legendre(n: usize) -> (Vec<f32>, Vec<f32>) {
    (0..n)
        .map(|i| {
            // Newton's method from the classical first guess (Abramowitz and Stegun 1964, 22.16.6).
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..8 {
                let (mut p, mut previous) = (x, 1.0);
                for k in 2..=n {
                    let k = k as f64;
                    (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
                }
                slope = n as f64 * (x * p - previous) / (x * x - 1.0);
                x -= p / slope;
            }
            ((0.5 + 0.5 * x) as f32, (1.0 / ((1.0 - x * x) * slope * slope)) as f32)
        })
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_exact() {
        for n in [2, 5, 32, 128] {
            let (x, w) = gauss_legendre(n);
            for power in 0..(2 * n).min(12) as i32 {
                let sum: f64 = x.iter().zip(&w).map(|(&x, &w)| f64::from(w) * f64::from(x).powi(power)).sum();
                assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-6, "{n} nodes, power {power}: {sum}");
            }
        }
    }
}
