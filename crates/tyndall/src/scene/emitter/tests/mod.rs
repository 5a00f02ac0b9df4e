//! Tests of the emitters.

mod density;
mod emission;
mod emission_medium;
mod error;
mod irradiance;
mod oracle;
mod segment;
mod selection;
mod shape;

use super::{EmitterSample, Lights};
use crate::math::{Ray, Transform, Vec2, Vec3};
use crate::scene::desc::{AreaEmitterDesc, EmitterDesc, EmitterKind, Filter, ImageDesc, Rgb, TextureDesc, Wrap};
use crate::scene::shape::Geometry;
use shape::{Form, geometry, hits, surface};
use std::sync::Arc;
use tyndall_testkit::random::Random;

/// Probability that any one group of statistical tests fails by chance.
const SIGNIFICANCE: f64 = 0.01;

fn emitter(kind: EmitterKind, to_world: Transform) -> EmitterDesc {
    EmitterDesc { name: "lamp".into(), kind, to_world, sampling_weight: 1.0, medium: None }
}

fn point(position: [f64; 3], intensity: f32) -> EmitterDesc {
    emitter(EmitterKind::Point { intensity: [intensity; 3] }, Transform::translate(position))
}

/// A picture of a formula with period 17 in its values.
fn picture(width: usize, height: usize) -> Arc<ImageDesc> {
    let value = |i: usize, j: usize, c: usize| ((7 * i + 11 * j + 5 * c) % 17) as f32 / 16.0;
    let pixels = (0..width * height).map(|p| [0, 1, 2].map(|c| value(p % width, p / width, c))).collect();
    Arc::new(ImageDesc { width, height, pixels })
}

fn bitmap(image: Arc<ImageDesc>) -> TextureDesc {
    TextureDesc::Bitmap { image, filter: Filter::Linear, wrap: Wrap::Clamp, to_uv: Transform::IDENTITY }
}

fn rotation() -> Transform {
    Transform::rotate([1.0, 2.0, 3.0], 50.0).unwrap().then(&Transform::translate([3.0, 4.0, 5.0]))
}

fn look_at() -> Transform {
    Transform::look_at([1.0, 2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0]).unwrap()
}

/// Emitters and emitting shapes with constant radiance.
fn lights(emitters: &[EmitterDesc], shapes: &[(Form, Rgb)]) -> Lights {
    let descs: Vec<_> = shapes.iter().map(|(_, radiance)| area(TextureDesc::Constant(*radiance))).collect();
    let areas = (0..).zip(&descs).map(|(shape, desc)| ("shape", shape, desc));
    let forms: Vec<_> = shapes.iter().map(|(form, _)| *form).collect();
    Lights::new(emitters, areas, geometry(&forms)).unwrap()
}

fn area(radiance: TextureDesc) -> AreaEmitterDesc {
    AreaEmitterDesc { radiance, sampling_weight: 1.0 }
}

fn sample(lights: &Lights, x: Vec3, random: &mut Random) -> Option<EmitterSample> {
    lights.sample(x, random.f32(), Vec2::from_array(random.f32x2()))
}

/// Density with which `lights` finds the direction `d` from `x`, through all shapes in the way.
fn pdf(lights: &Lights, shapes: &Geometry, x: Vec3, d: Vec3) -> f64 {
    let ray = Ray { origin: x, direction: d };
    let found: f64 = hits(shapes, ray).map(|hit| f64::from(lights.pdf_hit(x, &hit).0)).sum();
    found + f64::from(lights.pdf_escape(d).0)
}
