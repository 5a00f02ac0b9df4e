//! Emitting shapes: where they are, which way they face, and points on them chosen for a receiver.

use crate::math::{PerSolidAngle, Vec2, Vec3};
use crate::scene::shape::{AreaPoint, Form, Geometry};
use std::f32::consts::PI;

/// Added to the half angle of a mesh's cone of normals, radians: covers rounding.
const SLACK: f32 = 1e-3;

/// Axis and half angle (radians) of a cone around the geometric normals of a shape.
pub fn normals(form: &Form) -> (Vec3, f32) {
    const ALL: (Vec3, f32) = (Vec3::Z, PI);
    match form {
        Form::Mesh(mesh) => {
            let doubled = |triangle| {
                let [a, b, c] = mesh.corners(triangle);
                (b - a).cross(c - a)
            };
            let all = || (0..mesh.triangles.len()).map(doubled);
            let Some(axis) = all().sum::<Vec3>().try_normalize() else { return ALL };
            // The angle by atan2, which stands slivers of any size.
            let theta = all().map(|n| axis.cross(n).length().atan2(axis.dot(n))).fold(0.0, f32::max);
            (axis, (theta + SLACK).min(PI))
        }
        Form::Disk(disk) => (disk.normal.as_vec3(), 0.0),
        Form::Sphere(_) | Form::Cylinder(_) | Form::Instance(_) => ALL,
    }
}

/// A point on an emitting shape chosen for a receiver at `from`, with the density of its direction: by solid angle on
/// spheres that emit outwards, seen from outside; else by area. `None` where the point is seen edge-on.
#[inline]
pub fn sample_from(geometry: &Geometry, shape: u32, from: Vec3, u: Vec2) -> Option<(AreaPoint, PerSolidAngle)> {
    if emits_outwards(geometry, shape)
        && let Some(sample) = geometry.sample_sphere_solid_angle(shape, from, u)
    {
        return Some((sample.point, sample.pdf));
    }
    let (point, _) = geometry.sample_area(shape, u)?;
    let pdf = by_area(geometry, shape, from, point.position, point.normal);
    (pdf.0 > 0.0).then_some((point, pdf))
}

/// Density with which [`sample_from`] returns the point `position` of a shape, where the normal is `normal`.
#[inline]
pub fn pdf_from(geometry: &Geometry, shape: u32, from: Vec3, position: Vec3, normal: Vec3) -> PerSolidAngle {
    if emits_outwards(geometry, shape)
        && let Some(pdf) = geometry.sphere_solid_angle_pdf(shape, from)
    {
        return pdf;
    }
    by_area(geometry, shape, from, position, normal)
}

#[inline]
fn by_area(geometry: &Geometry, shape: u32, from: Vec3, position: Vec3, normal: Vec3) -> PerSolidAngle {
    let offset = position - from;
    let distance = offset.length();
    geometry.area_pdf(shape).to_solid_angle(distance, offset.dot(normal) / distance)
}

#[inline]
fn emits_outwards(geometry: &Geometry, shape: u32) -> bool {
    matches!(geometry.form(shape), Form::Sphere(sphere) if sphere.side > 0.0)
}
