//! Metals, smooth and rough.

use super::microfacet::Roughness;
use super::{BsdfSample, Ceiling, Event, fresnel};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3};
use crate::scene::texture::{Texture, TexturePoint};

/// Refractive index and tint of a metal.
#[derive(Clone, Debug)]
pub struct Metal {
    pub(super) eta: Texture,
    pub(super) k: Texture,
    pub(super) specular_reflectance: Texture,
}

impl Metal {
    #[inline(always)]
    fn reflectance(&self, point: &TexturePoint, cos: f32) -> Spectrum {
        fresnel::conductor(cos, self.eta.eval(point), self.k.eval(point)) * self.specular_reflectance.eval(point)
    }

    /// Whether the metal depends on the point.
    pub(super) fn varies(&self) -> bool {
        self.eta.varies() || self.k.varies() || self.specular_reflectance.varies()
    }
}

/// Smooth metal.
#[derive(Clone, Debug)]
pub struct Conductor {
    pub(super) metal: Metal,
}

impl Conductor {
    #[inline(always)]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3) -> Option<BsdfSample> {
        (wo.z > 0.0).then(|| {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            BsdfSample::delta(wi, self.metal.reflectance(point, wo.z), Event::DELTA_REFLECTION)
        })
    }
}

/// Rough metal (Cook and Torrance 1982 with Smith's masking).
#[derive(Clone, Debug)]
pub struct RoughConductor {
    pub(super) metal: Metal,
    pub(super) roughness: Roughness,
}

impl RoughConductor {
    #[inline]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        if !(wo.z > 0.0) {
            return None;
        }
        let distribution = self.roughness.at(point);
        let m = distribution.sample(wo, u);
        let cos = wo.dot(m);
        let wi = fresnel::reflect(wo, m);
        if !(cos > 0.0 && wi.z > 0.0) {
            return None;
        }
        let normal_pdf = distribution.normal_pdf(wo, m);
        let masking = if self.roughness.sample_visible() {
            distribution.masking(wi, m)
        } else {
            distribution.masking(wo, m) * distribution.masking(wi, m) * cos / (wo.z * m.z)
        };
        let pdf = normal_pdf / (4.0 * cos);
        let weight = self.metal.reflectance(point, cos) * masking;
        (pdf > 0.0 && pdf.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf: PerSolidAngle(pdf),
            event: Event::REFLECTION,
        })
    }

    #[inline]
    pub(super) fn ceiling(&self, point: &TexturePoint, wo: Vec3) -> Ceiling {
        if !(wo.z > 0.0) {
            return Ceiling::NOTHING;
        }
        let distribution = self.roughness.at(point);
        let facets = distribution.peak() * distribution.masking(wo, wo) / (4.0 * wo.z);
        Ceiling { value: self.metal.specular_reflectance.eval(point) * facets, cosine: false, exact: false }
    }

    #[inline]
    pub(super) fn eval(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return super::NOTHING;
        }
        let Some(m) = (wo + wi).try_normalize() else {
            return super::NOTHING;
        };
        let distribution = self.roughness.at(point);
        let cos = wo.dot(m);
        let pdf = distribution.normal_pdf(wo, m) / (4.0 * cos);
        let facets = distribution.density(m) * distribution.masking(wo, m) * distribution.masking(wi, m);
        let value = facets / (4.0 * wo.z);
        if !(value.is_finite() && pdf.is_finite()) {
            return super::NOTHING;
        }
        (self.metal.reflectance(point, cos) * value, PerSolidAngle(pdf))
    }
}
