//! The geometry of the merges: each against its integral, against itself in other lanes, and against brute force.

use super::*;
use crate::Spectrum;
use crate::accel::{Bvh, Visit};
use crate::estimators::{Query, gather};
use crate::math::kernels::Kernel;
use crate::math::lanes::{self, Level, WIDTH};
use crate::math::octahedral::Octahedral;
use crate::math::{Aabb, Frame, Vec2, warp};
use crate::photons::{
    Attenuation, Beam, BeamRadius, Beams, Flux, Origin, Photon, Plane, Planes, Points, Store, Tag, Width,
};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::medium::Medium;

const KERNEL: Kernel = Kernel::Epanechnikov;

fn tag() -> Tag {
    Tag::new(Some(MediumId(0)), 0, Origin::Direct)
}

fn direction(rng: &mut Rng) -> Vec3 {
    warp::square_to_sphere(Vec2::new(rng.f32(), rng.f32()))
}

fn position(rng: &mut Rng) -> Vec3 {
    Vec3::new(rng.f32(), rng.f32(), rng.f32())
}

fn photon(position: Vec3, radius: f32) -> Photon {
    let flux = Flux::new(Spectrum::ONE);
    Photon { position, radius, flux, direction: Octahedral::new(Vec3::Z), tag: tag() }
}

fn beam(origin: Vec3, direction: Vec3, length: f32) -> Beam {
    let flux = Flux::new(Spectrum::ONE);
    Beam { origin, direction, length, flux, attenuation: Attenuation::Rate(0.0), tag: tag(), width: Width::default() }
}

fn plane(origin: Vec3, directions: [Vec3; 2], lengths: [f32; 2]) -> Plane {
    let flux = Flux::new(Spectrum::ONE);
    Plane { origin, directions, lengths, flux, attenuation: Attenuation::Rate(0.0), end_rate: 0.0, tag: tag() }
}

fn points(photons: &[Photon]) -> Points {
    let mut store = Points::default();
    store.rebuild(photons);
    store
}

fn beams(list: &[Beam], radius: f32) -> Beams {
    let mut store = Beams::default();
    store.rebuild(list, BeamRadius::Fixed(radius));
    store
}

fn planes(list: &[Plane]) -> Planes {
    let mut store = Planes::default();
    store.rebuild(list);
    store
}

/// Data all over the unit cube; their number is no multiple of eight.
fn random_points(rng: &mut Rng) -> Points {
    let list: Vec<_> = (0..517).map(|_| photon(position(rng), 0.02 + 0.1 * rng.f32())).collect();
    points(&list)
}

fn random_beams(rng: &mut Rng) -> Beams {
    let list: Vec<_> = (0..101).map(|_| beam(position(rng), direction(rng), 0.1 + 0.9 * rng.f32())).collect();
    beams(&list, 0.05)
}

fn random_planes(rng: &mut Rng) -> Planes {
    let mut one = || {
        let directions = [direction(rng), direction(rng)];
        plane(position(rng), directions, [0.1 + 0.5 * rng.f32(), 0.1 + 0.5 * rng.f32()])
    };
    planes(&(0..203).map(|_| one()).collect::<Vec<_>>())
}

fn random_ray(rng: &mut Rng) -> BeamProbe {
    BeamProbe { ray: Ray { origin: position(rng), direction: direction(rng) }, length: 0.2 + rng.f32() }
}

/// The test of a block as a kernel.
struct Touch<'a, M: Merge> {
    merge: &'a M,
    probe: &'a M::Probe,
    block: &'a <M::Store as Store>::Block,
}

impl<M: Merge> lanes::Kernel for Touch<'_, M> {
    type Output = u32;
    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        self.merge.touches::<L>(self.probe, self.block)
    }
}

/// All meetings, found without the hierarchy.
fn meets<M: Merge>(merge: &M, probe: &M::Probe, store: &M::Store, rng: &mut Rng) -> Vec<(u32, usize, Meet)> {
    let mut found = Vec::new();
    for leaf in 0..store.bvh().leaf_count() as u32 {
        let touched = Level::Portable.run(Touch { merge, probe, block: store.block(leaf) });
        for lane in (0..WIDTH).filter(|lane| touched >> lane & 1 == 1) {
            found.extend(merge.meet(probe, store, leaf, lane, rng).map(|meet| (leaf, lane, meet)));
        }
    }
    found
}

