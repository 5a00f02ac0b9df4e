//! Interruptions of all kinds.
#![cfg(unix)]

use crate::{Folder, text};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const ENDLESS: &str = "render ball.xml --spp 1000000000 --variance --no-preview -o a.exr";

/// Sends SIGINT.
fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

/// Reads lines up to one that contains `word`.
fn wait_for_line(reader: &mut impl BufRead, word: &str) {
    let mut line = String::new();
    while !line.contains(word) {
        line.clear();
        assert!(reader.read_line(&mut line).unwrap() > 0, "no line with {word}");
    }
}

fn wait_for_file(folder: &Folder, name: &str) {
    let start = Instant::now();
    while !folder.path(name).exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no {name}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Changes with every write to a file.
fn stamp(folder: &Folder, name: &str) -> Option<(u64, u64, i64)> {
    folder.path(name).metadata().ok().map(|m| (m.ino(), m.len(), m.mtime_nsec()))
}

#[test]
fn killed_at_any_moment_it_continues_bit_for_bit() {
    let folder = Folder::with_scene();
    let picture = "render ball.xml --size 100x75 --variance --no-preview";
    let samples = |name: &str| folder.picture(name).attribute("samples").unwrap().parse::<u32>().unwrap();
    let mut done = 0;
    // At the very moment when a checkpoint is written, and some time after.
    for delay in [0, 0, 0, 0, 30] {
        let before = stamp(&folder, "a.exr.checkpoint");
        let words = format!("{picture} --spp 1000000000 -q --checkpoint 1ms --resume -o a.exr");
        let mut child = folder.command(&words).spawn().unwrap();
        let start = Instant::now();
        while stamp(&folder, "a.exr.checkpoint") == before {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint");
            std::hint::spin_loop();
        }
        std::thread::sleep(Duration::from_millis(delay));
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().signal(), Some(9));
        assert!(!folder.path("a.exr").exists());
        // How far it came: what a copy says when it is continued.
        std::fs::copy(folder.path("a.exr.checkpoint"), folder.path("copy.exr.checkpoint")).unwrap();
        let err = folder.succeed(&format!("{picture} --spp 1 --resume -o copy.exr")).1;
        assert!(err.contains("continuing from copy.exr.checkpoint"), "{err}");
        assert_eq!(err.contains("more than asked for"), samples("copy.exr") > 1, "{err}");
        assert!(samples("copy.exr") > done);
        done = samples("copy.exr");
    }
    let total = done + 3;
    folder.succeed(&format!("{picture} -q --spp {total} --resume -o a.exr"));
    assert!(!folder.path("a.exr.checkpoint").exists());
    folder.succeed(&format!("{picture} -q --spp {total} --threads 1 -o b.exr"));
    assert!(folder.timeless("a.exr") == folder.timeless("b.exr"));
    assert_eq!(samples("a.exr"), total);
}

#[test]
fn ctrl_c_writes_what_is_there() {
    let folder = Folder::with_scene();
    let mut child = folder.command(&format!("{ENDLESS} --checkpoint 1h")).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    wait_for_line(&mut stderr, "rendering 20x14 pixels");
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let mut rest = Vec::new();
    stderr.read_to_end(&mut rest).unwrap();
    let samples = folder.picture("a.exr").attribute("samples").unwrap().to_owned();
    let expected = format!("interrupted: wrote a.exr with {samples} samples per pixel");
    assert!(text(&rest).contains(&expected), "{}", text(&rest));
    // And it can be continued from exactly there.
    let total = samples.parse::<u32>().unwrap() + 2;
    let err = folder.succeed(&format!("render ball.xml --variance --no-preview --spp {total} --resume -o a.exr")).1;
    assert!(err.contains(&format!("continuing from a.exr.checkpoint at {samples} samples")), "{err}");
    folder.succeed(&format!("render ball.xml -q --variance --no-preview --spp {total} -o b.exr"));
    assert!(folder.timeless("a.exr") == folder.timeless("b.exr"));
}

#[test]
fn ctrl_c_twice_stops_at_once() {
    let folder = Folder::with_scene();
    // One pass takes many seconds.
    let words = format!("{ENDLESS} --size 3000x2000 --threads 1");
    let mut child = folder.command(&words).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    wait_for_line(&mut stderr, "rendering ");
    interrupt(&child);
    wait_for_line(&mut stderr, "press Ctrl-C again");
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(folder.files(), ["ball.xml"]);
}

#[test]
fn a_checkpoint_of_something_else_is_refused() {
    let folder = Folder::with_scene();
    let mut child = folder.command(&format!("{ENDLESS} -q --checkpoint 1ms")).spawn().unwrap();
    wait_for_file(&folder, "a.exr.checkpoint");
    child.kill().unwrap();
    child.wait().unwrap();
    for other in ["-D albedo=0.5", "--set max_depth=3", "-i path", "--seed 5", "--size 10x10", "--crop 0,0,5,5"] {
        let err = folder.fail(&format!("render ball.xml --no-preview --resume --spp 1 {other} -o a.exr"), 1);
        assert!(err.contains("a.exr.checkpoint: the checkpoint belongs to another"), "{other}: {err}");
    }
    let bytes = std::fs::read(folder.path("a.exr.checkpoint")).unwrap();
    std::fs::write(folder.path("a.exr.checkpoint"), &bytes[..bytes.len() - 9]).unwrap();
    let err = folder.fail("render ball.xml --no-preview --resume --spp 1 -o a.exr", 1);
    assert!(err.contains("not a complete checkpoint"), "{err}");
}

#[test]
fn without_a_checkpoint_resume_starts_anew() {
    let folder = Folder::with_scene();
    let err = folder.succeed("render ball.xml --no-preview --resume --spp 1").1;
    assert!(err.contains("starting anew"), "{err}");
    assert_eq!(folder.files(), ["ball.exr", "ball.xml"]);
}
