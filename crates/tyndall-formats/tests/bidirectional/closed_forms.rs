//! Against closed forms: the whole corpus.

use crate::common::{agrees, integrator, max_depth, mean, scene};
use tyndall_testkit::corpus::{self, Case};
use tyndall_testkit::ztest::sidak;

/// Every subset of the techniques that find light in media.
fn subsets() -> Vec<String> {
    let names = ["bpt", "pp3d", "bp2d", "bb1d"];
    let chosen = |set: u32| (0..4).filter(|i| set >> i & 1 == 1).map(|i| names[i]).collect::<Vec<_>>().join(",");
    (1..16).map(chosen).collect()
}

/// Renders every case, with at most so many passes; `precision` is the share of the answer that the standard error may be.
fn check(name: &str, set: &[(&str, &str)], cases: &[Case], passes: u32, precision: f64) {
    for case in cases {
        let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
        set.push(("max_depth", max_depth(case)));
        // Pixels share the light paths of a pass: they are not independent.
        let scene = scene(case, name != "bdpt");
        let (mean, error) = mean(&scene, integrator(name, &set), passes, case.radiance, 0.5 * precision);
        for c in 0..3 {
            let (found, truth) = (mean[c], case.radiance[c]);
            let sigma = error[c].hypot(case.error);
            let off = 100.0 * (found / truth - 1.0);
            let noise = 100.0 * sigma / truth;
            let line = format!("{name} {}, {}, channel {c}: {off:+.2} +- {noise:.2} %", set[0].1, case.name);
            println!("{line}");
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
    check("bdpt", &[("rr_depth", "5")], &cases, 1 << 16, 0.01);
}

fn named(names: &[&str]) -> Vec<Case> {
    corpus::all().into_iter().filter(|case| names.contains(&case.name.as_str())).collect()
}

/// A blur of radius r adds about `m r^2 / 2` times the Laplacian, here a quarter of a per cent at most.
fn unified(techniques: &[&str], cases: &[Case], passes: u32, precision: f64) {
    let (radius, alpha) = (("radius", "0.05"), ("alpha", "1"));
    for techniques in techniques {
        let set = [("techniques", *techniques), radius, alpha, ("photons", "4000"), ("beams", "1000")];
        check("upbp", &set, cases, passes, precision);
    }
}

#[test]
fn techniques_of_unified_points_beams_and_paths() {
    let techniques = ["bp2d", "bb1d", "pp3d,bp2d,bb1d", "bpt,pp3d,bp2d,bb1d"];
    unified(&techniques, &named(&["infinite-double", "infinite-chromatic-triple"]), 800, 0.07);
}

/// All fifteen subsets: `cargo test --release -p tyndall-formats --test bidirectional -- --ignored --nocapture subset`, three
/// to four minutes.
#[test]
#[ignore = "four minutes"]
fn every_subset_of_unified_points_beams_and_paths() {
    let subsets = subsets();
    let subsets: Vec<&str> = subsets.iter().map(String::as_str).collect();
    unified(&subsets, &named(&["infinite-double", "infinite-forward", "infinite-chromatic-triple"]), 1 << 14, 0.1);
}
