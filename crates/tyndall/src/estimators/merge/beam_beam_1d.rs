//! **Meets.** A camera's ray and a photon beam whose lines pass each other at less than the beam's radius, where they are
//! closest.
//!
//! **Formula.** `L = 1/N sum sigma_s f Phi Tr(t) A(s) K1(u) / sin`, `u` the distance between the lines, `sin` of the angle
//! between them, `Phi` the flux at the beam's start, `A` its attenuation.
//!
//! **Measure and Jacobian.** Length along the common normal; `1 / sin` from the area that `dt ds` spans.
//!
//! **Residual.** 0.
//!
//! **Extent.** Both whole, each with its attenuation.
//!
//! **Bias.** `m r^2 / 2` times the second derivative along the common normal. Parallel lines (sine below 1e-6) are lost.
//!
//! **Reference.** Jarosz et al. 2011, eq. 38 and table 1.

use super::{Approach, BeamProbe, Closest, Meet, Merge, approach, closest};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{BeamBlock, Beams, Store};

/// Beam query, photon beams, blur along the common normal.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam1D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for BeamBeam1D {
    type Probe = BeamProbe;
    type Store = Beams;
    const BLUR: u32 = 1;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &BeamBlock) -> u32 {
        let Approach { t, s, sin2, rest, slack } = approach::<L>(probe, block);
        let near = L::splat(0.0).lt(rest);
        let on_ray = L::splat(0.0).le(t).and(t.lt(L::splat(probe.length).mul(sin2)));
        let from = L::load(&block.s0).mul(sin2).sub(slack);
        let until = L::load(&block.s1).mul(sin2).add(slack);
        let on_beam = from.le(s).and(s.le(until));
        near.and(on_ray).and(on_beam).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Beams, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let Closest { t, s, distance2, sin2, normal } = closest(&probe.ray, &block.ray(lane))?;
        let inside = 0.0 <= t && t < probe.length && block.s0.0[lane] <= s && s < block.s1.0[lane];
        if !inside {
            return None;
        }
        let sin = sin2.sqrt();
        let radius = store.radius_at(leaf, lane, s, normal / sin);
        let weight = self.kernel.value::<1>(distance2 / (radius * radius), radius) / sin;
        (weight > 0.0).then_some(Meet { t, s: [s, 0.0], weight })
    }
}
