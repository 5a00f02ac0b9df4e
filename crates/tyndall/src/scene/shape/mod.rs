//! Shapes: what a ray can hit, and what is known of the point it hits.

mod compile;
mod curvature;
pub mod error;
pub mod geometry;
pub mod mesh;
pub mod quadric;
pub mod sample;
pub mod surface;
mod tree;

pub use error::{GeometryError, Problem};
pub use geometry::{Geometry, Hit, Shadow};
pub use mesh::Mesh;
pub use sample::{AreaPoint, SphereSample};
pub use surface::SurfacePoint;

use crate::math::Aabb;
use glam::{DAffine3, DVec3};
use quadric::{Cylinder, Disk, Sphere};

/// The form of a compiled shape, in world space (or in the space of its shape group).
#[derive(Debug)]
pub enum Form {
    /// A triangle mesh; also rectangles and cubes.
    Mesh(Mesh),
    /// A sphere.
    Sphere(Sphere),
    /// A disk or ellipse.
    Disk(Disk),
    /// An open tube.
    Cylinder(Cylinder),
    /// A placed shape group.
    Instance(Instance),
}

impl Form {
    /// The box around it; empty for instances.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => Aabb::from_points(mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize])),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disk(disk) => disk.bounds(),
            Self::Cylinder(cylinder) => cylinder.bounds(),
            Self::Instance(_) => Aabb::EMPTY,
        }
    }
}

/// A placed shape group.
#[derive(Debug)]
pub struct Instance {
    /// Which group.
    pub group: u32,
    to_world: DAffine3,
    to_local: DAffine3,
    /// Turns the normals of everything in it round.
    flip: bool,
}

impl Instance {
    /// The ray in the group's space. Distances along it stay as they are: the direction is not normalised.
    #[inline(always)]
    fn local_ray(&self, ray: &crate::math::Ray) -> crate::math::Ray {
        crate::math::Ray {
            origin: self.to_local.transform_point3(ray.origin.as_dvec3()).as_vec3(),
            direction: self.to_local.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
        }
    }

    /// Turns a normal of the group's space into a unit normal of the world.
    fn normal(&self, n: DVec3) -> DVec3 {
        let n = (self.to_local.matrix3.transpose() * n).normalize_or_zero();
        if self.flip { -n } else { n }
    }
}

#[cfg(test)]
mod tests;
