//! `volpath` against closed forms, on the whole corpus and with every choice of techniques.

use std::ops::ControlFlow;
use tyndall::scene::desc::{IntegratorDesc, ParameterValue};
use tyndall::{Budget, Rendering, Scene, Settings};
use tyndall_formats::mitsuba;
use tyndall_testkit::corpus::{self, Case};
use tyndall_testkit::ztest::{sidak, two_sided_p};

/// Share of the answer that the standard error may be, so that a test means something.
const PRECISION: f64 = 0.01;

/// Mean over all pixels and its standard error, per channel.
fn render(case: &Case, set: &[(&str, i64)]) -> ([f64; 3], [f64; 3]) {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in &case.files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let path = folder.path().join("scene.xml");
    std::fs::write(&path, &case.xml).unwrap();
    let loaded = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{}: {e}", case.name));
    let scene = Scene::build(&loaded.scene).unwrap_or_else(|e| panic!("{}: {e}", case.name));
    let mut integrator: IntegratorDesc = scene.integrator.clone();
    integrator.parameters.extend(set.iter().map(|(k, v)| (k.to_string(), ParameterValue::Integer(*v))));
    let settings = Settings { integrator: Some(integrator), ..Settings::default() };
    let mut rendering = Rendering::new(&scene, &settings).unwrap();
    let mut result = ([0.0; 3], [0.0; 3]);
    rendering.run(Budget::Passes(1 << 16), |rendering, _| {
        let picture = rendering.picture();
        let n = picture.pixels.len() as f64;
        for c in 0..3 {
            result.0[c] = picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
            result.1[c] = picture.variance.iter().map(|v| f64::from(v[c])).sum::<f64>().sqrt() / n;
        }
        let precise = (0..3).all(|c| result.1[c] <= 0.25 * PRECISION * case.radiance[c].abs());
        if precise && rendering.passes() >= 256 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(rendering.rare_events().non_finite, 0, "{}", case.name);
    result
}

fn agrees(case: &Case, set: &[(&str, i64)], tests: usize) {
    let (mean, error) = render(case, set);
    for c in 0..3 {
        let truth = case.radiance[c];
        assert!(error[c] <= PRECISION * truth.abs(), "{} {set:?}: {mean:?} +- {error:?} is no test", case.name);
        let sigma = error[c].hypot(case.error).max(1e-5 * truth);
        let p = two_sided_p((mean[c] - truth) / sigma);
        assert!(
            p > sidak(0.01, tests),
            "{} {set:?}, channel {c}: {} +- {sigma}, expected {truth} ({:+.2} %)",
            case.name,
            mean[c],
            100.0 * (mean[c] / truth - 1.0),
        );
    }
}

fn corpus(set: &[(&str, i64)]) {
    let cases = corpus::all();
    let tests = 3 * cases.len();
    cases.iter().for_each(|case| agrees(case, set, tests));
}

#[test]
fn with_equiangular_sampling_on_the_first_legs() {
    corpus(&[]);
}

#[test]
fn with_equiangular_sampling_on_all_legs() {
    corpus(&[("equiangular_legs", -1)]);
}

#[test]
fn without_equiangular_sampling() {
    corpus(&[("equiangular_legs", 0)]);
}
