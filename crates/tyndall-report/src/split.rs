//! How much of an error is bias, which time does not take away, and how much is noise.

use crate::blocks::Mean;
use crate::metrics::RELATIVE_SQUARE_FLOOR;
use crate::view::{MetricError, View};
use serde::Serialize;

/// The parts of a relative mean squared error: bias, variance of the render, variance of the reference.
///
/// Weighted by the reference blurred over a few pixels, in place of the pixel alone as relMSE is: else the reference's noise
/// would be in the weights too and look like bias. The parts therefore add up to relMSE only nearly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Split {
    /// Square of the bias: an unbiased estimate, which noise can make negative.
    pub bias_squared: f64,
    /// Its standard error.
    pub bias_error: f64,
    /// Variance of one render.
    pub variance: f64,
    /// Variance of the reference, where two halves of it are known; else 0.
    pub reference: f64,
    /// Independent renders that it comes from; with one, the variance is what the render says of itself.
    pub renders: usize,
    /// Whether the bias is above the noise: more than `Split::SIGNIFICANT` standard errors.
    pub significant: bool,
}

/// What a render's noise is known from.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// The scatter between renders.
    Scatter,
    /// The variance of every pixel's mean, as the only render estimates it from its samples.
    Variance(View<'a>),
}

/// A reference and, where it was rendered for the comparison, the two independent halves that it is the mean of.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The picture that errors are measured against.
    pub picture: View<'a>,
    /// The halves.
    pub halves: Option<[View<'a>; 2]>,
}

impl Reference<'_> {
    /// The variance of each channel of each pixel: a quarter of the squared difference of the halves.
    fn variance(&self, i: usize) -> f64 {
        self.halves.map_or(0.0, |halves| {
            let [a, b] = halves.map(|half| f64::from(half.pixels().as_flattened()[i]));
            (a - b).powi(2) / 4.0
        })
    }

    /// The part of every relMSE against it that is its own noise.
    pub fn own_error(&self) -> f64 {
        let values = self.picture.pixels().as_flattened();
        let error = |(i, &value)| weight(f64::from(value)) * self.variance(i);
        values.iter().enumerate().map(error).sum::<f64>() / values.len() as f64
    }

    /// The weights of all channels of all pixels, from the means over 5 x 5 pixels.
    fn smooth_weights(&self) -> Vec<f64> {
        const REACH: usize = 2;
        let (width, height) = (self.picture.width(), self.picture.height());
        let pixels = self.picture.pixels();
        let near = |x: usize, n: usize| x.saturating_sub(REACH)..(x + REACH + 1).min(n);
        let mean = |i: usize| {
            let (x, y) = (i % width, i / width);
            let around = || near(y, height).flat_map(|y| near(x, width).map(move |x| y * width + x));
            let count = around().count() as f64;
            [0, 1, 2].map(|c| around().map(|j| f64::from(pixels[j][c])).sum::<f64>() / count)
        };
        (0..pixels.len()).flat_map(|i| mean(i).map(weight)).collect()
    }
}

/// What relMSE divides by, for a value of the reference.
fn weight(value: f64) -> f64 {
    1.0 / (value * value + RELATIVE_SQUARE_FLOOR)
}

impl Split {
    /// A bias of more standard errors than this is flagged.
    pub const SIGNIFICANT: f64 = 4.0;

    /// Splits the error of independent renders. With n renders x of mean m and scatter s^2, and a reference r of variance v,
    /// the bias squared is `(m - r)^2 - s^2 / n - v`, pixel by pixel.
    pub fn of(renders: &[View], noise: Noise, reference: &Reference) -> Result<Self, MetricError> {
        let picture = reference.picture;
        let halves = reference.halves.into_iter().flatten();
        let variance = match noise {
            Noise::Scatter => None,
            Noise::Variance(view) => Some(view),
        };
        for view in renders.iter().copied().chain(halves).chain(variance) {
            view.check_same_size(&picture)?;
        }
        let count = renders.len();
        if count == 0 || (count == 1) != variance.is_some() {
            return Err(MetricError::Weights { weights: vec![1.0; count] });
        }
        let n = count as f64;
        let weights = reference.smooth_weights();
        let values: Vec<&[f32]> = renders.iter().map(|view| view.pixels().as_flattened()).collect();
        let expected = picture.pixels().as_flattened();
        // Bias squared and variance of one render, relative, for one channel of one pixel.
        let channel = |i: usize| {
            let mean = values.iter().map(|v| f64::from(v[i])).sum::<f64>() / n;
            let scatter = match variance {
                Some(view) => f64::from(view.pixels().as_flattened()[i]),
                None => values.iter().map(|v| (f64::from(v[i]) - mean).powi(2)).sum::<f64>() / (n - 1.0),
            };
            let square = (mean - f64::from(expected[i])).powi(2);
            [square - scatter / n - reference.variance(i), scatter].map(|part| part * weights[i])
        };
        let pixel = |i: usize| {
            let parts = [0, 1, 2].map(|c| channel(3 * i + c));
            [0, 1].map(|k| parts.iter().map(|p| p[k]).sum::<f64>() / 3.0)
        };
        let parts: Vec<[f64; 2]> = (0..picture.pixels().len()).map(pixel).collect();
        let bias = Mean::of(picture.width(), &parts.iter().map(|p| p[0]).collect::<Vec<_>>());
        Ok(Self {
            bias_squared: bias.value,
            bias_error: bias.error,
            variance: parts.iter().map(|p| p[1]).sum::<f64>() / parts.len() as f64,
            reference: reference.own_error(),
            renders: count,
            significant: bias.z() > Self::SIGNIFICANT,
        })
    }
}
