//! Rates of virtual lights: how many pairs of a light and what it lights a second of one core connects, beside the shadow
//! rays alone, between random vertices of the same light paths.
//!
//!     cargo bench -p tyndall-formats --bench virtual_lights
//!
//! Best of three runs on one thread. Rates of pairs contain all that a picture takes: light paths, camera rays, sampling.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;
use tyndall::math::lanes::WIDTH;
use tyndall::math::{Ray, Rng};
use tyndall::photons::{LightPaths, Tracing, Wanted};
use tyndall::scene::desc::{IntegratorDesc, ParameterValue};
use tyndall::scene::shape::Shadow;
use tyndall::walk::{Media, Rules};
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::mitsuba;

const SIZE: u32 = 64;
/// Lights that a query visits: as usual, and so many that light paths and camera rays take next to nothing.
const LIGHTS: [i64; 2] = [64, 1024];
/// Passes with so many.
const PASSES: [i64; 2] = [8, 1];
const RAYS: u64 = 1_000_000;

fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let mut desc = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")).scene;
    (desc.film.width, desc.film.height) = (SIZE, SIZE);
    desc.film.crop = None;
    Scene::build(&desc).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The best of three rates, millions a second; `run` answers how many there were.
fn best(mut run: impl FnMut() -> u64) -> f64 {
    let mut timed = || {
        let started = Instant::now();
        let count = run();
        count as f64 * 1e-6 / started.elapsed().as_secs_f64()
    };
    (0..3).map(|_| timed()).fold(0.0, f64::max)
}

/// Shadow rays between vertices of light paths: one by one, and eight a call as pairs send them.
fn shadow_rays(scene: &Scene) -> [f64; 2] {
    let rules = Rules { max_depth: 10, rr_depth: 0, rr_cap: 1.0, media: Media::Scatter };
    let wanted = Wanted { vertices: [true, true], ..Wanted::default() };
    let tracing = Tracing { wanted, ..Tracing::of(10_000, rules) };
    let mut paths = LightPaths::default();
    paths.trace(scene, &tracing).expect("memory is unlimited");
    let mut rng = Rng::keyed(1, 2, 3);
    let mut any = || paths.vertices[rng.bits() as usize % paths.vertices.len()].position;
    let ends = (0..RAYS).map(|_| (any(), any())).filter(|(a, b)| a != b);
    let (mut rays, lengths): (Vec<_>, Vec<_>) = ends.map(|(a, b)| (Ray::between(a, b), 0.9999 * a.distance(b))).unzip();
    rays.truncate(rays.len() / WIDTH * WIDTH);
    let mut clear = [0, 0];
    let single = best(|| {
        let is_clear = |&(ray, length): &(&Ray, &f32)| scene.geometry.shadow(ray, *length) == Shadow::Clear;
        clear[0] = black_box(rays.iter().zip(&lengths).filter(is_clear).count());
        rays.len() as u64
    });
    let eight = best(|| {
        let count = |(rays, lengths): (&[Ray; WIDTH], &[f32; WIDTH])| {
            scene.geometry.shadows(rays, lengths, 0xff, &mut [None; WIDTH])[0].count_ones() as usize
        };
        clear[1] = black_box(rays.as_chunks().0.iter().zip(lengths.as_chunks().0).map(count).sum());
        rays.len() as u64
    });
    assert_eq!(clear[0], clear[1], "both see the same");
    [single, eight]
}

/// Pairs of a light and what it lights.
fn pairs(scene: &Scene, name: &str, [lights, passes]: [i64; 2]) -> f64 {
    let components = ("components".into(), ParameterValue::Text("multiple+indirect".into()));
    let lights = ("lights".into(), ParameterValue::Integer(lights));
    let parameters = [components, lights].into_iter().collect();
    let integrator = Some(IntegratorDesc { name: name.into(), parameters });
    let settings = Settings { integrator, threads: Some(1), ..Settings::default() };
    best(|| {
        let mut rendering = Rendering::new(scene, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
        rendering.add_passes(passes as u32).expect("memory is unlimited");
        rendering.counts().connections
    })
}

fn main() {
    for name in ["cornell-smoke.xml", "statue-smoke.xml", "fruit-juice.xml", "foggy-street.xml"] {
        let scene = scene(name);
        let [single, eight] = shadow_rays(&scene);
        println!("{name}: {single:.2} M shadow rays/s alone, {eight:.2} in eights");
        for method in ["vpl", "vsl", "vrl", "vbl"] {
            let [few, many] = [0, 1].map(|i| pairs(&scene, method, [LIGHTS[i], PASSES[i]]));
            println!("    {method} {few:6.2} M pairs/s, {many:6.2} with {} lights a query", LIGHTS[1]);
        }
    }
}
