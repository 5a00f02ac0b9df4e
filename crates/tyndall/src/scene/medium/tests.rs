use super::*;
use crate::math::{Rng, Transform, warp};
use crate::scene::desc::{Filter, GridDesc, PhaseDesc, VolumeDesc, Wrap};
use proptest::prelude::*;
use std::sync::Arc;

const FILTERS: [Filter; 2] = [Filter::Linear, Filter::Nearest];
const WRAPS: [Wrap; 3] = [Wrap::Clamp, Wrap::Repeat, Wrap::Mirror];

fn medium(kind: MediumKind, sigma_t: VolumeDesc, albedo: VolumeDesc, scale: f32) -> MediumDesc {
    MediumDesc { name: "fog".into(), kind, sigma_t, albedo, scale, phase: PhaseDesc::Isotropic, sample_emitters: true }
}

fn homogeneous(sigma_t: [f32; 3], scale: f32) -> MediumDesc {
    medium(MediumKind::Homogeneous, VolumeDesc::constant(sigma_t), VolumeDesc::constant([0.8; 3]), scale)
}

fn heterogeneous(sigma_t: VolumeDesc, scale: f32) -> MediumDesc {
    medium(MediumKind::Heterogeneous, sigma_t, VolumeDesc::constant([0.8; 3]), scale)
}

fn grid_of(size: [usize; 3], channels: usize, values: Vec<f32>) -> GridDesc {
    GridDesc { size, channels, values, bounds: [[0.0; 3], [1.0; 3]] }
}

fn volume_of(grid: GridDesc, to_world: Transform, filter: Filter, wrap: Wrap) -> VolumeDesc {
    VolumeDesc::Grid { grid: Arc::new(grid), to_world, filter, wrap }
}

/// A grid of numbers in [0, 1), many of them zero.
fn random_grid(rng: &mut Rng, size: [usize; 3], channels: usize) -> GridDesc {
    let count = size.iter().product::<usize>() * channels;
    grid_of(size, channels, (0..count).map(|_| (2.0 * rng.f32() - 1.0).max(0.0)).collect())
}

fn skewed() -> Transform {
    Transform::scale([2.0, 3.0, 1.5])
        .then(&Transform::rotate([0.6, 0.0, 0.8], 40.0).unwrap())
        .then(&Transform::translate([1.0, -2.0, 0.5]))
}

fn homogeneous_part(medium: &Medium) -> &Homogeneous {
    match medium.kind() {
        Extinction::Homogeneous(medium) => medium,
        Extinction::Heterogeneous(_) => panic!("not homogeneous"),
    }
}

fn heterogeneous_part(medium: &Medium) -> &Heterogeneous {
    match medium.kind() {
        Extinction::Heterogeneous(medium) => medium,
        Extinction::Homogeneous(_) => panic!("not heterogeneous"),
    }
}

#[test]
fn homogeneous_coefficients() {
    let medium = Medium::compile(&homogeneous([0.5, 1.0, 0.0], 2.0)).unwrap();
    let fog = homogeneous_part(&medium);
    assert!(!fog.is_grey() && !medium.is_grey());
    assert_eq!(fog.sigma_t().to_rgb(), [1.0, 2.0, 0.0]);
    assert_eq!(fog.sigma_s(Vec3::ONE).to_rgb(), [0.8, 1.6, 0.0]);
    assert_eq!(medium.max_sigma_t(), 2.0);
    let expected = [(-1.5_f32).exp(), (-3.0_f32).exp(), 1.0];
    for (value, expected) in fog.transmittance(1.5).to_rgb().into_iter().zip(expected) {
        assert!((value - expected).abs() < 1e-7);
    }
    assert_eq!(fog.transmittance(f32::INFINITY).to_rgb(), [0.0, 0.0, 1.0]);
    let segments: Vec<_> = medium.segments(Vec3::ZERO, Vec3::X, 3.0).collect();
    assert_eq!(segments, [Segment { t0: 0.0, t1: 3.0, majorant: 2.0, minorant: 0.0 }]);

    let grey = Medium::compile(&homogeneous([0.5; 3], 3.0)).unwrap();
    assert!(grey.is_grey());
    assert!((homogeneous_part(&grey).transmittance(2.0)[1] - (-3.0_f32).exp()).abs() < 1e-8);
    assert_eq!(homogeneous_part(&grey).transmittance(0.0), Spectrum::ONE);

    let vacuum = Medium::compile(&homogeneous([0.5; 3], 0.0)).unwrap();
    assert_eq!(vacuum.segments(Vec3::ZERO, Vec3::X, f32::INFINITY).count(), 0);
}

