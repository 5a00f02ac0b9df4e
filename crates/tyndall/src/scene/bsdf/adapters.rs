//! Models made of other models: masks, two-sided surfaces and blends.

use super::{BsdfSample, Bsdfs, Ceiling, Event, SurfaceContext, Transport};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3};
use crate::scene::desc::BsdfId;
use crate::scene::texture::{Texture, TexturePoint};

/// A surface that is there with probability `opacity`.
#[derive(Clone, Debug)]
pub struct Mask {
    pub(super) opacity: Texture,
    pub(super) nested: BsdfId,
}

impl Mask {
    #[inline(always)]
    fn opacity(&self, point: &TexturePoint) -> f32 {
        self.opacity.eval_grey(point).clamp(0.0, 1.0)
    }

    #[inline]
    pub(super) fn sample(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let opacity = self.opacity(&ctx.texture);
        if u1 < opacity {
            let sample = bsdfs.sample(self.nested, ctx, wo, transport, u1 / opacity, u2)?;
            return Some(BsdfSample { pdf: sample.pdf * opacity, ..sample });
        }
        Some(BsdfSample::delta(-wo, Spectrum::ONE, Event::NULL))
    }

    #[inline]
    pub(super) fn eval(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let opacity = self.opacity(&ctx.texture);
        let (value, pdf) = bsdfs.eval(self.nested, ctx, wo, wi, transport);
        (value * opacity, pdf * opacity)
    }

    pub(super) fn ceiling(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Option<Ceiling> {
        let nested = bsdfs.ceiling(self.nested, ctx, wo)?;
        Some(Ceiling { value: nested.value * self.opacity(&ctx.texture), ..nested })
    }

    #[inline]
    pub(super) fn null_transmission(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        let opacity = self.opacity(&ctx.texture);
        Spectrum::ONE.lerp(bsdfs.null_transmission(self.nested, ctx, wo), opacity)
    }
}

/// One model on the side of the normal, one on the other, each seeing its side as the front.
#[derive(Clone, Debug)]
pub struct TwoSided {
    pub(super) front: BsdfId,
    pub(super) back: BsdfId,
}

impl TwoSided {
    /// The model for light on the side of `wo`, and the factor of z that brings that side to the front.
    #[inline(always)]
    pub(super) fn side(&self, wo: Vec3) -> (BsdfId, f32) {
        if wo.z < 0.0 { (self.back, -1.0) } else { (self.front, 1.0) }
    }

    #[inline]
    pub(super) fn sample(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let (model, sign) = self.side(wo);
        let mut sample = bsdfs.sample(model, ctx, Vec3::new(wo.x, wo.y, wo.z * sign), transport, u1, u2)?;
        sample.wi.z *= sign;
        Some(sample)
    }

    #[inline]
    pub(super) fn eval(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let (model, sign) = self.side(wo);
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, w.z * sign));
        bsdfs.eval(model, ctx, wo, wi, transport)
    }

    pub(super) fn ceiling(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Option<Ceiling> {
        let (model, sign) = self.side(wo);
        bsdfs.ceiling(model, ctx, Vec3::new(wo.x, wo.y, wo.z * sign))
    }

    #[inline]
    pub(super) fn null_transmission(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        let (model, sign) = self.side(wo);
        bsdfs.null_transmission(model, ctx, Vec3::new(wo.x, wo.y, wo.z * sign))
    }
}

/// `(1 - weight) * first + weight * second`.
#[derive(Clone, Debug)]
pub struct Blend {
    pub(super) weight: Texture,
    pub(super) first: BsdfId,
    pub(super) second: BsdfId,
}

impl Blend {
    #[inline(always)]
    fn weight(&self, point: &TexturePoint) -> f32 {
        self.weight.eval_grey(point).clamp(0.0, 1.0)
    }

    #[inline]
    pub(super) fn sample(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let weight = self.weight(&ctx.texture);
        let (model, u1) =
            if u1 < weight { (self.second, u1 / weight) } else { (self.first, (u1 - weight) / (1.0 - weight)) };
        let sample = bsdfs.sample(model, ctx, wo, transport, u1, u2)?;
        if sample.event.delta {
            return Some(sample);
        }
        let evaluated = self.eval(bsdfs, ctx, wo, sample.wi, transport);
        BsdfSample::evaluated(sample.wi, evaluated, sample.event)
    }

    #[inline]
    pub(super) fn eval(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let weight = self.weight(&ctx.texture);
        let (first, first_pdf) = bsdfs.eval(self.first, ctx, wo, wi, transport);
        let (second, second_pdf) = bsdfs.eval(self.second, ctx, wo, wi, transport);
        (first.lerp(second, weight), first_pdf * (1.0 - weight) + second_pdf * weight)
    }

    pub(super) fn ceiling(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Option<Ceiling> {
        let (first, second) = (bsdfs.ceiling(self.first, ctx, wo)?, bsdfs.ceiling(self.second, ctx, wo)?);
        let value = first.value.lerp(second.value, self.weight(&ctx.texture));
        let (cosine, exact) = (first.cosine && second.cosine, first.exact && second.exact);
        Some(Ceiling { value, cosine, exact })
    }

    #[inline]
    pub(super) fn null_transmission(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        let first = bsdfs.null_transmission(self.first, ctx, wo);
        first.lerp(bsdfs.null_transmission(self.second, ctx, wo), self.weight(&ctx.texture))
    }
}
