//! What tests of whole renders share.
#![allow(dead_code, reason = "each test binary uses a part")]

use std::ops::ControlFlow;
use tyndall::scene::desc::{IntegratorDesc, ParameterValue};
use tyndall::{Budget, Rendering, Scene, Settings};
use tyndall_formats::mitsuba;
use tyndall_testkit::corpus::{Case, Furnace, furnace, furnace_room};
use tyndall_testkit::ztest::two_sided_p;

/// The scene of a case; `one_pixel` crops it to the first pixel, all of which see the same.
pub fn scene(case: &Case, one_pixel: bool) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in &case.files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let path = folder.path().join("scene.xml");
    std::fs::write(&path, &case.xml).unwrap();
    let loaded = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{}: {e}", case.name));
    let mut desc = loaded.scene;
    if one_pixel {
        desc.film.crop = Some([0, 0, 1, 1]);
    }
    Scene::build(&desc).unwrap_or_else(|e| panic!("{}: {e}", case.name))
}

/// The parameter of the scene's own integrator.
pub fn max_depth(case: &Case) -> String {
    let name = r#"name="max_depth" value=""#;
    let at = case.xml.find(name).unwrap() + name.len();
    case.xml[at..].split('"').next().unwrap().into()
}

/// Furnaces full of media of all kinds, in glass too, and a room.
pub fn furnaces_of_all_kinds() -> [Case; 7] {
    [
        furnace("isotropic", Furnace::default()),
        furnace("forward", Furnace { g: 0.7, ..Furnace::default() }),
        furnace("chromatic", Furnace { sigma_t: [3.0, 1.0, 0.3], ..Furnace::default() }),
        furnace("glass", Furnace { glass: true, ..Furnace::default() }),
        furnace("ramp", Furnace { ramp: true, ..Furnace::default() }),
        furnace("lens", Furnace { lens: true, sigma_t: [0.7; 3], ..Furnace::default() }),
        furnace_room(0.5),
    ]
}

/// An integrator with parameters as on the command line.
pub fn integrator(name: &str, set: &[(&str, String)]) -> IntegratorDesc {
    let parameters = set.iter().map(|(k, v)| (k.to_string(), ParameterValue::Text(v.clone()))).collect();
    IntegratorDesc { name: name.into(), parameters }
}

/// Mean over all pixels and its standard error, per channel, after at most `passes`, sooner once every error is at most
/// `precise` of `truth`. The pixels count as independent.
pub fn mean(
    scene: &Scene,
    integrator: IntegratorDesc,
    passes: u32,
    truth: [f64; 3],
    precise: f64,
) -> ([f64; 3], [f64; 3]) {
    let name = integrator.name.clone();
    let settings = Settings { integrator: Some(integrator), ..Settings::default() };
    let mut rendering = Rendering::new(scene, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut result = ([0.0; 3], [0.0; 3]);
    let observe = |rendering: &Rendering, _| {
        let picture = rendering.picture();
        let n = picture.pixels.len() as f64;
        for c in 0..3 {
            result.0[c] = picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
            result.1[c] = picture.variance.iter().map(|v| f64::from(v[c])).sum::<f64>().sqrt() / n;
        }
        // A picture that is still black has no spread, but says nothing.
        let done = (0..3).all(|c| result.0[c] != 0.0 && result.1[c] <= precise * truth[c].abs());
        // A look at fixed numbers of passes only, so that the machine's speed decides nothing.
        if done && rendering.passes() >= 16 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut at = 16;
    let mut observe = observe;
    while at <= passes {
        rendering.run(Budget::Passes(at), |_, _| ControlFlow::Continue(())).unwrap();
        if observe(&rendering, ()).is_break() {
            break;
        }
        at += at / 4;
    }
    assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
    result
}

/// Whether `mean +- sigma` agrees with `truth` at the significance `level`.
pub fn agrees(mean: f64, sigma: f64, truth: f64, level: f64) -> bool {
    two_sided_p((mean - truth) / sigma.max(1e-5 * truth.abs())) > level
}