#[test]
fn albedo_may_vary_in_any_medium() {
    let albedo = volume_of(grid_of([2, 1, 1], 1, vec![0.2, 0.6]), Transform::IDENTITY, Filter::Linear, Wrap::Clamp);
    for kind in [MediumKind::Homogeneous, MediumKind::Heterogeneous] {
        let medium = Medium::compile(&medium(kind, VolumeDesc::constant([1.0; 3]), albedo.clone(), 1.0)).unwrap();
        // The albedo has no box: it goes on beyond the unit cube.
        for (x, expected) in [(-5.0, 0.2), (0.25, 0.2), (0.5, 0.4), (0.75, 0.6), (9.0, 0.6)] {
            assert!((medium.albedo(Vec3::new(x, 0.5, 3.0))[1] - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn heterogeneous_extinction_ends_at_the_box() {
    let constant =
        VolumeDesc::Constant { value: [0.5, 0.25, 0.125], to_world: Transform::rotate([0.0, 0.0, 1.0], 45.0).unwrap() };
    let medium = Medium::compile(&heterogeneous(constant, 2.0)).unwrap();
    // Outside the turned cube, inside the box around it (as in Mitsuba 3.9.1).
    assert_eq!(medium.sigma_t(Vec3::new(-0.65, 0.05, 0.5)).to_rgb(), [1.0, 0.5, 0.25]);
    assert_eq!(medium.sigma_t(Vec3::new(-0.71, 0.05, 0.5)), Spectrum::ZERO);
    let segments: Vec<_> = medium.segments(Vec3::new(-0.65, 0.05, -1.0), Vec3::Z, 10.0).collect();
    assert_eq!(segments, [Segment { t0: 1.0, t1: 2.0, majorant: 1.0, minorant: 0.25 }]);
}

#[test]
fn grid_look_ups_agree_with_mitsuba() {
    // `gridvolume` of Mitsuba 3.9.1 under this transform, at these points of the world.
    #[rustfmt::skip]
    let points = [[1.088284, -2.228046, 2.13855], [-0.2946467, -1.205338, 2.486272], [1.37488, -2.809594, 0.2685902],
        [1.366039, 0.2874532, 1.205708], [0.4634084, 0.0300541, 2.012065], [0.3283307, 1.363583, 3.357625]];
    #[rustfmt::skip]
    let grey = [
        (Filter::Linear, Wrap::Clamp, [0.614519, 0.206002, 0.128713, 0.168139, 0.564098, 0.454411]),
        (Filter::Linear, Wrap::Repeat, [0.333678, 0.540786, 0.49706, 0.588833, 0.564098, 0.725516]),
        (Filter::Linear, Wrap::Mirror, [0.614519, 0.206002, 0.69942, 0.168139, 0.564098, 0.617032]),
        (Filter::Nearest, Wrap::Clamp, [0.623762, 0.247525, 0.128713, 0.158416, 0.811881, 0.465347]),
        (Filter::Nearest, Wrap::Repeat, [0.128713, 0.653465, 0.158416, 0.653465, 0.811881, 0.841584]),
        (Filter::Nearest, Wrap::Mirror, [0.623762, 0.247525, 0.940594, 0.158416, 0.811881, 0.653465]),
    ];
    #[rustfmt::skip]
    let colour = [
        (Filter::Linear, Wrap::Clamp, [[0.586131, 0.0412079, 0.447149], [0.581306, 0.766522, 0.393187], [0.128713, 0.534653, 0.940594], [0.246992, 0.601245, 0.058873], [0.383064, 0.547954, 0.593208], [0.157389, 0.543029, 0.937755]]),
        (Filter::Linear, Wrap::Repeat, [[0.360332, 0.465725, 0.607021], [0.51496, 0.287266, 0.496283], [0.329767, 0.471958, 0.389185], [0.618085, 0.231347, 0.440021], [0.383064, 0.547954, 0.593208], [0.340177, 0.613164, 0.171138]]),
        (Filter::Linear, Wrap::Mirror, [[0.586131, 0.0412079, 0.447149], [0.581306, 0.766522, 0.393187], [0.434946, 0.840886, 0.543883], [0.246992, 0.601245, 0.058873], [0.383064, 0.547954, 0.593208], [0.62829, 0.183534, 0.570395]]),
    ];
    let values = |count: usize| (0..count).map(|i| ((i * 7919 + 13) % 101) as f32 / 101.0).collect();
    let volume = |channels: usize, filter, wrap| {
        let grid = grid_of([2, 4, 3], channels, values(24 * channels));
        Volume::compile(&volume_of(grid, skewed(), filter, wrap), 1.0, 1.0).unwrap()
    };
    for (filter, wrap, expected) in grey {
        for (p, expected) in points.into_iter().zip(expected) {
            let value = volume(1, filter, wrap).at(Vec3::from(p))[2];
            assert!((value - expected).abs() < 1e-5, "{filter:?} {wrap:?} {p:?}: {value} {expected}");
        }
    }
    for (filter, wrap, expected) in colour {
        for (p, expected) in points.into_iter().zip(expected) {
            let value = volume(3, filter, wrap).at(Vec3::from(p)) - Spectrum::from_rgb(expected);
            assert!(value.map(f32::abs).max_channel() < 1e-5, "{filter:?} {wrap:?} {p:?}: {value:?}");
        }
    }
}

#[test]
fn look_ups_survive_any_point() {
    let mut rng = Rng::keyed(5, 0, 0);
    for (filter, wrap) in FILTERS.into_iter().flat_map(|f| WRAPS.map(|w| (f, w))) {
        let desc = volume_of(random_grid(&mut rng, [3, 1, 2], 1), skewed(), filter, wrap);
        let volume = Volume::compile(&desc, 1.0, 1.0).unwrap();
        for hard in [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30, -1e30, 1e-40, -0.0] {
            let value = volume.at(Vec3::new(hard, 0.3, hard))[0];
            assert!((0.0..=1.0).contains(&value), "{filter:?} {wrap:?} {hard}: {value}");
        }
    }
}

#[test]
fn majorants_bound_the_extinction() {
    let mut rng = Rng::keyed(6, 0, 0);
    for case in 0..60 {
        let size = [1, 2, 3, 5, 9, 17, 40];
        let mut pick = || size[(rng.f32() * size.len() as f32) as usize];
        let size = [pick(), pick(), pick()];
        let (filter, wrap) = (FILTERS[case % 2], WRAPS[case / 2 % 3]);
        let to_world = if case % 4 < 2 { skewed() } else { Transform::scale([1.0, -2.0, 0.5]) };
        let desc = volume_of(random_grid(&mut rng, size, [1, 3][case % 3 % 2]), to_world, filter, wrap);
        let medium = Medium::compile(&heterogeneous(desc, 3.0)).unwrap();
        let bounds = heterogeneous_part(&medium).bounds();
        let radius = bounds.extent().length();
        let mut tight = 0.0_f32;
        for _ in 0..400 {
            let d = warp::square_to_sphere(rng.vec2());
            let o = bounds.centre() + radius * (Vec3::new(rng.f32(), rng.f32(), rng.f32()) - Vec3::splat(0.5));
            for segment in medium.segments(o, d, 2.0 * radius) {
                assert!(segment.majorant <= medium.max_sigma_t());
                // Both ends included: there rounding errors can reach into the neighbouring cell.
                for s in [0.0, rng.f32(), 1.0] {
                    let x = o + (segment.t0 + s * (segment.t1 - segment.t0)) * d;
                    if bounds.contains(x) {
                        let sigma_t = medium.sigma_t(x);
                        assert!(sigma_t.max_channel() <= segment.majorant, "{size:?} {filter:?} {wrap:?} {segment:?}");
                        assert!(sigma_t.min_channel() >= segment.minorant, "{size:?} {filter:?} {wrap:?} {segment:?}");
                        tight = tight.max(sigma_t.max_channel() / segment.majorant);
                    }
                }
            }
        }
        assert!(tight > 0.4, "{size:?} {filter:?} {wrap:?}: {tight}");
    }
}

#[test]
fn cells_without_extinction_are_skipped() {
    let mut values = vec![0.0; 64];
    values[40] = 2.0;
    let desc = volume_of(grid_of([64, 1, 1], 1, values), Transform::IDENTITY, Filter::Linear, Wrap::Clamp);
    let medium = Medium::compile(&heterogeneous(desc, 1.0)).unwrap();
    let segments: Vec<_> = medium.segments(Vec3::new(2.0, 0.5, 0.5), Vec3::NEG_X, 9.0).collect();
    // Voxel 40 reaches from the centre of voxel 39 to that of voxel 41; cells are four voxels wide.
    let ends = (segments[0].t0, segments[segments.len() - 1].t1);
    assert_eq!(segments.len(), 2);
    assert!((ends.0 - (2.0 - 44.0 / 64.0)).abs() < 1e-6 && (ends.1 - (2.0 - 36.0 / 64.0)).abs() < 1e-6, "{ends:?}");
    assert!(segments.iter().all(|s| s.majorant >= 2.0 && s.majorant < 2.0001 && s.minorant == 0.0));
}

/// The part of the ray within `[0, t_max]` inside the box, in double precision.
fn clip(bounds: crate::math::Aabb, o: Vec3, d: Vec3, t_max: f32) -> Option<(f64, f64)> {
    let (mut near, mut far) = (0.0_f64, f64::from(t_max));
    for i in 0..3 {
        let [min, max, o, d] = [bounds.min[i], bounds.max[i], o[i], d[i]].map(f64::from);
        if d == 0.0 {
            if o < min || o > max {
                return None;
            }
        } else {
            let (a, b) = ((min - o) / d, (max - o) / d);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    (near < far).then_some((near, far))
}

fn check_tiling(medium: &Medium, o: Vec3, d: Vec3, t_max: f32) {
    let bounds = heterogeneous_part(medium).bounds();
    let most = heterogeneous_part(medium).majorants().size().iter().sum::<usize>();
    let segments = medium.segments(o, d, t_max);
    let (mut count, mut start, mut end) = (0, f32::NAN, f32::NAN);
    for segment in segments {
        assert!(segment.t0 < segment.t1, "{segment:?}");
        if count == 0 {
            start = segment.t0;
        } else {
            assert_eq!(segment.t0, end, "a gap or an overlap");
        }
        end = segment.t1;
        count += 1;
        assert!(count <= most);
    }
    let tolerance = 1e-5 * f64::from(1.0 + o.length());
    match clip(bounds, o, d, t_max) {
        Some((near, far)) if count > 0 => {
            assert!((f64::from(start) - near).abs() < tolerance, "{start} {near}");
            assert!((f64::from(end) - far).abs() < tolerance, "{end} {far}");
        }
        // Either side may see a chord as short as a rounding error.
        Some((near, far)) => assert!(far - near < tolerance, "nothing on {near}..{far}"),
        None => assert!(count == 0 || f64::from(end - start) < tolerance, "{start}..{end} outside the box"),
    }
}

fn positive_grid() -> Medium {
    let grid = grid_of([40, 12, 7], 1, (0..40 * 12 * 7).map(|i| 1.0 + (i % 5) as f32).collect());
    let to_world = Transform::scale([2.0, 1.0, 0.5]).then(&Transform::translate([-1.0, 0.0, 0.25]));
    Medium::compile(&heterogeneous(volume_of(grid, to_world, Filter::Linear, Wrap::Clamp), 1.0)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn segments_tile_the_ray(
        // Multiples of the cell's size: origins on faces, edges and corners; directions along axes and diagonals.
        o in prop::array::uniform3(-40..40_i32), shift in prop::array::uniform3(prop_oneof![Just(0.0_f32), -1.0..1.0_f32]),
        d in prop::array::uniform3(prop_oneof![Just(0.0_f32), Just(-0.0), Just(1.0), Just(-1.0), Just(1e-12), -1.0..1.0_f32]),
        t_max in prop_oneof![0.0..4.0_f32, Just(f32::INFINITY), Just(0.0)],
    ) {
        thread_local!(static MEDIUM: Medium = positive_grid());
        prop_assume!(d.iter().any(|d| d.abs() > 1e-3));
        let o = Vec3::new(o[0] as f32 * 0.1, o[1] as f32 / 6.0, o[2] as f32 * 0.125) + 0.1 * Vec3::from(shift);
        MEDIUM.with(|medium| check_tiling(medium, o, Vec3::from(d).normalize(), t_max));
    }
}

#[test]
fn far_away_rays_tile_too() {
    let medium = positive_grid();
    let mut rng = Rng::keyed(7, 0, 0);
    for _ in 0..2000 {
        let target = Vec3::new(rng.f32() * 2.0 - 1.0, rng.f32(), 0.25 + 0.5 * rng.f32());
        let d = warp::square_to_sphere(rng.vec2());
        check_tiling(&medium, target - 1000.0 * d, d, 2000.0);
    }
    let wrong = [Vec3::new(f32::NAN, 0.0, 0.0), Vec3::splat(f32::INFINITY), Vec3::splat(f32::NAN)];
    for (a, b) in wrong.into_iter().flat_map(|w| [(w, Vec3::X), (Vec3::ZERO, w), (w, w)]) {
        assert!(medium.segments(a, b, 1.0).count() < 100);
    }
}

#[test]
fn wrong_parameters_are_errors() {
    let error = |desc: MediumDesc| Medium::compile(&desc).unwrap_err();
    for scale in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(error(homogeneous([1.0; 3], scale)), MediumError::Scale(_)));
    }
    let range = |e| matches!(e, MediumError::SigmaT(VolumeError::Range { .. } | VolumeError::NotFinite { .. }));
    for value in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(range(error(homogeneous([0.0, value, 0.0], 1.0))));
        assert!(range(error(heterogeneous(VolumeDesc::constant([0.0, value, 0.0]), 1.0))));
        let grid = grid_of([2, 1, 1], 1, vec![0.0, value]);
        assert!(range(error(heterogeneous(volume_of(grid, skewed(), Filter::Linear, Wrap::Clamp), 1.0))));
    }
    assert_eq!(error(homogeneous([1e30; 3], 1e30)), MediumError::Overflow);
    assert_eq!(error(heterogeneous(VolumeDesc::constant([1e30; 3]), 1e30)), MediumError::Overflow);
    for albedo in [-0.1, 1.5, f32::NAN] {
        let desc = |albedo| medium(MediumKind::Homogeneous, VolumeDesc::constant([1.0; 3]), albedo, 1.0);
        assert!(matches!(error(desc(VolumeDesc::constant([0.5, 0.5, albedo]))), MediumError::Albedo(_)));
        let grid = grid_of([1, 1, 2], 1, vec![0.5, albedo]);
        let grid = volume_of(grid, Transform::IDENTITY, Filter::Linear, Wrap::Clamp);
        assert!(matches!(error(desc(grid)), MediumError::Albedo(_)));
    }
    let volume = |size, channels, values: usize, to_world| {
        let grid = grid_of(size, channels, vec![0.5; values]);
        match error(heterogeneous(volume_of(grid, to_world, Filter::Linear, Wrap::Clamp), 1.0)) {
            MediumError::SigmaT(error) => error,
            other => panic!("{other}"),
        }
    };
    let id = Transform::IDENTITY;
    assert_eq!(volume([2, 2, 2], 1, 7, id), VolumeError::Length { found: 7, size: [2, 2, 2], channels: 1 });
    assert_eq!(volume([2, 0, 2], 1, 0, id), VolumeError::Size([2, 0, 2]));
    assert_eq!(volume([2, 2, 2], 6, 48, id), VolumeError::Channels { found: 6, expected: 1 });
    assert_eq!(volume([2, 2, 2], 1, 8, Transform::scale([1.0, 0.0, 1.0])), VolumeError::Transform);
    let grid = volume_of(grid_of([1, 1, 1], 1, vec![1.0]), id, Filter::Linear, Wrap::Clamp);
    let desc = medium(MediumKind::Homogeneous, grid, VolumeDesc::constant([0.5; 3]), 1.0);
    assert_eq!(error(desc), MediumError::VaryingExtinction);
    let mut desc = homogeneous([1.0; 3], 1.0);
    desc.phase = PhaseDesc::HenyeyGreenstein { g: 1.0 };
    assert_eq!(error(desc), MediumError::Phase(PhaseError::MeanCosine(1.0)));
}
