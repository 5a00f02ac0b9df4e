//! Eight edges at once bring what eight edges bring one by one.

use std::path::Path;
use tyndall::estimators::connect::{Way, transfer};
use tyndall::estimators::edges::{Edges, Junction, Junctions, Source};
use tyndall::estimators::transport::{SHORT_OF, departure, turned};
use tyndall::math::lanes::{Row, WIDTH};
use tyndall::math::{Frame, Ray, Rng, Vec2, Vec3};
use tyndall::photons::{LightPaths, Tracing, Wanted};
use tyndall::scene::medium::Extinction;
use tyndall::walk::{FromCamera, FromLight, Media, Rules, Scattering, Vertex, passage};
use tyndall::{Scene, Spectrum};
use tyndall_formats::mitsuba;

/// Vertices of light paths: any pair of them may be connected.
fn vertices(name: &str) -> (Scene, Vec<Vertex>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let desc = mitsuba::read(&path, &mitsuba::Options::default()).unwrap().scene;
    let scene = Scene::build(&desc).unwrap();
    let rules = Rules { max_depth: 10, rr_depth: 0, rr_cap: 1.0, media: Media::Scatter };
    let wanted = Wanted { vertices: [true, true], ..Wanted::default() };
    let tracing = Tracing { seed: 3, wanted, ..Tracing::of(5000, rules) };
    let mut paths = LightPaths::default();
    paths.trace(&scene, &tracing).unwrap();
    // Some scenes have little but a ground, whose points do not see each other.
    let (media, mut vertices): (Vec<_>, Vec<_>) =
        paths.vertices.into_iter().partition(|v| matches!(v.scattering, Scattering::Medium { .. }));
    vertices.truncate(media.len());
    vertices.extend(media);
    (scene, vertices)
}

struct Case {
    radius: f32,
    clamp: f32,
}

/// One edge, and what it brings by the functions for one.
fn one(scene: &Scene, light: &Vertex, camera: &Vertex, case: &Case, u: Vec2) -> Spectrum {
    let Some(way) = Way::new(light.position, camera.position) else { return Spectrum::ZERO };
    let mut rng = Rng::keyed(1, 0, 0);
    let (value, spread) = match case.radius > 0.0 {
        true => from_ball(scene, light, camera, case.radius, u, &mut rng),
        false => (transfer(scene, &way, light, camera, &mut rng), way.spread),
    };
    let kept = if case.clamp > 0.0 { (case.clamp / spread).min(1.0) } else { 1.0 };
    value.map_or(Spectrum::ZERO, |value| light.throughput * camera.throughput * value * kept)
}

/// The same from a ball: what is in the way is looked for from its centre, turns are those of a direction uniform in the cone
/// around it, and the solid angle of the cone over that of the disk stands for the spread.
fn from_ball(
    scene: &Scene,
    light: &Vertex,
    camera: &Vertex,
    radius: f32,
    u: Vec2,
    rng: &mut Rng,
) -> (Option<Spectrum>, f32) {
    let straight = (camera.position - light.position).normalize();
    let sin2 = (radius * radius / camera.position.distance_squared(light.position)).min(1.0);
    let cap = 1.0 - (1.0 - f64::from(sin2)).sqrt();
    let spread = (2.0 * cap) as f32 / (radius * radius);
    let cos = (1.0 - f64::from(u.x) * cap) as f32;
    let (y, x) = (std::f32::consts::TAU * u.y).sin_cos();
    let aside = (1.0 - cos * cos).max(0.0).sqrt();
    let turning = Frame::from_normal(straight).to_world(Vec3::new(aside * x, aside * y, cos));
    let turns = turned::<FromLight>(scene, light, turning) * turned::<FromCamera>(scene, camera, -turning);
    let (from, medium) = departure(scene, light, straight);
    let (to, _) = departure(scene, camera, -straight);
    let passage = passage(scene, Ray::between(from, to), from.distance(to) * SHORT_OF, medium, true, rng);
    (passage.map(|passage| turns * spread * passage.transmittance), spread)
}

