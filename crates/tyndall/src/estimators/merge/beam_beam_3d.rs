//! **Meets.** A camera's ray and a photon beam that pass each other at less than the beam's radius: all pairs of points, one
//! on each, less than the radius apart.
//!
//! **Formula.** `L = 1/N sum sigma_s f Phi INT INT Tr(t) A(s) K3(|x(t) - y(s)|) ds dt`, `Phi` the flux at the beam's start, `A`
//! its attenuation.
//!
//! **Measure and Jacobian.** Volume, integrated along both; none.
//!
//! **Residual.** 2: `t`, uniform where a partner exists, then `s`, uniform on the chord of the ball around `x(t)`.
//!
//! **Extent.** Both whole, each with its attenuation; a piece takes the part of the chord that lies on it.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian.
//!
//! **Reference.** Jarosz et al. 2011, table 1.

use super::{BeamProbe, Meet, Merge, chord, closest, cut, lines_touch};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::Lanes;
use crate::photons::{BeamBlock, Beams, Store};

/// Beam query, photon beams, blur over a ball.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam3D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for BeamBeam3D {
    type Probe = BeamProbe;
    type Store = Beams;
    const BLUR: u32 = 3;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &BeamBlock) -> u32 {
        lines_touch::<L>(probe, block)
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Beams, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let beam = block.ray(lane);
        let near = closest(&probe.ray, &beam)?;
        let radius = store.radius_at(leaf, lane, near.s, near.across());
        let rest = radius * radius - near.distance2;
        let (t0, t1) = cut(near.t, rest, near.sin2.sqrt(), 0.0, probe.length)?;
        let t = t0 + (t1 - t0) * rng.f32();
        let offset = probe.ray.at(t) - beam.origin;
        let (s0, s1) = chord(offset, beam.direction, radius, block.s0.0[lane], block.s1.0[lane])?;
        let s = s0 + (s1 - s0) * rng.f32();
        let squared = (offset - s * beam.direction).length_squared() / (radius * radius);
        let weight = self.kernel.value::<3>(squared, radius) * (t1 - t0) * (s1 - s0);
        (weight > 0.0).then_some(Meet { t, s: [s, 0.0], weight })
    }
}
