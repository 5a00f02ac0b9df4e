//! Are two pictures with different seeds the same picture? A z-test of every pixel, and one of the mean.

use crate::blocks::Mean;
use crate::view::{MetricError, View};
use serde::Serialize;

/// A picture with the variance of every pixel's mean, as renders estimate it from their samples.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// The picture.
    pub picture: View<'a>,
    /// Variances in the same order.
    pub variance: View<'a>,
    /// Samples per pixel that both come from.
    pub samples: u32,
}

/// How far two pictures are apart in units of their noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Mean square of the pixels' z; 1 where only noise tells the pictures apart, or a little less.
    ///
    /// Less, because samples are stratified and their variance is therefore a little too large.
    pub mean_square: f64,
    /// Share of pixels with |z| > 3; 0.0027 for normal noise.
    pub beyond_three: f64,
    /// z of the difference of the means.
    pub of_means: f64,
    /// Whether all three are within reason.
    pub agree: bool,
}

impl Agreement {
    /// Fewer samples have variances that are noise themselves.
    pub const LEAST_SAMPLES: u32 = 8;
    /// Pixels are correlated in photon methods: their mean square scatters more than that of as many independent ones.
    const MOST_MEAN_SQUARE: f64 = 1.5;
    const MOST_BEYOND_THREE: f64 = 0.01;
    const MOST_OF_MEANS: f64 = 4.0;

    /// Compares; `None` where one has too few samples to know its noise.
    pub fn of(a: Estimate, b: Estimate) -> Result<Option<Self>, MetricError> {
        for other in [a.variance, b.picture, b.variance] {
            a.picture.check_same_size(&other)?;
        }
        if a.samples.min(b.samples) < Self::LEAST_SAMPLES {
            return Ok(None);
        }
        let values = |view: View<'_>| view.pixels().as_flattened().iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
        let [pa, va, pb, vb] = [a.picture, a.variance, b.picture, b.variance].map(values);
        let (mut squares, mut beyond, mut tested) = (0.0, 0u32, 0u32);
        for i in 0..pa.len() {
            let (difference, variance) = (pa[i] - pb[i], va[i] + vb[i]);
            // Below the rounding of single precision there is nothing to test.
            let rounding = 1e-6 * pa[i].abs().max(pb[i].abs());
            if variance.sqrt() <= rounding && difference.abs() <= rounding {
                continue;
            }
            let z = difference / variance.sqrt().max(rounding);
            squares += z * z;
            beyond += u32::from(z.abs() > 3.0);
            tested += 1;
        }
        // Student's t has heavier tails: its mean square is nu / (nu - 2).
        let freedom = f64::from(a.samples) + f64::from(b.samples) - 2.0;
        let mean_square = squares / f64::from(tested.max(1)) * (freedom - 2.0) / freedom;
        let beyond_three = f64::from(beyond) / f64::from(tested.max(1));
        let grey: Vec<f64> = (0..pa.len() / 3).map(|i| (0..3).map(|c| pa[3 * i + c] - pb[3 * i + c]).sum()).collect();
        let of_means = Mean::of(a.picture.width(), &grey).z();
        let agree = mean_square <= Self::MOST_MEAN_SQUARE
            && beyond_three <= Self::MOST_BEYOND_THREE
            && of_means.abs() <= Self::MOST_OF_MEANS;
        Ok(Some(Self { mean_square, beyond_three, of_means, agree }))
    }
}
