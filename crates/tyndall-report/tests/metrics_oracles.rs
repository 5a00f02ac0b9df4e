//! Metrics against the numbers of oracles.py: the authors' FLIP and plain numpy.

use serde::Deserialize;
use tyndall_report::View;
use tyndall_report::flip::{self, PIXELS_PER_DEGREE};
use tyndall_report::hdr_flip::{self, Exposures};
use tyndall_report::metrics::{Metric, psnr};

#[derive(Deserialize)]
struct Case {
    width: usize,
    height: usize,
    scale: f64,
    mse: f64,
    relmse: f64,
    robust: f64,
    mape: f64,
    smape: f64,
    psnr: f64,
    ldr_flip: f64,
    hdr_flip: f64,
    hdr_corners: [f64; 3],
    start: f64,
    stop: f64,
    exposures: u32,
}

/// The pictures of oracles.py: the reference and another.
fn pictures(width: usize, height: usize, scale: f64) -> [Vec<[f32; 3]>; 2] {
    let mut pictures = [Vec::new(), Vec::new()];
    for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
        let (x, y) = (column as f64, row as f64);
        let (w, h) = (width as f64, height as f64);
        let lamp = 40.0 * (-((x - 0.7 * w).powi(2) + (y - 0.3 * h).powi(2)) / 6.0).exp();
        let squares = ((column / 8 + row / 8) % 2) as f64;
        let reference = [
            0.02 + x / w + lamp,
            0.3 + 0.25 * (0.3 * x).sin() * (0.2 * y).cos() + lamp,
            0.05 + 0.6 * squares + 0.8 * lamp,
        ];
        let hash = ((column * 31 + row * 17) % 23) as f64;
        let noise = (hash - 11.0) / 30.0 + if hash == 7.0 { 0.9 } else { 0.0 };
        let strength = [1.0, -0.6, 0.8];
        let picture = [0, 1, 2].map(|c| reference[c] * (1.02 + noise * strength[c]) + 0.004 * hash);
        pictures[0].push(reference.map(|v| (scale * v) as f32));
        pictures[1].push(picture.map(|v| (scale * v) as f32));
    }
    pictures
}

fn near(what: &str, found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-4 * expected.abs().max(1.0), "{what}: {found}, expected {expected}");
}

/// To a relative 1e-4, however small.
fn close(what: &str, found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-4, "{what}: {found}, expected {expected}");
}

#[test]
fn the_numbers_of_others() {
    let cases: Vec<Case> = serde_json::from_str(include_str!("oracles.json")).unwrap();
    assert_eq!(cases.len(), 3);
    for case in cases {
        let [reference, picture] = pictures(case.width, case.height, case.scale);
        let view = |pixels| View::new(case.width, case.height, pixels).unwrap();
        let (p, r) = (view(&picture), view(&reference));
        let peak = f64::from(reference.as_flattened().iter().copied().fold(0.0, f32::max));
        close("MSE", Metric::Mse.mean(p, r).unwrap(), case.mse);
        close("relMSE", Metric::RelMse.mean(p, r).unwrap(), case.relmse);
        close("robust relMSE", Metric::RelMse.trimmed_mean(p, r, 0.001).unwrap(), case.robust);
        close("MAPE", Metric::Mape.mean(p, r).unwrap(), case.mape);
        close("SMAPE", Metric::Smape.mean(p, r).unwrap(), case.smape);
        close("PSNR", psnr(p, r, peak).unwrap(), case.psnr);
        near("FLIP", flip::mean(p, r, PIXELS_PER_DEGREE).unwrap(), case.ldr_flip);
        let exposures = Exposures::of(r);
        assert_eq!(exposures.count, case.exposures);
        near("start", exposures.start, case.start);
        near("stop", exposures.stop, case.stop);
        let map = hdr_flip::map(p, r, PIXELS_PER_DEGREE).unwrap();
        let corners = [0, (case.height / 2) * case.width + case.width / 2, map.len() - 1];
        for (found, expected) in corners.map(|i| map[i]).into_iter().zip(case.hdr_corners) {
            near("HDR-FLIP of a pixel", found, expected);
        }
        near("HDR-FLIP", hdr_flip::mean(p, r, PIXELS_PER_DEGREE).unwrap(), case.hdr_flip);
    }
}
