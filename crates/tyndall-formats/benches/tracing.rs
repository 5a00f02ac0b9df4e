//! Rates of tracing light paths and of arranging what they leave, on scenes of the literature.
//!
//!     cargo bench -p tyndall-formats --bench tracing
//!
//! Best of five runs on one thread, after one that claims the memory.

use std::path::Path;
use std::time::Instant;
use tyndall::Scene;
use tyndall::photons::{BeamRadius, Beams, LightPaths, Points, Tracing, Wanted};
use tyndall::walk::{Media, Rules};
use tyndall_formats::mitsuba;

const PATHS: u32 = 200_000;
/// As other renderers are measured: six bounces.
const DEPTH: u32 = 7;

fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let desc = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")).scene;
    Scene::build(&desc).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn tracing(paths: u32, wanted: Wanted) -> Tracing<'static> {
    let rules = Rules { max_depth: DEPTH, rr_depth: 0, rr_cap: 1.0, media: Media::Scatter };
    Tracing { point_radius: 0.01, surface_radius: 0.01, wanted, ..Tracing::of(paths, rules) }
}

/// Seconds of the quickest of five runs.
fn best(mut run: impl FnMut()) -> f64 {
    run();
    let mut timed = || {
        let started = Instant::now();
        run();
        started.elapsed().as_secs_f64()
    };
    (0..5).map(|_| timed()).fold(f64::INFINITY, f64::min)
}

fn rate(scene: &Scene, what: &str, wanted: Wanted) {
    let mut paths = LightPaths::default();
    let seconds = best(|| {
        paths.trace(scene, &tracing(PATHS, wanted)).expect("memory is unlimited");
    });
    let millions = |n: usize| n as f64 / seconds * 1e-6;
    println!("    {what:20} {:6.2} M light paths/s {:6.2} M data/s", millions(PATHS as usize), millions(paths.data()));
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        for name in ["volumetric-caustic.xml", "cornell-smoke.xml", "bumpy-sphere.xml", "lighthouse.xml"] {
            println!("{name}");
            let scene = scene(name);
            rate(&scene, "nothing kept", Wanted::default());
            rate(&scene, "points", Wanted { points: true, surfaces: true, direct: true, ..Wanted::default() });
            rate(&scene, "beams", Wanted { beams: true, ..Wanted::default() });
        }
        let scene = scene("volumetric-caustic.xml");
        let wanted = Wanted { beams: true, ..Wanted::default() };
        let mut paths = LightPaths::default();
        paths.trace(&scene, &tracing(PATHS, wanted)).expect("memory is unlimited");
        let number = (1e6 / (paths.beams.len() as f64 / f64::from(PATHS))) as u32;
        let started = Instant::now();
        paths.trace(&scene, &tracing(number, wanted)).expect("memory is unlimited");
        let traced = started.elapsed().as_secs_f64();
        let mut beams = Beams::default();
        let started = Instant::now();
        beams.rebuild(&paths.beams, BeamRadius::Fixed(0.005));
        let (built, count) = (started.elapsed().as_secs_f64(), paths.beams.len());
        let mega = beams.memory_bytes() as f64 / 1e6;
        println!("{count} beams: traced in {traced:.2} s, arranged in {built:.2} s, {mega:.0} MB");
        let wanted = Wanted { points: true, ..Wanted::default() };
        paths.trace(&scene, &tracing(number, wanted)).expect("memory is unlimited");
        let mut points = Points::default();
        let seconds = best(|| points.rebuild(&paths.points));
        println!("{} points: arranged in {seconds:.2} s", paths.points.len());
    });
}
