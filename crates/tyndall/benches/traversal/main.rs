//! Rays through a million triangles: primary, scattered and occlusion rays in a closed room of displaced spheres.
//!
//! With the path of an Embree 4 shared library in `TYNDALL_EMBREE`, the same rays go through its robust mode in the
//! same run, and the ratios are printed.

mod embree;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use embree::Embree;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tyndall::math::{Ray, Rng, Vec3, warp};
use tyndall::scene::desc::{GeometryDesc, MeshDesc, ShapeDesc};
use tyndall::scene::shape::Geometry;

/// A closed bumpy sphere of `2 sectors (rings - 1)` triangles.
fn displaced_sphere(centre: Vec3, radius: f32, sectors: u32, rings: u32, bump: f32) -> MeshDesc {
    let mut mesh = MeshDesc::default();
    let mut add = |theta: f32, phi: f32| {
        let n = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let r = radius * (1.0 + bump * (17.0 * n.x).sin() * (13.0 * n.y).sin() * (19.0 * n.z).cos());
        mesh.positions.push((centre + r * n).to_array());
    };
    add(0.0, 0.0);
    for i in 1..rings {
        for j in 0..sectors {
            let turn = std::f32::consts::TAU * j as f32 / sectors as f32;
            add(std::f32::consts::PI * i as f32 / rings as f32, turn);
        }
    }
    add(std::f32::consts::PI, 0.0);
    let last = mesh.positions.len() as u32 - 1;
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == rings => last,
        i => 1 + (i - 1) * sectors + j % sectors,
    };
    for i in 0..rings {
        for j in 0..sectors {
            if i > 0 {
                mesh.triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            }
            if i + 1 < rings {
                mesh.triangles.push([at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]);
            }
        }
    }
    mesh
}

fn room() -> MeshDesc {
    let positions = (0..8).map(|i| [0, 1, 2].map(|bit| if i >> bit & 1 == 0 { -5.0 } else { 5.0 })).collect();
    let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    MeshDesc { positions, triangles, ..MeshDesc::default() }
}

fn million() -> Vec<MeshDesc> {
    let mut meshes = vec![room()];
    for i in 0..8 {
        let centre = Vec3::from_array([0, 1, 2].map(|bit| if i >> bit & 1 == 0 { -2.3 } else { 2.3 }));
        meshes.push(displaced_sphere(centre + 0.1 * i as f32, 1.8, 360, 175, 0.05));
    }
    meshes
}

fn geometry(meshes: &[MeshDesc]) -> Geometry {
    let shape = |m: &MeshDesc| ShapeDesc::new("mesh", GeometryDesc::Mesh(Arc::new(m.clone())));
    let shapes: Vec<_> = meshes.iter().map(shape).collect();
    Geometry::build(&shapes, &[], |_| true).expect("the meshes are sound")
}

struct Rays {
    name: &'static str,
    any: bool,
    rays: Vec<(Ray, f32)>,
}

/// Primary rays of a pinhole camera, cosine-distributed rays from where they hit, and rays between random hit points.
fn rays(geometry: &Geometry) -> [Rays; 3] {
    const SIDE: u32 = 400;
    let mut rng = Rng::keyed(1, 0, 0);
    let origin = Vec3::new(-4.8, -4.5, 0.3);
    let (mut primary, mut scattered) = (Vec::new(), Vec::new());
    let mut starts = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f32 / SIDE as f32 - 0.5, (i / SIDE) as f32 / SIDE as f32 - 0.5);
        let ray = Ray { origin, direction: (Vec3::new(1.0, 0.95, 0.0) + Vec3::new(-x, x, 1.4 * y)).normalize() };
        primary.push((ray, f32::INFINITY));
        if let Some(hit) = geometry.intersect(&ray, f32::INFINITY) {
            let mut point = geometry.surface(&ray, &hit);
            if point.normal.dot(ray.direction) > 0.0 {
                point.normal = -point.normal;
            }
            let frame = tyndall::math::Frame::from_normal(point.normal);
            let direction = frame.to_world(warp::square_to_cosine_hemisphere(rng.vec2()));
            scattered.push((Ray { origin: point.leave(direction), direction }, f32::INFINITY));
            starts.push(point);
        }
    }
    let mut occlusion = Vec::new();
    for point in &starts {
        let lamp = Vec3::new(4.0 * rng.f32() - 2.0, 4.0 * rng.f32() - 2.0, 4.5);
        let offset = lamp - point.position;
        let direction = offset.normalize();
        occlusion.push((Ray { origin: point.leave(direction), direction }, offset.length() * 0.999));
    }
    let rays = |name, any, rays| Rays { name, any, rays };
    [rays("primary", false, primary), rays("scattered", false, scattered), rays("occlusion", true, occlusion)]
}

