//! `volpath` against closed forms: the whole corpus, with equiangular sampling and without.

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
    let run = rendering.run(Budget::Passes(1 << 18), |rendering, _| {
        let picture = rendering.picture();
        let n = picture.pixels.len() as f64;
        for c in 0..3 {
            result.0[c] = picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
            result.1[c] = picture.variance.iter().map(|v| f64::from(v[c])).sum::<f64>().sqrt() / n;
        }
        let precise = (0..3).all(|c| result.1[c] <= 0.5 * PRECISION * case.radiance[c].abs());
        if precise && rendering.passes() >= 256 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    run.unwrap();
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

/// Next-event estimation alone has infinite variance near point lights, so that its means are low for ever.
fn is_near_a_point_light(case: &Case) -> bool {
    case.name.starts_with("infinite")
}

#[test]
fn equiangular_sampling_on_all_legs() {
    let cases: Vec<Case> = corpus::all().into_iter().filter(is_near_a_point_light).collect();
    cases.iter().for_each(|case| agrees(case, &[("equiangular_legs", -1), ("rr_depth", 5)], 3 * cases.len()));
}

#[test]
fn default_techniques() {
    let cases: Vec<Case> = corpus::all().into_iter().filter(|case| !is_near_a_point_light(case)).collect();
    cases.iter().for_each(|case| agrees(case, &[("rr_depth", 5)], 3 * cases.len()));
}

#[test]
fn without_equiangular_sampling() {
    let names = ["square-light", "furnace-chromatic", "furnace-room"];
    let cases: Vec<Case> =
        corpus::all().into_iter().filter(|case| names.iter().any(|n| case.name.contains(n))).collect();
    assert_eq!(cases.len(), names.len());
    cases.iter().for_each(|case| agrees(case, &[("equiangular_legs", 0)], 3 * cases.len()));
}
