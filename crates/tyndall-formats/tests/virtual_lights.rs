//! Virtual lights against closed forms.

mod common;

use common::{agrees, furnaces_of_all_kinds, integrator, max_depth, mean, scene};
use tyndall::scene::desc::IntegratorDesc;
use tyndall::{Rendering, Settings};
use tyndall_testkit::corpus::{Case, Infinite, furnace_room, infinite};
use tyndall_testkit::ztest::sidak;

/// One pixel, and every pass its own light paths: passes are independent.
fn check(name: &str, set: &[(&str, &str)], case: &Case, truth: [f64; 3], precision: f64) {
    let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    if set.iter().all(|(key, _)| *key != "max_depth") {
        set.push(("max_depth", max_depth(case)));
    }
    let (mean, error) = mean(&scene(case, true), integrator(name, &set), 1 << 18, truth, 0.9 * precision);
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
const KINDS: [(&str, &[(&str, &str)]); 7] = [
    ("vrl", &[("photons", "20"), ("product", "always"), ("extent", "long"), ("lights", "0")]),
    ("vpl", &[("photons", "20"), ("lights", "0")]),
    ("vpl", &[("photons", "20"), ("clamp", "4"), ("lights", "0")]),
    ("vrl", &[("photons", "20"), ("product", "never"), ("extent", "short"), ("lights", "0")]),
    ("vrl", &[("photons", "20"), ("product", "never"), ("extent", "long"), ("lights", "0")]),
    ("vbl", &[("photons", "20"), ("radius", "0.03"), ("reuse", "0"), ("lights", "0")]),
    ("vsl", &[("photons", "20"), ("radius", "0.03"), ("reuse", "0"), ("lights", "0")]),
];

/// Light scattered twice, alone: what virtual lights themselves give.
const TWICE: [(&str, &str); 2] = [("components", "multiple"), ("max_depth", "3")];

#[test]
fn double_scattering() {
    let orders = |n| infinite("double", &Infinite { orders: Some(n), ..Infinite::default() });
    let (both, single) = (orders(2).radiance, orders(1).radiance);
    let truth = [0, 1, 2].map(|c| both[c] - single[c]);
    for (kind, set) in &KINDS[..5] {
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
        for (kind, set) in &KINDS[..5] {
            check(kind, &[set, &TWICE[..]].concat(), &case, truth, 0.01);
        }
    }
}

#[test]
fn chromatic_triple_scattering() {
    let case = infinite("triple", &Infinite { orders: Some(3), ..tyndall_testkit::corpus::CHROMATIC });
    for (kind, set) in &KINDS[..5] {
        check(kind, set, &case, case.radiance, 0.01);
    }
}

#[test]
fn furnaces() {
    for case in furnaces_of_all_kinds() {
        for (kind, set) in &KINDS[..5] {
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
fn beams_and_spheres_of_light() {
    for (kind, set) in &KINDS[5..] {
        let set: Vec<_> = set.iter().copied().filter(|(key, _)| *key != "reuse").collect();
        let double = infinite("double", &Infinite { orders: Some(2), ..Infinite::default() });
        for case in [double, furnace_room(0.5)] {
            check(kind, &set, &case, case.radiance, 0.01);
        }
        let (case, truth) = forward(0.5);
        check(kind, &[&set, &TWICE[..]].concat(), &case, truth, 0.01);
    }
}

/// Surfaces by photon mapping, light scattered once by photon beams and more often by ray lights, in one picture
/// (Novak et al. 2012a, section 6). In a room whose walls glow evenly photons lose nothing at edges.
#[test]
fn composed_with_photons() {
    let parts = [
        ("photonmap", "emitted+direct+indirect+caustic"),
        ("beams", "single"),
        ("vrl", "multiple"),
        ("photonmap.photons", "1000"),
        ("photonmap.surface_radius", "0.15"),
        ("beams.photons", "300"),
        ("beams.radius", "0.05"),
        ("vrl.photons", "20"),
        ("vrl.lights", "0"),
    ];
    let case = furnace_room(0.5);
    check("composite", &parts, &case, case.radiance, 0.01);
}

/// Lights cut off at a quarter of the mean free path.
fn cut_off(compensation: &'static str) -> Vec<(&'static str, &'static str)> {
    vec![("photons", "20"), ("clamp", "16"), ("compensation", compensation), ("lights", "0")]
}

/// A point light in a medium without end: what the bound cuts off is a tenth, and both compensations give it back. In
/// coloured media too, and after any number of scatterings.
#[test]
fn compensations() {
    let multiple = infinite("multiple", &Infinite { orders: None, ..Infinite::default() });
    let chromatic = infinite("triple", &Infinite { orders: Some(3), ..tyndall_testkit::corpus::CHROMATIC });
    for case in [&multiple, &chromatic] {
        for kind in ["vpl", "vrl"] {
            check(kind, &cut_off("approximate"), case, case.radiance, 0.01);
        }
        check("vpl", &cut_off("path"), case, case.radiance, 0.01);
    }
    let mut set: Vec<_> = cut_off("none").iter().map(|(k, v)| (*k, v.to_string())).collect();
    set.push(("max_depth", max_depth(&multiple)));
    let (mean, error) = mean(&scene(&multiple, true), integrator("vpl", &set), 1 << 17, multiple.radiance, 0.005);
    println!("cut off: {} +- {}, all: {}", mean[0], error[0], multiple.radiance[0]);
    assert!(mean[0] < 0.95 * multiple.radiance[0], "{} +- {}", mean[0], error[0]);
}

/// A room of fog and walls, seen from `x`.
fn frame(integrator: IntegratorDesc, x: f32, seed: u64) -> Vec<[f32; 3]> {
    let mut case = furnace_room(0.5);
    // A lamp in the middle, so that there is something to see.
    case.xml = case
        .xml
        .replace("fov\" value=\"0.01\"", "fov\" value=\"60\"")
        .replace("<emitter type=\"area\"><rgb name=\"radiance\" value=\"0.5\"/><ref id=\"fog\"/></emitter>", "");
    case.xml = case.xml.replace("0.3, 0.2, 0.4\"", &format!("{}, 0.2, 0.4\"", 0.3 + x)).replace(
        "<sensor",
        "<emitter type=\"point\"><point name=\"position\" x=\"-0.4\" y=\"0.5\" z=\"0\"/><ref id=\"fog\"/></emitter><sensor",
    );
    let scene = scene(&case, false);
    let settings = Settings { integrator: Some(integrator), seed: Some(seed), ..Settings::default() };
    let mut rendering = Rendering::new(&scene, &settings).unwrap();
    rendering.add_passes(256).unwrap();
    rendering.picture().pixels.clone()
}

/// Mean square difference of two pictures.
fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let squares = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>() / (3 * a.len()) as f64
}

/// Few lights, all of which serve all passes: their own noise is what the pictures have.
#[test]
fn frames_share_lights() {
    for kind in ["vpl", "vsl", "vrl", "vbl"] {
        let with = |light_seed: &str| {
            let set = [("photons", "20"), ("lights", "0"), ("reuse", "0"), ("components", "indirect+multiple")];
            let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
            set.push(("light_seed", light_seed.into()));
            if kind == "vpl" {
                set.push(("clamp", "20".into()));
                set.push(("compensation", "none".into()));
            }
            integrator(kind, &set)
        };
        let first = frame(with("7"), 0.0, 1);
        // The picture's seed decides nothing but noise, which is low.
        let other_seed = difference(&first, &frame(with("7"), 0.0, 2));
        let moved = difference(&first, &frame(with("7"), 1e-3, 1));
        let other_lights = difference(&first, &frame(with("8"), 0.0, 1));
        let own_lights = difference(&frame(with("-1"), 0.0, 1), &frame(with("-1"), 0.0, 2));
        println!(
            "{kind}: moved {moved:e}, other seed {other_seed:e}, other lights {other_lights:e}, own {own_lights:e}"
        );
        assert!(moved < 1e-3 * other_lights, "{kind}: {moved} against {other_lights}");
        assert!(other_seed < 1e-2 * other_lights, "{kind}: {other_seed} against {other_lights}");
        assert!(own_lights > 0.3 * other_lights, "{kind}: {own_lights} against {other_lights}");
    }
}
