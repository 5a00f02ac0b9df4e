//! Shapes that emit.

use super::area;
use crate::math::{Frame, Ray, Transform, Vec2, Vec3};
use crate::scene::desc::{GeometryDesc, MeshDesc, ShapeDesc, TextureDesc};
use crate::scene::shape::{Geometry, SurfacePoint};
use std::sync::Arc;

#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Corner and two edges; the normal is their cross product.
    Parallelogram(Vec3, Vec3, Vec3),
    /// The square [-1, 1]^2 at z = 0, facing +z, with texture coordinates.
    Rectangle,
    /// Centre and radius.
    Sphere(Vec3, f32),
    /// Centre and radius; emits inwards.
    Shell(Vec3, f32),
    /// The unit disk at z = 0, facing +z.
    Disk,
    /// The tube of radius 1/2 around the z axis from 0 to 1.
    Tube,
    /// The cube [-1, 1]^3.
    Cube,
}

impl Form {
    fn desc(self) -> ShapeDesc {
        let sphere =
            |c: Vec3, r: f32| GeometryDesc::Sphere { center: c.to_array().map(f64::from), radius: f64::from(r) };
        let form = match self {
            Self::Parallelogram(p, a, b) => GeometryDesc::Mesh(Arc::new(MeshDesc {
                positions: [p, p + a, p + a + b, p + b].map(|v| v.to_array()).into(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                ..MeshDesc::default()
            })),
            Self::Sphere(c, r) | Self::Shell(c, r) => sphere(c, r),
            Self::Rectangle => GeometryDesc::Rectangle,
            Self::Disk => GeometryDesc::Disk,
            Self::Tube => GeometryDesc::Cylinder { p0: [0.0; 3], p1: [0.0, 0.0, 1.0], radius: 0.5 },
            Self::Cube => GeometryDesc::Cube,
        };
        let flip_normals = matches!(self, Self::Shell(..));
        let emission = Some(area(TextureDesc::grey(1.0)));
        ShapeDesc { flip_normals, emission, to_world: Transform::IDENTITY, ..ShapeDesc::new("shape", form) }
    }
}

pub fn geometry(forms: &[Form]) -> Arc<Geometry> {
    let descs: Vec<_> = forms.iter().map(|form| form.desc()).collect();
    Arc::new(Geometry::build(&descs, &[], |_| true).unwrap())
}

/// All points at which `ray` meets a surface.
pub fn hits(geometry: &Geometry, mut ray: Ray) -> impl Iterator<Item = SurfacePoint> {
    std::iter::from_fn(move || {
        let hit = geometry.intersect(&ray, f32::INFINITY)?;
        let point = geometry.surface(&ray, &hit);
        ray.origin = point.leave(ray.direction);
        Some(point)
    })
}

/// A point of a shape without texture coordinates.
pub fn surface(shape: u32, position: Vec3, normal: Vec3) -> SurfacePoint {
    SurfacePoint {
        position,
        normal,
        shading: Frame::from_normal(normal),
        uv: Vec2::ZERO,
        dp_du: Vec3::X,
        dp_dv: Vec3::Y,
        shape,
        triangle: 0,
        barycentrics: Vec2::ZERO,
        epsilon: 1e-5,
    }
}
