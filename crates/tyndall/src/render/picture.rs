//! Rendered pictures.

use crate::film::pixels::Pixels;

/// A rendered picture: linear sRGB radiance, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// `[red, green, blue]` of every pixel, row by row, W/(m^2 sr).
    pub pixels: Vec<[f32; 3]>,
    /// Variance of each pixel's mean, in the same order; zero when there are fewer than two samples.
    pub variance: Vec<[f32; 3]>,
}

impl Picture {
    /// Means and variances after `samples` samples per pixel.
    pub(super) fn new(sums: &Pixels, samples: u32) -> Self {
        let rows = sums.map(|sum| sum.mean_and_variance(samples));
        Self {
            width: sums.width(),
            height: sums.height(),
            samples,
            pixels: rows.iter().map(|(mean, _)| mean.map(|v| v as f32)).collect(),
            variance: rows.iter().map(|(_, variance)| variance.map(|v| v as f32)).collect(),
        }
    }

    /// All channels of all pixels in one slice: red, green, blue, red, ...
    pub fn as_slice(&self) -> &[f32] {
        self.pixels.as_flattened()
    }

    /// Estimate of the relative error: the square root of the mean over pixels of the luminance's variance divided by
    /// its square plus 1e-3 of the picture's mean square.
    pub fn relative_error(&self) -> f64 {
        const LUMINANCE: [f64; 3] = [0.212_671, 0.715_16, 0.072_169];
        let luminance = |p: &[f32; 3]| (0..3).map(|c| LUMINANCE[c] * f64::from(p[c])).sum::<f64>();
        // An upper bound: channels of a pixel are correlated at most fully.
        let deviation = |v: &[f32; 3]| (0..3).map(|c| LUMINANCE[c] * f64::from(v[c]).sqrt()).sum::<f64>();
        let n = self.pixels.len().max(1) as f64;
        let mean_square = self.pixels.iter().map(|p| luminance(p).powi(2)).sum::<f64>() / n;
        let floor = (1e-3 * mean_square).max(1e-30);
        let sum: f64 = self
            .pixels
            .iter()
            .zip(&self.variance)
            .map(|(p, v)| deviation(v).powi(2) / (luminance(p).powi(2) + floor))
            .sum();
        (sum / n).sqrt()
    }
}