/// The test gives the same bits at every level, never one of an empty lane, and all whose meeting `counts`; of those
/// it gives, at most the share `idle` has no meeting.
#[track_caller]
fn check_lanes<M: Merge>(
    merge: M,
    store: &M::Store,
    idle: f64,
    mut probe: impl FnMut(&mut Rng) -> M::Probe,
    counts: impl Fn(&M::Probe, u32, usize, &Meet) -> bool,
) {
    let mut rng = Rng::keyed(1, 2, 3);
    let (mut touched_lanes, mut met, mut padded) = (0, 0, 0);
    for _ in 0..4000 {
        let probe = probe(&mut rng);
        for leaf in 0..store.bvh().leaf_count() as u32 {
            let used = store.bvh().leaf(leaf).len();
            let run = |level: &Level| level.run(Touch { merge: &merge, probe: &probe, block: store.block(leaf) });
            let mut answers = Level::available().iter().map(run);
            let touched = answers.next().unwrap();
            assert!(answers.all(|other| other == touched), "the levels differ in leaf {leaf}");
            assert_eq!(touched >> used, 0, "an empty lane of leaf {leaf} is touched");
            padded += WIDTH - used;
            for lane in 0..used {
                let hit = (0..8).filter_map(|_| merge.meet(&probe, store, leaf, lane, &mut rng));
                let hit = hit.filter(|meet| counts(&probe, leaf, lane, meet)).count() > 0;
                let touch = touched >> lane & 1 == 1;
                assert!(touch || !hit, "leaf {leaf}, lane {lane} meets but is not touched");
                touched_lanes += u32::from(touch);
                met += u32::from(hit);
            }
        }
    }
    assert!(met > 500 && padded > 0, "only {met} meetings, {padded} empty lanes");
    let share = 1.0 - f64::from(met) / f64::from(touched_lanes);
    assert!(share <= idle, "{share} of the touches are idle");
}

/// Meetings this close to a border may be seen on either side of it.
const MARGIN: f32 = 1e-4;

fn within(x: f32, low: f32, high: f32) -> bool {
    low + MARGIN <= x && x <= high - MARGIN
}

#[test]
fn lanes_of_points() {
    let mut rng = Rng::keyed(7, 0, 0);
    let store = random_points(&mut rng);
    let heavy = |leaf: u32, lane: usize, meet: &Meet, dimension: i32| {
        meet.weight * store.block(leaf).radius.0[lane].powi(dimension) > 1e-3
    };
    let at_point = |rng: &mut Rng| PointProbe { position: position(rng) };
    check_lanes(PointPoint3D { kernel: KERNEL }, &store, 0.01, at_point, |_, leaf, lane, m| heavy(leaf, lane, m, 3));
    check_lanes(BeamPoint2D { kernel: KERNEL }, &store, 0.01, random_ray, |p, leaf, lane, m| {
        heavy(leaf, lane, m, 2) && within(m.t, 0.0, p.length)
    });
    // A ball may be in reach of the ray's line, but not of the ray.
    check_lanes(BeamPoint3D { kernel: KERNEL }, &store, 0.12, random_ray, |_, leaf, lane, m| heavy(leaf, lane, m, 2));
    let on_surface = |rng: &mut Rng| SurfaceProbe { position: position(rng), normal: direction(rng) };
    // The margin around the slab takes a few.
    check_lanes(SurfacePoint2D { kernel: KERNEL }, &store, 0.04, on_surface, |p, leaf, lane, m| {
        let block = store.block(leaf);
        let above = (block.position(lane) - p.position).dot(p.normal).abs();
        heavy(leaf, lane, m, 2) && above < 0.3 * block.radius.0[lane] - MARGIN
    });
}

