//! Photon estimators against closed forms.

mod common;

use common::{agrees, integrator, mean, scene};
use tyndall_testkit::corpus::{Case, Furnace, Infinite, furnace, furnace_room, infinite};
use tyndall_testkit::ztest::sidak;

/// Every way to gather in media: integrator, estimator, dimension of the blur.
const ESTIMATORS: [(&str, &str, u32); 10] = [
    ("vpm", "", 3),
    ("bre", "", 2),
    ("beams", "beam-point-3d", 3),
    ("beams", "point-beam-3d", 3),
    ("beams", "point-beam-2d", 2),
    ("beams", "beam-beam-3d", 3),
    ("beams", "beam-beam-2d-beam", 2),
    ("beams", "beam-beam-2d-query", 2),
    ("beams", "beam-beam-1d", 1),
    ("planes", "", 1),
];

/// Standard error asked for.
const PRECISION: f64 = 0.01;

/// Renders `case` with every estimator whose blur has a radius here.
fn check(case: &Case, radius: [Option<f64>; 3], extents: &[&str], tests: usize) {
    let scene = scene(case, true);
    for (name, estimator, blur) in ESTIMATORS {
        let Some(radius) = radius[blur as usize - 1] else { continue };
        let beams = estimator.contains("beam-beam") || estimator.contains("point-beam") || name == "planes";
        for extent in if beams { extents } else { &["short"] } {
            let mut set = vec![("radius", radius.to_string()), ("max_depth", depth(case))];
            set.push(("photons", if beams { "5000".into() } else { "20000".to_string() }));
            if name == "beams" {
                set.push(("estimator", estimator.into()));
            }
            if beams {
                set.push(("extent", extent.to_string()));
            }
            if name == "vpm" || estimator.starts_with("point") {
                set.push(("steps", "400".into()));
            }
            if name == "bre" {
                set.push(("neighbours", "0".into()));
            }
            let (mean, sigma) = mean(&scene, integrator(name, &set), 4096, case.radiance, 0.95 * PRECISION);
            let what = format!("{} {name} {estimator} {extent}", case.name);
            println!(
                "{what}: {:+.2} +- {:.2} %",
                100.0 * (mean[0] / case.radiance[0] - 1.0),
                100.0 * sigma[0] / case.radiance[0]
            );
            for c in 0..3 {
                let truth = case.radiance[c];
                assert!(sigma[c] <= PRECISION * truth, "{what}: {mean:?} +- {sigma:?} is no test");
                let error = 100.0 * (mean[c] / truth - 1.0);
                let allowed = 100.0 * sigma[c] / truth;
                assert!(
                    agrees(mean[c], sigma[c], truth, sidak(0.01, tests)),
                    "{what}: {error:+.2} % +- {allowed:.2} %"
                );
            }
        }
    }
}

/// The largest depth that the case asks for.
fn depth(case: &Case) -> String {
    let text = case.xml.split("max_depth\" value=\"").nth(1).unwrap();
    text.split('"').next().unwrap().into()
}

#[test]
fn single_scattering() {
    let abreast = Infinite { a: 1.0, h: 1.0, ..Infinite::default() };
    let cases = [
        infinite("single", &abreast),
        infinite("forward", &Infinite { g: 0.5, ..abreast.clone() }),
        infinite("chromatic", &Infinite { sigma_t: [1.5, 1.0, 0.7], albedo: [0.9, 0.5, 0.8], ..abreast.clone() }),
        infinite("double", &Infinite { orders: Some(2), ..abreast.clone() }),
    ];
    cases.iter().for_each(|case| check(case, [Some(0.1), Some(0.12), Some(0.15)], &["short", "long"], 400));
}

/// Blurs over balls lose light at the walls of a box, one over the radius of it, where the others lose next to nothing: they
/// are left out.
#[test]
fn furnaces() {
    let cases = [
        furnace("isotropic", Furnace::default()),
        furnace("glass", Furnace { glass: true, ..Furnace::default() }),
        furnace("chromatic", Furnace { sigma_t: [3.0, 1.0, 0.3], ..Furnace::default() }),
        furnace("ramp", Furnace { ramp: true, ..Furnace::default() }),
        furnace("lens", Furnace { lens: true, sigma_t: [0.7; 3], ..Furnace::default() }),
        furnace_room(0.5),
    ];
    cases.iter().for_each(|case| check(case, [Some(0.1), Some(0.1), None], &["short", "long"], 400));
}
