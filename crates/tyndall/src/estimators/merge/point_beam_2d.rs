//! **Meets.** A point of the camera's ray and a photon beam less than its radius away, at the point's foot on the beam.
//!
//! **Formula.** `sigma_s L_s = 1/N sum sigma_s f Phi A(s) K2(|x - y(s)|)`, `s` the foot, `Phi` the flux at the beam's start,
//! `A` its attenuation.
//!
//! **Measure and Jacobian.** Area at right angles to the beam; none.
//!
//! **Residual.** 0. The integral along the ray is the query's.
//!
//! **Extent.** Of the beam, cut flat at its ends.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian across the beam.
//!
//! **Reference.** Jarosz et al. 2011, table 1.

use super::{Meet, Merge, PointProbe, feet, load, minus, splat};
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::math::{Rng, Vec3};
use crate::photons::{BeamBlock, Beams, Store};

/// Point query, photon beams, blur over a disc across the beam.
#[derive(Clone, Copy, Debug)]
pub struct PointBeam2D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for PointBeam2D {
    type Probe = PointProbe;
    type Store = Beams;
    const BLUR: u32 = 2;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &PointProbe, block: &BeamBlock) -> u32 {
        let direction = load::<L>(&block.direction);
        let offset = minus(splat::<L>(probe.position), load(&block.origin));
        let radius = L::load(&block.radius);
        let (s, near) = feet(offset, direction, radius);
        near.and(L::load(&block.s0).le(s)).and(s.lt(L::load(&block.s1))).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &PointProbe, store: &Beams, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let beam = store.block(leaf).ray(lane);
        let offset = probe.position - beam.origin;
        let s = offset.dot(beam.direction);
        let across = offset - s * beam.direction;
        let radius = store.radius_at(leaf, lane, s, across.try_normalize().unwrap_or(Vec3::ZERO));
        let squared = across.length_squared() / (radius * radius);
        let weight = self.kernel.value::<2>(squared, radius);
        (weight > 0.0).then_some(Meet { t: 0.0, s: [s, 0.0], weight })
    }
}
