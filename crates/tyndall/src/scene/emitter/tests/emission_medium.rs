//! Light starts in the medium around its emitter.

use super::*;
use crate::scene::desc::{
    BsdfDesc, BsdfId, GeometryDesc, MediumDesc, MediumId, MediumKind, PhaseDesc, SceneDesc, ShapeDesc, VolumeDesc,
};
use crate::scene::{BuildError, Scene};

const FOG: Option<MediumId> = Some(MediumId(0));
const SMOKE: Option<MediumId> = Some(MediumId(1));

/// The cube [-1, 1]^3 of fog; smoke is nowhere.
fn fog_bank() -> SceneDesc {
    let medium = |name: &str| MediumDesc {
        name: name.into(),
        kind: MediumKind::Homogeneous,
        sigma_t: VolumeDesc::constant([1.0; 3]),
        albedo: VolumeDesc::constant([0.5; 3]),
        scale: 1.0,
        phase: PhaseDesc::Isotropic,
        sample_emitters: true,
    };
    let mut desc = SceneDesc { media: vec![medium("fog"), medium("smoke")], ..SceneDesc::default() };
    (desc.film.width, desc.film.height) = (4, 4);
    desc.bsdfs.push(BsdfDesc::Null);
    let mut bounds = ShapeDesc::new("bounds", GeometryDesc::Cube);
    (bounds.bsdf, bounds.interior) = (Some(BsdfId(0)), FOG);
    desc.shapes.push(bounds);
    desc
}

fn lamp(x: f64, y: f64) -> ShapeDesc {
    let mut lamp = ShapeDesc::new("lamp", GeometryDesc::Disk);
    lamp.to_world = Transform::scale([0.1; 3]).then(&Transform::translate([x, y, 0.0]));
    lamp.emission = Some(area(TextureDesc::grey(1.0)));
    lamp
}

/// By emitter, the medium in which its light starts.
fn media(desc: &SceneDesc) -> Vec<Option<MediumId>> {
    let scene = Scene::build(desc).unwrap();
    let mut random = Random::new(41);
    let mut media = vec![None; scene.lights.emitters().len()];
    for _ in 0..10_000 {
        let u_position = Vec2::from_array(random.f32x2());
        let emission = scene.sample_emission(random.f32(), u_position, Vec2::from_array(random.f32x2()));
        if let Some(e) = emission {
            let found = media[e.emitter.0 as usize].replace(e.medium);
            assert!(found.is_none_or(|found| found == e.medium));
        }
    }
    media.into_iter().map(|medium| medium.expect("every emitter is chosen")).collect()
}

#[test]
fn found_by_position() {
    let mut desc = fog_bank();
    let spot = EmitterKind::Spot { intensity: [1.0; 3], cutoff_angle: 60.0, beam_width: 20.0, texture: None };
    desc.emitters = vec![
        point([0.5, 0.5, 0.5], 1.0),
        point([3.0, 0.0, 0.0], 1.0),
        emitter(spot, Transform::IDENTITY),
        emitter(EmitterKind::Constant { radiance: [0.02; 3] }, Transform::IDENTITY),
        EmitterDesc { medium: SMOKE, ..point([0.2, 0.0, 0.0], 1.0) },
    ];
    // Lamps inside and outside the fog, and one just below a face of the cube, which it does not reach.
    let mut lid = lamp(0.0, 0.0);
    lid.to_world = Transform::translate([0.0, 0.0, 0.999]);
    // A lamp that is itself a boundary: light leaves on the side of its exterior.
    let mut boundary = lamp(5.0, 0.0);
    (boundary.interior, boundary.exterior) = (FOG, SMOKE);
    desc.shapes.extend([lamp(0.4, -0.3), lamp(4.0, 1.0), lid, boundary]);
    for shape in &mut desc.shapes[1..3] {
        shape.emission = Some(area(TextureDesc::grey(40.0)));
    }
    desc.shapes[4].emission = Some(area(TextureDesc::grey(40.0)));
    assert_eq!(media(&desc), [FOG, None, FOG, None, SMOKE, FOG, None, FOG, SMOKE]);
}

#[test]
fn flush_with_a_face() {
    // The lamp lies in a face of the cube and shines into the fog, or away from it.
    let mut desc = fog_bank();
    let mut ceiling = lamp(0.0, 0.0);
    ceiling.flip_normals = true;
    ceiling.to_world = Transform::translate([0.0, 0.0, 1.0]);
    let mut roof = lamp(0.0, 0.0);
    roof.to_world = Transform::translate([0.0, 0.0, 1.0]);
    desc.shapes.extend([ceiling, roof]);
    assert_eq!(media(&desc), [FOG, None]);
}

#[test]
fn no_media() {
    let mut desc = fog_bank();
    desc.media.clear();
    desc.shapes[0].interior = None;
    desc.emitters = vec![point([0.5, 0.5, 0.5], 1.0)];
    assert_eq!(media(&desc), [None]);
}

#[test]
fn unknown_medium() {
    let mut desc = fog_bank();
    desc.emitters = vec![EmitterDesc { medium: Some(MediumId(7)), ..point([0.0; 3], 1.0) }];
    let error = Scene::build(&desc).unwrap_err();
    assert!(matches!(error, BuildError::Dangling { index: 7, count: 2, .. }), "{error}");
}