#[test]
fn lanes_of_beams() {
    let store = random_beams(&mut Rng::keyed(7, 0, 0));
    let at_point = |rng: &mut Rng| PointProbe { position: position(rng) };
    let heavy = |m: &Meet| m.weight > 0.01;
    check_lanes(PointBeam2D { kernel: KERNEL }, &store, 0.01, at_point, |_, leaf, lane, m| {
        let block = store.block(leaf);
        heavy(m) && within(m.s[0], block.s0.0[lane], block.s1.0[lane])
    });
    check_lanes(PointBeam3D { kernel: KERNEL }, &store, 0.15, at_point, |_, _, _, m| heavy(m));
    check_lanes(BeamBeam1D { kernel: KERNEL }, &store, 0.01, random_ray, |_, _, _, m| heavy(m));
    check_lanes(BeamBeam2DAboutBeam { kernel: KERNEL }, &store, 0.35, random_ray, |_, _, _, m| heavy(m));
    check_lanes(BeamBeam2DAboutQuery { kernel: KERNEL }, &store, 0.35, random_ray, |_, _, _, m| heavy(m));
    check_lanes(BeamBeam3D { kernel: KERNEL }, &store, 0.35, random_ray, |_, _, _, m| heavy(m));
}

#[test]
fn lanes_of_planes() {
    let store = random_planes(&mut Rng::keyed(7, 0, 0));
    check_lanes(BeamPlane0D, &store, 0.01, random_ray, |p, leaf, lane, m| {
        let [first, second] = &store.block(leaf).lengths;
        within(m.t, 0.0, p.length) && within(m.s[0], 0.0, first.0[lane]) && within(m.s[1], 0.0, second.0[lane])
    });
}

/// Mean over the probes of the meetings' weights, and of the weights times the coordinates on the datum.
fn means<M: Merge>(merge: &M, store: &M::Store, probes: impl Iterator<Item = M::Probe>) -> [f64; 3] {
    let mut rng = Rng::keyed(4, 5, 6);
    let (mut sums, mut count) = ([0.0; 3], 0.0);
    for probe in probes {
        count += 1.0;
        for (_, _, Meet { s, weight, .. }) in meets(merge, &probe, store, &mut rng) {
            let factors = [1.0, s[0], s[1]];
            (0..3).for_each(|i| sums[i] += f64::from(weight) * f64::from(factors[i]));
        }
    }
    sums.map(|sum| sum / count)
}

#[track_caller]
fn close(found: f64, expected: f64, what: &str) {
    within_share(found, expected, 4e-3, what);
}

#[track_caller]
fn within_share(found: f64, expected: f64, share: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < share, "{what}: {found}, expected {expected}");
}

/// `n` x `n` points, one in each cell of the square [-1/2, 1/2]^2.
fn square(n: u32) -> impl Iterator<Item = (f32, f32)> {
    let mut rng = Rng::keyed(9, 9, 9);
    let cell = move |i: u32, u: f32| (i as f32 + u) / n as f32 - 0.5;
    (0..n * n).map(move |k| (cell(k / n, rng.f32()), cell(k % n, rng.f32())))
}

/// The same in the cube.
fn cube(n: [u32; 3]) -> impl Iterator<Item = Vec3> {
    let mut rng = Rng::keyed(9, 9, 9);
    let cell = |i: u32, u: f32, n: u32| (i as f32 + u) / n as f32 - 0.5;
    (0..n[0] * n[1] * n[2]).map(move |k| {
        let [i, j, l] = [k % n[0], k / n[0] % n[1], k / n[0] / n[1]];
        Vec3::new(cell(i, rng.f32(), n[0]), cell(j, rng.f32(), n[1]), cell(l, rng.f32(), n[2]))
    })
}

/// Rays along `direction`, 10 m long, through a square of side `side` about `centre` across them.
fn parallel_rays(n: u32, centre: Vec3, direction: Vec3, side: f32) -> impl Iterator<Item = BeamProbe> {
    let frame = Frame::from_normal(direction);
    square(n).map(move |(x, y)| {
        let through = centre + side * (x * frame.s + y * frame.t);
        BeamProbe { ray: Ray { origin: through - 5.0 * direction, direction }, length: 10.0 }
    })
}

