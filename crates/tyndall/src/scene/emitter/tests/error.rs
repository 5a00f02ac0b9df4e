//! What cannot be built says why.

use super::*;
use crate::scene::emitter::EmitterError;

fn failure(desc: EmitterDesc) -> String {
    let built: Result<Lights, EmitterError> = Lights::new(&[desc], [], geometry(&[]));
    built.unwrap_err().to_string()
}

fn spot(cutoff_angle: f32, beam_width: f32) -> EmitterDesc {
    let kind = EmitterKind::Spot { intensity: [1.0; 3], cutoff_angle, beam_width, texture: None };
    emitter(kind, Transform::IDENTITY)
}

#[test]
fn numbers_out_of_range() {
    assert_eq!(failure(spot(0.0, 0.0)), "emitter \"lamp\": cutoff_angle is 0, expected in (0, 180]");
    assert_eq!(failure(spot(20.0, 25.0)), "emitter \"lamp\": beam_width is 25, expected in [0, cutoff_angle]");
    assert!(failure(spot(f32::NAN, 1.0)).contains("cutoff_angle is NaN"));
    assert!(failure(EmitterDesc { sampling_weight: -1.0, ..point([0.0; 3], 1.0) }).contains("sampling_weight is -1"));
    let projector =
        EmitterKind::Projector { irradiance: TextureDesc::grey(1.0), scale: 1.0, fov_x: 180.0, aspect: 1.0 };
    assert!(failure(emitter(projector, Transform::IDENTITY)).contains("fov is 180, expected in (0, 180)"));
}

#[test]
fn colours() {
    assert!(failure(point([0.0; 3], -1.0)).contains("intensity is [-1.0, -1.0, -1.0]"));
    assert!(failure(point([0.0; 3], f32::NAN)).contains("intensity is [NaN"));
    let constant = EmitterKind::Constant { radiance: [1.0, f32::INFINITY, 0.0] };
    assert!(failure(emitter(constant, Transform::IDENTITY)).contains("radiance is [1.0, inf, 0.0]"));
    let shapes = geometry(&[Form::Sphere(Vec3::ZERO, 1.0)]);
    let negative = area(TextureDesc::Constant([1.0, -1.0, 1.0]));
    let error = Lights::new(&[], [("globe", 0, &negative)], shapes).unwrap_err();
    assert_eq!(
        error.to_string(),
        "emitter \"globe\": radiance is [1.0, -1.0, 1.0], expected finite channels, none negative"
    );
}

#[test]
fn pictures() {
    let envmap = |image| emitter(EmitterKind::Envmap { image: Arc::new(image), scale: 1.0 }, Transform::IDENTITY);
    assert!(failure(envmap(ImageDesc::default())).contains("0 pixels, expected 0 x 0, at least one"));
    let short = ImageDesc { width: 2, height: 2, pixels: vec![[1.0; 3]; 3] };
    assert!(failure(envmap(short)).contains("3 pixels, expected 2 x 2"));
    let negative = ImageDesc { width: 1, height: 1, pixels: vec![[0.0, -1.0, 0.0]] };
    assert!(failure(envmap(negative)).contains("a pixel is [0.0, -1.0, 0.0]"));
}

#[test]
fn degenerate_directions() {
    let flat = Transform::scale([1.0, 1.0, 0.0]);
    assert!(failure(emitter(EmitterKind::Directional { irradiance: [1.0; 3] }, flat)).contains("to_world"));
    assert!(failure(EmitterDesc { to_world: flat, ..spot(20.0, 10.0) }).contains("keeps angles"));
    let stretched = Transform::scale([1.0, 2.0, 1.0]);
    assert!(failure(EmitterDesc { to_world: stretched, ..spot(20.0, 10.0) }).contains("keeps angles"));
}

#[test]
fn nothing_to_sample() {
    let dark = lights(&[point([0.0; 3], 0.0)], &[]);
    assert!(dark.sample(Vec3::ONE, 0.5, Vec2::ZERO).is_none());
    let empty = lights(&[], &[]);
    assert!(empty.sample(Vec3::ONE, 0.5, Vec2::ZERO).is_none());
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X };
    assert!(empty.sample_for_segment(&ray, 1.0, 0.5, Vec2::ZERO).is_none());
    assert!(empty.radiance_escape(Vec3::X).is_black());
}
