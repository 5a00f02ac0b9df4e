//! **Meets.** A camera's ray and a photon beam that pass each other at less than the beam's radius: the part of the ray in
//! the cylinder around the beam, or the part of the beam in the cylinder around the ray.
//!
//! **Formula.** About the beam: `L = 1/N sum sigma_s f Phi INT Tr(t) A(s(t)) K2(|x(t) - y(s(t))|) dt`, `s(t)` the foot of
//! `x(t)` on the beam. About the query: `... INT Tr(t(s)) A(s) K2(|y(s) - x(t(s))|) ds`.
//!
//! **Measure and Jacobian.** Area at right angles to the beam, or to the ray; none.
//!
//! **Residual.** 1: `t`, or `s`, uniform on the chord.
//!
//! **Extent.** Both whole, each with its attenuation; a piece of a beam takes the part of the chord whose feet lie on it.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian across the beam, or across the ray.
//!
//! **Reference.** Jarosz et al. 2011, table 1.

use super::{BeamProbe, Closest, Meet, Merge, closest, cut, lines_touch};
use crate::math::kernels::Kernel;
use crate::math::lanes::Lanes;
use crate::math::{Ray, Rng};
use crate::photons::{BeamBlock, Beams, Store};

/// Beam query, photon beams, blur over a disc across the photon beam.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam2DAboutBeam {
    /// Shape of the blur.
    pub kernel: Kernel,
}

/// Beam query, photon beams, blur over a disc across the ray.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam2DAboutQuery {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for BeamBeam2DAboutBeam {
    type Probe = BeamProbe;
    type Store = Beams;
    const BLUR: u32 = 2;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &BeamBlock) -> u32 {
        lines_touch::<L>(probe, block)
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Beams, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let (query, beam) = (Stretch::of_probe(probe), Stretch::of_piece(block, lane));
        let near = closest(&query.ray, &beam.ray)?;
        let radius = store.radius_at(leaf, lane, near.s, near.across());
        let (t, s, weight) = about(&query, near.t, &beam, near.s, &near, radius, self.kernel, rng)?;
        Some(Meet { t, s: [s, 0.0], weight })
    }
}

impl Merge for BeamBeam2DAboutQuery {
    type Probe = BeamProbe;
    type Store = Beams;
    const BLUR: u32 = 2;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &BeamBlock) -> u32 {
        lines_touch::<L>(probe, block)
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Beams, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let (query, beam) = (Stretch::of_probe(probe), Stretch::of_piece(block, lane));
        let near = closest(&query.ray, &beam.ray)?;
        let radius = store.radius_at(leaf, lane, near.s, near.across());
        let (s, t, weight) = about(&beam, near.s, &query, near.t, &near, radius, self.kernel, rng)?;
        Some(Meet { t, s: [s, 0.0], weight })
    }
}

/// A stretch of a line.
struct Stretch {
    ray: Ray,
    from: f32,
    until: f32,
}

impl Stretch {
    #[inline(always)]
    fn of_probe(probe: &BeamProbe) -> Self {
        Self { ray: probe.ray, from: 0.0, until: probe.length }
    }

    #[inline(always)]
    fn of_piece(block: &BeamBlock, lane: usize) -> Self {
        Self { ray: block.ray(lane), from: block.s0.0[lane], until: block.s1.0[lane] }
    }
}

/// A point of `line` in the cylinder around `axis`, its foot on the axis, and the kernel times the length of the chord;
/// `line_near` and `axis_near` are the distances along the two where they are `near` each other. A foot outside the axis'
/// stretch weighs nothing: that needs no division by the cosine, which may be zero.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "two lines and where they are closest")]
fn about(
    line: &Stretch,
    line_near: f32,
    axis: &Stretch,
    axis_near: f32,
    near: &Closest,
    radius: f32,
    kernel: Kernel,
    rng: &mut Rng,
) -> Option<(f32, f32, f32)> {
    let rest = radius * radius - near.distance2;
    let (low, high) = cut(line_near, rest, near.sin2.sqrt(), line.from, line.until)?;
    let p = low + (high - low) * rng.f32();
    let along = p - line_near;
    let foot = axis_near + line.ray.direction.dot(axis.ray.direction) * along;
    if !(axis.from <= foot && foot < axis.until) {
        return None;
    }
    let squared = (near.distance2 + along * along * near.sin2) / (radius * radius);
    let weight = kernel.value::<2>(squared, radius) * (high - low);
    (weight > 0.0).then_some((p, foot, weight))
}
