//! The passage of light between two points.

use super::Edge;
use super::flight::transmittance;
use crate::Spectrum;
use crate::math::{Ray, Rng};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::medium::Medium;
use crate::scene::shape::Shadow;

/// What is left of light on a straight way that no opaque surface blocks.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Transmittance of all media and index-matched boundaries, exact or an unbiased estimate.
    pub transmittance: Spectrum,
    /// Mean over the channels of the transmittance of the homogeneous media on the way; weights of multiple
    /// importance sampling use it, nothing else.
    pub survival: f32,
}

impl Passage {
    const FREE: Self = Self { transmittance: Spectrum::ONE, survival: 1.0 };
}

/// Light's way from the ray's origin over `length` metres, starting in `medium`; `None` when it is blocked.
///
/// Index-matched boundaries change the medium on the way. Without `media` every surface blocks.
#[inline]
pub fn passage(
    scene: &Scene,
    ray: Ray,
    length: f32,
    medium: Option<MediumId>,
    media: bool,
    rng: &mut Rng,
) -> Option<Passage> {
    if !media {
        return (!scene.geometry.occluded(&ray, length)).then_some(Passage::FREE);
    }
    passage_from(scene, scene.geometry.shadow(&ray, length), ray, length, medium, rng)
}

/// The same, all media present, once the first `shadow` of the way is known.
#[inline]
pub fn passage_from(
    scene: &Scene,
    shadow: Shadow,
    ray: Ray,
    length: f32,
    medium: Option<MediumId>,
    rng: &mut Rng,
) -> Option<Passage> {
    pass(scene, shadow, ray, length, medium, rng, |_, _, _| ())
}

/// The same way, all media present, and how likely flights pass it.
#[inline]
pub fn edge_passage(
    scene: &Scene,
    ray: Ray,
    length: f32,
    medium: Option<MediumId>,
    rng: &mut Rng,
) -> Option<(Spectrum, Edge)> {
    let mut edge = Edge::START;
    let shadow = scene.geometry.shadow(&ray, length);
    let passage = pass(scene, shadow, ray, length, medium, rng, |inside, ray, length| edge.pass(inside, ray, length))?;
    Some((passage.transmittance, edge))
}

/// Follows the way, whose first `shadow` is known, and tells `visit` each stretch inside a medium.
#[inline(always)]
fn pass(
    scene: &Scene,
    mut shadow: Shadow,
    mut ray: Ray,
    mut length: f32,
    mut medium: Option<MediumId>,
    rng: &mut Rng,
    mut visit: impl FnMut(&Medium, &Ray, f32),
) -> Option<Passage> {
    let mut passage = Passage::FREE;
    loop {
        let (step, hit) = match &shadow {
            Shadow::Blocked => return None,
            Shadow::Clear => (length, None),
            Shadow::Transparent(hit) => (hit.t, Some(hit)),
        };
        if let Some(inside) = medium {
            let (transmitted, survival) = transmittance(scene.medium(inside), &ray, step, rng);
            visit(scene.medium(inside), &ray, step);
            passage.transmittance *= transmitted;
            passage.survival *= survival;
        }
        let Some(hit) = hit else { return Some(passage) };
        let point = scene.geometry.surface(&ray, hit);
        passage.transmittance *= scene.null_transmission(&point, ray.direction);
        if passage.transmittance.is_black() {
            return None;
        }
        medium = scene.medium_towards(&point, ray.direction, medium);
        ray.origin = point.leave(ray.direction);
        length -= step;
        shadow = scene.geometry.shadow(&ray, length);
    }
}
