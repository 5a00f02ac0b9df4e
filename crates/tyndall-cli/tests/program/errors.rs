//! Mistakes: each is found before rendering, says what is wrong, and ends with 2 on the command line, 1 elsewhere.

use crate::{Folder, SCENE};

#[test]
fn the_command_line() {
    let folder = Folder::with_scene();
    for (words, code, expected) in [
        ("render ball.xml -i volpth", 2, "there is no integrator `volpth`; did you mean `volpath`?"),
        ("render ball.xml --set max_dept=3", 2, "did you mean `max_depth`?"),
        ("render ball.xml --set max_depth=x", 2, "a whole number, found `x`"),
        ("render ball.xml --set rr_depth=0", 2, "must be a whole number from 1, found `0`"),
        ("render ball.xml --set max_depth", 2, "expected NAME=VALUE"),
        ("render ball.xml --size 12", 2, "such as 640x480"),
        ("render ball.xml --size 0x4", 2, "such as 640x480"),
        ("render ball.xml --crop 10,0,11,4", 2, "leaves the film of 20x14 pixels"),
        ("render ball.xml --time soon", 2, "such as 30s"),
        ("render ball.xml --spp 0", 2, "a whole number from 1"),
        ("render ball.xml --spp 4 --time 3s", 2, "cannot be used with"),
        ("render ball.xml --error 0", 2, "above 0"),
        ("render ball.xml --threads 0", 2, "a whole number from 1"),
        ("render ball.xml --seed x", 2, "a whole number from 0"),
        ("render ball.xml --sed 3", 2, "--seed"),
        ("render ball.xml --tonemap filmik", 2, "did you mean `filmic`?"),
        ("render ball.xml --half -o a.png", 2, "--half is for .exr"),
        ("render ball.xml --variance -o a.pfm", 2, "--variance is for .exr"),
        ("render ball.xml -o a.exe", 2, "did you mean `exr`?"),
        ("render ball.xml -o picture", 2, "no ending"),
        ("render ball.xml -o missing/a.exr", 1, "there is no folder missing"),
        (
            "render ball.xml --pyramid p",
            2,
            "--pyramid: `volpath` does not tell techniques apart: those that do are ptracer,",
        ),
        ("render ball.xml -i bdpt --pyramid p --resume", 2, "cannot be used with"),
        ("render ball.xml -i bdpt --pyramid-depth 3", 2, "--pyramid <FOLDER>"),
        ("render ball.xml -i bdpt --pyramid p --pyramid-depth 33", 2, "1..=32"),
        (
            "render ball.xml -i upbp --set max_depth=-1 --pyramid p --pyramid-depth 32 --size 300x200",
            2,
            "more than the 4096 MiB allowed",
        ),
        ("render ball.xml -i bdpt --pyramid ball.xml", 1, "cannot make the folder ball.xml"),
        ("render none.xml", 1, "none.xml"),
        ("render", 2, "SCENE"),
        ("rendr ball.xml", 2, "render"),
        ("integrators pth", 2, "did you mean `path`?"),
        ("image diff a.exr b.exr --metric ssim", 2, "there is no metric `ssim`"),
        ("image info none.exr", 1, "none.exr"),
    ] {
        let err = folder.fail(words, code);
        assert!(err.contains(expected), "{words}\n{err}");
    }
    assert_eq!(folder.files(), ["ball.xml"]);
}

#[test]
fn a_broken_scene_shows_the_place() {
    let folder = Folder::with_scene();
    let broken = SCENE.replace("name=\"max_depth\" value=\"6\"", "name=\"max_depth\" value=\"six\"");
    std::fs::write(folder.path("broken.xml"), broken).unwrap();
    for command in ["render", "check"] {
        let err = folder.fail(&format!("{command} broken.xml"), 1);
        assert!(err.starts_with("error: broken.xml:3:"), "{err}");
        assert!(err.contains("<integer name=\"max_depth\" value=\"six\"/>") && err.contains("^^^"), "{err}");
    }
    std::fs::write(folder.path("cut.xml"), &SCENE[..SCENE.len() / 2]).unwrap();
    assert!(folder.fail("check cut.xml", 1).contains("cut.xml:"));
}

#[test]
fn mistakes_about_the_integrator_of_the_scene() {
    let folder = Folder::with_scene();
    let write = |name: &str, from: &str, to: &str| {
        assert_eq!(SCENE.matches(from).count(), 1);
        std::fs::write(folder.path(name), SCENE.replace(from, to)).unwrap();
    };
    write("mlt.xml", "type=\"volpath\"", "type=\"volpth\"");
    write("name.xml", "name=\"max_depth\"", "name=\"max_dept\"");
    write("range.xml", "value=\"6\"", "value=\"-6\"");
    write("kind.xml", "<integer name=\"max_depth\" value=\"6\"/>", "<float name=\"max_depth\" value=\"6.5\"/>");
    for command in ["render", "check"] {
        for (file, place, marked, said) in [
            ("mlt.xml", "3:23", "volpth", "did you mean \"volpath\"?"),
            ("name.xml", "3:47", "max_dept", "did you mean \"max_depth\"?"),
            ("range.xml", "3:65", "-6", "found `-6`"),
            ("kind.xml", "3:63", "6.5", "found `6.5`"),
        ] {
            let err = folder.fail(&format!("{command} {file}"), 1);
            assert!(err.starts_with(&format!("error: {file}:{place}: ")) && err.contains(said), "{err}");
            assert!(err.contains(&format!(" {}\n", "^".repeat(marked.len()))), "{err}");
        }
    }
    // Another one can be chosen, which has no use for what the first could not read.
    folder.succeed("render mlt.xml -i volpath --spp 1 -q");
    folder.succeed("render name.xml -i path --spp 1 -q");
    // What it takes over still has to make sense.
    assert!(folder.fail("render range.xml -i path", 1).starts_with("error: range.xml:3:65: "));
}

#[test]
fn errors_of_writing_come_before_rendering() {
    let folder = Folder::with_scene();
    std::fs::create_dir(folder.path("a.exr")).unwrap();
    let err = folder.fail("render ball.xml --spp 1000000000 -o a.exr", 1);
    assert!(err.contains("a.exr is a folder"), "{err}");
    std::fs::create_dir(folder.path("b.png")).unwrap();
    let err = folder.fail("render ball.xml --spp 1000000000 -o b.exr", 1);
    assert!(err.contains("b.png is a folder"), "{err}");
}
