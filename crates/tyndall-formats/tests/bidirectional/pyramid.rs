//! The pyramid of techniques: its parts add up to the picture, and each is right by itself.

use crate::common::{agrees, integrator};
use crate::reciprocity;
use std::path::Path;
use tyndall::mis::{Merging, Technique};
use tyndall::render::TechniquePicture;
use tyndall::scene::desc::IntegratorDesc;
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::mitsuba;
use tyndall_testkit::ztest::sidak;

fn described(name: &str, set: &[(&str, &str)]) -> IntegratorDesc {
    integrator(name, &set.iter().map(|(k, v)| (*k, v.to_string())).collect::<Vec<_>>())
}

/// A rendering that keeps techniques up to `depth`, after some passes.
fn render<'s>(
    scene: &'s Scene,
    desc: IntegratorDesc,
    seed: u64,
    threads: usize,
    depth: u32,
    passes: &[u32],
) -> Rendering<'s> {
    let settings = Settings { integrator: Some(desc), seed: Some(seed), threads: Some(threads) };
    let mut rendering = Rendering::new(scene, &settings).unwrap();
    rendering.keep_techniques(depth, usize::MAX).unwrap();
    passes.iter().for_each(|count| rendering.add_passes(*count).unwrap());
    rendering
}

const METHODS: [(&str, &[(&str, &str)]); 5] = [
    ("ptracer", &[("max_depth", "6")]),
    ("bdpt", &[("max_depth", "6")]),
    ("vcm", &[("max_depth", "6"), ("photons", "500")]),
    ("upbp", &[("max_depth", "6"), ("photons", "500"), ("beams", "200"), ("radius", "0.1")]),
    ("upbp", &[("max_depth", "3"), ("photons", "8000"), ("radius", "0.1"), ("techniques", "surf,bp2d,bb1d")]),
];

#[test]
fn parts_add_up_to_the_picture() {
    for (name, scene) in reciprocity::scenes() {
        if !["pinhole, gaussian", "spot", "constant", "rough glass"].contains(&name) {
            continue;
        }
        for (method, set) in METHODS {
            let what = format!("{name}, {method} {set:?}");
            let kept = render(&scene, described(method, set), 3, 2, 3, &[5]);
            let settings = Settings { integrator: Some(described(method, set)), seed: Some(3), ..Settings::default() };
            let mut plain = Rendering::new(&scene, &settings).unwrap();
            plain.add_passes(5).unwrap();
            assert_eq!(plain.pyramid().count(), 0);
            let picture = plain.picture();
            assert!(picture == kept.picture(), "{what}: the picture is another one");
            let parts: Vec<TechniquePicture> = kept.pyramid().collect();
            let longer = parts.iter().any(|part| part.technique == Technique::Longer);
            assert_eq!(longer, set[0].1 == "6", "{what}");
            let mut light = 0.0;
            for (i, expected) in picture.pixels.iter().enumerate() {
                for (c, expected) in expected.iter().enumerate() {
                    let sum: f64 = parts.iter().map(|part| f64::from(part.weighted[i][c])).sum();
                    // The filter's weight may be negative, so that parts are larger than the whole.
                    let size: f64 = parts.iter().map(|part| f64::from(part.weighted[i][c].abs())).sum();
                    let off = (sum - f64::from(*expected)).abs();
                    assert!(off <= 2e-6 * size, "{what}: {sum} is not {expected} in pixel {i}, channel {c}");
                    light += sum;
                }
            }
            assert!(light > 1.0, "{what}");
            let bright = |part: &&TechniquePicture| part.weighted.iter().flatten().any(|v| *v > 0.0);
            let count = parts.iter().filter(bright).count();
            assert!(count >= 3, "{what}: {count} bright parts");
        }
    }
}

#[test]
fn parts_do_not_depend_on_threads_or_groups_of_passes() {
    let scenes = reciprocity::scenes();
    let (_, scene) = scenes.iter().find(|(name, _)| *name == "pinhole, gaussian").unwrap();
    for (method, set) in METHODS {
        let parts = |threads: usize, passes: &[u32]| -> Vec<TechniquePicture> {
            render(scene, described(method, set), 7, threads, 4, passes).pyramid().collect()
        };
        let one = parts(1, &[4]);
        assert!(one == parts(2, &[4]) && one == parts(3, &[4]), "{method}: threads");
        assert!(one == parts(2, &[1, 3]), "{method}: groups");
    }
}

