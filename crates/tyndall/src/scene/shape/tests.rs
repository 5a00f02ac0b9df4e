use super::*;
use crate::math::lanes::Level;
use crate::math::{Ray, Rng, Transform, Vec2, Vec3, warp};
use crate::scene::desc::{AreaEmitterDesc, GeometryDesc, MeshDesc, ShapeDesc, ShapeGroupId, TextureDesc};
use std::sync::Arc;

/// A closed bumpy sphere around the origin.
fn bumpy(sectors: u32, rings: u32, bump: f32, offset: Vec3) -> MeshDesc {
    let mut mesh = MeshDesc::default();
    for i in 0..=rings {
        for j in 0..if i == 0 || i == rings { 1 } else { sectors } {
            let theta = std::f32::consts::PI * i as f32 / rings as f32;
            let phi = std::f32::consts::TAU * j as f32 / sectors as f32;
            let n = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            let r = 1.0 + bump * (17.0 * n.x).sin() * (13.0 * n.y).sin() * (19.0 * n.z).cos();
            mesh.positions.push((offset + r * n).to_array());
        }
    }
    let last = mesh.positions.len() as u32 - 1;
    let at = |i: u32, j: u32| if i == 0 { 0 } else { (1 + (i - 1) * sectors + j % sectors).min(last) };
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

fn shape(geometry: GeometryDesc) -> ShapeDesc {
    ShapeDesc::new("thing", geometry)
}

fn mesh(mesh: MeshDesc) -> ShapeDesc {
    shape(GeometryDesc::Mesh(Arc::new(mesh)))
}

fn at(mut shape: ShapeDesc, to_world: Transform) -> ShapeDesc {
    shape.to_world = to_world;
    shape
}

fn emitting(mut shape: ShapeDesc) -> ShapeDesc {
    shape.emission = Some(AreaEmitterDesc { radiance: TextureDesc::Constant([1.0; 3]), sampling_weight: 1.0 });
    shape
}

fn sphere(center: [f64; 3], radius: f64) -> ShapeDesc {
    shape(GeometryDesc::Sphere { center, radius })
}

fn build(shapes: &[ShapeDesc]) -> Geometry {
    Geometry::build(shapes, &[], |_| true).unwrap()
}

fn hit_point(geometry: &Geometry, origin: [f32; 3], direction: [f32; 3]) -> SurfacePoint {
    let ray = Ray { origin: origin.into(), direction: direction.into() };
    geometry.surface(&ray, &geometry.intersect(&ray, f32::INFINITY).expect("a hit"))
}

#[test]
fn a_closed_mesh_does_not_leak() {
    for offset in [Vec3::ZERO, Vec3::new(1000.0, -300.0, 50.0)] {
        let desc = bumpy(101, 100, 0.05, offset);
        let geometry = build(&[mesh(desc.clone())]);
        let mut rng = Rng::keyed(1, 0, 0);
        let inside = |ray: Ray| assert!(geometry.intersect(&ray, f32::INFINITY).is_some(), "{ray:?}");
        for _ in 0..100_000 {
            let origin = offset + 0.8 * rng.f32() * warp::square_to_sphere(rng.vec2());
            inside(Ray { origin, direction: warp::square_to_sphere(rng.vec2()) });
        }
        // At vertices and at the middles of edges.
        for [a, b, _] in &desc.triangles {
            let [a, b] = [a, b].map(|i| Vec3::from_array(desc.positions[*i as usize]));
            for target in [a, (a + b) * 0.5] {
                let origin = offset + 0.5 * warp::square_to_sphere(rng.vec2());
                inside(Ray { origin, direction: (target - origin).normalize() });
            }
        }
    }
}

/// Bounces inside: the ray must stay inside for ever, and must come out when it is sent out.
fn bounces(geometry: &Geometry, start: Vec3, inside: impl Fn(Vec3) -> bool) {
    let mut rng = Rng::keyed(3, 0, 0);
    let mut ray = Ray { origin: start, direction: Vec3::X };
    for i in 0..20_000 {
        let hit = geometry.intersect(&ray, f32::INFINITY).unwrap_or_else(|| panic!("bounce {i} leaked: {ray:?}"));
        let point = geometry.surface(&ray, &hit);
        assert!(point.epsilon > 0.0 && inside(point.position), "{point:?}");
        // Sometimes nearly along the surface.
        let mut local = warp::square_to_cosine_hemisphere(rng.vec2());
        local.z *= [1.0, 1e-2, 1e-4, 1e-6][i % 4];
        let direction = crate::math::Frame::from_normal(-point.normal).to_world(local).normalize();
        let out = Ray { origin: point.leave(-direction), direction: -direction };
        if direction.dot(point.normal) < 0.0 {
            // Convex from outside: nothing there, however near.
            assert!(!geometry.occluded(&out, f32::INFINITY), "bounce {i} met its own surface: {point:?}");
            ray = Ray { origin: point.leave(direction), direction };
        }
    }
}

#[test]
fn leaving_rays_never_meet_their_own_surface_nor_tunnel() {
    for scale in [1e-3, 1.0, 1e4] {
        for offset in [0.0, 20.0] {
            let place = Transform::scale([scale; 3]).then(&Transform::rotate([1.0, 2.0, 3.0], 33.0).unwrap());
            let place = place.then(&Transform::translate([offset * scale, -offset * scale, 0.5 * scale]));
            let start = Vec3::new((offset * scale) as f32, (-offset * scale) as f32, (0.5 * scale) as f32);
            let near = |p: Vec3| (p - start).length() <= 1.8 * scale as f32;
            for desc in [sphere([0.0; 3], 1.0), shape(GeometryDesc::Cube), mesh(bumpy(24, 12, 0.0, Vec3::ZERO))] {
                let group = vec![desc.clone()];
                bounces(&build(&[at(desc, place)]), start, near);
                let instance = at(shape(GeometryDesc::Instance(ShapeGroupId(0))), place);
                bounces(&Geometry::build(&[instance], &[group], |_| true).unwrap(), start, near);
            }
        }
    }
}

#[test]
fn a_huge_slanted_floor_is_left_within_micrometres() {
    let place = Transform::scale([1e4; 3]).then(&Transform::rotate([0.3, 1.0, 0.1], 77.0).unwrap());
    let geometry = build(&[at(shape(GeometryDesc::Rectangle), place)]);
    let mut rng = Rng::keyed(4, 0, 0);
    for i in 0..50_000 {
        let target = warp::square_to_sphere(rng.vec2());
        let direction = warp::square_to_sphere(rng.vec2());
        let ray = Ray { origin: target - 3.0 * direction, direction };
        let Some(hit) = geometry.intersect(&ray, f32::INFINITY) else { continue };
        let point = geometry.surface(&ray, &hit);
        let away = warp::square_to_sphere(rng.vec2());
        let away = (away - (1.0 - 10.0_f32.powi(-(i % 7))) * away.dot(point.normal) * point.normal).normalize();
        let out = Ray { origin: point.leave(away), direction: away };
        // The corners are rounded to millimetres, so the two triangles of the floor are not quite in one plane; nor is
        // the normal known better. Rays flatter than that may meet the floor, far away.
        let slope = away.dot(point.normal).abs();
        assert!(slope < 3e-7 || !geometry.occluded(&out, f32::INFINITY), "{out:?} {slope}");
        assert!(!geometry.occluded(&out, 10.0), "{out:?} {slope}");
        if hit.t < 10.0 {
            assert!(point.epsilon < 2e-5);
        }
    }
}

#[test]
fn levels_agree_bit_for_bit_and_with_every_triangle_alone() {
    let desc = bumpy(21, 16, 0.1, Vec3::ZERO);
    let shapes =
        [mesh(desc.clone()), sphere([3.0, 0.0, 0.0], 1.0), at(shape(GeometryDesc::Disk), Transform::scale([5.0; 3]))];
    let geometry = build(&shapes);
    let alone: Vec<Geometry> = desc
        .triangles
        .iter()
        .map(|t| build(&[mesh(MeshDesc { triangles: vec![*t], ..desc.clone() })]))
        .chain(shapes[1..].iter().map(|s| build(std::slice::from_ref(s))))
        .collect();
    let mut rng = Rng::keyed(5, 0, 0);
    let mut hits = 0;
    for _ in 0..1500 {
        let origin = 4.0 * warp::square_to_sphere(rng.vec2()) * rng.f32();
        let ray = Ray { origin, direction: warp::square_to_sphere(rng.vec2()) };
        let found: Vec<_> = Level::available()
            .iter()
            .map(|level| {
                level.force();
                (geometry.intersect(&ray, 9.0), geometry.occluded(&ray, 9.0), geometry.shadow(&ray, 9.0))
            })
            .collect();
        assert!(found.iter().all(|f| *f == found[0]));
        let nearest = alone.iter().filter_map(|g| g.intersect(&ray, 9.0)).map(|h| h.t).reduce(f32::min);
        assert_eq!(found[0].0.map(|h| h.t), nearest);
        assert_eq!(found[0].1, nearest.is_some());
        hits += found[0].1 as u32;
    }
    assert!(hits > 300);
}

#[test]
fn instances_are_the_transformed_mesh() {
    let place = Transform::scale([2.0, -1.0, 0.5]).then(&Transform::rotate([1.0, 1.0, 0.0], 40.0).unwrap());
    let place = place.then(&Transform::translate([3.0, 1.0, -2.0]));
    let member = mesh(bumpy(20, 11, 0.1, Vec3::ZERO));
    let instance = at(shape(GeometryDesc::Instance(ShapeGroupId(0))), place);
    let placed = Geometry::build(&[instance], &[vec![member.clone()]], |_| true).unwrap();
    let direct = build(&[at(member, place)]);
    let mut rng = Rng::keyed(6, 0, 0);
    let mut agree = 0;
    for _ in 0..5000 {
        let target = Vec3::new(3.0, 1.0, -2.0) + 1.5 * warp::square_to_sphere(rng.vec2());
        let direction = warp::square_to_sphere(rng.vec2());
        let ray = Ray { origin: target - 5.0 * direction, direction };
        if let (Some(a), Some(b)) = (placed.intersect(&ray, 99.0), direct.intersect(&ray, 99.0))
            && a.triangle == b.triangle
        {
            let (p, q) = (placed.surface(&ray, &a), direct.surface(&ray, &b));
            assert!((a.t - b.t).abs() < 1e-4 && (p.position - q.position).length() < 1e-4);
            // The inverse transpose keeps the outside outside; the mesh without normals is turned by its winding.
            assert!((p.normal + q.normal).length() < 1e-3);
            assert_eq!((a.shape, a.instance, p.shape), (1, Some(0), placed.group_first_shape(0)));
            agree += 1;
        }
    }
    assert!(agree > 1000, "{agree}");
}

#[test]
fn shadow_rays_stop_at_any_opaque_surface_and_name_the_nearest_transparent_one() {
    let pane = |z: f64, name: &str| {
        let mut pane = at(shape(GeometryDesc::Rectangle), Transform::translate([0.0, 0.0, z]));
        pane.name = name.into();
        pane
    };
    let shapes = [pane(3.0, "clear"), pane(1.0, "clear"), pane(5.0, "wall")];
    let geometry = Geometry::build(&shapes, &[], |s| s.name == "wall").unwrap();
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z };
    assert_eq!(geometry.shadow(&ray, 1.0), Shadow::Clear);
    let Shadow::Transparent(hit) = geometry.shadow(&ray, 4.0) else { panic!() };
    assert_eq!((hit.shape, hit.t), (1, 1.0));
    assert!(matches!(geometry.shadow(&ray, 5.0), Shadow::Transparent(_)));
    assert_eq!(geometry.shadow(&ray, 5.1), Shadow::Blocked);
    assert!(geometry.occluded(&ray, 1.5) && !geometry.occluded(&ray, 1.0));
    assert_eq!(geometry.intersect(&ray, 9.0).map(|h| h.shape), Some(1));
}

