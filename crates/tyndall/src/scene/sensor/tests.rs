use super::*;
use crate::math::Transform;

const FILM: FilmDesc =
    FilmDesc { width: 40, height: 30, crop: None, filter: crate::scene::desc::ReconstructionFilter::Box };

fn to_world() -> Transform {
    Transform::look_at([1.0, 2.0, 3.0], [0.5, 0.0, -1.0], [0.0, 1.0, 0.0]).unwrap()
}

fn desc(kind: SensorKind, to_world: Transform) -> SensorDesc {
    SensorDesc { kind, to_world, near_clip: 0.5, far_clip: 20.0, medium: None }
}

fn perspective(principal_point: [f32; 2]) -> SensorDesc {
    desc(SensorKind::Perspective { fov_x: 50.0, principal_point }, to_world())
}

fn thin_lens(aperture_radius: f32, focus_distance: f32) -> SensorDesc {
    desc(SensorKind::ThinLens { fov_x: 50.0, aperture_radius, focus_distance }, to_world())
}

/// Position in fractions of the film, point of the lens, origin, direction and end of a ray.
type Row = ([f32; 2], [f32; 2], [f32; 3], [f32; 3], f32);

fn check(desc: &SensorDesc, rows: &[Row]) {
    let sensor = Sensor::compile(desc, &FILM).unwrap();
    for &(position, lens, origin, direction, t_max) in rows {
        let ray = sensor.sample_ray(Vec2::from(position) * Vec2::new(40.0, 30.0), Vec2::from(lens));
        assert!(ray.ray.origin.abs_diff_eq(Vec3::from(origin), 1e-5), "{position:?}: {ray:?}, expected {origin:?}");
        assert!(ray.ray.direction.abs_diff_eq(Vec3::from(direction), 1e-5), "{ray:?}, expected {direction:?}");
        assert!((ray.t_max - t_max).abs() < 1e-4, "{position:?}: {ray:?}, expected {t_max}");
    }
}

// The rows are what the sensors of Mitsuba 3.9.1 give.

#[test]
fn perspective_rays_agree_with_mitsuba() {
    #[rustfmt::skip]
    check(&perspective([0.0; 2]), &[
        ([0.0, 0.0], [0.5, 0.5], [0.7034513, 1.9344233, 2.5073569], [-0.512405, -0.1133097, -0.8512356], 22.570814),
        ([0.25, 0.75], [0.5, 0.5], [0.8335876, 1.699455, 2.6085739], [-0.3195311, -0.5770811, -0.7515832], 20.311277),
        ([0.9, 0.4], [0.5, 0.5], [1.1275991, 1.8091069, 2.5169966], [0.238591, -0.3569412, -0.903143], 20.857304),
    ]);
    #[rustfmt::skip]
    check(&perspective([0.1, -0.2]), &[
        ([0.0, 0.0], [0.5, 0.5], [0.7458661, 1.9970815, 2.470726], [-0.4328397, -0.0049708, -0.9014572], 22.898132),
        ([0.25, 0.75], [0.5, 0.5], [0.8760024, 1.7621132, 2.571943], [-0.2454565, -0.470903, -0.8473497], 19.701687),
        ([0.9, 0.4], [0.5, 0.5], [1.1700139, 1.8717651, 2.4803658], [0.3027438, -0.2283478, -0.9253126], 21.901505),
    ]);
    // A mirrored frame is allowed.
    let mut mirrored = perspective([0.0; 2]);
    mirrored.to_world = Transform::scale([-1.0, 1.0, 1.0]).then(&to_world());
    #[rustfmt::skip]
    check(&mirrored, &[
        ([0.25, 0.75], [0.2, 0.9], [1.064941, 1.699455, 2.5796549], [0.1246943, -0.5770811, -0.8071113], 20.311277),
    ]);
}

#[test]
fn thin_lens_rays_agree_with_mitsuba() {
    #[rustfmt::skip]
    check(&thin_lens(0.3, 4.0), &[
        ([0.0, 0.0], [0.5, 0.5], [0.7034513, 1.9344233, 2.5073569], [-0.512405, -0.1133097, -0.8512356], 22.570814),
        ([0.0, 0.0], [0.2, 0.9], [0.8095946, 2.0908387, 2.4158812], [-0.5386472, -0.1519313, -0.8287195], 22.569073),
        ([0.0, 0.0], [0.8, 0.1], [0.597308, 1.7780077, 2.5988326], [-0.4848659, -0.0744941, -0.8714102], 22.633119),
        ([0.25, 0.75], [0.2, 0.9], [0.9397309, 1.8558705, 2.5170982], [-0.3429118, -0.6097885, -0.7145416], 20.650951),
        ([0.25, 0.75], [0.8, 0.1], [0.7274443, 1.5430394, 2.7000499], [-0.2944312, -0.541562, -0.7874141], 20.034265),
        ([0.9, 0.4], [0.8, 0.1], [1.0214558, 1.6526914, 2.6084723], [0.2629021, -0.3103872, -0.9135328], 21.17798),
    ]);
}