#[test]
fn kernels_around_points_integrate_to_one() {
    let mut rng = Rng::keyed(3, 1, 4);
    let (centre, radius) = (position(&mut rng), 0.3);
    let store = points(&[photon(centre, radius)]);
    let side = 2.0 * radius;
    for (name, kernel) in Kernel::NAMES {
        let around = cube([64; 3]).map(|u| PointProbe { position: centre + side * u });
        let volume = f64::from(side).powi(3);
        close(volume * means(&PointPoint3D { kernel }, &store, around)[0], 1.0, name);
        let d = direction(&mut rng);
        let area = f64::from(side * side);
        let rays = || parallel_rays(400, centre, d, side);
        close(area * means(&BeamPoint2D { kernel }, &store, rays())[0], 1.0, name);
        close(area * means(&BeamPoint3D { kernel }, &store, rays())[0], 1.0, name);
        let frame = Frame::from_normal(d);
        let on_plane =
            square(400).map(|(x, y)| SurfaceProbe { position: centre + side * (x * frame.s + y * frame.t), normal: d });
        close(area * means(&SurfacePoint2D { kernel }, &store, on_plane)[0], 1.0, name);
    }
}

/// A cap of the sphere of chord `r` has the area `pi r^2` of the disc, so the photons of a ball, uniform, have the right
/// density under any kernel, as long as those half a radius away count.
#[test]
fn kernels_on_a_ball_find_its_density() {
    let mut rng = Rng::keyed(6, 2, 8);
    let (centre, radius) = (position(&mut rng), 0.4);
    let on_ball = |(u, v)| centre + radius * warp::square_to_sphere(Vec2::new(u + 0.5, v + 0.5));
    let photons: Vec<_> = square(300).map(|uv| photon(on_ball(uv), 0.5 * radius)).collect();
    let store = points(&photons);
    let probes: Vec<_> = (0..200).map(|_| direction(&mut rng)).collect();
    let density = photons.len() as f64 / (4.0 * std::f64::consts::PI * f64::from(radius).powi(2));
    for (name, kernel) in Kernel::NAMES {
        let around = probes.iter().map(|&normal| SurfaceProbe { position: centre + radius * normal, normal });
        close(means(&SurfacePoint2D { kernel }, &store, around)[0], density, name);
    }
}

/// The integral over all places of the query is the beam's length, and the mean coordinate is its middle.
#[test]
fn kernels_around_beams_integrate_to_its_length() {
    let mut rng = Rng::keyed(2, 7, 1);
    let (origin, b, length, radius) = (position(&mut rng), direction(&mut rng), 2.0, 0.1);
    let store = beams(&[beam(origin, b, length)], radius);
    assert!(store.piece_count() > 2);
    let centre = origin + 0.5 * length * b;
    let expected = [f64::from(length), 0.5 * f64::from(length * length)];
    // Sampled residual integrals are noisy.
    let check = |measure: f64, means: [f64; 3], what: &str| {
        let share = if what.contains("1d") || what.contains("point-beam-2d") { 4e-3 } else { 0.02 };
        (0..2).for_each(|i| within_share(measure * means[i], expected[i], share, &format!("{what}, moment {i}")));
    };
    let frame = Frame::from_normal(b);
    for (name, kernel) in Kernel::NAMES {
        let (long, wide) = (length + 2.0 * radius, 2.0 * radius);
        let around = || {
            cube([40, 40, 160]).map(|u| {
                let offset = wide * (u.x * frame.s + u.y * frame.t) + long * u.z * b;
                PointProbe { position: centre + offset }
            })
        };
        let volume = f64::from(wide * wide * long);
        check(volume, means(&PointBeam2D { kernel }, &store, around()), &format!("point-beam-2d {name}"));
        check(volume, means(&PointBeam3D { kernel }, &store, around()), &format!("point-beam-3d {name}"));
        // Across the beam too: neither numerator nor denominator may hang on the cosine.
        for slope in [0.0, 0.5, 2.0] {
            let d = (frame.s + slope * b).normalize();
            let side = length + 4.0 * radius;
            let area = f64::from(side * side);
            let rays = || parallel_rays(500, centre, d, side);
            let what = |dimension: &str| format!("beam-beam-{dimension} {name}, slope {slope}");
            check(area, means(&BeamBeam1D { kernel }, &store, rays()), &what("1d"));
            check(area, means(&BeamBeam2DAboutBeam { kernel }, &store, rays()), &what("2d-beam"));
            check(area, means(&BeamBeam2DAboutQuery { kernel }, &store, rays()), &what("2d-query"));
            check(area, means(&BeamBeam3D { kernel }, &store, rays()), &what("3d"));
        }
    }
}

