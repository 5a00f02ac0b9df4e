//! The physics of scattering at a vertex, written once.

use crate::Spectrum;
use crate::math::{PerSolidAngle, Ray, Rng, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::Transport;
use crate::scene::desc::MediumId;
use crate::scene::emitter::EmitterSample;
use crate::scene::shape::SurfacePoint;
use crate::walk::{Mode, Scattering, Vertex, passage, reverse_pdf};

/// What a vertex does with light that leaves it along a given direction.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Phase function (1/sr), or BSDF times cosine (1/sr). The coefficient `sigma_s` belongs to the flight.
    pub value: Spectrum,
    /// Density with which the walk would choose the direction.
    pub pdf: PerSolidAngle,
}

/// The response of `vertex` to the camera's walk going on along the unit vector `direction`.
#[inline]
pub fn respond(scene: &Scene, vertex: &Vertex, direction: Vec3) -> Response {
    match &vertex.scattering {
        Scattering::Medium { medium } => {
            let value = scene.medium(*medium).phase().eval(vertex.position, vertex.direction, direction);
            Response { value: Spectrum::grey(value), pdf: PerSolidAngle(value) }
        }
        Scattering::Surface { point, .. } => {
            let (wo, wi) = (point.shading.to_local(-vertex.direction), point.shading.to_local(direction));
            let context = scene.surface_context(point);
            let (value, pdf) = scene.bsdfs.eval(scene.bsdf_of(point.shape), &context, wo, wi, Transport::Radiance);
            Response { value, pdf }
        }
    }
}

/// What a vertex does with a walk that goes on along a given direction, and with one that comes the other way.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Phase function (1/sr), or BSDF times cosine (1/sr), of the walk. The coefficient `sigma_s` belongs to the flight.
    pub value: Spectrum,
    /// Density with which the walk would choose the direction.
    pub pdf: PerSolidAngle,
    /// Density with which a walk from the other end, coming along the direction, would go back the way this one came.
    pub reverse: PerSolidAngle,
}

/// The turn of a walk at `vertex` into the unit vector `direction`.
///
/// Light turns by the camera's BSDF with its arguments exchanged. With shading normals light's density on a surface
/// depends on the geometric cosine and its scattering on the shading one (Veach 1997, eq. 5.19), which this takes in.
#[inline]
pub fn turn<M: Mode>(scene: &Scene, vertex: &Vertex, direction: Vec3) -> Turn {
    match (&vertex.scattering, M::TRANSPORT) {
        (Scattering::Medium { medium }, _) => {
            let phase = scene.medium(*medium).phase();
            let value = phase.eval(vertex.position, vertex.direction, direction);
            let reverse = phase.eval(vertex.position, -direction, -vertex.direction);
            Turn { value: Spectrum::grey(value), pdf: PerSolidAngle(value), reverse: PerSolidAngle(reverse) }
        }
        (Scattering::Surface { .. }, Transport::Radiance) => {
            let Response { value, pdf } = respond(scene, vertex, direction);
            Turn { value, pdf, reverse: reverse_pdf::<M>(scene, vertex, direction) }
        }
        (Scattering::Surface { point, .. }, Transport::Importance) => {
            let Response { value, pdf: reverse } = respond_backward(scene, vertex, point, direction);
            let (wo, wi) = (point.shading.to_local(-vertex.direction), point.shading.to_local(direction));
            let context = scene.surface_context(point);
            let (_, pdf) = scene.bsdfs.eval(scene.bsdf_of(point.shape), &context, wo, wi, Transport::Importance);
            Turn { value, pdf, reverse }
        }
    }
}

/// The value of [`turn`] alone.
#[inline]
pub fn turned<M: Mode>(scene: &Scene, vertex: &Vertex, direction: Vec3) -> Spectrum {
    match (&vertex.scattering, M::TRANSPORT) {
        (Scattering::Surface { point, .. }, Transport::Importance) => {
            respond_backward(scene, vertex, point, direction).value
        }
        _ => respond(scene, vertex, direction).value,
    }
}

/// The value of a turn of light's walk at a surface, and the density of the way back.
#[inline]
fn respond_backward(scene: &Scene, vertex: &Vertex, point: &SurfacePoint, direction: Vec3) -> Response {
    let seen = Vertex { direction: -direction, ..*vertex };
    let Response { value, pdf } = respond(scene, &seen, -vertex.direction);
    let cos = vertex.direction.dot(point.normal);
    let value = if cos == 0.0 { Spectrum::ZERO } else { value * (direction.dot(point.normal) / cos).abs() };
    Response { value, pdf }
}

/// Whether the vertex scatters other than by a delta distribution.
#[inline]
pub fn is_smooth(scene: &Scene, vertex: &Vertex) -> bool {
    match &vertex.scattering {
        Scattering::Medium { .. } => true,
        Scattering::Surface { point, .. } => scene.is_smooth(point.shape),
    }
}

/// Where a ray that leaves `vertex` along `direction` starts, and in which medium.
#[inline]
pub fn departure(scene: &Scene, vertex: &Vertex, direction: Vec3) -> (Vec3, Option<MediumId>) {
    match &vertex.scattering {
        Scattering::Medium { medium } => (vertex.position, Some(*medium)),
        Scattering::Surface { point, medium } => {
            (point.leave(direction), scene.medium_towards(point, direction, *medium))
        }
    }
}

/// Whether emitters can be connected to `vertex`.
#[inline]
pub fn samples_emitters(scene: &Scene, vertex: &Vertex) -> bool {
    match &vertex.scattering {
        Scattering::Medium { medium } => scene.medium(*medium).sample_emitters(),
        Scattering::Surface { point, .. } => scene.is_smooth(point.shape),
    }
}

/// Share of the way to a surface on which it does not hide itself, whatever the rounding.
pub const SHORT_OF: f32 = 1.0 - 1e-4;

/// Radiance that arrives at `origin` from the sampled emitter, not divided by any density, and the survival of its passage (see
/// [`Passage`](crate::walk::Passage)); `None` when nothing arrives. Without `media` every surface blocks.
#[inline]
pub fn connect(
    scene: &Scene,
    origin: Vec3,
    light: &EmitterSample,
    medium: Option<MediumId>,
    media: bool,
    rng: &mut Rng,
) -> Option<(Spectrum, f32)> {
    let ray = Ray { origin, direction: light.direction };
    let passage = passage(scene, ray, light.distance * SHORT_OF, medium, media, rng)?;
    Some((light.radiance * passage.transmittance, passage.survival))
}

/// The BSDF (1/sr) at the camera's `vertex` for light that arrives along the unit vector `direction`, whose density on the
/// surface already contains the geometric cosine; zero at vertices in media.
#[inline]
pub fn respond_to_light(scene: &Scene, vertex: &Vertex, direction: Vec3) -> Spectrum {
    let Scattering::Surface { point, .. } = &vertex.scattering else { return Spectrum::ZERO };
    let cos = direction.dot(point.normal).abs();
    // A photon's packed direction may lie in the surface.
    if cos < 1e-6 { Spectrum::ZERO } else { respond(scene, vertex, -direction).value / cos }
}