/// Time of both on all rays: the sum over short batches of the best of several alternating runs of each, so that other
/// work on the machine does not count.
fn race(
    rays: &[(Ray, f32)],
    mut ours: impl FnMut(&Ray, f32),
    mut theirs: impl FnMut(&Ray, f32),
) -> (Duration, Duration) {
    let mut sums = (Duration::ZERO, Duration::ZERO);
    for batch in rays.chunks(1000) {
        let mut best = (Duration::MAX, Duration::MAX);
        for _ in 0..5 {
            let start = Instant::now();
            batch.iter().for_each(|(ray, t_max)| ours(ray, *t_max));
            let middle = Instant::now();
            batch.iter().for_each(|(ray, t_max)| theirs(ray, *t_max));
            best = (best.0.min(middle - start), best.1.min(middle.elapsed()));
        }
        sums = (sums.0 + best.0, sums.1 + best.1);
    }
    sums
}

fn compare(meshes: &[MeshDesc], geometry: &Geometry, rays: &[Rays]) {
    let Some(embree) = Embree::open(meshes) else {
        println!("no Embree: set TYNDALL_EMBREE to the path of its shared library");
        return;
    };
    for Rays { name, any, rays } in rays {
        let (ours, theirs) = match any {
            true => race(
                rays,
                |r, t| {
                    black_box(geometry.occluded(r, t));
                },
                |r, t| {
                    black_box(embree.occluded(r, t));
                },
            ),
            false => race(
                rays,
                |r, t| {
                    black_box(geometry.intersect(r, t));
                },
                |r, t| {
                    black_box(embree.intersect(r, t));
                },
            ),
        };
        let rate = |time: Duration| rays.len() as f64 / time.as_secs_f64() * 1e-6;
        let differ = |(ray, t_max): &&(Ray, f32)| match any {
            true => geometry.occluded(ray, *t_max) != embree.occluded(ray, *t_max),
            false => {
                let (a, b) = (geometry.intersect(ray, *t_max), embree.intersect(ray, *t_max));
                (a.map_or(-1.0, |h| h.t) - b.unwrap_or(-1.0)).abs() > 1e-4
            }
        };
        println!(
            "{name:10} {:.2} Mrays/s, Embree robust {:.2}, ratio {:.2}; {} of {} rays differ",
            rate(ours),
            rate(theirs),
            theirs.as_secs_f64() / ours.as_secs_f64(),
            rays.iter().filter(differ).count(),
            rays.len()
        );
    }
}

/// A million rays from inside a closed mesh of a million triangles.
fn leaks() {
    let geometry = geometry(&[displaced_sphere(Vec3::splat(0.3), 2.0, 1000, 501, 0.05)]);
    let mut rng = Rng::keyed(2, 0, 0);
    let leaked = (0..1_000_000)
        .filter(|_| {
            let origin = Vec3::splat(0.3) + rng.f32() * warp::square_to_sphere(rng.vec2());
            geometry.intersect(&Ray { origin, direction: warp::square_to_sphere(rng.vec2()) }, f32::INFINITY).is_none()
        })
        .count();
    println!("{leaked} of 1000000 rays leaked out of {} triangles", geometry.triangle_count());
    assert_eq!(leaked, 0);
}

fn traversal(criterion: &mut Criterion) {
    let meshes = million();
    let start = Instant::now();
    let geometry = geometry(&meshes);
    println!(
        "{} triangles compiled in {:.2} s, {:.1} MiB",
        geometry.triangle_count(),
        start.elapsed().as_secs_f64(),
        geometry.memory_bytes() as f64 / (1 << 20) as f64
    );
    let sets = rays(&geometry);
    compare(&meshes, &geometry, &sets);
    leaks();
    let mut group = criterion.benchmark_group("million_triangles");
    group.sample_size(10);
    for Rays { name, any, rays } in &sets {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(*name, |b| match any {
            true => b.iter(|| rays.iter().filter(|(ray, t_max)| geometry.occluded(ray, *t_max)).count()),
            false => b.iter(|| {
                rays.iter().filter_map(|(ray, t_max)| geometry.intersect(ray, *t_max)).map(|h| h.t).sum::<f32>()
            }),
        });
    }
}

criterion_group!(benches, traversal);
criterion_main!(benches);