#[test]
fn orthographic_rays_agree_with_mitsuba() {
    let d = [-0.1111111, -0.4444444, -0.8888889];
    #[rustfmt::skip]
    check(&desc(SensorKind::Orthographic, to_world()), &[
        ([0.0, 0.0], [0.5, 0.5], [-0.0891783, 2.4496324, 2.3488309], d, 19.5),
        ([0.25, 0.75], [0.5, 0.5], [0.468978, 1.4418504, 2.7829525], d, 19.5),
        ([0.9, 0.4], [0.5, 0.5], [1.7299975, 1.9121488, 2.3901761], d, 19.5),
    ]);
    let scaled = Transform::scale([2.0, 3.0, 4.0]).then(&to_world());
    #[rustfmt::skip]
    check(&desc(SensorKind::Orthographic, scaled), &[
        ([0.0, 0.0], [0.5, 0.5], [-1.3308127, 3.1266756, 0.4780139], d, 19.5),
        ([0.25, 0.75], [0.5, 0.5], [-0.1524828, 0.1033291, 1.8423957], d, 19.5),
        ([0.9, 0.4], [0.5, 0.5], [2.3406148, 1.5142241, 0.8253111], d, 19.5),
    ]);
}

#[test]
fn rays_of_a_thin_lens_meet_in_focus() {
    let sensor = Sensor::compile(&thin_lens(0.3, 4.0), &FILM).unwrap();
    let pinhole = Sensor::compile(&perspective([0.0; 2]), &FILM).unwrap();
    let position = Vec2::new(7.3, 21.9);
    let centre = pinhole.sample_ray(position, Vec2::ZERO).ray;
    let axis = sensor.direction();
    let in_focus = |ray: Ray| ray.at((4.0 - (ray.origin - sensor.position()).dot(axis)) / ray.direction.dot(axis));
    for u in [[0.0, 0.0], [0.9, 0.2], [0.3, 0.999]] {
        let ray = sensor.sample_ray(position, Vec2::from(u)).ray;
        assert!(in_focus(ray).abs_diff_eq(in_focus(centre), 1e-5));
    }
}

#[test]
fn projection_inverts_the_rays() {
    let scaled = Transform::scale([2.0, 3.0, 4.0]).then(&to_world());
    let sheared =
        Transform::from_rows([[1.0, 0.0, 0.3, 0.0], [0.2, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
    let cameras = [
        perspective([0.1, -0.2]),
        thin_lens(0.3, 4.0),
        desc(SensorKind::Orthographic, to_world()),
        desc(SensorKind::Orthographic, scaled),
        desc(SensorKind::Orthographic, sheared.then(&to_world())),
    ];
    for desc in cameras {
        let sensor = Sensor::compile(&desc, &FILM).unwrap();
        for (position, u) in [([3.0, 28.0], [0.1, 0.7]), ([39.0, 1.5], [0.9, 0.9]), ([20.0, 15.0], [0.5, 0.2])] {
            let (position, u) = (Vec2::from(position), Vec2::from(u));
            let CameraRay { ray, t_max } = sensor.sample_ray(position, u);
            let x = ray.at(6.0);
            let found = sensor.project(x, u).unwrap();
            assert!(found.film_position.abs_diff_eq(position, 1e-3), "{desc:?}: {found:?}, expected {position}");
            assert!(found.ray.ray.origin.abs_diff_eq(ray.origin, 1e-5), "{desc:?}: {found:?}");
            assert!(found.ray.ray.direction.abs_diff_eq(ray.direction, 1e-5), "{desc:?}: {found:?}");
            assert!((found.distance - 6.0).abs() < 1e-4 && (found.ray.t_max - t_max).abs() < 1e-4);
            assert!(sensor.project(ray.at(-0.01), u).is_none() && sensor.project(ray.at(t_max * 1.001), u).is_none());

            // The area on the film of a small square at right angles to the ray, by central differences.
            let frame = crate::math::Frame::from_normal(ray.direction);
            let at = |offset: Vec3| sensor.project(x + offset, u).unwrap().film_position;
            let h = 0.05;
            let side = |axis: Vec3| (at(h * axis) - at(-h * axis)) / (2.0 * h);
            let area = side(frame.s).perp_dot(side(frame.t)).abs();
            assert!((found.pixels_per_area / area - 1.0).abs() < 2e-3, "{desc:?}: {found:?}, expected {area}");
        }
    }
}

#[test]
fn wrong_parameters_are_errors() {
    let error = |desc: SensorDesc| Sensor::compile(&desc, &FILM).unwrap_err();
    let view = |fov_x| desc(SensorKind::Perspective { fov_x, principal_point: [0.0; 2] }, to_world());
    for fov in [0.0, -3.0, 180.0, f32::NAN] {
        assert!(matches!(error(view(fov)), SensorError::FieldOfView(_)));
    }
    for (near, far) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (1.0, f32::INFINITY), (f32::NAN, 1.0)] {
        let desc = SensorDesc { near_clip: near, far_clip: far, ..view(50.0) };
        assert!(matches!(error(desc), SensorError::Clip { .. }));
    }
    for scale in [[2.0, 2.0, 2.0], [1.0, 1.0, 1.001]] {
        let to_world = Transform::scale(scale).then(&to_world());
        assert_eq!(error(SensorDesc { to_world, ..view(50.0) }), SensorError::Scaled);
    }
    let flat = Transform::scale([1.0, 1.0, 0.0]);
    assert_eq!(error(SensorDesc { to_world: flat, ..view(50.0) }), SensorError::Transform);
    assert_eq!(error(thin_lens(0.0, 4.0)), SensorError::Aperture(0.0));
    assert_eq!(error(thin_lens(0.3, -4.0)), SensorError::Focus(-4.0));
    assert!(matches!(error(perspective([f32::NAN, 0.0])), SensorError::PrincipalPoint(_)));
    let empty = FilmDesc { height: 0, ..FILM };
    assert_eq!(Sensor::compile(&view(50.0), &empty).unwrap_err(), SensorError::Film { width: 40, height: 0 });
}