#[test]
fn spheres_are_met_tangentially_from_inside_and_from_afar() {
    let geometry = build(&[sphere([0.0; 3], 1.0)]);
    let t = |o: [f32; 3], d: [f32; 3]| {
        geometry.intersect(&Ray { origin: o.into(), direction: d.into() }, f32::INFINITY).map(|h| h.t)
    };
    assert_eq!(t([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]), Some(1.0));
    assert_eq!(t([0.0, 1.0, -3.0], [0.0, 0.0, 1.0]), Some(3.0));
    assert_eq!(t([0.0, 1.0_f32.next_up(), -3.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(t([0.0, 0.0, -1e6], [0.0, 0.0, 1.0]), Some(1e6 - 1.0));
    assert_eq!(t([0.0, 0.0, 2.0], [0.0, 0.0, 1.0]), None);
    let far = hit_point(&geometry, [0.5, 0.25, -1e6], [0.0, 0.0, 1.0]);
    assert!((far.position.length() - 1.0).abs() < 2e-7 && (far.position.x - 0.5).abs() < 2e-2);
}

/// Values found with Mitsuba 3.9.
#[test]
fn texture_coordinates_and_normals_are_those_of_mitsuba() {
    let check = |desc: ShapeDesc, o: [f32; 3], d: [f32; 3], n: [f32; 3], uv: [f32; 2], du: [f32; 3], dv: [f32; 3]| {
        let p = hit_point(&build(std::slice::from_ref(&desc)), o, d);
        let near = |a: Vec3, b: [f32; 3]| assert!((a - Vec3::from_array(b)).length() < 2e-5, "{desc:?} {a} {b:?}");
        near(p.normal, n);
        near(p.shading.n, n);
        near(p.uv.extend(0.0), [uv[0], uv[1], 0.0]);
        near(p.dp_du, du);
        near(p.dp_dv, dv);
    };
    let (down, above) = ([0.0, 0.0, -1.0], [0.3, 0.2, 5.0]);
    let cube = || shape(GeometryDesc::Cube);
    check(cube(), [5.0, 0.2, 0.1], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.6, 0.45], [0.0, 2.0, 0.0], [0.0, 0.0, -2.0]);
    check(cube(), [-5.0, 0.2, 0.1], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.6, 0.55], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]);
    check(cube(), [0.3, 5.0, 0.1], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.35, 0.45], [-2.0, 0.0, 0.0], [0.0, 0.0, -2.0]);
    check(cube(), [0.3, -5.0, 0.1], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.55, 0.65], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
    check(cube(), above, down, [0.0, 0.0, 1.0], [0.6, 0.65], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    check(cube(), [0.3, 0.2, -5.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.4, 0.65], [0.0, -2.0, 0.0], [2.0, 0.0, 0.0]);
    check(shape(GeometryDesc::Rectangle), above, down, [0.0, 0.0, 1.0], [0.65, 0.6], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let disk = at(shape(GeometryDesc::Disk), Transform::scale([2.0, 3.0, -1.0]));
    check(
        disk,
        above,
        down,
        [0.0, 0.0, -1.0],
        [0.164148, 0.0665624],
        [1.82762, 1.21842, 0.0],
        [-0.837758, 2.82743, 0.0],
    );
    let n = [0.3, 0.2, 0.932738];
    let (du, dv) = ([-1.25664, 1.88496, 0.0], [2.43814, 1.62543, -1.13272]);
    check(sphere([0.0; 3], 1.0), above, down, n, [0.0935835, 0.117413], du, dv);
    let mirrored = at(sphere([0.0; 3], 1.0), Transform::scale([-1.0, 1.0, 1.0]));
    check(mirrored, above, down, n.map(|x| -x), [0.406416, 0.117413], [1.25664, -1.88496, 0.0], dv);
    let tube = GeometryDesc::Cylinder { p0: [0.0; 3], p1: [2.0, 0.0, 0.0], radius: 0.5 };
    let du = [0.0, -2.51327, -1.88496];
    check(shape(tube), [0.3, -5.0, 0.4], [0.0, 1.0, 0.0], [0.0, -0.6, 0.8], [0.602416, 0.15], du, [2.0, 0.0, 0.0]);
    let mut flipped = cube();
    flipped.flip_normals = true;
    check(flipped, above, down, [0.0, 0.0, -1.0], [0.6, 0.65], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
}

/// Chi-square of counts against expected ones; true when it is within about five sigma.
fn fits(counts: &[f64], expected: f64) -> bool {
    let chi: f64 = counts.iter().map(|c| (c - expected) * (c - expected) / expected).sum();
    let freedom = counts.len() as f64 - 1.0;
    chi < freedom + 5.0 * (2.0 * freedom).sqrt()
}

#[test]
fn area_samples_are_uniform() {
    let place = Transform::scale([2.0; 3]).then(&Transform::rotate([1.0, 2.0, 0.5], 50.0).unwrap());
    let stretched = Transform::scale([1.0, 3.0, 1.0]).then(&place);
    let tube = GeometryDesc::Cylinder { p0: [0.0, 0.0, 1.0], p1: [1.0, 0.0, 3.0], radius: 0.5 };
    let shapes = [
        (at(sphere([1.0, 0.0, 0.0], 0.5), place), 4.0 * std::f32::consts::PI),
        (at(shape(GeometryDesc::Disk), stretched), 12.0 * std::f32::consts::PI),
        (at(shape(tube), place), 4.0 * std::f32::consts::PI * 5.0_f32.sqrt()),
        (at(shape(GeometryDesc::Rectangle), stretched), 48.0),
    ];
    let mut rng = Rng::keyed(7, 0, 0);
    for (desc, area) in shapes {
        let geometry = build(&[emitting(desc)]);
        assert!((geometry.area(0) / area - 1.0).abs() < 1e-4);
        let mut counts = [0.0; 64];
        for _ in 0..64_000 {
            let (point, pdf) = geometry.sample_area(0, rng.vec2()).unwrap();
            assert!((pdf.0 * area - 1.0).abs() < 1e-4);
            // Coordinates in which area is uniform.
            let Vec2 { x: u, y: v } = point.uv;
            let (a, b) = match geometry.form(0) {
                Form::Sphere(_) => (u, 0.5 - 0.5 * (std::f32::consts::PI * v).cos()),
                Form::Disk(_) => (u * u, v),
                _ => (u, v),
            };
            counts[((8.0 * a) as usize).min(7) * 8 + ((8.0 * b) as usize).min(7)] += 1.0;
        }
        assert!(fits(&counts, 1000.0), "{counts:?}");
    }
    // Triangles by their areas.
    let geometry = build(&[emitting(mesh(bumpy(12, 7, 0.3, Vec3::ZERO)))]);
    let Form::Mesh(compiled) = geometry.form(0) else { panic!() };
    let mut counts = vec![0.0; compiled.triangles.len()];
    (0..100_000).for_each(|_| counts[geometry.sample_area(0, rng.vec2()).unwrap().0.triangle as usize] += 1.0);
    for (i, count) in counts.iter().enumerate() {
        let expected = 1e5 * compiled.triangle_area(i) / geometry.area(0) as f64;
        assert!((count - expected).abs() < 5.0 * expected.sqrt(), "triangle {i}");
    }
}

#[test]
fn directions_to_a_sphere_are_uniform_in_its_cone() {
    for (distance, radius) in [(1.01, 1.0), (3.0, 1.0), (1000.0, 0.01)] {
        let geometry = build(&[sphere([0.0, 0.0, distance], radius)]);
        let mut rng = Rng::keyed(8, 0, 0);
        let mut counts = [0.0; 64];
        let sin2 = (radius / distance).powi(2);
        let fall = sin2 / (1.0 + (1.0 - sin2).sqrt());
        for _ in 0..64_000 {
            let s = geometry.sample_sphere_solid_angle(0, Vec3::ZERO, rng.vec2()).unwrap();
            assert!((s.pdf.0 as f64 * std::f64::consts::TAU * fall - 1.0).abs() < 1e-5);
            assert!((s.point.position.as_dvec3() - glam::DVec3::Z * distance).length() < radius + 1e-4);
            assert!((s.point.position - s.distance * s.direction).length() < 1e-4 * s.distance);
            let d = s.direction.as_dvec3();
            let across2 = d.x * d.x + d.y * d.y;
            let a = across2 / (1.0 + (1.0 - across2).sqrt()) / fall;
            let b = d.y.atan2(d.x) / std::f64::consts::TAU + 0.5;
            counts[((8.0 * a) as usize).min(7) * 8 + ((8.0 * b) as usize).min(7)] += 1.0;
        }
        assert!(fits(&counts, 1000.0), "{distance} {counts:?}");
        assert!(geometry.sample_sphere_solid_angle(0, Vec3::Z * distance as f32, Vec2::ZERO).is_none());
    }
}

#[test]
fn errors_name_the_shape_and_the_problem() {
    let problem = |desc: ShapeDesc| {
        let error = Geometry::build(&[desc], &[], |_| true).unwrap_err();
        assert!(error.to_string().starts_with("shape `thing`: "), "{error}");
        error.problem
    };
    let triangle = || MeshDesc {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..MeshDesc::default()
    };
    let mut bad = triangle();
    bad.positions[1][2] = f32::NAN;
    assert_eq!(problem(mesh(bad)), Problem::NotFinite { what: "vertex", index: 1 });
    let bad = MeshDesc { triangles: vec![[0, 1, 2], [0, 3, 1]], ..triangle() };
    assert_eq!(problem(mesh(bad)), Problem::IndexOutOfRange { triangle: 1, vertex: 3, vertices: 3 });
    let bad = MeshDesc { uvs: vec![[0.0; 2]; 2], ..triangle() };
    assert!(matches!(problem(mesh(bad)), Problem::WrongLength { found: 2, expected: 3, .. }));
    let flat = Transform::scale([1.0, 1.0, 0.0]);
    assert_eq!(problem(at(mesh(triangle()), flat)), Problem::BadTransform);
    let stretch = Transform::scale([1.0, 1.0, 2.0]);
    assert_eq!(problem(at(sphere([0.0; 3], 1.0), stretch)), Problem::NonUniformScale { form: "sphere" });
    let tube = |p1, radius| shape(GeometryDesc::Cylinder { p0: [0.0; 3], p1, radius });
    assert_eq!(problem(at(tube([0.0, 0.0, 1.0], 1.0), stretch)), Problem::NonUniformScale { form: "cylinder" });
    assert_eq!(problem(tube([0.0; 3], 1.0)), Problem::BadAxis);
    assert_eq!(problem(sphere([0.0; 3], -1.0)), Problem::BadRadius(-1.0));
    let instance = || shape(GeometryDesc::Instance(ShapeGroupId(0)));
    assert_eq!(problem(instance()), Problem::UnknownGroup(0));
    assert_eq!(problem(emitting(instance())), Problem::InstancedEmitter);
    let in_group = |desc| Geometry::build(&[], &[vec![desc]], |_| true).unwrap_err().problem;
    assert_eq!(in_group(instance()), Problem::NestedInstance);
    assert_eq!(in_group(emitting(sphere([0.0; 3], 1.0))), Problem::InstancedEmitter);
}

#[test]
fn nothing_and_flat_triangles_are_never_hit() {
    let flat =
        MeshDesc { positions: vec![[0.0; 3], [1.0; 3], [2.0; 3]], triangles: vec![[0, 1, 2]], ..MeshDesc::default() };
    for geometry in [build(&[]), build(&[mesh(flat)]), build(&[mesh(MeshDesc::default())])] {
        let ray = Ray { origin: Vec3::new(1.0, 1.0, -5.0), direction: Vec3::Z };
        assert!(geometry.intersect(&ray, f32::INFINITY).is_none() && geometry.bounds().is_empty());
        assert_eq!(geometry.shadow(&ray, 1.0), Shadow::Clear);
    }
}
