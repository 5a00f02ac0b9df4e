//! **Meets.** A point of the camera's ray and the part of a photon beam in the ball around the point.
//!
//! **Formula.** `sigma_s L_s = 1/N sum sigma_s f Phi INT A(s) K3(|x - y(s)|) ds`, `Phi` the flux at the beam's start, `A` its
//! attenuation.
//!
//! **Measure and Jacobian.** Volume, integrated along the beam; none.
//!
//! **Residual.** 1: `s`, uniform on the chord. The integral along the ray is the query's.
//!
//! **Extent.** Of the beam; a piece takes the part of the chord that lies on it.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian.
//!
//! **Reference.** Jarosz et al. 2011, table 1.

use super::{Meet, Merge, PointProbe, chord, feet, load, minus, splat};
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::math::{Rng, Vec3};
use crate::photons::{BeamBlock, Beams, Store};

/// Point query, photon beams, blur over a ball.
#[derive(Clone, Copy, Debug)]
pub struct PointBeam3D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for PointBeam3D {
    type Probe = PointProbe;
    type Store = Beams;
    const BLUR: u32 = 3;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &PointProbe, block: &BeamBlock) -> u32 {
        let direction = load::<L>(&block.direction);
        let offset = minus(splat::<L>(probe.position), load(&block.origin));
        let radius = L::load(&block.radius);
        let (s, near) = feet(offset, direction, radius);
        near.and(L::load(&block.s0).lt(s.add(radius))).and(s.sub(radius).lt(L::load(&block.s1))).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &PointProbe, store: &Beams, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let beam = block.ray(lane);
        let offset = probe.position - beam.origin;
        let foot = offset.dot(beam.direction);
        let across = (offset - foot * beam.direction).try_normalize().unwrap_or(Vec3::ZERO);
        let radius = store.radius_at(leaf, lane, foot, across);
        let (low, high) = chord(offset, beam.direction, radius, block.s0.0[lane], block.s1.0[lane])?;
        let s = low + (high - low) * rng.f32();
        let squared = (offset - s * beam.direction).length_squared() / (radius * radius);
        Some(Meet { t: 0.0, s: [s, 0.0], weight: self.kernel.value::<3>(squared, radius) * (high - low) })
    }
}
