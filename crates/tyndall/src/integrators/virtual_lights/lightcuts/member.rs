//! What clusters know of a vertex.

use super::clusters::{Member, SURFACE};
use crate::Spectrum;
use crate::math::Vec3;
use crate::scene::Scene;
use crate::scene::bsdf::{Ceiling, Transport};
use crate::scene::desc::MediumId;
use crate::scene::phase::Phase;
use crate::scene::shape::SurfacePoint;
use crate::walk::{Scattering, Vertex};
use std::f32::consts::{FRAC_1_PI, PI};

/// What BSDFs that know no bound are granted above their values in a few directions.
const MARGIN: f32 = 2.0;

/// Normals nearer to each other are one.
const SAME: f32 = 1e-5;

/// A vertex of light's walk; `None` if it scatters nothing.
pub(super) fn light(scene: &Scene, vertex: &Vertex, index: u32) -> Option<Member> {
    let (point, member) = match &vertex.scattering {
        Scattering::Medium { medium } => return in_medium(scene, vertex, *medium, index),
        Scattering::Surface { point, .. } => (point, bare(vertex, index)),
    };
    let from = point.shading.to_local(-vertex.direction);
    let cos = vertex.direction.dot(point.normal).abs();
    if cos == 0.0 {
        return None;
    }
    // Light turns by the BSDF with its arguments exchanged, and by the geometric cosines.
    let bend = point.shading.n.cross(point.normal).length();
    let bend = if bend < SAME { 0.0 } else { bend };
    // The shading normal lies on the side of the geometric one.
    let axis = point.normal * 1.0_f32.copysign(from.z);
    let member = match ceiling(scene, point, from) {
        Ceiling { value, cosine: true, .. } => Member {
            weight: strength(vertex.throughput * value) * (from.z.abs() / cos),
            // Beyond the horizon of one normal the other may see a little.
            floor: bend,
            axis,
            ..member
        },
        Ceiling { value, .. } => Member { peak: PI * value.max_channel(), floor: 1.0, axis, ..member },
    };
    (member.weight > 0.0 && member.peak > 0.0).then_some(member)
}

/// A vertex of the camera's walk; `None` if it scatters nothing.
pub(super) fn point(scene: &Scene, vertex: &Vertex, index: u32) -> Option<Member> {
    let (point, member) = match &vertex.scattering {
        Scattering::Medium { medium } => return in_medium(scene, vertex, *medium, index),
        Scattering::Surface { point, .. } => (point, bare(vertex, index)),
    };
    let to = point.shading.to_local(-vertex.direction);
    let axis = point.shading.n * 1.0_f32.copysign(to.z);
    let member = match ceiling(scene, point, to) {
        Ceiling { value, cosine: true, .. } => Member { weight: strength(vertex.throughput * value), axis, ..member },
        Ceiling { value, .. } => Member { peak: PI * value.max_channel(), floor: 1.0, axis, ..member },
    };
    (member.weight > 0.0 && member.peak > 0.0).then_some(member)
}

/// A vertex on a surface that scatters like white paper.
fn bare(vertex: &Vertex, index: u32) -> Member {
    Member {
        position: vertex.position,
        axis: Vec3::Z,
        weight: FRAC_1_PI * strength(vertex.throughput),
        peak: 1.0,
        floor: 0.0,
        class: SURFACE,
        index,
    }
}

fn in_medium(scene: &Scene, vertex: &Vertex, medium: MediumId, index: u32) -> Option<Member> {
    // Where the direction of arrival does not matter, it should not part clusters.
    let isotropic = matches!(scene.medium(medium).phase(), Phase::Isotropic);
    let member = Member {
        position: vertex.position,
        axis: if isotropic { Vec3::Z } else { vertex.direction },
        weight: strength(vertex.throughput),
        peak: 1.0,
        floor: 1.0,
        class: SURFACE + 1 + medium.0 as u32,
        index,
    };
    (member.weight > 0.0).then_some(member)
}

/// The largest channel; filters may turn the sign.
fn strength(throughput: Spectrum) -> f32 {
    throughput.max_channel().max(-throughput.min_channel())
}

/// A bound of what the surface scatters between the local `direction` and any other. Where the model knows none, a guess:
/// what it scatters along its mirror image, the normals, and straight on, with a margin. A wrong one costs noise, nothing
/// else.
fn ceiling(scene: &Scene, point: &SurfacePoint, direction: Vec3) -> Ceiling {
    let (bsdf, context) = (scene.bsdf_of(point.shape), scene.surface_context(point));
    scene.bsdfs.ceiling(bsdf, &context, direction).unwrap_or_else(|| {
        let mirror = Vec3::new(-direction.x, -direction.y, direction.z);
        let guess = [mirror, Vec3::Z, -Vec3::Z, -direction]
            .map(|to| scene.bsdfs.eval(bsdf, &context, direction, to, Transport::Radiance).0.max_channel())
            .into_iter()
            .fold(FRAC_1_PI, f32::max);
        Ceiling { value: Spectrum::grey(MARGIN * guess), cosine: false, exact: false }
    })
}
