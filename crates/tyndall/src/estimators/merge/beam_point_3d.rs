//! **Meets.** A camera's ray and the ball around a photon point that it crosses.
//!
//! **Formula.** `L = 1/N sum f Phi INT Tr(t) K3(|x(t) - x_p|) dt`, `Phi` the flux that leaves the collision.
//!
//! **Measure and Jacobian.** Volume, integrated along the ray; none.
//!
//! **Residual.** 1: `t`, uniform on the chord.
//!
//! **Extent.** The whole ray, with its transmittance.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian.
//!
//! **Reference.** Jarosz et al. 2011, table 1.

use super::{BeamProbe, Meet, Merge, chord, feet, load, minus, splat};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{PointBlock, Points, Store};

/// Beam query, photon points, blur over a ball.
#[derive(Clone, Copy, Debug)]
pub struct BeamPoint3D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for BeamPoint3D {
    type Probe = BeamProbe;
    type Store = Points;
    const BLUR: u32 = 3;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &PointBlock) -> u32 {
        let direction = splat::<L>(probe.ray.direction);
        let offset = minus(load::<L>(&block.position), splat(probe.ray.origin));
        let radius = L::load(&block.radius);
        let (t, near) = feet(offset, direction, radius);
        // The ball reaches beyond its centre by less than its radius.
        near.and(L::splat(0.0).lt(t.add(radius))).and(t.sub(radius).lt(L::splat(probe.length))).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Points, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let offset = block.position(lane) - probe.ray.origin;
        let radius = block.radius.0[lane];
        let (low, high) = chord(offset, probe.ray.direction, radius, 0.0, probe.length)?;
        let t = low + (high - low) * rng.f32();
        let squared = (offset - t * probe.ray.direction).length_squared() / (radius * radius);
        Some(Meet { t, s: [0.0; 2], weight: self.kernel.value::<3>(squared, radius) * (high - low) })
    }
}
