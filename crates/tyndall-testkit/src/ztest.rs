//! z-tests: is a mean what it should be, are two means the same, are two images the same picture?

use statrs::function::erf::erfc;

/// Probability that a standard normal deviates from zero by at least `|z|`.
pub fn two_sided_p(z: f64) -> f64 {
    if z.is_nan() { 0.0 } else { erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2) }
}

/// Significance of each of `tests` tests such that all together err with probability `significance` (Šidák 1967).
pub fn sidak(significance: f64, tests: usize) -> f64 {
    1.0 - (1.0 - significance).powf(1.0 / tests.max(1) as f64)
}

/// Running mean and variance (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: f64,
    mean: f64,
    m2: f64,
}

impl Moments {
    /// Adds one sample.
    pub fn push(&mut self, x: f64) {
        self.count += 1.0;
        let before = x - self.mean;
        self.mean += before / self.count;
        self.m2 += before * (x - self.mean);
    }

    /// Both sets of samples together (Chan et al. 1979).
    pub fn merge(self, other: Self) -> Self {
        let count = self.count + other.count;
        if count == 0.0 {
            return self;
        }
        let d = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + d * other.count / count,
            m2: self.m2 + other.m2 + d * d * self.count * other.count / count,
        }
    }

    /// Number of samples.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased estimate of the variance of one sample.
    pub fn variance(&self) -> f64 {
        self.m2 / (self.count - 1.0)
    }

    /// Standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count).sqrt()
    }

    /// Deviation of the mean from the truth in standard errors.
    pub fn z(&self, truth: f64) -> f64 {
        quotient(self.mean - truth, self.standard_error())
    }

    /// Difference of two means in standard errors.
    pub fn two_sample_z(&self, other: &Self) -> f64 {
        quotient(self.mean - other.mean, self.standard_error().hypot(other.standard_error()))
    }

    /// Panics unless the mean is within the noise of the truth, one of `tests` tests made together.
    #[track_caller]
    pub fn assert(&self, truth: f64, significance: f64, tests: usize) {
        let z = self.z(truth);
        assert!(
            two_sided_p(z) >= sidak(significance, tests),
            "mean {:.6e} +- {:.1e} is not {truth:.6e} (z = {z:.2}, {} samples)",
            self.mean,
            self.standard_error(),
            self.count
        );
    }
}

impl Extend<f64> for Moments {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, samples: T) {
        samples.into_iter().for_each(|x| self.push(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<T: IntoIterator<Item = f64>>(samples: T) -> Self {
        let mut moments = Self::default();
        moments.extend(samples);
        moments
    }
}

/// Zero over zero is no deviation at all.
fn quotient(difference: f64, error: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / error }
}

/// An estimated image, in interleaved channels.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Mean of the samples of each pixel and channel, `[row][column][channel]`.
    pub mean: &'a [f32],
    /// Variance of one sample, in the same order.
    pub variance: &'a [f32],
    /// Samples behind the mean; infinite for a truth.
    pub samples: f64,
}

/// What came out of comparing two images.
#[derive(Clone, Debug)]
pub struct PictureOutcome {
    /// Part of the pixel-channels whose two-sided p is above [`PIXEL_SIGNIFICANCE`].
    pub agreeing: f64,
    /// z of the mean over all pixels, per channel.
    pub mean_z: Vec<f64>,
    /// Largest |z| of the mean over a square of 8 x 8 pixels, over channels.
    pub block_z: f64,
    /// Number of such squares times channels.
    pub blocks: usize,
}

/// Significance of one pixel-channel: 0.01 Šidák-corrected for 48 x 48 pixels.
pub const PIXEL_SIGNIFICANCE: f64 = 4.4e-6;
/// Part of the pixel-channels that must agree.
pub const AGREEING: f64 = 0.9975;
/// Least variance of one sample: a pixel that happened to see no light is not certain.
pub const MIN_VARIANCE: f64 = 1e-4;
/// Width of the squares of [`PictureOutcome::block_z`].
const BLOCK: usize = 8;

impl PictureOutcome {
    /// Whether at least [`AGREEING`] of the pixels, and the means over the whole and over the squares, agree.
    pub fn passes(&self) -> bool {
        let whole = sidak(1e-3, self.mean_z.len());
        self.agreeing >= AGREEING
            && self.mean_z.iter().all(|&z| two_sided_p(z) >= whole)
            && two_sided_p(self.block_z) >= sidak(1e-4, self.blocks)
    }

    /// Panics with the figures unless [`PictureOutcome::passes`].
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.passes(), "the images differ by more than their noise: {self:?}");
    }
}

