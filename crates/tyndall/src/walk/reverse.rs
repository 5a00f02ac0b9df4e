//! A vertex as the walk from the other end would see it.

use super::{Corner, Effort, Merges, Mode, Scattering, Vertex};
use crate::math::{PerSolidAngle, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::Transport;

/// Density with which a walk from the other end, coming against `direction` to `vertex`, would go back the way this one
/// came.
#[inline]
pub fn reverse_pdf<M: Mode>(scene: &Scene, vertex: &Vertex, direction: Vec3) -> PerSolidAngle {
    match &vertex.scattering {
        Scattering::Medium { medium } => {
            PerSolidAngle(scene.medium(*medium).phase().eval(vertex.position, -direction, -vertex.direction))
        }
        Scattering::Surface { point, .. } => {
            let transport = match M::TRANSPORT {
                Transport::Radiance => Transport::Importance,
                Transport::Importance => Transport::Radiance,
            };
            let (wo, wi) = (point.shading.to_local(direction), point.shading.to_local(-vertex.direction));
            let context = scene.surface_context(point);
            scene.bsdfs.eval(scene.bsdf_of(point.shape), &context, wo, wi, transport).1
        }
    }
}

/// What weights of multiple importance sampling ask of a vertex.
#[inline]
pub fn corner(scene: &Scene, effort: &Effort, vertex: &Vertex) -> Corner {
    let x = vertex.position;
    let (normal, merges) = match &vertex.scattering {
        Scattering::Medium { medium } => (Vec3::ZERO, effort.in_medium(scene.medium(*medium), x)),
        Scattering::Surface { point, .. } if scene.is_diffuse(point.shape) => {
            let merges = effort.on_surface(x);
            let mirror = scene.is_glossy(point.shape);
            (point.normal, if mirror { effort.on_mirror(merges) } else { merges })
        }
        Scattering::Surface { point, .. } if scene.is_smooth(point.shape) => {
            (point.normal, effort.on_mirror(Merges::NONE))
        }
        Scattering::Surface { point, .. } => (point.normal, Merges::NONE),
    };
    Corner { position: x, arriving: vertex.direction, normal, merges }
}
