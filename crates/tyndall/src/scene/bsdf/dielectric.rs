//! Smooth dielectrics: an interface and a thin sheet.

use super::{BsdfSample, Event, Transport, fresnel};
use crate::Spectrum;
use crate::math::Vec3;
use crate::scene::texture::{Texture, TexturePoint};

/// Smooth interface between two dielectrics.
#[derive(Clone, Debug)]
pub struct Dielectric {
    pub(super) eta: f32,
    pub(super) inverse_eta: f32,
    pub(super) specular_reflectance: Texture,
    pub(super) specular_transmittance: Texture,
}

impl Dielectric {
    /// Probability of reflection.
    #[inline(always)]
    pub(super) fn reflectance(&self, wo: Vec3) -> f32 {
        fresnel::dielectric(wo.z.abs(), if wo.z > 0.0 { self.eta } else { self.inverse_eta }).0
    }

    #[inline(always)]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, transport: Transport, u: f32) -> Option<BsdfSample> {
        let cos = wo.z.abs();
        if !(cos > 0.0) {
            return None;
        }
        let (eta, inverse) = if wo.z > 0.0 { (self.eta, self.inverse_eta) } else { (self.inverse_eta, self.eta) };
        let (reflectance, cos_t) = fresnel::dielectric(cos, eta);
        if u < reflectance {
            let weight = self.specular_reflectance.eval(point);
            return Some(BsdfSample::delta(Vec3::new(-wo.x, -wo.y, wo.z), weight, Event::DELTA_REFLECTION));
        }
        let wi = Vec3::new(-wo.x * inverse, -wo.y * inverse, -cos_t.copysign(wo.z));
        let weight = self.specular_transmittance.eval(point) * transport.refraction_scale(eta);
        Some(BsdfSample::delta(wi, weight, Event::delta_transmission(eta)))
    }
}

/// A thin sheet of glass: what it lets through goes straight on.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    pub(super) eta: f32,
    pub(super) specular_reflectance: Texture,
    pub(super) specular_transmittance: Texture,
}

impl ThinDielectric {
    /// Share reflected by the sheet, all internal reflections included: `R + T^2 R / (1 - R^2) = 2 R / (1 + R)`.
    #[inline(always)]
    fn reflectance(&self, wo: Vec3) -> f32 {
        let (one_side, _) = fresnel::dielectric(wo.z.abs(), self.eta);
        2.0 * one_side / (1.0 + one_side)
    }

    #[inline(always)]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u: f32) -> BsdfSample {
        if u < self.reflectance(wo) {
            let weight = self.specular_reflectance.eval(point);
            return BsdfSample::delta(Vec3::new(-wo.x, -wo.y, wo.z), weight, Event::DELTA_REFLECTION);
        }
        BsdfSample::delta(-wo, self.specular_transmittance.eval(point), Event::NULL)
    }

    #[inline(always)]
    pub(super) fn null_transmission(&self, point: &TexturePoint, wo: Vec3) -> Spectrum {
        self.specular_transmittance.eval(point) * (1.0 - self.reflectance(wo))
    }
}
