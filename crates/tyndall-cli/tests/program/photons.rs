//! Integrators that keep light paths, or tables.

use crate::Folder;

/// Every one and every estimator, at a size that takes no time.
const CHOICES: [&str; 33] = [
    "-i photonmap --set steps=3",
    "-i photonmap --set steps=3 --set final_gather=true --set reuse=2",
    "-i vpm --set steps=3 --set neighbours=5",
    "-i bre",
    "-i bre --set reuse=0",
    "-i beams",
    "-i beams --set extent=long --set footprint=1.5 --set reuse=3",
    "-i beams --set estimator=point-point-3d --set steps=3",
    "-i beams --set estimator=beam-point-2d",
    "-i beams --set estimator=beam-point-3d",
    "-i beams --set estimator=point-beam-3d --set steps=3",
    "-i beams --set estimator=point-beam-2d --set steps=3",
    "-i beams --set estimator=beam-beam-3d",
    "-i beams --set estimator=beam-beam-2d-beam",
    "-i beams --set estimator=beam-beam-2d-query --set extent=long",
    "-i planes",
    "-i ppm",
    "-i pvpm --set steps=3",
    "-i pbre --set neighbours=8",
    "-i ppb",
    "-i ptracer",
    "-i bdpt",
    "-i bdpt --set joint=true",
    "-i jis",
    "-i vcm --set surface_radius=0.05",
    "-i upbp --set techniques=pp3d,bp2d,bb1d,surf,bpt",
    "-i vpl --set clamp=10 --set lights=4",
    "-i vrl --set extent=long --set lights=4",
    "-i vbl --set reuse=2 --set lights=4",
    "-i vsl --set lights=4",
    "-i vrl --set product=always --set clamp=10 --set compensation=approximate --set lights=4",
    "-i lightcuts --set max_cut=100 --set samples=2",
    COMPOSITE,
];

const COMPOSITE: &str = "-i composite --set volpath=emitted+direct --set photonmap=indirect+caustic --set photonmap.photons=5000 \
                         --set beams=single --set beams.photons=5000 --set bre=multiple --set bre.photons=5000";

/// More light paths than a chunk of them holds, so that several threads trace.
fn photons(choice: &str) -> &'static str {
    let none = [COMPOSITE, "-i ptracer", "-i bdpt", "-i bdpt --set joint=true", "-i jis"];
    if none.contains(&choice) { "" } else { "--set photons=5000" }
}

#[test]
fn the_same_picture_at_any_number_of_threads() {
    let folder = Folder::with_scene();
    for choice in CHOICES {
        let photons = photons(choice);
        for threads in 1..=3 {
            folder.succeed(&format!(
                "render ball.xml -q --no-preview --variance --spp 4 {choice} {photons} --threads {threads} -o {threads}.exr"
            ));
        }
        let one = folder.timeless("1.exr");
        assert!(crate::red(&one).iter().any(|x| *x > 0.01), "{choice}");
        assert!(one == folder.timeless("2.exr") && one == folder.timeless("3.exr"), "{choice}");
    }
}

#[cfg(unix)]
#[test]
fn killed_they_continue_bit_for_bit() {
    use std::time::{Duration, Instant};
    let folder = Folder::with_scene();
    for choice in CHOICES {
        let picture = format!("render ball.xml -q --no-preview --variance {choice} {}", photons(choice));
        let words = format!("{picture} --spp 1000000000 --checkpoint 1ms -o a.exr");
        let mut child = folder.command(&words).spawn().unwrap();
        let start = Instant::now();
        while !folder.path("a.exr.checkpoint").exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "{choice}: no checkpoint");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        // As far as it came, and on to a number of passes that no group of them ends with.
        std::fs::copy(folder.path("a.exr.checkpoint"), folder.path("b.exr.checkpoint")).unwrap();
        folder.succeed(&format!("{picture} --spp 1 --resume -o b.exr"));
        let done: u32 = folder.picture("b.exr").attribute("samples").unwrap().parse().unwrap();
        let total = done + 3;
        folder.succeed(&format!("{picture} --spp {total} --resume -o a.exr"));
        folder.succeed(&format!("{picture} --spp {total} --threads 1 -o c.exr"));
        assert!(folder.timeless("a.exr") == folder.timeless("c.exr"), "{choice}, killed after {done}");
        assert!(!folder.path("a.exr.checkpoint").exists());
        std::fs::remove_file(folder.path("a.exr")).unwrap();
    }
}

#[test]
fn light_paths_that_do_not_fit_are_an_error() {
    let folder = Folder::with_scene();
    for choice in ["-i photonmap", "-i vpm", "-i bre", "-i beams", "-i planes", "-i pvpm", "-i pbre", "-i ppb"] {
        let err = folder.fail(&format!("render ball.xml {choice} --set photons=1e6 --set memory=1M -o a.exr"), 1);
        assert!(
            err.contains("need more than the 1 MiB that `memory` allows: trace fewer `photons`"),
            "{choice}: {err}"
        );
        assert_eq!(folder.files(), ["ball.xml"], "{choice}");
    }
}

#[test]
fn wrong_values() {
    let folder = Folder::with_scene();
    for (words, expected) in [
        ("bre --set photons=0", "parameter `photons` of `bre` must be a whole number from 1, found `0`"),
        ("bre --set photons=1.5", "parameter `photons` of `bre` is a whole number, found `1.5`"),
        ("bre --set photons=-3", "must be a whole number from 1, found `-3`"),
        ("bre --set radius=-1", "parameter `radius` of `bre` must be a number from 0, found `-1`"),
        ("bre --set radius=nan", "a number, found `nan`"),
        ("bre --set surface_radius=-1", "must be a number from 0, found `-1`"),
        ("bre --set neighbours=-1", "must be a whole number from 0, found `-1`"),
        ("bre --set reuse=-1", "must be a whole number from 0, found `-1`"),
        ("bre --set alpha=0.5", "there is no parameter of `bre` `alpha`"),
        ("bre --set memory=lots", "is a size such as 512M or 4G, found `lots`"),
        ("bre --set kernel=box", "is one of constant, epanechnikov, biweight, found `box`"),
        ("bre --set absorption=none", "is one of analogue, weight, found `none`"),
        ("bre --set components=everything", "must be all, or some of emitted, direct"),
        ("vpm --set steps=0", "must be a whole number from 1, found `0`"),
        ("vpm --set jitter=perhaps", "is true or false, found `perhaps`"),
        ("beams --set estimator=beam-beam-4d", "is one of point-point-3d, beam-point-2d"),
        ("beams --set extent=medium", "is one of short, long, found `medium`"),
        ("beams --set footprint=-1", "must be a number from 0, found `-1`"),
        ("ppb --set alpha=1", "must be a number from 0 to below 1, found `1`"),
        ("ppb --set alpha=-0.1", "must be a number from 0 to below 1, found `-0.1`"),
        ("composite --set volpath=emitted", "`composite`: no integrator takes `direct+indirect"),
        ("composite --set volpath=all --set bre=single", "`composite`: `single` is taken twice"),
        ("composite --set volpath=all --set bre.photons=x --set bre=single", "`composite`: `single` is taken twice"),
    ] {
        let err = folder.fail(&format!("render ball.xml -i {words}"), 2);
        assert!(err.contains(expected), "{words}\n{err}");
    }
    assert_eq!(folder.files(), ["ball.xml"]);
}
