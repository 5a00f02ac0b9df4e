//! What light's walk carried where it left a beam, for weights of multiple importance sampling. Kept apart from all that
//! queries test.

use crate::math::{Ray, Vec3};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::emitter::{EndDensity, LightEnd};
use crate::walk::{Account, Arrival, Edge, Effort, FromLight, Leg};

/// The leg that left a beam.
#[derive(Clone, Copy, Debug)]
pub struct BeamTerms {
    leg: Leg,
    /// The way up to the stretch of the medium in which the beam lies.
    edge: Edge,
    /// That stretch.
    ray: Ray,
    /// The emitter, on the first leg.
    emitter: Option<(LightEnd, EndDensity)>,
}

impl BeamTerms {
    /// Of the leg on which the walk is, about to pass a stretch of a medium along `ray`.
    #[inline]
    pub fn new(account: &Account<FromLight>, ray: &Ray) -> Self {
        Self { leg: account.leg, edge: account.edge, ray: *ray, emitter: account.emitter().copied() }
    }

    /// What the walk would carry if it collided at `x` on the beam. Distances count from the last vertex, not from the
    /// start of the beam.
    #[inline]
    pub fn arrive(&self, scene: &Scene, effort: &Effort, medium: MediumId, x: Vec3) -> Arrival {
        let leg = match &self.emitter {
            Some((end, density)) => self.leg.lit(effort, density, scene.lights.sampled_density(x, end)),
            None => self.leg,
        };
        let mut edge = self.edge;
        edge.pass(scene.medium(medium), &self.ray, self.ray.origin.distance(x));
        leg.arrive::<FromLight>(&edge, leg.spread(x), 1.0, true)
    }
}
