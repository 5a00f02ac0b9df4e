//! Errors of linear pictures against a reference.

use crate::view::{MetricError, View};

/// Added to squares of the reference: keeps the error of black finite.
pub(crate) const RELATIVE_SQUARE_FLOOR: f64 = 1e-3;
/// Added to values of the reference.
const RELATIVE_FLOOR: f64 = 1e-2;

/// What is averaged over pixels and channels, with I the picture and R the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// (I - R)^2, the mean squared error.
    Mse,
    /// (I - R)^2 / (R^2 + 0.001), the relative mean squared error.
    RelMse,
    /// |I - R| / (|R| + 0.01), the mean absolute percentage error as a fraction.
    Mape,
    /// |I - R| / (|I| + |R| + 0.01), the symmetric mean absolute percentage error as a fraction, at most 1.
    Smape,
}

impl Metric {
    fn of(self, value: f32, reference: f32) -> f64 {
        let (value, reference) = (f64::from(value), f64::from(reference));
        let difference = value - reference;
        match self {
            Self::Mse => difference * difference,
            Self::RelMse => difference * difference / (reference * reference + RELATIVE_SQUARE_FLOOR),
            Self::Mape => difference.abs() / (reference.abs() + RELATIVE_FLOOR),
            Self::Smape => difference.abs() / (value.abs() + reference.abs() + RELATIVE_FLOOR),
        }
    }

    /// The error of every pixel: the mean over its channels.
    pub fn map(self, picture: View, reference: View) -> Result<Vec<f64>, MetricError> {
        picture.check_same_size(&reference)?;
        let error = |(p, r): (&[f32; 3], &[f32; 3])| p.iter().zip(r).map(|(&p, &r)| self.of(p, r)).sum::<f64>() / 3.0;
        Ok(picture.pixels().iter().zip(reference.pixels()).map(error).collect())
    }

    /// The mean over all pixels.
    pub fn mean(self, picture: View, reference: View) -> Result<f64, MetricError> {
        self.trimmed_mean(picture, reference, 0.0)
    }

    /// [`Self::trimmed_mean`] without the worst thousandth.
    pub fn robust_mean(self, picture: View, reference: View) -> Result<f64, MetricError> {
        self.trimmed_mean(picture, reference, 1e-3)
    }

    /// The mean over the pixels left when a fraction of them, those of the largest errors, is dropped; 0.001 is usual.
    ///
    /// The number dropped is rounded down, and one pixel always stays.
    pub fn trimmed_mean(self, picture: View, reference: View, drop: f64) -> Result<f64, MetricError> {
        let mut errors = self.map(picture, reference)?;
        let dropped = ((errors.len() as f64 * drop) as usize).min(errors.len() - 1);
        let kept = errors.len() - dropped;
        if dropped > 0 {
            errors.select_nth_unstable_by(kept - 1, f64::total_cmp);
            // In one order, so that the sum does not depend on how the selection went.
            errors[..kept].sort_unstable_by(f64::total_cmp);
        }
        Ok(errors[..kept].iter().sum::<f64>() / kept as f64)
    }
}

/// The largest value of a picture, at least 0: what its PSNR is usually measured against.
pub fn peak(view: View) -> f64 {
    f64::from(view.pixels().as_flattened().iter().copied().fold(0.0, f32::max))
}

/// Peak signal-to-noise ratio in decibels for values up to `peak`; infinite when the pictures are equal.
pub fn psnr(picture: View, reference: View, peak: f64) -> Result<f64, MetricError> {
    Ok(10.0 * (peak * peak / Metric::Mse.mean(picture, reference)?).log10())
}
