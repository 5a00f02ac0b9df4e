//! Queries whose answers are weighed.

use crate::Spectrum;
use crate::accel::{Bvh, Visit};
use crate::estimators::{Meet, Query};
use crate::math::Vec3;
use crate::math::lanes::Lanes;
use crate::photons::Tag;
use crate::scene::Scene;
use crate::scene::desc::MediumId;

/// The weights of data that a query meets.
pub trait Weigher {
    /// See [`Query::weigh`].
    fn weigh(&self, datum: u32, meet: &Meet, x: Vec3, direction: Vec3) -> f32;
    /// See [`Query::met`].
    fn met(&self, tag: Tag, seen: Spectrum, weight: f32);
}

/// A query and the weight of each datum it meets.
pub struct Weighed<Q, W> {
    /// The query.
    pub query: Q,
    /// The weights.
    pub weigher: W,
}

impl<Q: Query, W: Weigher> Query for Weighed<Q, W> {
    const DIMENSION: u32 = Q::DIMENSION;
    const SPACE: u32 = Q::SPACE;
    type Probe = Q::Probe;

    #[inline(always)]
    fn probe(&self) -> &Q::Probe {
        self.query.probe()
    }

    #[inline(always)]
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit) {
        self.query.traverse::<L>(bvh, visit);
    }

    #[inline(always)]
    fn accepts(&self, tag: Tag) -> bool {
        self.query.accepts(tag)
    }

    #[inline(always)]
    fn position(&self, t: f32) -> Vec3 {
        self.query.position(t)
    }

    #[inline(always)]
    fn place(&self) -> (&Scene, Option<MediumId>) {
        self.query.place()
    }

    #[inline(always)]
    fn respond(&self, t: f32, direction: Vec3) -> Spectrum {
        self.query.respond(t, direction)
    }

    #[inline(always)]
    fn weigh(&self, datum: u32, meet: &Meet, x: Vec3, direction: Vec3) -> f32 {
        self.weigher.weigh(datum, meet, x, direction)
    }

    #[inline(always)]
    fn met(&self, tag: Tag, seen: Spectrum, weight: f32) {
        self.weigher.met(tag, seen, weight);
    }
}
