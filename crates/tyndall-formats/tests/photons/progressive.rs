//! Passes are added: the error falls at the rate that theory gives, or stops at the bias.

use crate::blur::{Blur, blurred};
use crate::common;
use tyndall::{Rendering, Scene, Settings};
use tyndall_testkit::corpus::{Infinite, infinite};

const PASSES: [u32; 4] = [4, 40, 400, 4000];

fn near() -> Infinite {
    Infinite { a: 0.7, h: 0.6, ..Infinite::default() }
}

/// Mean squared errors relative to the answer after [`PASSES`], over `runs` independent renders.
fn errors(scene: &Scene, name: &str, set: &[(&str, &str)], truth: f64, runs: u64) -> [f64; 4] {
    let set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    let mut sums = [0.0; 4];
    for seed in 0..runs {
        let integrator = Some(common::integrator(name, &set));
        let settings = Settings { integrator, seed: Some(seed), threads: Some(1) };
        let mut rendering = Rendering::new(scene, &settings).unwrap();
        for (passes, sum) in PASSES.into_iter().zip(&mut sums) {
            rendering.add_passes(passes - rendering.passes()).unwrap();
            *sum += (f64::from(rendering.picture().pixels[0][0]) / truth - 1.0).powi(2);
        }
    }
    sums.map(|sum| sum / runs as f64)
}

/// Exponent of the power law through the errors (least squares).
fn slope(errors: [f64; 4]) -> f64 {
    let points = PASSES.map(|n| f64::from(n).ln()).into_iter().zip(errors.map(f64::ln));
    let (mx, my) = points.clone().fold((0.0, 0.0), |(x, y), (px, py)| (x + px / 4.0, y + py / 4.0));
    let (top, bottom) = points.fold((0.0, 0.0), |(t, b), (x, y)| (t + (x - mx) * (y - my), b + (x - mx) * (x - mx)));
    top / bottom
}

/// Standard error of [`slope`]: a mean of n squares of normal numbers is off by the share sqrt(2 / n).
fn slope_sigma(runs: u64) -> f64 {
    let x = PASSES.map(|n| f64::from(n).ln());
    let mean = x.iter().sum::<f64>() / 4.0;
    let spread = x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    (2.0 / runs as f64).sqrt() / spread.sqrt()
}

#[test]
fn errors_fall_as_powers() {
    const RUNS: u64 = 24;
    let p = near();
    let scene = common::scene(&infinite("progressive", &p), true);
    let truth = infinite("progressive", &p).radiance[0];
    let common = [("max_depth", "2"), ("radius", "0.4")];
    for (name, photons, alpha) in [("ppb", "60", 0.8), ("pbre", "300", 2.0 / 3.0)] {
        let set = [common[0], common[1], ("photons", photons)];
        let found = errors(&scene, name, &set, truth, RUNS);
        let (slope, sigma) = (slope(found), slope_sigma(RUNS));
        println!("{name}: relMSE {found:.5?}, slope {slope:.3} +- {sigma:.3}, expected {:.3}", -alpha);
        assert!((slope + alpha).abs() < 3.0 * sigma, "{name}: {slope} +- {sigma}, expected {}", -alpha);
    }
}

#[test]
fn a_radius_that_stays_leaves_its_bias() {
    const RUNS: u64 = 8;
    let p = near();
    let scene = common::scene(&infinite("fixed", &p), true);
    let truth = infinite("fixed", &p).radiance[0];
    let set = [("max_depth", "2"), ("radius", "0.55"), ("photons", "60")];
    let found = errors(&scene, "beams", &set, truth, RUNS);
    let plateau = (blurred(&p, Blur::CommonNormal, 0.55)[0] / truth - 1.0).powi(2);
    println!("beams: relMSE {found:.5?}, squared bias {plateau:.2e}");
    // Noise first, then nothing but bias.
    assert!(found[0] > 1.5 * plateau, "{found:?}: no noise to begin with");
    assert!(found[2..].iter().all(|error| (error / plateau - 1.0).abs() < 0.15), "{found:?}, {plateau}");
}
