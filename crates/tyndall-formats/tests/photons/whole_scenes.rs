//! The scenes of the repository: photons against the path tracer.

use crate::common;
use std::path::Path;
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::mitsuba;

/// A scene of the repository as a square of that width.
pub fn scene(name: &str, size: u32) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let mut desc = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")).scene;
    (desc.film.width, desc.film.height) = (size, size);
    desc.film.crop = None;
    Scene::build(&desc).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Mean over the picture, per channel, and its standard error from `batches` renders of different seeds.
pub fn picture_mean(scene: &Scene, name: &str, set: &[(&str, &str)], passes: u32, batches: u64) -> [(f64, f64); 3] {
    let set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    let means: Vec<[f64; 3]> = (0..batches)
        .map(|seed| {
            let integrator = Some(common::integrator(name, &set));
            let settings = Settings { integrator, seed: Some(1 + seed), ..Settings::default() };
            let mut rendering = Rendering::new(scene, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
            rendering.add_passes(passes).unwrap();
            assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
            let pixels = rendering.picture().pixels;
            [0, 1, 2].map(|c| pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / pixels.len() as f64)
        })
        .collect();
    let n = batches as f64;
    [0, 1, 2].map(|c| {
        let mean = means.iter().map(|m| m[c]).sum::<f64>() / n;
        let variance = means.iter().map(|m| (m[c] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    })
}

/// Means of whole pictures within half a per cent, where the path tracer converges. Blur loses light at edges, in
/// proportion to the radius, which is therefore small: `cargo test --release -p tyndall-formats --test
/// photons -- --ignored --nocapture pictures`, six minutes.
#[test]
#[ignore = "six minutes"]
fn means_of_pictures_are_those_of_the_path_tracer() {
    let mut wrong = Vec::new();
    for name in ["cornell-smoke.xml", "statue-smoke.xml", "peers/cbox-smoke.xml", "peers/smoke-hetero.xml"] {
        let scene = scene(name, 48);
        let depth = [("max_depth", "12")];
        let truth = picture_mean(&scene, "volpath", &depth, 512, 8);
        println!("{name} volpath: {truth:.5?}");
        for (integrator, photons, blur) in
            [("ppb", "10000", "0.25"), ("pbre", "20000", "0.125"), ("pvpm", "20000", "0.125")]
        {
            let found = picture_mean(&scene, integrator, &[depth[0], ("photons", photons), ("blur", blur)], 64, 8);
            for c in 0..3 {
                let ((mean, sigma), (truth, of_truth)) = (found[c], truth[c]);
                let (off, noise) = (mean / truth - 1.0, sigma.hypot(of_truth) / truth);
                let line = format!("{name} {integrator}, channel {c}: {:+.2} +- {:.2} %", 100.0 * off, 100.0 * noise);
                println!("{line}");
                if off.abs() > 0.005 + 3.0 * noise {
                    wrong.push(line);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
