//! `volpath`, `jis` and `bdpt` against Mitsuba 3: whole pictures of the scenes in `references/`, compared within the noise of both.

use std::path::{Path, PathBuf};
use tyndall::scene::desc::IntegratorDesc;
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::{image, mitsuba};
use tyndall_testkit::ztest::{self, Picture, PictureOutcome};

/// Renders `scene` by the `integrator`, its own if there is none, with `passes` samples and compares it with the mean and the variance of one sample in two files: with
/// the noise of both, or, where the reference is of unknown `samples`, with the larger variance at our number of samples.
/// (Mitsuba's variances are differences of second moments in XYZ and squared means in RGB: in saturated pixels they are
/// next to nothing, and no renderer, Mitsuba included, keeps within them.)
fn compare(
    scene: &Path,
    integrator: Option<&str>,
    passes: u32,
    mean: &Path,
    variance: &Path,
    samples: Option<f64>,
) -> PictureOutcome {
    let name = scene.display();
    let loaded = mitsuba::read(scene, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    let scene = Scene::build(&loaded.scene).unwrap_or_else(|e| panic!("{name}: {e}"));
    let integrator = integrator.map(|name| IntegratorDesc { name: name.into(), ..scene.integrator.clone() });
    let mut rendering = Rendering::new(&scene, &Settings { integrator, seed: Some(2), threads: None }).unwrap();
    rendering.add_passes(passes).unwrap();
    assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
    let ours = rendering.picture();
    let per_sample: Vec<f32> = ours.variance.as_flattened().iter().map(|v| v * passes as f32).collect();
    let [mean, variance] = [mean, variance].map(|path| image::read(path, true).unwrap().pixels);
    let variance = variance.as_flattened();
    let ours_variance: Vec<f32> = match samples {
        Some(_) => per_sample,
        None => per_sample.iter().zip(variance).map(|(a, b)| a.max(*b)).collect(),
    };
    let samples = samples.unwrap_or(f64::INFINITY);
    let outcome = ztest::pictures(
        &Picture { mean: ours.as_slice(), variance: &ours_variance, samples: f64::from(passes) },
        &Picture { mean: mean.as_flattened(), variance, samples },
        ours.width as usize,
        3,
    );
    println!(
        "{name} {}: {:.4} of the pixels agree, z of the means {:.2?}, of the worst square {:.2} of {}",
        rendering.integrator().name,
        outcome.agreeing,
        outcome.mean_z,
        outcome.block_z,
        outcome.blocks
    );
    outcome
}

/// The scenes of which the picture by the `integrator` differs; each gets as many `passes` as its name says.
fn differing(integrator: Option<&str>, passes: impl Fn(&str) -> u32) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references");
    let list = std::fs::read_to_string(folder.join("references.txt")).unwrap();
    let mut differing = Vec::new();
    for line in list.lines() {
        let mut words = line.split_whitespace();
        let (name, samples) = (words.next().unwrap(), words.next().unwrap().parse::<f64>().unwrap());
        let file = |suffix: &str| folder.join(format!("{name}{suffix}"));
        let (mean, variance) = (file(".exr"), file("-variance.exr"));
        if !compare(&file(".xml"), integrator, passes(name), &mean, &variance, Some(samples)).passes() {
            differing.push(name.to_string());
        }
    }
    differing
}

#[test]
fn every_scene_is_the_same_picture() {
    assert_eq!(differing(None, |_| 256), [""; 0], "differing by more than their noise");
}

#[test]
fn every_scene_is_the_same_picture_by_joint_importance_sampling() {
    assert_eq!(differing(Some("jis"), |_| 256), [""; 0], "differing by more than their noise");
}

#[test]
fn every_scene_is_the_same_picture_by_bidirectional_path_tracing() {
    // Paths joined through rough glass are rarely bright: a pixel's mean is not normal after a few hundred.
    let passes = |name: &str| if name == "rough-shell" { 1024 } else { 256 };
    assert_eq!(differing(Some("bdpt"), passes), [""; 0], "differing by more than their noise");
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
        compare(&scene, None, 868, &reference(""), &reference("_var"), None).assert();
        count += 1;
    }
    assert!(count > 0, "no scene in {}", folder.display());
}
