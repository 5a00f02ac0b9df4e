//! Free flights, phase functions and whole paths.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::sync::Arc;
use tyndall::math::{Ray, Rng, Vec2, Vec3};
use tyndall::scene::desc::*;
use tyndall::scene::medium::Medium;
use tyndall::scene::phase::Phase;
use tyndall::walk::flight::{ahead, fly, transmittance};
use tyndall::{Budget, Rendering, Scene, SceneDesc, Settings, Spectrum, Transform};

/// A box of `[-1, 1]^3` around a grid of soft blobs.
fn blobs() -> VolumeDesc {
    let n = 48;
    let value = |i: usize| {
        let [x, y, z] = [i % n, i / n % n, i / (n * n)].map(|k| k as f32 / n as f32 * 9.0);
        (x.sin() * y.sin() * z.sin()).max(0.0)
    };
    let grid =
        GridDesc { size: [n; 3], channels: 1, values: (0..n * n * n).map(value).collect(), ..GridDesc::default() };
    let to_world = Transform::scale([2.0; 3]).then(&Transform::translate([-1.0; 3]));
    VolumeDesc::Grid { grid: Arc::new(grid), to_world, filter: Filter::Linear, wrap: Wrap::Clamp }
}

fn medium(sigma_t: VolumeDesc, kind: MediumKind, scale: f32) -> MediumDesc {
    MediumDesc {
        name: "medium".into(),
        kind,
        sigma_t,
        albedo: VolumeDesc::constant([0.9; 3]),
        scale,
        phase: PhaseDesc::HenyeyGreenstein { g: 0.5 },
        sample_emitters: true,
    }
}

fn media() -> [(&'static str, MediumDesc); 3] {
    [
        ("homogeneous", medium(VolumeDesc::constant([1.0; 3]), MediumKind::Homogeneous, 1.0)),
        ("chromatic", medium(VolumeDesc::constant([1.0, 0.5, 0.2]), MediumKind::Homogeneous, 1.0)),
        ("grid", medium(blobs(), MediumKind::Heterogeneous, 8.0)),
    ]
}

fn flights(criterion: &mut Criterion) {
    for (name, desc) in media() {
        let medium = Medium::compile(&desc).unwrap();
        let ray = Ray { origin: Vec3::new(-0.9, 0.1, 0.2), direction: Vec3::new(0.8, 0.36, 0.48) };
        let mut rng = Rng::keyed(0, 0, 0);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(1));
        group.bench_function("free flight", |b| {
            b.iter(|| {
                let u = Vec2::new(rng.f32(), rng.f32());
                let ahead = ahead(&medium, &ray, Spectrum::ONE, u);
                black_box(fly(&medium, &ray, 1.8, ahead, Spectrum::ONE, u, &mut rng))
            });
        });
        group.bench_function("transmittance", |b| b.iter(|| black_box(transmittance(&medium, &ray, 1.8, &mut rng))));
    }
}

fn phases(criterion: &mut Criterion) {
    let table = PhaseDesc::Tabulated { values: vec![1.0, 0.5, 0.2, 0.5, 4.0] };
    let all = [
        ("isotropic", PhaseDesc::Isotropic),
        ("hg", PhaseDesc::HenyeyGreenstein { g: 0.8 }),
        ("rayleigh", PhaseDesc::Rayleigh),
        ("tabulated", table),
    ];
    for (name, desc) in all {
        let phase = Phase::compile(&desc).unwrap();
        let mut rng = Rng::keyed(0, 0, 0);
        criterion.benchmark_group("phase sampling").throughput(Throughput::Elements(1)).bench_function(name, |b| {
            b.iter(|| black_box(phase.sample(Vec3::ZERO, Vec3::Z, rng.f32(), rng.vec2())));
        });
    }
}

/// A lit box of fog or smoke around a ball.
fn room(medium: MediumDesc) -> SceneDesc {
    let mut desc = SceneDesc::default();
    (desc.film.width, desc.film.height) = (64, 64);
    desc.sensor.to_world = Transform::look_at([0.0, 0.5, 4.0], [0.0; 3], [0.0, 1.0, 0.0]).unwrap();
    desc.media.push(medium);
    desc.bsdfs.push(BsdfDesc::Null);
    let mut bounds = ShapeDesc::new("bounds", GeometryDesc::Cube);
    (bounds.bsdf, bounds.interior) = (Some(BsdfId(0)), Some(MediumId(0)));
    let mut light = ShapeDesc::new("light", GeometryDesc::Sphere { center: [0.5, 0.8, 0.0], radius: 0.1 });
    light.emission = Some(AreaEmitterDesc { radiance: TextureDesc::grey(50.0), sampling_weight: 1.0 });
    let mut ball = ShapeDesc::new("ball", GeometryDesc::Sphere { center: [-0.2, -0.3, 0.0], radius: 0.4 });
    ball.exterior = Some(MediumId(0));
    desc.shapes = vec![bounds, light, ball];
    desc
}

fn paths(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("volpath, one thread");
    for (name, medium) in media() {
        let scene = Scene::build(&room(medium)).unwrap();
        let settings = Settings { threads: Some(1), ..Settings::default() };
        group.throughput(Throughput::Elements(64 * 64 * 4)).sample_size(20);
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut rendering = Rendering::new(&scene, &settings).unwrap();
                rendering.run(Budget::Passes(4), |_, _| std::ops::ControlFlow::Continue(())).unwrap();
                rendering.picture()
            });
        });
    }
}

criterion_group!(benches, flights, phases, paths);
criterion_main!(benches);
