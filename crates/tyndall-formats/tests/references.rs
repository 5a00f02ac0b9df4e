//! `volpath` against Mitsuba 3: whole pictures of the scenes in `references/`, compared within the noise of both.

use std::path::{Path, PathBuf};
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::{image, mitsuba};
use tyndall_testkit::ztest::{self, Picture, PictureOutcome};

/// Renders `scene` with `passes` samples and compares it with the mean and the variance of one sample in two files.
fn compare(scene: &Path, passes: u32, mean: &Path, variance: &Path, samples: f64) -> PictureOutcome {
    let name = scene.display();
    let loaded = mitsuba::read(scene, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    let scene = Scene::build(&loaded.scene).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut rendering = Rendering::new(&scene, &Settings { seed: Some(2), ..Settings::default() }).unwrap();
    rendering.add_passes(passes);
    assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
    let ours = rendering.picture();
    let per_sample: Vec<f32> = ours.variance.as_flattened().iter().map(|v| v * passes as f32).collect();
    let [mean, variance] = [mean, variance].map(|path| image::read(path, true).unwrap().pixels);
    let outcome = ztest::pictures(
        &Picture { mean: ours.as_slice(), variance: &per_sample, samples: f64::from(passes) },
        &Picture { mean: mean.as_flattened(), variance: variance.as_flattened(), samples },
        ours.width as usize,
        3,
    );
    println!(
        "{name}: {:.4} of the pixels agree, z of the means {:.2?}, of the worst square {:.2} of {}",
        outcome.agreeing, outcome.mean_z, outcome.block_z, outcome.blocks
    );
    outcome
}

#[test]
fn every_scene_is_the_same_picture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references");
    let list = std::fs::read_to_string(folder.join("references.txt")).unwrap();
    let mut differing = Vec::new();
    for line in list.lines() {
        let mut words = line.split_whitespace();
        let (name, samples) = (words.next().unwrap(), words.next().unwrap().parse().unwrap());
        let file = |suffix: &str| folder.join(format!("{name}{suffix}"));
        if !compare(&file(".xml"), 256, &file(".exr"), &file("-variance.exr"), samples).passes() {
            differing.push(name);
        }
    }
    assert!(differing.is_empty(), "differing by more than their noise: {differing:?}");
}

/// Mitsuba's own test scenes, where `TYNDALL_MITSUBA_SCENES` names a folder of them (NAME_volpath.xml or
/// NAME_volpathmis.xml with refs/NAME_ref_rgb.exr and refs/NAME_ref_rgb_var.exr).
#[test]
fn scenes_of_mitsuba_are_the_same_pictures() {
    let Some(folder) = std::env::var_os("TYNDALL_MITSUBA_SCENES").map(PathBuf::from) else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let scene = entry.unwrap().path();
        let name = scene.file_name().unwrap().to_string_lossy().into_owned();
        let Some((name, _)) = name.split_once("_volpath") else { continue };
        let reference = |suffix: &str| folder.join(format!("refs/{name}_ref_rgb{suffix}.exr"));
        // The reference counts as exact, as in Mitsuba's own rule.
        compare(&scene, 868, &reference(""), &reference("_var"), 1e9).assert();
        count += 1;
    }
    assert!(count > 0, "no scene in {}", folder.display());
}
