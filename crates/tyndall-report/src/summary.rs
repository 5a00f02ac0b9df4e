//! Numbers of several renders in one: medians with spread, slopes, the time to reach an error.

use serde::Serialize;

/// A figure of one or more repeats.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// The middle value, or the mean of the two in the middle.
    pub median: f64,
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
    /// One a repeat, in their order.
    pub values: Vec<f64>,
}

impl Figure {
    /// Of some values; `None` if there are none or one is not finite.
    pub fn new(values: Vec<f64>) -> Option<Self> {
        let mut sorted = values.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let (low, high) = (*sorted.first()?, *sorted.last()?);
        let n = sorted.len();
        let median = if n % 2 == 1 { sorted[n / 2] } else { 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]) };
        values.iter().all(|v| v.is_finite()).then_some(Self { median, low, high, values })
    }
}

/// A line through logarithms: `y = factor x^slope`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerLaw {
    /// The exponent.
    pub slope: f64,
    /// Standard error of the slope, from the scatter about the line.
    pub slope_error: f64,
    /// The value at x = 1.
    pub factor: f64,
}

impl PowerLaw {
    /// The line of least squares through the points whose coordinates are positive; `None` with fewer than three.
    pub fn fit(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let usable = |p: &[f64; 2]| p.iter().all(|v| v.is_finite() && *v > 0.0);
        let points: Vec<[f64; 2]> = points.into_iter().filter(usable).map(|p| p.map(f64::ln)).collect();
        let n = points.len() as f64;
        if points.len() < 3 {
            return None;
        }
        let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let moment = |i: usize, j: usize| points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
        let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
        if xx < 1e-12 {
            return None;
        }
        let slope = xy / xx;
        let residual = (yy - slope * xy).max(0.0);
        Some(Self { slope, slope_error: (residual / (n - 2.0) / xx).sqrt(), factor: (mean[1] - slope * mean[0]).exp() })
    }
}

/// When a curve of (time, error) first falls to `error`, on straight lines between logarithms; `None` if it never does, or
/// had done so before its first point.
pub fn time_to_reach(curve: &[[f64; 2]], error: f64) -> Option<f64> {
    let crossing = curve.windows(2).find(|pair| pair[0][1] > error && pair[1][1] <= error)?;
    let [[t0, e0], [t1, e1]] = [crossing[0], crossing[1]].map(|p| p.map(|v| v.max(1e-300).ln()));
    let share = (e0 - error.max(1e-300).ln()) / (e0 - e1);
    Some((t0 + share.clamp(0.0, 1.0) * (t1 - t0)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        let figure = |values: &[f64]| Figure::new(values.to_vec()).map(|f| (f.low, f.median, f.high));
        assert_eq!(figure(&[3.0, 1.0, 2.0]), Some((1.0, 2.0, 3.0)));
        assert_eq!(figure(&[4.0, 1.0]), Some((1.0, 2.5, 4.0)));
        assert_eq!(figure(&[]), None);
        assert_eq!(figure(&[1.0, f64::NAN]), None);
        assert_eq!(figure(&[1.0, f64::INFINITY]), None);
    }

    #[test]
    fn a_power_law_is_found() {
        let points = |noise: f64| {
            (0..8).map(move |i| {
                let x = f64::from(1 << i);
                [x, 3.0 * x.powf(-0.8) * (noise * f64::from(i % 2)).exp()]
            })
        };
        let exact = PowerLaw::fit(points(0.0)).unwrap();
        assert!((exact.slope + 0.8).abs() < 1e-12 && (exact.factor - 3.0).abs() < 1e-9 && exact.slope_error < 1e-6);
        let noisy = PowerLaw::fit(points(0.1)).unwrap();
        assert!((noisy.slope + 0.8).abs() < 2.0 * noisy.slope_error && noisy.slope_error > 0.005);
        assert_eq!(PowerLaw::fit(points(0.0).take(2)), None);
        assert_eq!(PowerLaw::fit([[1.0, 1.0], [2.0, 0.0], [3.0, 1.0]]), None);
        assert_eq!(PowerLaw::fit([[1.0, 1.0]; 4]), None);
    }

    #[test]
    fn times_between_points() {
        let curve = [[1.0, 1.0], [2.0, 0.5], [4.0, 0.25]];
        assert!((time_to_reach(&curve, 0.4).unwrap() - 2.5).abs() < 1e-12);
        assert!((time_to_reach(&curve, 0.25).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(time_to_reach(&curve, 0.1), None);
        assert_eq!(time_to_reach(&curve, 2.0), None);
    }
}
