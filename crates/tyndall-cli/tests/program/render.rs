//! Rendering: files, budgets, choices.

use crate::{Folder, magic, red};

#[test]
fn writes_a_picture_and_a_preview_beside_it() {
    let folder = Folder::with_scene();
    let (out, err) = folder.succeed("render ball.xml");
    assert_eq!(out, "");
    assert!(err.contains("wrote ball.exr and ball.png with 4 samples per pixel"), "{err}");
    assert_eq!(folder.files(), ["ball.exr", "ball.png", "ball.xml"]);
    let picture = folder.picture("ball.exr");
    assert_eq!((picture.width, picture.height, picture.layers.len()), (20, 14, 1));
    assert!(red(&picture).iter().all(|x| x.is_finite() && *x >= 0.0) && red(&picture).iter().any(|x| *x > 0.1));
    let expected = [
        ("integrator", "volpath"),
        ("samples", "4"),
        ("renderer", concat!("tyndall ", env!("CARGO_PKG_VERSION"))),
        ("scene", "ball.xml"),
        ("seed", "0"),
    ];
    for (name, value) in expected {
        assert_eq!(picture.attribute(name), Some(value));
    }
    assert!(picture.attribute("parameters").unwrap().starts_with("max_depth=6 rr_depth=5 "));
    assert!(picture.attribute("seconds").unwrap().parse::<f64>().unwrap() > 0.0);
}

#[test]
fn writes_every_format() {
    let folder = Folder::with_scene();
    folder.succeed("render ball.xml --spp 1 --quiet --variance --half --no-preview -o a.exr");
    folder.succeed("render ball.xml --spp 1 --quiet -o a.PFM");
    folder.succeed("render ball.xml --spp 1 --quiet -o a.hdr");
    folder.succeed("render ball.xml --spp 1 --quiet --exposure -1 --tonemap filmic -o a.png");
    assert_eq!(folder.files(), ["a.PFM", "a.exr", "a.hdr", "a.png", "ball.xml"]);
    assert_eq!(magic(&folder.path("a.exr")), [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(&magic(&folder.path("a.PFM"))[..3], b"PF\n");
    assert_eq!(&magic(&folder.path("a.hdr"))[..2], b"#?");
    assert_eq!(&magic(&folder.path("a.png"))[1..], b"PNG");
    assert!(folder.picture("a.exr").layer("variance").is_some());
    // The darker preview is darker.
    folder.succeed("render ball.xml --spp 1 --quiet --tonemap filmic -o b.png");
    let sum = |name: &str| red(&folder.picture(name)).iter().sum::<f32>();
    assert!(sum("a.png") < 0.8 * sum("b.png"));
}

#[test]
fn quiet_says_nothing_and_verbose_more() {
    let folder = Folder::with_scene();
    assert_eq!(folder.succeed("render ball.xml --spp 1 -q"), (String::new(), String::new()));
    let normal = folder.succeed("render ball.xml --spp 1").1;
    let verbose = folder.succeed("render ball.xml --spp 1 -v").1;
    assert!(!normal.contains("max_depth=6") && verbose.contains("max_depth=6"), "{verbose}");
}

#[test]
fn budgets() {
    let folder = Folder::with_scene();
    let samples = |words: &str| -> u32 {
        folder.succeed(&format!("render ball.xml -q --no-preview {words}"));
        folder.picture("ball.exr").attribute("samples").unwrap().parse().unwrap()
    };
    assert_eq!(samples("--spp 7"), 7);
    assert_eq!(samples("--passes 3"), 3);
    assert!(samples("--time 50ms") > 1);
    // A 3 % picture needs more samples than a 10 % one, but not without end.
    let (rough, fine) = (samples("--error 0.2"), samples("--error 0.07"));
    assert!((16..1000).contains(&rough) && rough < fine && fine < 100_000, "{rough} {fine}");
}

#[test]
fn the_same_picture_at_any_number_of_threads() {
    let folder = Folder::with_scene();
    for threads in 1..=3 {
        folder.succeed(&format!(
            "render ball.xml -q --no-preview --variance --size 50x40 --threads {threads} -o {threads}.exr"
        ));
    }
    let one = folder.timeless("1.exr");
    assert_eq!((one.width, one.height), (50, 40));
    assert!(one == folder.timeless("2.exr") && one == folder.timeless("3.exr"));
    folder.succeed("render ball.xml -q --no-preview --size 50x40 --seed 1 -o other.exr");
    assert!(red(&one) != red(&folder.picture("other.exr")));
}

#[test]
fn a_crop_is_that_part_of_the_picture() {
    let folder = Folder::with_scene();
    folder.succeed("render ball.xml -q --no-preview -o whole.exr");
    folder.succeed("render ball.xml -q --no-preview --crop 3,2,11,9 -o part.exr");
    let (whole, part) = (folder.picture("whole.exr"), folder.picture("part.exr"));
    assert_eq!((part.width, part.height), (11, 9));
    let expected: Vec<f32> = (0..9 * 11).map(|i| red(&whole)[(2 + i / 11) * 20 + 3 + i % 11]).collect();
    assert_eq!(red(&part), expected);
}

#[test]
fn integrator_parameters_and_variables() {
    let folder = Folder::with_scene();
    let mean = |words: &str| {
        folder.succeed(&format!("render ball.xml -q --no-preview --spp 16 {words}"));
        let picture = folder.picture("ball.exr");
        (red(&picture).iter().sum::<f32>(), picture.attribute("parameters").unwrap().to_owned())
    };
    let (bright, parameters) = mean("");
    assert!(parameters.contains("max_depth=6"));
    // A black fog, set in the scene; only emission seen directly and not even that, set for the integrator.
    let (dark, _) = mean("-D albedo=0");
    assert!(dark < 0.9 * bright);
    assert_eq!(folder.picture("ball.exr").attribute("defines"), Some("albedo=0"));
    let (darker, parameters) = mean("--set max_depth=1 --set hide_emitters=true");
    assert!(darker == 0.0 && parameters.contains("max_depth=1 "), "{darker} {parameters}");
    // Another integrator keeps the depth and warns of the medium.
    let (_, parameters) = mean("-i path");
    assert!(parameters.starts_with("max_depth=6 "));
    assert_eq!(folder.picture("ball.exr").attribute("integrator"), Some("path"));
    let err = folder.succeed("render ball.xml -v --spp 1 -i path").1;
    assert!(err.contains("warning: ") && err.contains("kept from the scene's `volpath`: max_depth"), "{err}");
}