#[test]
fn planes_integrate_to_the_product_of_their_edges() {
    let mut rng = Rng::keyed(2, 7, 1);
    for _ in 0..5 {
        let (origin, directions, lengths) =
            (position(&mut rng), [direction(&mut rng), direction(&mut rng)], [1.0, 0.7]);
        let store = planes(&[plane(origin, directions, lengths)]);
        let centre = origin + 0.5 * (lengths[0] * directions[0] + lengths[1] * directions[1]);
        let side = 1.8f32;
        let found = means(&BeamPlane0D, &store, parallel_rays(1000, centre, direction(&mut rng), side));
        let [l0, l1] = lengths.map(f64::from);
        for (found, expected) in found.into_iter().zip([l0 * l1, 0.5 * l0 * l0 * l1, 0.5 * l0 * l1 * l1]) {
            close(f64::from(side * side) * found, expected, "plane");
        }
    }
}

/// A meeting's two points are no farther from each other than the radius, and both lie where they may.
#[test]
fn meetings_are_within_the_radius() {
    fn check<M: Merge<Probe = BeamProbe, Store = Beams>>(merge: M, store: &Beams) {
        let mut rng = Rng::keyed(5, 5, 5);
        let mut count = 0;
        for _ in 0..400 {
            let probe = random_ray(&mut rng);
            for (leaf, lane, Meet { t, s: [s, _], .. }) in meets(&merge, &probe, store, &mut rng) {
                let block = store.block(leaf);
                let distance = probe.ray.at(t).distance(block.ray(lane).at(s));
                assert!(distance < 0.05 + MARGIN, "{distance}");
                assert!((0.0..=probe.length).contains(&t) && block.s0.0[lane] <= s && s <= block.s1.0[lane]);
                count += 1;
            }
        }
        assert!(count > 500);
    }
    let store = random_beams(&mut Rng::keyed(7, 0, 0));
    check(BeamBeam1D { kernel: KERNEL }, &store);
    check(BeamBeam2DAboutBeam { kernel: KERNEL }, &store);
    check(BeamBeam2DAboutQuery { kernel: KERNEL }, &store);
    check(BeamBeam3D { kernel: KERNEL }, &store);
}

/// A long beam far away makes all others short by comparison, so that they stay whole.
fn cut_and_whole() -> [Beams; 2] {
    let mut rng = Rng::keyed(8, 0, 0);
    let mut list: Vec<_> = (0..60).map(|_| beam(position(&mut rng), direction(&mut rng), 1.0)).collect();
    let cut = beams(&list, 0.04);
    list.push(beam(Vec3::splat(1e5), Vec3::X, 2000.0));
    let whole = beams(&list, 0.04);
    assert!(cut.piece_count() == 180 && whole.piece_count() <= 60 + 64);
    [cut, whole]
}

/// Sum of the weights, mean over `draws`, and its variance.
fn weights<M: Merge>(merge: &M, probe: &M::Probe, store: &M::Store, draws: u32, rng: &mut Rng) -> (f64, f64) {
    let sum = |rng: &mut Rng| meets(merge, probe, store, rng).iter().map(|(_, _, m)| f64::from(m.weight)).sum::<f64>();
    let all: Vec<f64> = (0..draws).map(|_| sum(rng)).collect();
    let n = f64::from(draws);
    let mean = all.iter().sum::<f64>() / n;
    (mean, all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0).max(1.0)))
}

