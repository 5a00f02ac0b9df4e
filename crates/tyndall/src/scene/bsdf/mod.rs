//! Scattering at surfaces: the models of Mitsuba 3, compiled for sampling and evaluation.
//!
//! Directions are unit, in the shading frame (z the shading normal), and point away from the surface: `wo` to where
//! the walk came from, `wi` to where it goes. Values are `f |cos(wi)|`, in 1/sr. `f` is that of [`Transport`]: for
//! radiance refraction carries `(eta_o / eta_i)^2`, for importance it does not; the correction for shading normals is
//! the walk's business. Straight-through parts are `null` events, never part of `eval`.

mod adapters;
mod compile;
mod conductor;
mod dielectric;
mod diffuse;
mod erf;
pub mod fresnel;
mod interaction;
mod microfacet;
mod perturbed;
mod plastic;
mod principled;
mod principled_thin;
mod quadrature;
mod rough_dielectric;

#[cfg(test)]
mod tests;

pub use adapters::{Blend, Mask, TwoSided};
pub use compile::BsdfError;
pub use conductor::{Conductor, Metal, RoughConductor};
pub use dielectric::{Dielectric, ThinDielectric};
pub use diffuse::Diffuse;
pub use interaction::{BsdfSample, Ceiling, Event, SurfaceContext, Traits, Transport};
pub use perturbed::{Perturbed, Relief};
pub use plastic::{Plastic, RoughPlastic};
pub use principled::Principled;
pub use principled_thin::PrincipledThin;
pub use rough_dielectric::RoughDielectric;

use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3};
use crate::scene::desc::BsdfId;

/// No light, never sampled.
const NOTHING: (Spectrum, PerSolidAngle) = (Spectrum::ZERO, PerSolidAngle(0.0));

/// A compiled model; models within models are entries of the same [`Bsdfs`].
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "each variant is documented at its type")]
pub enum Bsdf {
    Diffuse(Diffuse),
    Dielectric(Dielectric),
    ThinDielectric(ThinDielectric),
    RoughDielectric(RoughDielectric),
    Conductor(Conductor),
    RoughConductor(RoughConductor),
    Plastic(Plastic),
    RoughPlastic(RoughPlastic),
    Principled(Box<Principled>),
    PrincipledThin(Box<PrincipledThin>),
    /// An index-matched boundary.
    Null,
    Mask(Mask),
    TwoSided(TwoSided),
    Blend(Blend),
    Perturbed(Perturbed),
}

/// All models of a scene, by [`BsdfId`].
#[derive(Clone, Debug, Default)]
pub struct Bsdfs {
    models: Vec<Bsdf>,
    traits: Vec<Traits>,
}

impl Bsdfs {
    /// Samples a direction from two random inputs in [0, 1), `u1` for the choice of the lobe. `None`: absorbed.
    ///
    /// What walks meet most is done here, without a call.
    #[inline(always)]
    pub fn sample(
        &self,
        id: BsdfId,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let point = &ctx.texture;
        let (id, sign) = match &self.models[id.0] {
            Bsdf::TwoSided(model) => model.side(wo),
            _ => (id, 1.0),
        };
        let wo = Vec3::new(wo.x, wo.y, wo.z * sign);
        let mut sample = match &self.models[id.0] {
            Bsdf::Diffuse(model) => model.sample(point, wo, u2),
            Bsdf::Dielectric(model) => model.sample(point, wo, transport, u1),
            _ => self.sample_any(id, ctx, wo, transport, u1, u2),
        }?;
        sample.wi.z *= sign;
        Some(sample)
    }

    /// Where a smooth interface both reflects and refracts, the probability of reflection: below it the choice of the lobe in
    /// [`Self::sample`] reflects, from it on it refracts.
    #[inline]
    pub fn forks(&self, id: BsdfId, wo: Vec3) -> Option<f32> {
        let Bsdf::Dielectric(model) = &self.models[id.0] else { return None };
        Some(model.reflectance(wo)).filter(|reflectance| 0.0 < *reflectance && *reflectance < 1.0)
    }

