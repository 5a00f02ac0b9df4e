//! `tyndall compare` and `tyndall view`: whole comparisons of a small scene.

use crate::{Folder, text};
use serde_json::Value;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// This program as if it were another renderer.
const OTHER: &str = concat!(
    "other=",
    env!("CARGO_BIN_EXE_tyndall"),
    " render {scene} --spp {spp} --seed {seed} --size {width}x{height} -o {out}"
);

fn report(folder: &Folder, output: &str) -> Value {
    let text = std::fs::read_to_string(folder.path(output).join("report.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// A method of the first scene.
fn method<'a>(report: &'a Value, name: &str) -> &'a Value {
    let methods = report["scenes"][0]["methods"].as_array().unwrap();
    methods.iter().find(|method| method["name"] == name).unwrap()
}

#[test]
fn bias_is_flagged_and_failures_are_rows() {
    let folder = Folder::with_scene();
    let words = "compare ball.xml --with volpath,shallow=volpath --set shallow.max_depth=2 --samples 64 --repeat 3 \
                 --size 64x48 --reference-limit 12s --inset 10,10,20,16 -o out --external";
    let mut command = folder.command(words);
    command.args([OTHER, "--external", "broken=no-such-renderer {scene} {out} {spp}", "--external"]);
    let output = command.arg("silent=true {scene} {out} {spp}").output().unwrap();
    let err = text(&output.stderr);
    assert!(output.status.success(), "{err}");
    let report = report(&folder, "out");
    let scene = &report["scenes"][0];
    let reference = &scene["reference"];
    assert_eq!(reference["agreement"]["agree"], true, "{reference}");
    assert!(reference["own_error"].as_f64().unwrap() > 0.0);

    let volpath = method(&report, "volpath");
    assert_eq!(volpath["split"]["significant"], false, "{volpath}");
    assert_eq!(volpath["agreement"]["agree"], true, "{volpath}");
    let square = volpath["agreement"]["mean_square"].as_f64().unwrap();
    // Samples are stratified, so that the noise is smaller than they say.
    assert!((0.2..1.3).contains(&square), "z against another seed: {square}");
    assert!(volpath["figures"]["memory"]["median"].as_f64().is_none_or(|bytes| bytes > 1e6));
    assert_eq!(volpath["runs"].as_array().unwrap().len(), 3);
    let shallow = method(&report, "shallow");
    assert_eq!(shallow["split"]["significant"], true, "{shallow}");
    assert!(shallow["split"]["bias_squared"].as_f64() > volpath["split"]["bias_squared"].as_f64());

    // The same program by its command line: the same figures.
    let other = method(&report, "other");
    assert_eq!(other["figures"]["relmse"]["values"], volpath["figures"]["relmse"]["values"]);
    let broken = method(&report, "broken");
    assert!(broken["failure"].as_str().unwrap().contains("cannot start `no-such-renderer`"), "{broken}");
    assert!(method(&report, "silent")["failure"].as_str().unwrap().contains("wrote no picture"));

    let csv = std::fs::read_to_string(folder.path("out/report.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 5 * 3);
    assert!(std::fs::read_to_string(folder.path("out/report.tex")).unwrap().contains("\\begin{tabular}"));
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(page.contains("no-such-renderer") && page.len() < 2_000_000);
}

/// All finished renders with the moment they were written.
fn finished(folder: &Folder) -> Vec<(PathBuf, std::time::SystemTime)> {
    let Ok(entries) = std::fs::read_dir(folder.path("out/runs/ball")) else { return Vec::new() };
    let file = entries.map(|entry| entry.unwrap().path().join("run.json"));
    let mut found: Vec<_> = file.filter_map(|f| Some((f.clone(), f.metadata().ok()?.modified().ok()?))).collect();
    found.sort();
    found
}

#[test]
fn killed_at_any_moment_it_goes_on() {
    let folder = Folder::with_scene();
    let words = "compare ball.xml --with volpath,vpm,beams --time 300ms --repeat 2 --reference-limit 2s -o out";
    let mut known: Vec<(PathBuf, std::time::SystemTime)> = Vec::new();
    for delay in [0, 40, 120, 150] {
        let mut child = folder.command(words).stderr(std::process::Stdio::null()).spawn().unwrap();
        let start = Instant::now();
        while finished(&folder).len() <= known.len() && !folder.path("out/references").exists() {
            assert!(start.elapsed() < Duration::from_secs(120), "nothing is finished");
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(delay));
        child.kill().unwrap();
        child.wait().unwrap();
        let now = finished(&folder);
        assert!(known.iter().all(|run| now.contains(run)), "a finished render was repeated");
        assert!(!folder.path("out/index.html").exists());
        known = now;
    }
    let err = folder.succeed(words).1;
    assert!(err.contains("was finished"), "{err}");
    let now = finished(&folder);
    assert_eq!(now.len(), 6);
    assert!(known.iter().all(|run| now.contains(run)), "a finished render was repeated");
    let first = report(&folder, "out");
    let points = method(&first, "volpath")["curve"].as_array().unwrap();
    assert!(points.len() >= 2, "{points:?}");
    // Once more changes nothing but the date: everything was finished.
    folder.succeed(words);
    assert_eq!(finished(&folder), now);
    let again = report(&folder, "out");
    assert_eq!(first["scenes"][0]["methods"], again["scenes"][0]["methods"]);
}

#[test]
fn equal_error_with_a_file() {
    let folder = Folder::with_scene();
    let experiment = "error = 0.25\nlimit = \"20s\"\nsize = \"40x28\"\nreference-limit = \"10s\"\n[[scene]]\npath = \"ball.xml\"\n\
                      [[method]]\nintegrator = \"volpath\"\n[[method]]\nname = \"deep\"\nintegrator = \"volpath\"\n\
                      set = { max_depth = 12 }\n";
    std::fs::write(folder.path("fog.toml"), experiment).unwrap();
    folder.succeed("compare fog.toml");
    let report = report(&folder, "fog.report");
    for name in ["volpath", "deep"] {
        let error = method(&report, name)["figures"]["relmse"]["median"].as_f64().unwrap();
        assert!(error.sqrt() <= 0.25, "{name}: {error}");
    }
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::with_scene();
    let cases = [
        ("compare ball.xml", "expected methods"),
        ("compare ball.xml --with volpth", "did you mean `volpath`?"),
        ("compare ball.xml --with vpm --set vmp.photons=3", "did you mean `vpm`?"),
        ("compare ball.xml --with vpm --set vpm.photns=3", "did you mean `photons`?"),
        ("compare ball.xml --with vpm --set photons=3", "METHOD.KEY=VALUE"),
        ("compare ball.xml --with vpm,vpm", "two methods are called `vpm`"),
        ("compare ball.xml --with vpm --inset 15,0,10,4", "leaves the picture"),
        ("compare ball.xml --with vpm --error 0.1 --reference none", "needs a reference"),
        ("compare ball.xml --external m=x", "no {scene}"),
        ("compare ball.xml --with vpm --time 3s --samples 4", "cannot be used with"),
    ];
    for (words, hint) in cases {
        let err = folder.fail(words, 2);
        assert!(err.contains(hint), "{words}\n{err}");
    }
    folder.succeed("render ball.xml --size 10x10 --spp 1 -q -o small.exr");
    let err = folder.fail("compare ball.xml --with vpm --reference small.exr", 1);
    assert!(err.contains("10x10 pixels, expected 20x14"), "{err}");
    std::fs::write(folder.path("e.toml"), "time = \"1s\"\nrepat = 2\n").unwrap();
    let err = folder.fail("compare e.toml", 1);
    assert!(err.contains("e.toml:2:1: unknown field `repat`") && err.contains("did you mean `repeat`?"), "{err}");
    // Nothing was begun.
    assert!(!folder.path("report").exists());
}

#[test]
fn any_pictures_can_be_viewed() {
    let folder = Folder::with_scene();
    for (name, seed) in [("a.exr", 1), ("b.exr", 2)] {
        folder.succeed(&format!("render ball.xml --spp 2 --seed {seed} -q --no-preview -o {name}"));
    }
    folder.succeed("render ball.xml --spp 1 --size 8x8 -q --no-preview -o c.exr");
    folder.succeed("view a.exr b.exr c.exr --no-open --title Fog");
    let page = std::fs::read_to_string(folder.path("view.html")).unwrap();
    assert!(page.contains("<title>Fog</title>") && page.contains("\"name\":\"20 × 14\"") && page.contains("8 × 8"));
    folder.succeed("view a.exr --reference b.exr --no-open -o v.html");
    assert!(std::fs::read_to_string(folder.path("v.html")).unwrap().contains("\"relmse\""));
    let err = folder.fail("view a.exr missing.exr --no-open", 1);
    assert!(err.contains("missing.exr"), "{err}");
    let err = folder.fail("view c.exr --reference a.exr --no-open", 1);
    assert!(err.contains("c.exr has 8x8 pixels, the reference 20x14"), "{err}");
}