#[test]
fn a_beam_in_pieces_is_the_same_beam() {
    fn check<M: Merge<Store = Beams>>(merge: M, stores: &[Beams; 2], draws: u32, probe: impl Fn(&mut Rng) -> M::Probe) {
        let mut rng = Rng::keyed(5, 5, 5);
        let mut total = 0.0;
        for _ in 0..100 {
            let probe = probe(&mut rng);
            let [(a, va), (b, vb)] = [0, 1].map(|i| weights(&merge, &probe, &stores[i], draws, &mut rng));
            let allowed = 4.0 * (va + vb).sqrt() + 1e-4 * (a + b);
            assert!((a - b).abs() <= allowed, "{a} in pieces, {b} whole, allowed {allowed}");
            total += a;
        }
        assert!(total > 0.0);
    }
    let stores = cut_and_whole();
    let at_point = |rng: &mut Rng| PointProbe { position: position(rng) };
    check(PointBeam2D { kernel: KERNEL }, &stores, 1, at_point);
    check(BeamBeam1D { kernel: KERNEL }, &stores, 1, random_ray);
    // The constant kernel weighs a chord whole: no noise at all.
    check(PointBeam3D { kernel: Kernel::Constant }, &stores, 1, at_point);
    check(BeamBeam2DAboutQuery { kernel: KERNEL }, &stores, 400, random_ray);
    check(BeamBeam2DAboutBeam { kernel: KERNEL }, &stores, 400, random_ray);
    check(BeamBeam3D { kernel: KERNEL }, &stores, 400, random_ray);
}

#[test]
fn perpendicular_pairs_contribute() {
    let store = beams(&[beam(Vec3::new(-1.0, 0.0, 0.1), Vec3::X, 2.0)], 0.2);
    let probe = BeamProbe { ray: Ray { origin: Vec3::new(0.3, -1.0, 0.0), direction: Vec3::Y }, length: 2.0 };
    let mut rng = Rng::keyed(0, 0, 0);
    let kernel = Kernel::Constant;
    let found = meets(&BeamBeam1D { kernel }, &probe, &store, &mut rng);
    assert_eq!(found.len(), 1);
    let Meet { t, s, weight } = found[0].2;
    assert!((t - 1.0).abs() < 1e-6 && (s[0] - 1.3).abs() < 1e-6 && (weight - 2.5).abs() < 1e-5, "{:?}", found[0]);
    // The chord is 2 sqrt(0.2^2 - 0.1^2) long, the kernel 1 / (pi 0.2^2) high.
    let expected = 2.0 * 0.03f64.sqrt() / (std::f64::consts::PI * 0.04);
    let about_beam = weights(&BeamBeam2DAboutBeam { kernel }, &probe, &store, 1, &mut rng).0;
    let about_query = weights(&BeamBeam2DAboutQuery { kernel }, &probe, &store, 1, &mut rng).0;
    close(about_beam, expected, "about the beam");
    close(about_query, expected, "about the query");
    assert!(weights(&BeamBeam3D { kernel }, &probe, &store, 1, &mut rng).0 > 0.0);
}

#[test]
fn planes_are_crossed_where_algebra_says() {
    let mut rng = Rng::keyed(6, 6, 6);
    let mut crossings = 0;
    for _ in 0..20_000 {
        let (origin, [w0, w1]) = (position(&mut rng), [direction(&mut rng), direction(&mut rng)]);
        let lengths = [0.2 + rng.f32(), 0.2 + rng.f32()];
        let probe = random_ray(&mut rng);
        // origin + s w0 + q w1 = o + t d, by inverting the matrix in double precision.
        let d = probe.ray.direction;
        let matrix = glam::DMat3::from_cols(w0.as_dvec3(), w1.as_dvec3(), -d.as_dvec3());
        let determinant = matrix.determinant();
        if determinant.abs() < 1e-3 {
            continue;
        }
        let solution = matrix.inverse() * (probe.ray.origin.as_dvec3() - origin.as_dvec3());
        let [s, q, t] = solution.to_array();
        let ends = [(s, lengths[0]), (q, lengths[1]), (t, probe.length)].map(|(x, end)| (x, f64::from(end)));
        if ends.iter().any(|(x, end)| x.abs() < 1e-3 || (x - end).abs() < 1e-3) {
            continue;
        }
        let inside = ends.iter().all(|(x, end)| 0.0 < *x && x < end);
        let found = meets(&BeamPlane0D, &probe, &planes(&[plane(origin, [w0, w1], lengths)]), &mut rng);
        assert_eq!(found.len(), usize::from(inside), "s {s}, q {q}, t {t}");
        for (_, _, meet) in found {
            let error = |a: f32, b: f64| (f64::from(a) - b).abs();
            assert!(error(meet.s[0], s) + error(meet.s[1], q) + error(meet.t, t) < 2e-3, "{meet:?}: {s}, {q}, {t}");
            assert!(error(meet.weight, 1.0 / determinant.abs()) < 1e-3 / determinant.abs(), "{meet:?}");
            crossings += 1;
        }
    }
    assert!(crossings > 500, "{crossings}");
}

