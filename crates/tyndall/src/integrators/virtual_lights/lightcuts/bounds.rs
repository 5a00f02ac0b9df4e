//! How much a cluster of lights can send to a cluster of points.

use super::clusters::{Node, SURFACE};
use crate::math::Vec3;
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::medium::Extinction;
use crate::scene::phase::Phase;

/// What bounds know of the scene.
#[derive(Debug)]
pub(super) struct Bounds<'a> {
    /// Phase functions by the number of the medium.
    pub(super) phases: Vec<&'a Phase>,
    /// Bound of 1/d^2, 1/m^2; infinite for none.
    pub(super) clamp: f32,
    /// What extinction is everywhere at least, 1/m.
    pub(super) extinction: f32,
}

/// Distances below that share of the clusters' coordinates are those of rounding.
const ROUNDING: f32 = 2e-6;

/// Rounding of cosines.
const ROUNDED: f32 = 1e-6;

impl<'a> Bounds<'a> {
    /// In a scene, with a bound on 1/d^2 (1/m^2; 0 is none).
    pub(super) fn new(scene: &'a Scene, clamp: f32) -> Self {
        let phases = scene.media().iter().map(|medium| medium.phase()).collect();
        let extinction = scene.everywhere().map_or(0.0, |everywhere| least_extinction(scene, everywhere));
        Self { phases, clamp: if clamp > 0.0 { clamp } else { f32::INFINITY }, extinction }
    }

    /// Upper bound, in every channel, of what all the members of `lights` together give by way of all of `points`.
    #[inline]
    pub(super) fn of(&self, lights: &Node, points: &Node) -> f32 {
        // The box of the ways from lights to points.
        let (lo, hi) = (points.bounds.min - lights.bounds.max, points.bounds.max - lights.bounds.min);
        let near = lo.max(-hi).max(Vec3::ZERO).length();
        let (centre, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
        let ways = Ways {
            centre,
            half,
            near,
            far: lo.abs().max(hi.abs()).length(),
            rounding: ROUNDING * (points.bounds.max.abs() + lights.bounds.max.abs()).max_element(),
            middle: centre.length(),
            radius: half.length(),
        };
        let shapes = self.shape(lights, &ways, 1.0) * self.shape(points, &ways, -1.0);
        let spread = (1.0 / (near * near)).min(self.clamp).min(1e30);
        let transmittance = if self.extinction > 0.0 { (-self.extinction * near).exp() } else { 1.0 };
        lights.weight * points.weight * shapes * (spread * transmittance)
    }

    /// Bound of `peak shape` over the directions of `ways`, turned round if `sign` is -1.
    #[inline]
    fn shape(&self, node: &Node, ways: &Ways, sign: f32) -> f32 {
        if node.class == SURFACE {
            return node.peak * ways.cosine(sign * node.axis, node).max(node.floor);
        }
        let phase = self.phases[node.class as usize - 1];
        let cosines = if let Phase::Isotropic = phase { [-1.0, 1.0] } else { ways.cosines(sign * node.axis, node) };
        node.peak * phase.ceiling(cosines)
    }
}

/// The box of all ways from one cluster to the other.
struct Ways {
    centre: Vec3,
    half: Vec3,
    /// Lengths of the shortest and the longest, metres.
    near: f32,
    far: f32,
    /// Lengths that are no more than rounding, metres.
    rounding: f32,
    /// Length of the centre.
    middle: f32,
    /// Radius of the sphere around the box, metres.
    radius: f32,
}

impl Ways {
    /// Sine and cosine of the greatest angle between any way and the centre's; `None` where they go everywhere.
    #[inline(always)]
    fn spread(&self) -> Option<(f32, f32)> {
        (self.radius < self.middle).then(|| {
            let sin = self.radius / self.middle;
            (sin, (1.0 - sin * sin).max(0.0).sqrt())
        })
    }

    /// Upper bound of the cosine between ways and the cone about `axis` of the node's angle; zero when none is positive.
    #[inline]
    fn cosine(&self, axis: Vec3, node: &Node) -> f32 {
        // How far ways lead along an axis of the cone, at most: that of its own axis, turned.
        let height = axis.dot(self.centre) + axis.abs().dot(self.half);
        let along = if node.cos > 0.0 { node.cos * height + node.sin * self.far } else { self.far };
        if along <= self.rounding {
            return 0.0;
        }
        (along / self.near.max(1e-30) + ROUNDED).min(self.cosines(axis, node)[1]).max(0.0)
    }

    /// Bounds of the cosine between ways and the cone about `axis`.
    #[inline]
    fn cosines(&self, axis: Vec3, node: &Node) -> [f32; 2] {
        let Some((sin_ways, cos_ways)) = self.spread() else { return [-1.0, 1.0] };
        // Half angle of the cone and that of the ways, together at most pi.
        let (sin, cos) = (node.sin * cos_ways + node.cos * sin_ways, node.cos * cos_ways - node.sin * sin_ways);
        if sin <= 0.0 && cos < 1.0 {
            return [-1.0, 1.0];
        }
        let cos_axis = (axis.dot(self.centre) / self.middle).clamp(-1.0, 1.0);
        let sin_axis = (1.0 - cos_axis * cos_axis).sqrt();
        let product = cos_axis * cos;
        let rest = sin_axis * sin;
        // Angles beyond 0 and pi stay there.
        let most = if cos_axis >= cos { 1.0 } else { product + rest };
        let least = if cos_axis <= -cos { -1.0 } else { product - rest };
        [least - ROUNDED, most + ROUNDED]
    }
}

/// What the extinction of that medium is at least, 1/m.
fn least_extinction(scene: &Scene, medium: MediumId) -> f32 {
    let medium = scene.medium(medium);
    match medium.kind() {
        Extinction::Homogeneous(model) if !medium.phase().is_anisotropic_medium() => model.sigma_t().min_channel(),
        _ => 0.0,
    }
}
