//! Metrics against hand-made numbers.

use tyndall_report::metrics::{Metric, psnr};
use tyndall_report::{MetricError, View, merge};

fn near(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-6 * b.abs(), "{a} {b}");
}

#[test]
fn errors_of_two_pixels() {
    let (i, r) = ([[1.5, 0.0, 2.0], [0.5; 3]], [[1.0, 0.0, 1.0], [0.5; 3]]);
    let (i, r) = (View::new(2, 1, &i).unwrap(), View::new(2, 1, &r).unwrap());
    near(Metric::Mse.mean(i, r).unwrap(), 1.25 / 6.0);
    near(Metric::RelMse.mean(i, r).unwrap(), 1.25 / 1.001 / 6.0);
    near(Metric::Mape.mean(i, r).unwrap(), 1.5 / 1.01 / 6.0);
    near(psnr(i, r, 2.0).unwrap(), 10.0 * (4.0f64 / (1.25 / 6.0)).log10());
    assert_eq!(psnr(r, r, 1.0).unwrap(), f64::INFINITY);
    assert_eq!(Metric::Mse.map(i, r).unwrap()[1], 0.0);
}

#[test]
fn the_worst_are_dropped() {
    let reference = vec![[0.0; 3]; 2000];
    let picture: Vec<[f32; 3]> = (0..2000).map(|i| [((i * 7919) % 2000) as f32; 3]).collect();
    let (i, r) = (View::new(50, 40, &picture).unwrap(), View::new(50, 40, &reference).unwrap());
    let expected: f64 = (0..1998).map(|i| f64::from(i).powi(2)).sum::<f64>() / 1998.0;
    near(Metric::Mse.trimmed_mean(i, r, 0.001).unwrap(), expected);
    near(Metric::Mse.trimmed_mean(i, r, 0.0).unwrap(), (0..2000).map(|i| f64::from(i).powi(2)).sum::<f64>() / 2000.0);
    assert_eq!(Metric::Mse.trimmed_mean(i, r, 1.0).unwrap(), 0.0);
}

#[test]
fn what_does_not_fit_is_an_error() {
    let pixels = [[0.0; 3]; 6];
    let (wide, high) = (View::new(3, 2, &pixels).unwrap(), View::new(2, 3, &pixels).unwrap());
    let sizes = MetricError::Sizes { first: [3, 2], second: [2, 3] };
    assert_eq!(Metric::Mse.mean(wide, high), Err(sizes.clone()));
    assert_eq!(tyndall_report::flip::mean(wide, high, 67.0), Err(sizes));
    assert_eq!(View::new(3, 3, &pixels).unwrap_err().to_string(), "found 6 pixels, expected 3 x 3 and at least one");
    assert!(View::new(0, 0, &[]).is_err());
    let nan = [[0.0; 3], [0.0, f32::NAN, 0.0]];
    let message = View::new(1, 2, &nan).unwrap_err().to_string();
    assert_eq!(message, "found [0.0, NaN, 0.0] in column 0, row 1, expected finite numbers");
}

#[test]
fn renders_merge_by_their_weights() {
    let (a, b) = ([1.0f32, 4.0], [2.0f32, 0.0]);
    assert_eq!(merge::mean(&[(&a, 1.0), (&b, 3.0)]).unwrap(), [1.75, 1.0]);
    assert_eq!(merge::variance_of_mean(&[(&a, 1.0), (&b, 3.0)]).unwrap(), [1.1875, 0.25]);
    assert!(matches!(merge::mean(&[]), Err(MetricError::Weights { .. })));
    assert!(matches!(merge::mean(&[(&a, 0.0)]), Err(MetricError::Weights { .. })));
    assert!(matches!(merge::mean(&[(&a, 1.0), (&b[..1], 1.0)]), Err(MetricError::Sizes { .. })));
}