/// Mean over the picture of each technique alone, with its standard error from renders of different seeds.
fn alone(scene: &Scene, desc: &IntegratorDesc, depth: u32, passes: u32) -> Vec<(Technique, f64, f64)> {
    const BATCHES: u64 = 12;
    let mut found: Vec<(Technique, Vec<f64>)> = Vec::new();
    for seed in 0..BATCHES {
        let rendering = render(scene, desc.clone(), 40 + seed, 2, depth, &[passes]);
        assert_eq!(rendering.rare_events().non_finite, 0);
        for (i, part) in rendering.pyramid().enumerate() {
            let values = part.alone.as_flattened();
            let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
            if seed == 0 {
                found.push((part.technique, Vec::new()));
            }
            found[i].1.push(mean);
        }
    }
    let n = BATCHES as f64;
    let summary = |(technique, means): (Technique, Vec<f64>)| {
        let mean = means.iter().sum::<f64>() / n;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (technique, mean, (variance / n).sqrt())
    };
    found.into_iter().map(summary).collect()
}

/// All techniques of a depth have one expectation: that of sampling emitters. `precise` is the share of it that the error of
/// each may be, `blur` what merging may be off.
fn agree(what: &str, found: &[(Technique, f64, f64)], precise: f64, blur: f64, tested: impl Fn(Technique) -> bool) {
    let chosen: Vec<_> = found.iter().filter(|(technique, ..)| tested(*technique)).collect();
    for (technique, mean, sigma) in &chosen {
        let depth = technique.depth().unwrap();
        let sampled = Technique::Join { light: 1, camera: depth };
        let (_, truth, of_truth) = found.iter().find(|(technique, ..)| *technique == sampled).unwrap();
        let allowed = if matches!(technique, Technique::Merge { .. }) { blur * truth } else { 0.0 };
        let noise = sigma.hypot(*of_truth);
        let line =
            format!("{what}, {technique}: {:+.2} +- {:.2} %", 100.0 * (mean / truth - 1.0), 100.0 * noise / truth);
        println!("{line}");
        assert!(*truth > 0.0 && noise <= precise * truth, "{line}: no test");
        let off = (mean - truth).abs();
        assert!(agrees(truth + (off - allowed).max(0.0), noise, *truth, sidak(0.01, chosen.len())), "{line}");
    }
}

/// Pixels of what is built.
const PIXELS: usize = 1024;

fn built(parts: &str) -> Scene {
    let text = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="45"/>
            <transform name="to_world"><lookat origin="0, 0.2, 4.5" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/>
            <rfilter type="box"/></film></sensor>{parts}
            <shape type="rectangle"><transform name="to_world"><scale value="1.3"/><rotate x="1" angle="90"/>
                <translate y="2"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
                <emitter type="area"><rgb name="radiance" value="3"/></emitter></shape></scene>"#
    );
    let loaded = mitsuba::read_str(&text, Path::new("."), &mitsuba::Options::default()).unwrap();
    Scene::build(&loaded.scene).unwrap()
}

/// Two plates that do not touch: what is joined is never close, and no technique has an infinite variance.
#[test]
fn every_join_finds_all_light_between_surfaces() {
    let scene = built(
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform>
            <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><translate z="-2"/></transform>
            <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf></shape>"#,
    );
    let found = alone(&scene, &described("bdpt", &[("max_depth", "3")]), 3, 200);
    agree("plates", &found, 0.02, 0.0, |technique| matches!(technique.depth(), Some(2..=3)));
    // Disks lose up to half of their light at the edge.
    let merged =
        [("max_depth", "3"), ("photons", "40000"), ("surface_radius", "0.06"), ("alpha", "1"), ("continuation", "1")];
    let found = alone(&scene, &described("vcm", &merged), 3, 60);
    agree("plates", &found, 0.03, 0.03, |technique| matches!(technique, Technique::Merge { .. }));
}

/// Beside merges one sample in four is joined, and two walks go on from a rough mirror.
#[test]
fn every_join_finds_all_light_beside_merges() {
    let scene = built(
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform>
            <bsdf type="blendbsdf"><float name="weight" value="0.7"/><bsdf type="diffuse"/>
                <bsdf type="roughconductor"><float name="alpha" value="0.4"/></bsdf></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><translate z="-2"/></transform>
            <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf></shape>"#,
    );
    let set = [("max_depth", "3"), ("photons", "200"), ("surface_radius", "0.06"), ("continuation", "1")];
    let found = alone(&scene, &described("vcm", &set), 3, 500);
    agree("beside merges", &found, 0.02, 0.0, |technique| {
        matches!(technique, Technique::Join { .. }) && matches!(technique.depth(), Some(2..=3))
    });
}

