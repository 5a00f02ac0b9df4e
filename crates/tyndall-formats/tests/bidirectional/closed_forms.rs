//! Against closed forms: the whole corpus.

use crate::common::{agrees, integrator, mean, scene};
use tyndall_testkit::corpus::{self, Case};
use tyndall_testkit::ztest::sidak;

/// The parameter of the scene's own integrator.
fn max_depth(case: &Case) -> String {
    let name = r#"name="max_depth" value=""#;
    let at = case.xml.find(name).unwrap() + name.len();
    case.xml[at..].split('"').next().unwrap().into()
}

/// Renders every case; `precision` is the share of the answer that the standard error may be.
fn check(name: &str, set: &[(&str, &str)], cases: &[Case], precision: f64) {
    for case in cases {
        let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
        set.push(("max_depth", max_depth(case)));
        let (mean, error) = mean(&scene(case, false), integrator(name, &set), 1 << 16, case.radiance, 0.5 * precision);
        for c in 0..3 {
            let (found, truth) = (mean[c], case.radiance[c]);
            let sigma = error[c].hypot(case.error);
            let line = format!("{name}, {}, channel {c}: {found} +- {sigma}, expected {truth}", case.name);
            println!("{line} ({:+.2} %)", 100.0 * (found / truth - 1.0));
            assert!(error[c] <= precision * truth, "{line}: no test");
            assert!(agrees(found, sigma, truth, sidak(0.01, 3 * cases.len())), "{line}");
        }
    }
}

/// Near a point light the single scattering of a joined path has no finite variance.
fn is_near_a_point_light(case: &Case) -> bool {
    case.name.starts_with("infinite")
}

#[test]
fn bidirectional_path_tracing() {
    let cases: Vec<_> = corpus::all().into_iter().filter(|case| !is_near_a_point_light(case)).collect();
    check("bdpt", &[("rr_depth", "5")], &cases, 0.01);
}
