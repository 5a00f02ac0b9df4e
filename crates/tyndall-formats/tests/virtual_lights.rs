//! Virtual lights against closed forms.

mod common;

use common::{agrees, integrator, mean, scene};
use tyndall_testkit::corpus::{Case, Furnace, Infinite, furnace, furnace_room, infinite};
use tyndall_testkit::ztest::sidak;

/// The parameter of the scene's own integrator.
fn max_depth(case: &Case) -> String {
    let name = r#"name="max_depth" value=""#;
    let at = case.xml.find(name).unwrap() + name.len();
    case.xml[at..].split('"').next().unwrap().into()
}

/// One pixel, and every pass its own light paths: passes are independent.
fn check(name: &str, set: &[(&str, &str)], case: &Case, truth: [f64; 3], precision: f64) {
    let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    if set.iter().all(|(key, _)| *key != "max_depth") {
        set.push(("max_depth", max_depth(case)));
    }
    let (mean, error) = mean(&scene(case, true), integrator(name, &set), 1 << 17, truth, 0.9 * precision);
    for c in 0..3 {
        let (found, truth) = (mean[c], truth[c]);
        let line =
            format!("{name} {:?}, {}, channel {c}: {found} +- {}, expected {truth}", &set[..2], case.name, error[c]);
        println!("{line} ({:+.2} +- {:.2} %)", 100.0 * (found / truth - 1.0), 100.0 * error[c] / truth);
        assert!(error[c] <= precision * truth, "{line}: no test");
        assert!(agrees(found, error[c], truth, sidak(0.01, 100)), "{line}");
    }
}

/// Each kind of lights, all of which a query visits.
const KINDS: [(&str, &[(&str, &str)]); 5] = [
    ("vpl", &[("photons", "20"), ("lights", "0")]),
    ("vpl", &[("photons", "20"), ("clamp", "4"), ("lights", "0")]),
    ("vrl", &[("photons", "20"), ("extent", "short"), ("lights", "0")]),
    ("vrl", &[("photons", "20"), ("extent", "long"), ("lights", "0")]),
    ("vbl", &[("photons", "20"), ("radius", "0.03"), ("reuse", "0"), ("lights", "0")]),
];

/// Light scattered twice, alone: what virtual lights themselves give.
const TWICE: [(&str, &str); 2] = [("components", "multiple"), ("max_depth", "3")];

#[test]
fn double_scattering() {
    let orders = |n| infinite("double", &Infinite { orders: Some(n), ..Infinite::default() });
    let (both, single) = (orders(2).radiance, orders(1).radiance);
    let truth = [0, 1, 2].map(|c| both[c] - single[c]);
    for (kind, set) in &KINDS[..4] {
        check(kind, &[set, &TWICE[..]].concat(), &orders(1), truth, 0.01);
    }
}

/// Light of a point source scattered twice with asymmetry `g`, and seen along the ray (2, 0.5): the answers are those of 10^9
/// random walks.
fn forward(g: f64) -> (Case, [f64; 3]) {
    let case = infinite("forward", &Infinite { g, albedo: [1.0; 3], ..Infinite::default() });
    let truth = if g == 0.5 { 3.7948e-3 } else { 2.4443e-3 };
    (case, [truth; 3])
}

#[test]
fn anisotropic_double_scattering() {
    for g in [0.5, -0.5] {
        let (case, truth) = forward(g);
        for (kind, set) in &KINDS[..4] {
            check(kind, &[set, &TWICE[..]].concat(), &case, truth, 0.01);
        }
    }
}

#[test]
fn chromatic_triple_scattering() {
    let case = infinite("triple", &Infinite { orders: Some(3), ..tyndall_testkit::corpus::CHROMATIC });
    for (kind, set) in &KINDS[..4] {
        check(kind, set, &case, case.radiance, 0.01);
    }
}

#[test]
fn furnaces() {
    for case in [
        furnace("isotropic", Furnace::default()),
        furnace("forward", Furnace { g: 0.7, ..Furnace::default() }),
        furnace("chromatic", Furnace { sigma_t: [3.0, 1.0, 0.3], ..Furnace::default() }),
        furnace("glass", Furnace { glass: true, ..Furnace::default() }),
        furnace("ramp", Furnace { ramp: true, ..Furnace::default() }),
        furnace("lens", Furnace { lens: true, sigma_t: [0.7; 3], ..Furnace::default() }),
        furnace_room(0.5),
    ] {
        for (kind, set) in &KINDS[..4] {
            check(kind, set, &case, case.radiance, 0.015);
        }
    }
}

/// A few of many lights, chosen by their power.
#[test]
fn some_of_the_lights() {
    let case = infinite("double", &Infinite { orders: Some(2), ..Infinite::default() });
    check("vrl", &[("photons", "200"), ("lights", "7"), ("samples", "2")], &case, case.radiance, 0.01);
    check("vpl", &[("photons", "200"), ("lights", "7")], &case, case.radiance, 0.01);
}

/// The bias of a radius is of second order: gone at a small one.
#[test]
fn beams_of_light() {
    let (kind, set) = KINDS[4];
    let set: Vec<_> = set.iter().copied().filter(|(key, _)| *key != "reuse").collect();
    let double = infinite("double", &Infinite { orders: Some(2), ..Infinite::default() });
    for case in [double, furnace_room(0.5)] {
        check(kind, &set, &case, case.radiance, 0.01);
    }
    let (case, truth) = forward(0.5);
    check(kind, &[&set, &TWICE[..]].concat(), &case, truth, 0.01);
}