/// Two vertices in fog are joined with an infinite variance: those joins are left out.
#[test]
fn every_technique_finds_all_light_in_fog() {
    let scene = built(
        r#"<medium type="homogeneous" id="fog"><float name="sigma_t" value="0.7"/><float name="albedo" value="0.9"/>
            <phase type="hg"><float name="g" value="0.4"/></phase></medium>
        <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>"#,
    );
    // Disks and ribbons lose a part of their light at the boundary.
    let set = [
        ("max_depth", "3"),
        ("photons", "16000"),
        ("beams", "2400"),
        ("radius", "0.03"),
        ("alpha", "1"),
        ("continuation", "1"),
    ];
    let found = alone(&scene, &described("upbp", &set), 3, 75);
    agree("fog", &found, 0.02, 0.02, |technique| match technique {
        Technique::Join { light, camera } => light + camera > 2 && (light < 2 || camera < 2),
        Technique::Merge { merging, .. } => matches!(merging, Merging::BeamPoint | Merging::BeamBeam),
        Technique::Longer => false,
    });
    // Balls take a larger radius for as little noise, and lose more: r S / V times 3/16, and up to twice that where the faces are
    // the brightest places.
    let set = [
        ("max_depth", "3"),
        ("photons", "50000"),
        ("radius", "0.05"),
        ("alpha", "1"),
        ("continuation", "1"),
        ("techniques", "bpt,pp3d"),
    ];
    let found = alone(&scene, &described("upbp", &set), 3, 75);
    agree("fog", &found, 0.03, 0.056, |technique| matches!(technique, Technique::Merge { .. }));
}

#[test]
fn what_cannot_be_kept_is_an_error() {
    let scene = built("");
    let error = |name: &str, memory: usize| {
        let settings = Settings { integrator: Some(described(name, &[])), ..Settings::default() };
        let mut rendering = Rendering::new(&scene, &settings).unwrap();
        rendering.keep_techniques(3, memory).unwrap_err().to_string()
    };
    assert_eq!(
        error("volpath", usize::MAX),
        "`volpath` does not tell techniques apart: those that do are ptracer, bdpt, vcm, upbp"
    );
    // One pixel of one technique takes 48 bytes.
    let found = error("bdpt", 9 * PIXELS * 48 - 1);
    assert_eq!(
        found,
        "9 techniques of 32x32 pixels need 0 MiB, more than the 0 MiB allowed: take fewer pixels or a lower depth"
    );
    let settings = Settings { integrator: Some(described("bdpt", &[])), ..Settings::default() };
    assert!(Rendering::new(&scene, &settings).unwrap().keep_techniques(3, 9 * PIXELS * 48).is_ok());
}

#[test]
fn light_paths_and_what_they_leave_are_counted() {
    let scene = built(
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="9"/>
            <translate y="-1"/></transform><bsdf type="diffuse"/></shape>"#,
    );
    let counts = |name: &str, set: &[(&str, &str)], threads| {
        let settings = Settings { integrator: Some(described(name, set)), seed: Some(1), threads: Some(threads) };
        let mut rendering = Rendering::new(&scene, &settings).unwrap();
        rendering.add_passes(3).unwrap();
        rendering.counts()
    };
    for (name, set, light_paths) in [
        ("ptracer", &[][..], 3 * PIXELS as u64),
        ("bdpt", &[], 3 * PIXELS as u64),
        // A sixteenth more where the camera's walk has scattered.
        ("vcm", &[("photons", "160")], 3 * (PIXELS as u64 + 160 + 10)),
        ("vcm", &[("photons", "160"), ("techniques", "surf")], 3 * (160 + 10)),
    ] {
        let found = counts(name, set, 2);
        assert_eq!(found.light_paths, light_paths, "{name} {set:?}");
        // Nearly all light falls on the floor, from where little comes back.
        assert!(
            (0.8 * light_paths as f64..1.3 * light_paths as f64).contains(&(found.photons as f64)),
            "{name} {set:?}"
        );
        assert_eq!(found, counts(name, set, 1));
    }
}
