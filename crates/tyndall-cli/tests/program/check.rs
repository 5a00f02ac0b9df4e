//! `tyndall check` and `tyndall integrators`.

use crate::{Folder, SCENE};
use std::process::Stdio;

#[test]
fn a_summary_of_the_scene() {
    let folder = Folder::with_scene();
    let (out, err) = folder.succeed("check ball.xml");
    for expected in [
        "ball.xml\n",
        "shapes      2 (1 rectangle, 1 sphere), 0 triangles\n",
        "media       1\n",
        "`fog`: homogeneous, sigma_t 1.5 1/m, albedo 0.8, Henyey-Greenstein g 0.3\n",
        "emitters    2 (1 constant, 1 point)\n",
        "camera      perspective, 40 degrees wide, at (0 1 5)\n",
        "film        20x14 pixels, Gaussian filter of deviation 0.5\n",
        "sampler     4 samples per pixel, seed 0\n",
        "integrator  volpath max_depth=6 rr_depth=5 ",
        "memory      ",
    ] {
        assert!(out.contains(expected), "{expected}\n{out}");
    }
    assert_eq!(err, "");
    assert!(folder.succeed("check ball.xml -D albedo=0.25").0.contains("albedo 0.25"));
    assert_eq!(folder.files(), ["ball.xml"]);
}

#[test]
fn warnings() {
    let folder = Folder::with_scene();
    let mut dark: String = SCENE.lines().filter(|line| !line.contains("<emitter")).collect();
    dark = dark.replace("origin=\"0, 1, 5\"", "origin=\"0, 0, 0.5\"").replace("volpath", "path");
    std::fs::write(folder.path("dark.xml"), dark).unwrap();
    let (out, err) = folder.succeed("check dark.xml");
    assert!(out.contains("emitters    0\n"), "{out}");
    assert!(out.contains("inside the medium `fog`"), "{out}");
    for expected in ["warning: the scene has no emitter", "inside the medium `fog`", "ignores the scene's media"] {
        assert!(err.contains(expected), "{err}");
    }
}

#[test]
fn integrators() {
    let folder = Folder::with_scene();
    let (list, _) = folder.succeed("integrators");
    let (one, _) = folder.succeed("integrators volpath");
    let (alias, _) = folder.succeed("integrators volpathmis");
    let (page, _) = folder.succeed("integrators volpath --markdown");
    let (pages, _) = folder.succeed("integrators --markdown");
    for name in ["volpath", "path", "direct"] {
        assert!(list.contains(&format!("{name} ")) && pages.contains(&format!("# `{name}`\n")), "{list}");
    }
    assert_eq!(one, alias);
    assert!(one.contains("max_depth: a whole number, default -1\n") && one.contains("Source: "), "{one}");
    assert!(page.contains("| `max_depth` | a whole number | `-1` | ") && pages.contains(&page), "{page}");
}

#[test]
fn a_reader_who_has_seen_enough_is_no_error() {
    let folder = Folder::with_scene();
    let mut child =
        folder.command("integrators --markdown").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}