    /// As [`Self::sample`], for all models.
    #[inline(never)]
    fn sample_any(
        &self,
        id: BsdfId,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let point = &ctx.texture;
        match &self.models[id.0] {
            Bsdf::Diffuse(model) => model.sample(point, wo, u2),
            Bsdf::Dielectric(model) => model.sample(point, wo, transport, u1),
            Bsdf::ThinDielectric(model) => Some(model.sample(point, wo, u1)),
            Bsdf::RoughDielectric(model) => model.sample(point, wo, transport, u1, u2),
            Bsdf::Conductor(model) => model.sample(point, wo),
            Bsdf::RoughConductor(model) => model.sample(point, wo, u2),
            Bsdf::Plastic(model) => model.sample(point, wo, u1, u2),
            Bsdf::RoughPlastic(model) => model.sample(point, wo, u1, u2),
            Bsdf::Principled(model) => model.sample(point, wo, transport, u1, u2),
            Bsdf::PrincipledThin(model) => model.sample(point, wo, u1, u2),
            Bsdf::Null => Some(BsdfSample::delta(-wo, Spectrum::ONE, Event::NULL)),
            Bsdf::Mask(model) => model.sample(self, ctx, wo, transport, u1, u2),
            Bsdf::TwoSided(model) => model.sample(self, ctx, wo, transport, u1, u2),
            Bsdf::Blend(model) => model.sample(self, ctx, wo, transport, u1, u2),
            Bsdf::Perturbed(model) => model.sample(self, ctx, wo, transport, u1, u2),
        }
    }

    /// `f |cos(wi)|` of everything but delta and null parts, and the density with which [`Self::sample`] finds `wi`.
    #[inline]
    pub fn eval(
        &self,
        id: BsdfId,
        ctx: &SurfaceContext,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let point = &ctx.texture;
        match &self.models[id.0] {
            Bsdf::Diffuse(model) => model.eval(point, wo, wi),
            Bsdf::RoughDielectric(model) => model.eval(point, wo, wi, transport),
            Bsdf::RoughConductor(model) => model.eval(point, wo, wi),
            Bsdf::Plastic(model) => model.eval(point, wo, wi),
            Bsdf::RoughPlastic(model) => model.eval(point, wo, wi),
            Bsdf::Principled(model) => model.eval(point, wo, wi, transport),
            Bsdf::PrincipledThin(model) => model.eval(point, wo, wi),
            Bsdf::Mask(model) => model.eval(self, ctx, wo, wi, transport),
            Bsdf::TwoSided(model) => model.eval(self, ctx, wo, wi, transport),
            Bsdf::Blend(model) => model.eval(self, ctx, wo, wi, transport),
            Bsdf::Perturbed(model) => model.eval(self, ctx, wo, wi, transport),
            Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) | Bsdf::Conductor(_) | Bsdf::Null => NOTHING,
        }
    }

    /// A bound of what [`Self::eval`] answers for `wo` and any `wi`, in either transport; `None` where the model knows none.
    /// Models that know one only reflect, and are reciprocal.
    pub fn ceiling(&self, id: BsdfId, ctx: &SurfaceContext, wo: Vec3) -> Option<Ceiling> {
        let point = &ctx.texture;
        match &self.models[id.0] {
            Bsdf::Diffuse(model) => Some(model.ceiling(point, wo)),
            Bsdf::RoughConductor(model) => Some(model.ceiling(point, wo)),
            Bsdf::Plastic(model) => Some(model.ceiling(point, wo)),
            Bsdf::RoughPlastic(model) => Some(model.ceiling(point, wo)),
            Bsdf::Mask(model) => model.ceiling(self, ctx, wo),
            Bsdf::TwoSided(model) => model.ceiling(self, ctx, wo),
            Bsdf::Blend(model) => model.ceiling(self, ctx, wo),
            Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) | Bsdf::Conductor(_) | Bsdf::Null => Some(Ceiling::NOTHING),
            Bsdf::RoughDielectric(_) | Bsdf::Principled(_) | Bsdf::PrincipledThin(_) | Bsdf::Perturbed(_) => None,
        }
    }

    /// Share of the light that passes straight through the null part, for shadow rays.
    #[inline]
    pub fn null_transmission(&self, id: BsdfId, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        match &self.models[id.0] {
            Bsdf::Null => Spectrum::ONE,
            Bsdf::ThinDielectric(model) => model.null_transmission(&ctx.texture, wo),
            Bsdf::Mask(model) => model.null_transmission(self, ctx, wo),
            Bsdf::TwoSided(model) => model.null_transmission(self, ctx, wo),
            Bsdf::Blend(model) => model.null_transmission(self, ctx, wo),
            Bsdf::Perturbed(model) => model.null_transmission(self, ctx, wo),
            _ => Spectrum::ZERO,
        }
    }

    /// What is known of the model without a point.
    #[inline(always)]
    pub fn traits(&self, id: BsdfId) -> Traits {
        self.traits[id.0]
    }

    /// The number of models.
    pub fn len(&self) -> usize {
        self.models.len()
    }

    /// Whether there is no model.
    pub fn is_empty(&self) -> bool {
        self.models.is_empty()
    }
}