#[test]
fn lanes_bring_what_single_edges_bring() {
    // Diffuse walls in grey fog, glass and rough metal around a chromatic medium, a forward medium, maps, grids, many lamps.
    let names = [
        "cornell-smoke.xml",
        "fruit-juice.xml",
        "statue-smoke.xml",
        "foggy-street.xml",
        "bumpy-sphere.xml",
        "smoke-plume.xml",
    ];
    for name in names {
        let (scene, vertices) = vertices(name);
        let mut rng = Rng::keyed(7, 0, 0);
        let mut any = |n: usize| rng.bits() as usize % n;
        let (mut arrived, mut total) = (0, 0);
        for round in 0..600 {
            let case = Case { radius: [0.0, 0.05][round % 2], clamp: [0.0, 3.0][round / 2 % 2] };
            let same = round % 3 == 0;
            let mut lights: Vec<&Vertex> = Vec::new();
            let mut cameras: Vec<&Vertex> = Vec::new();
            let manner = |light: &Vertex| Junction::new::<FromLight>(&scene, light).manner;
            let seen = |camera: &Vertex| Junction::new::<FromCamera>(&scene, camera).manner;
            while lights.len() < 1 + round % WIDTH {
                let (light, camera) = (&vertices[any(vertices.len())], &vertices[any(vertices.len())]);
                let camera = if same { cameras.first().copied().unwrap_or(camera) } else { camera };
                if lights.first().is_none_or(|l| manner(l) == manner(light))
                    && cameras.first().is_none_or(|c| seen(c) == seen(camera))
                {
                    lights.push(light);
                    cameras.push(camera);
                }
            }
            let u: [Row; 2] = std::array::from_fn(|i| Row(std::array::from_fn(|lane| (lane * 2 + i) as f32 / 17.0)));
            let (mut light, mut camera) = (Junctions::none(), Junctions::none());
            for (lane, (l, c)) in lights.iter().zip(&cameras).enumerate() {
                light.set(lane, &Junction::new::<FromLight>(&scene, l), Source::Vertex(l));
                camera.set(lane, &Junction::new::<FromCamera>(&scene, c), Source::Vertex(c));
            }
            if same {
                camera = Junctions::all(&Junction::new::<FromCamera>(&scene, cameras[0]), Source::Vertex(cameras[0]));
            }
            // One lane after the other counts.
            for (lane, (l, c)) in lights.iter().zip(&cameras).enumerate() {
                let mut weight = Row([0.0; WIDTH]);
                weight.0[lane] = 2.0;
                let Case { radius, clamp } = case;
                // Random transmittances see the same numbers only where no other lane has used some.
                let count = lane + 1;
                let edges = Edges { light: &light, camera: &camera, radius, u: &u, clamp, count, weight: &weight };
                if lane > 0 && scene.media().iter().any(|m| matches!(m.kind(), Extinction::Heterogeneous(_))) {
                    continue;
                }
                let found = edges.radiance(&scene, &mut Rng::keyed(1, 0, 0));
                let expected = one(&scene, l, c, &case, Vec2::new(u[0].0[lane], u[1].0[lane])) * 2.0;
                total += 1;
                arrived += usize::from(!expected.is_black());
                // Cosines within a plane are rounding.
                let noise = l.throughput * c.throughput * (2e-6 / l.position.distance_squared(c.position));
                for channel in 0..3 {
                    let (found, expected) = (found[channel], expected[channel]);
                    let allowed = 1e-3 * expected + noise[channel];
                    assert!((found - expected).abs() <= allowed, "{name}, {round}, {lane}: {found} {expected}");
                }
            }
        }
        println!("{name}: {arrived} of {total} edges bring light");
        assert!(arrived * 20 > total, "{name}: {arrived} of {total} edges bring light");
    }
}
