//! THE gathering: all data of a store that an estimator lets a query meet.

use super::merge::Merge;
use super::query::Query;
use crate::Spectrum;
use crate::accel::Visit;
use crate::math::Rng;
use crate::math::lanes::{Kernel, Lanes, Level};
use crate::photons::Store;

/// What a gathering found.
#[derive(Clone, Copy, Debug)]
pub struct Gathered {
    /// Radiance times the number of light paths, W/(m^2 sr).
    pub radiance: Spectrum,
    /// How many data contributed.
    pub count: u32,
}

/// Sum over all data of response times flux times the estimator's weight. Divide it by the number of light paths.
///
/// An estimator whose dimensions leave deltas over does not compile. This one does:
///
/// ```
/// # use tyndall::{estimators::{Meet, Merge, PointQuery, gather, merge::PointProbe}, math::{Rng, lanes::Lanes}};
/// # use tyndall::photons::{PointBlock, Points};
/// struct Blur;
///
/// impl Merge for Blur {
///     type Probe = PointProbe;
///     type Store = Points;
///     const BLUR: u32 = 3;
/// #   fn touches<L: Lanes>(&self, _: &PointProbe, _: &PointBlock) -> u32 { 0 }
/// #   fn meet(&self, _: &PointProbe, _: &Points, _: u32, _: usize, _: &mut Rng) -> Option<Meet> { None }
///     // ...
/// }
///
/// let query: fn(&PointQuery, &Points, &mut Rng) = |query, store, rng| _ = gather(&Blur, query, store, rng);
/// # std::hint::black_box(query);
/// ```
///
/// A blur of two dimensions is too little between a point and a point:
///
/// ```compile_fail
/// # use tyndall::{estimators::{Meet, Merge, PointQuery, gather, merge::PointProbe}, math::{Rng, lanes::Lanes}};
/// # use tyndall::photons::{PointBlock, Points};
/// # struct Blur;
/// # impl Merge for Blur {
/// #   type Probe = PointProbe;
/// #   type Store = Points;
///     const BLUR: u32 = 2;
/// #   fn touches<L: Lanes>(&self, _: &PointProbe, _: &PointBlock) -> u32 { 0 }
/// #   fn meet(&self, _: &PointProbe, _: &Points, _: u32, _: usize, _: &mut Rng) -> Option<Meet> { None }
/// # }
/// # let query: fn(&PointQuery, &Points, &mut Rng) = |query, store, rng| _ = gather(&Blur, query, store, rng);
/// # std::hint::black_box(query);
/// ```
#[inline]
pub fn gather<M, Q>(merge: &M, query: &Q, store: &M::Store, rng: &mut Rng) -> Gathered
where
    M: Merge,
    Q: Query<Probe = M::Probe>,
{
    // The residual integrals must not be negative in number: deltas would be left over.
    const { assert!(Q::DIMENSION + <M::Store as Store>::DIMENSION + M::BLUR >= Q::SPACE) }
    let mut visitor = Visitor { merge, query, store, rng, found: Gathered { radiance: Spectrum::ZERO, count: 0 } };
    Level::dispatch(Traversal { visitor: &mut visitor });
    visitor.found
}

struct Visitor<'a, M: Merge, Q> {
    merge: &'a M,
    query: &'a Q,
    store: &'a M::Store,
    rng: &'a mut Rng,
    found: Gathered,
}

struct Traversal<'a, 'b, M: Merge, Q> {
    visitor: &'a mut Visitor<'b, M, Q>,
}

impl<M: Merge, Q: Query<Probe = M::Probe>> Kernel for Traversal<'_, '_, M, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let query = self.visitor.query;
        query.traverse::<L>(self.visitor.store.bvh(), self.visitor);
    }
}

impl<M: Merge, Q: Query<Probe = M::Probe>> Visit for Visitor<'_, M, Q> {
    const ANNOUNCES: bool = true;

    #[inline(always)]
    fn announce(&self, leaf: u32) {
        self.store.announce(leaf);
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32 {
        let mut lanes = self.merge.touches::<L>(self.query.probe(), self.store.block(leaf));
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & 7;
            lanes &= lanes - 1;
            self.take(leaf, lane);
        }
        t_max
    }
}

impl<M: Merge, Q: Query<Probe = M::Probe>> Visitor<'_, M, Q> {
    /// One datum through the physics.
    #[inline(always)]
    fn take(&mut self, leaf: u32, lane: usize) {
        let tag = self.store.tag(leaf, lane);
        if !self.query.accepts(tag) {
            return;
        }
        let Some(meet) = self.merge.meet(self.query.probe(), self.store, leaf, lane, self.rng) else { return };
        let x = self.query.position(meet.t);
        let light = self.store.arriving(leaf, lane, meet.s, x, self.query.medium());
        let weight = self.query.weigh(self.store.index(leaf, lane), &meet, x, light.direction);
        let mut seen = self.query.respond(meet.t, light.direction) * light.flux * (meet.weight * weight);
        if M::SHADOWED && !seen.is_black() {
            let bend = x - meet.s[1] * light.direction;
            seen *= self.query.look_through(bend, light.direction, meet.s[1], self.rng);
        }
        self.query.met(tag, seen, weight);
        self.found.radiance += seen;
        self.found.count += 1;
    }
}