/// A ray that takes everything and weighs it alike.
struct Plain(BeamProbe);

impl Query for Plain {
    const DIMENSION: u32 = 1;
    type Probe = BeamProbe;

    fn probe(&self) -> &BeamProbe {
        &self.0
    }
    #[inline(always)]
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit) {
        bvh.along::<L>(&self.0.ray, self.0.length, visit);
    }
    fn accepts(&self, _tag: Tag) -> bool {
        true
    }
    fn position(&self, t: f32) -> Vec3 {
        self.0.ray.at(t)
    }
    fn place(&self) -> (&Scene, Option<MediumId>) {
        unreachable!("neither the medium nor the way through it is asked of the scene")
    }
    fn medium(&self) -> Option<&Medium> {
        None
    }
    fn respond(&self, _t: f32, _direction: Vec3) -> Spectrum {
        Spectrum::ONE
    }
    fn look_through(&self, _bend: Vec3, _direction: Vec3, _length: f32, _rng: &mut Rng) -> Spectrum {
        Spectrum::ONE
    }
}

#[test]
fn gathering_leaves_nothing_out() {
    let mut rng = Rng::keyed(11, 0, 0);
    let (points, beams, planes) = (random_points(&mut rng), random_beams(&mut rng), random_planes(&mut rng));
    let (points_merge, beams_merge) = (BeamPoint2D { kernel: KERNEL }, BeamBeam1D { kernel: KERNEL });
    for _ in 0..1000 {
        let query = Plain(random_ray(&mut rng));
        let found = gather(&points_merge, &query, &points, &mut rng);
        let expected = meets(&points_merge, &query.0, &points, &mut rng);
        assert_eq!(found.count as usize, expected.len());
        let sum: f32 = expected.iter().map(|(_, _, m)| m.weight).sum();
        assert!((found.radiance[0] - sum).abs() <= 1e-4 * sum, "{:?} {sum}", found.radiance);
        let found = gather(&beams_merge, &query, &beams, &mut rng).count as usize;
        assert_eq!(found, meets(&beams_merge, &query.0, &beams, &mut rng).len());
        let found = gather(&BeamPlane0D, &query, &planes, &mut rng).count as usize;
        assert_eq!(found, meets(&BeamPlane0D, &query.0, &planes, &mut rng).len());
    }
}

/// Points reach queries at points as well.
#[test]
fn boxes_of_points_hold_their_balls() {
    let mut rng = Rng::keyed(12, 0, 0);
    let store = random_points(&mut rng);
    let merge = PointPoint3D { kernel: KERNEL };
    for _ in 0..1000 {
        let probe = PointProbe { position: position(&mut rng) };
        let mut visited = Vec::new();
        let mut visit = |leaf: u32, t_max: f32| {
            visited.push(leaf);
            t_max
        };
        let at = Aabb { min: probe.position, max: probe.position };
        store.bvh().overlapping::<lanes::Portable>(at, &mut visit);
        assert!(meets(&merge, &probe, &store, &mut rng).iter().all(|(leaf, _, _)| visited.contains(leaf)));
    }
}