/// Compares two images of the same size.
///
/// Pixels one by one find spots and errors of geometry; averages over squares and over the whole find a small bias
/// that hides in the noise of each pixel. `variance` of each must be that of its own estimator: pass the reference's for
/// both only where both are the same estimator.
pub fn pictures(ours: &Picture, reference: &Picture, width: usize, channels: usize) -> PictureOutcome {
    let n = reference.mean.len();
    let lengths = [ours.mean.len(), ours.variance.len(), reference.variance.len()];
    assert!(lengths == [n; 3] && n.is_multiple_of(width * channels), "sizes differ: {lengths:?}, {n}");
    let error2 = |p: &Picture, i: usize| (f64::from(p.variance[i])).max(MIN_VARIANCE) / p.samples;
    let columns = width.div_ceil(BLOCK);
    let rows = (n / (width * channels)).div_ceil(BLOCK);
    let mut whole = vec![(0.0, 0.0); channels];
    let mut blocks = vec![(0.0, 0.0); columns * rows * channels];
    let mut agreeing = 0;
    for i in 0..n {
        let (pixel, channel) = (i / channels, i % channels);
        let d = f64::from(ours.mean[i]) - f64::from(reference.mean[i]);
        let e2 = error2(ours, i) + error2(reference, i);
        agreeing += usize::from(two_sided_p(d / e2.sqrt()) > PIXEL_SIGNIFICANCE);
        let block = (pixel % width) / BLOCK + columns * (pixel / width / BLOCK);
        for sum in [&mut whole[channel], &mut blocks[block * channels + channel]] {
            *sum = (sum.0 + d, sum.1 + e2);
        }
    }
    let z = |&(d, e2): &(f64, f64)| quotient(d, f64::sqrt(e2));
    PictureOutcome {
        agreeing: agreeing as f64 / n as f64,
        mean_z: whole.iter().map(z).collect(),
        // f64::max would pass over NaN
        block_z: blocks.iter().map(|b| z(b).abs()).fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a }),
        blocks: blocks.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn moments_and_their_merge() {
        let all: Moments = (0..10).map(f64::from).collect();
        let [low, high] = [0..4, 4..10].map(|r| r.map(f64::from).collect::<Moments>());
        assert!((all.mean() - 4.5).abs() < 1e-12 && (all.variance() - 55.0 / 6.0).abs() < 1e-12);
        let merged = low.merge(high);
        assert!((merged.mean() - 4.5).abs() < 1e-12 && (merged.variance() - 55.0 / 6.0).abs() < 1e-12);
        assert!((two_sided_p(1.959_964) - 0.05).abs() < 1e-6);
        assert_eq!(two_sided_p(f64::NAN), 0.0);
    }

    #[test]
    fn sees_a_bias_and_nothing_else() {
        let mut random = Random::new(7);
        let normal: Moments = (0..40_000).map(|_| 2.0 + random.normal()).collect();
        let other: Moments = (0..10_000).map(|_| 2.0 + 3.0 * random.normal()).collect();
        normal.assert(2.0, 0.01, 1);
        assert!(two_sided_p(normal.z(2.04)) < 1e-6);
        assert!(normal.two_sample_z(&other).abs() < 3.0);
    }

    #[test]
    fn images_agree_or_not() {
        const N: usize = 48 * 48 * 3;
        let mut random = Random::new(3);
        let spp = 256.0;
        let truth: Vec<f32> = (0..N).map(|i| 0.5 + (i % 144) as f32 / 144.0).collect();
        let variance: Vec<f32> = truth.iter().map(|m| m * m).collect();
        let mut noisy = |bias: &dyn Fn(usize) -> f32| -> Vec<f32> {
            let error = |i: usize| (f64::from(variance[i]) / spp).sqrt();
            (0..N).map(|i| truth[i] + bias(i) + (error(i) * random.normal()) as f32).collect()
        };
        let reference = Picture { mean: &truth, variance: &variance, samples: f64::INFINITY };
        let judge = |mean: &[f32]| pictures(&Picture { mean, variance: &variance, samples: spp }, &reference, 48, 3);

        judge(&noisy(&|_| 0.0)).assert();
        // half a percent everywhere: no pixel shows it, the mean does
        let dim = judge(&noisy(&|i| -0.005 * truth[i]));
        assert!(dim.agreeing > AGREEING && !dim.passes(), "{dim:?}");
        // 6 % in one corner: the squares show it
        let corner = judge(&noisy(&|i| if i % 144 < 24 && i / 144 < 8 { 0.06 * truth[i] } else { 0.0 }));
        assert!(corner.agreeing > AGREEING && !corner.passes(), "{corner:?}");
        // a wrong row
        assert!(judge(&noisy(&|i| if i / 144 == 20 { 1.0 } else { 0.0 })).agreeing < AGREEING);
        // not a number
        assert!(!judge(&noisy(&|i| if i == 5 { f32::NAN } else { 0.0 })).passes());
    }
}
