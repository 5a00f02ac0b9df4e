//! One picture of several that were rendered independently.

use crate::view::MetricError;

/// The mean of each value, weighted (by the numbers of samples, say).
pub fn mean(renders: &[(&[f32], f64)]) -> Result<Vec<f32>, MetricError> {
    let total = check(renders)?;
    Ok(sum(renders, |weight| weight / total))
}

/// The variance of that mean, from the variances of the renders: their shares come squared.
pub fn variance_of_mean(variances: &[(&[f32], f64)]) -> Result<Vec<f32>, MetricError> {
    let total = check(variances)?;
    Ok(sum(variances, |weight| (weight / total).powi(2)))
}

fn sum(renders: &[(&[f32], f64)], share: impl Fn(f64) -> f64) -> Vec<f32> {
    let value = |i| renders.iter().map(|&(values, weight)| share(weight) * f64::from(values[i])).sum::<f64>() as f32;
    (0..renders[0].0.len()).map(value).collect()
}

/// The sum of the weights, when everything fits together.
fn check(renders: &[(&[f32], f64)]) -> Result<f64, MetricError> {
    let total: f64 = renders.iter().map(|r| r.1).sum();
    if renders.is_empty() || !total.is_finite() || renders.iter().any(|r| !(r.1 > 0.0)) {
        return Err(MetricError::Weights { weights: renders.iter().map(|r| r.1).collect() });
    }
    let first = renders[0].0.len();
    match renders.iter().find(|r| r.0.len() != first) {
        Some(other) => Err(MetricError::Sizes { first: [first, 1], second: [other.0.len(), 1] }),
        None => Ok(total),
    }
}
