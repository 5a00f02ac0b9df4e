//! Means over a picture whose pixels may be correlated: neighbours are summed to blocks, which hardly are.

/// Edge of a block, pixels: a few times the reach of a photon's blur.
const EDGE: usize = 8;

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// The mean over all pixels.
    pub(crate) value: f64,
    /// Its standard error from the scatter of blocks, which are taken to be independent.
    pub(crate) error: f64,
}

impl Mean {
    /// Of a value for every pixel, row by row.
    pub(crate) fn of(width: usize, values: &[f64]) -> Self {
        let across = width.div_ceil(EDGE);
        let down = (values.len() / width).div_ceil(EDGE);
        let mut sums = vec![(0.0, 0.0); across * down];
        for (i, value) in values.iter().enumerate() {
            let block = &mut sums[(i / width / EDGE) * across + i % width / EDGE];
            block.0 += value;
            block.1 += 1.0;
        }
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let blocks = sums.len() as f64;
        let squares: f64 = sums.iter().map(|(sum, count)| (sum - count * value).powi(2)).sum();
        let error = if blocks > 1.0 { (squares * blocks / (blocks - 1.0)).sqrt() / n } else { f64::INFINITY };
        Self { value, error }
    }

    /// The mean in units of its error; 0 when all is 0.
    pub(crate) fn z(self) -> f64 {
        if self.value == 0.0 { 0.0 } else { self.value / self.error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn independent_pixels_have_the_usual_error() {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let values: Vec<f64> = (0..100 * 90).map(|_| uniform()).collect();
        let mean = Mean::of(100, &values);
        let expected = (1.0f64 / 12.0 / 9000.0).sqrt();
        assert!((mean.error / expected - 1.0).abs() < 0.2, "{} {expected}", mean.error);
        assert!((mean.value - 0.5).abs() < 4.0 * mean.error);
        // Each value eight times: the error has to grow by the root of eight.
        let copies: Vec<f64> = (0..100 * 90).map(|i| values[i % 100 / 8 + i / 100 * 100]).collect();
        let grown = Mean::of(100, &copies).error / expected;
        assert!((2.2..3.5).contains(&grown), "{grown}");
    }
}
