//! A point light in a medium without end: every estimator, and its bias.

use crate::blur::blurred;
use crate::{Measured, WAYS, Way, common};
use tyndall_testkit::corpus::{Infinite, infinite};
use tyndall_testkit::ztest::{sidak, two_sided_p};

/// Near enough that a light path in fifty is seen.
fn near() -> Infinite {
    Infinite { a: 0.7, h: 0.6, ..Infinite::default() }
}

/// Renders the medium with every way, to that precision.
fn check(name: &str, p: &Infinite, radius: f64, ways: &[Way], precision: f64, tests: usize) {
    aim(name, p, radius, ways, [0.8 * precision, precision], tests);
}

/// The same, with the precision that the number of passes is meant for before the one that is needed.
fn aim(name: &str, p: &Infinite, radius: f64, ways: &[Way], [meant, precision]: [f64; 2], tests: usize) {
    let scene = common::scene(&infinite(name, p), true);
    for (seed, way) in (1..).zip(ways) {
        let truth = blurred(p, way.blur, radius);
        let mut set = way.parameters(radius, p.orders.map_or(-1, |n| n as i32 + 1));
        set.push(("photons", way.photons().to_string()));
        let found = Measured::precisely(&scene, way.name, &set, seed, truth, meant);
        found.assert(&format!("{name} {}", way.title()), truth, precision, sidak(0.01, tests));
    }
}

fn some(names: &[(&str, &str)]) -> Vec<Way> {
    names.iter().map(|(name, extent)| Way::find(name, extent)).collect()
}

fn forward() -> Infinite {
    Infinite { g: 0.5, ..near() }
}

fn chromatic() -> Infinite {
    Infinite { sigma_t: [1.5, 1.0, 0.7], albedo: [0.9, 0.5, 0.8], ..near() }
}

fn double() -> Infinite {
    Infinite { orders: Some(2), ..near() }
}

#[test]
fn single_scattering() {
    check("single", &near(), 0.3, &WAYS, 0.01, 54);
}

#[test]
fn anisotropic_scattering() {
    let ways = some(&[("bre", ""), ("beam-beam-2d-beam", "short"), ("beam-beam-1d", "long"), ("beam-beam-3d", "long")]);
    check("forward", &forward(), 0.3, &ways, 0.01, 12);
}

#[test]
fn chromatic_media() {
    let ways =
        some(&[("bre", ""), ("beam-beam-2d-query", "short"), ("beam-beam-1d", "short"), ("beam-beam-1d", "long")]);
    check("chromatic", &chromatic(), 0.3, &ways, 0.01, 12);
}

#[test]
fn double_scattering() {
    check("double", &double(), 0.3, &some(&[("bre", ""), ("beam-beam-3d", "long")]), 0.01, 15);
    check(
        "double",
        &double(),
        0.1,
        &some(&[("beam-beam-1d", "long"), ("planes", "short"), ("planes", "long")]),
        0.01,
        15,
    );
}

/// All cases with all estimators at a third of a per cent: `cargo test --release -p tyndall-formats --test photons -- --ignored
/// --nocapture every_estimator`, five minutes.
#[test]
#[ignore = "five minutes"]
fn every_estimator_everywhere() {
    for (name, p) in [("single", near()), ("forward", forward()), ("chromatic", chromatic())] {
        check(name, &p, 0.3, &WAYS, 0.0033, 200);
    }
    // Its tails are long, and a few passes may not tell how many are needed.
    aim("double", &double(), 0.1, &WAYS, [0.0045, 0.0066], 200);
}

/// The bias is seen, at two radii, and is the one predicted.
#[test]
fn bias_falls_as_predicted() {
    let p = near();
    let scene = common::scene(&infinite("bias", &p), true);
    let exact = infinite("bias", &p).radiance;
    let ways = [
        ("beam-beam-3d", "long"),
        ("beam-beam-2d-query", "long"),
        ("beam-beam-2d-beam", "long"),
        ("beam-beam-1d", "long"),
    ];
    for (seed, way) in (1..).zip(some(&ways)) {
        let mut biases = [0.0; 2];
        for (radius, bias) in [0.55, 0.4].into_iter().zip(&mut biases) {
            let truth = blurred(&p, way.blur, radius);
            let predicted = truth[0] / exact[0] - 1.0;
            let mut set = way.parameters(radius, 2);
            set.push(("photons", way.photons().to_string()));
            let found = Measured::precisely(&scene, way.name, &set, seed, truth, predicted.abs() / 6.0);
            let what = format!("{} with radius {radius}, bias {:+.2} %", way.title(), 100.0 * predicted);
            found.report(&what, exact);
            let seen = (found.mean[0] - exact[0]) / found.sigma[0];
            assert!(seen.abs() > 4.0 && seen.signum() == predicted.signum(), "{what}: seen at {seen:.1} sigma");
            let z = (found.mean[0] - truth[0]) / found.sigma[0];
            assert!(two_sided_p(z) > sidak(0.01, 2 * ways.len()), "{what}: z = {z:.1}");
            *bias = predicted;
        }
        // Of the predictions, which the measurements have just met: the squared radii have the quotient 0.53, and these are
        // so large that higher powers count too.
        let quotient = biases[1] / biases[0];
        assert!((0.35..0.62).contains(&quotient), "{}: {quotient}", way.title());
    }
}
