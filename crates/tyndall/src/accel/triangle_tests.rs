use super::*;
use crate::math::Rng;
use crate::math::lanes::{Kernel, Level};

struct Meet<'a> {
    packet: &'a TrianglePacket,
    ray: Ray,
    t_max: f32,
}

impl Kernel for Meet<'_> {
    type Output = Vec<TriangleHit>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<TriangleHit> {
        let mut hits = Vec::new();
        self.packet.meet::<L>(&TriangleRay::new(&self.ray), self.t_max, |hit, t_max| {
            hits.push(hit);
            t_max
        });
        hits
    }
}

fn meet(packet: &TrianglePacket, ray: Ray, t_max: f32) -> Vec<TriangleHit> {
    let mut results = Level::available().iter().map(|level| level.run(Meet { packet, ray, t_max }));
    let first = results.next().unwrap();
    assert!(results.all(|r| r == first), "levels differ");
    first
}

fn vec3(rng: &mut Rng) -> Vec3 {
    Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5) * 2.0
}

/// Cramer's rule in double precision: distance and barycentric coordinates.
fn solve(triangle: [Vec3; 3], ray: &Ray) -> (f64, [f64; 3]) {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2, s) = (b - a, c - a, o - a);
    let p = d.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let q = s.cross(e1);
    let (v, w) = (s.dot(p) * inverse, d.dot(q) * inverse);
    (e2.dot(q) * inverse, [1.0 - v - w, v, w])
}

#[test]
fn packets_agree_with_double_precision() {
    let mut rng = Rng::keyed(1, 0, 0);
    let mut met = 0;
    for _ in 0..4000 {
        let mut packet = TrianglePacket::EMPTY;
        let count = 1 + rng.bits() as usize % 8;
        for lane in 0..count {
            packet.set(lane, [vec3(&mut rng), vec3(&mut rng), vec3(&mut rng)], lane as u32);
        }
        let origin = vec3(&mut rng);
        let ray = Ray { origin, direction: vec3(&mut rng) };
        let hits = meet(&packet, ray, f32::INFINITY);
        for lane in 0..count {
            let (t, b) = solve(packet.triangle(lane), &ray);
            let hit = hits.iter().find(|h| h.lane == lane);
            let least = b.iter().copied().fold(t, f64::min);
            if least.abs() > 1e-4 {
                assert_eq!(hit.is_some(), least > 0.0, "{ray:?} {:?}", packet.triangle(lane));
            }
            if let Some(hit) = hit {
                met += 1;
                assert!((hit.t as f64 - t).abs() < 1e-3 * t.max(1.0));
                assert!((hit.barycentrics.as_dvec2() - glam::DVec2::new(b[1], b[2])).length() < 1e-3);
            }
        }
        assert!(hits.iter().all(|h| h.lane < count), "a padding lane was hit");
    }
    assert!(met > 500);
}

#[test]
fn triangles_without_area_are_never_hit() {
    let mut packet = TrianglePacket::EMPTY;
    packet.set(0, [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], 0);
    packet.set(1, [Vec3::ZERO; 3], 1);
    for direction in [Vec3::Z, Vec3::Y, Vec3::X, Vec3::ONE] {
        for x in [0.0, 0.5, 1.0] {
            let ray = Ray { origin: Vec3::X * x - 3.0 * direction, direction };
            assert!(meet(&packet, ray, f32::INFINITY).is_empty());
        }
    }
}

#[test]
fn distances_are_limited_on_both_sides() {
    let mut packet = TrianglePacket::EMPTY;
    packet.set(3, [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 3.0, 2.0)], 0);
    let at = |z: f32| Ray { origin: Vec3::Z * z, direction: Vec3::Z };
    assert_eq!(meet(&packet, at(0.0), 2.0), [], "t_max is excluded");
    assert_eq!(meet(&packet, at(0.0), 2.1).len(), 1);
    assert_eq!(meet(&packet, at(2.0), 9.0), [], "so is 0");
    assert_eq!(meet(&packet, at(2.1), 9.0), [], "behind");
    assert_eq!(meet(&packet, at(2.0_f32.next_down()), 9.0)[0].t, 2.0 - 2.0_f32.next_down());
}

/// A fan of triangles around a vertex: rays at the vertex, at the spokes and near them must hit some triangle.
#[test]
fn shared_vertices_and_edges_do_not_leak() {
    let mut rng = Rng::keyed(2, 0, 0);
    for round in 0..3000 {
        let centre = vec3(&mut rng) * 10.0_f32.powi(round % 4);
        let radius = 10.0_f32.powi(-(round % 3));
        let spokes = 3 + rng.bits() as usize % 6;
        let origin = centre + 5.0 * vec3(&mut rng);
        let towards = (centre - origin).normalize();
        let frame = crate::math::Frame::from_normal(towards);
        let rim: Vec<Vec3> = (0..spokes)
            .map(|i| {
                let (sin, cos) = ((i as f32 + 0.5 * rng.f32()) / spokes as f32 * std::f32::consts::TAU).sin_cos();
                let (r, h) = (radius * (0.5 + rng.f32()), radius * (rng.f32() - 0.5));
                centre + r * (cos * frame.s + sin * frame.t) + h * towards
            })
            .collect();
        let mut packet = TrianglePacket::EMPTY;
        for i in 0..spokes {
            packet.set(i, [centre, rim[i], rim[(i + 1) % spokes]], i as u32);
        }
        let aim = |target: Vec3| Ray { origin, direction: (target - origin).normalize() };
        // Where the directions to the vertices span little more than rounding, nothing can be asked.
        if radius < 1e-3 * (centre - origin).length().max(centre.abs().max_element()) {
            continue;
        }
        assert!(!meet(&packet, aim(centre), f32::INFINITY).is_empty(), "vertex");
        for end in &rim {
            for s in [1e-6, 0.01, 0.1, 0.3, 0.7] {
                let on_spoke = centre + s * (*end - centre);
                assert!(!meet(&packet, aim(on_spoke), f32::INFINITY).is_empty(), "spoke at {s}");
            }
        }
    }
}
