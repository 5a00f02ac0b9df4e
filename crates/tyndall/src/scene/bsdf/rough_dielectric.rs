//! Rough interface between two dielectrics (Walter et al. 2007).

use super::microfacet::{Distribution, Roughness};
use super::{BsdfSample, Event, Transport, fresnel};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3};
use crate::scene::texture::{Texture, TexturePoint};

/// Rough interface between two dielectrics.
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    pub(super) eta: f32,
    pub(super) inverse_eta: f32,
    pub(super) specular_reflectance: Texture,
    pub(super) specular_transmittance: Texture,
    pub(super) roughness: Roughness,
}

impl RoughDielectric {
    /// Relative index for light that arrives from the side of `wo`.
    #[inline(always)]
    fn eta(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { self.inverse_eta }
    }

    /// The distribution that is sampled: widened where all normals are (Walter et al. 2007, section 5.3), so that the
    /// weights stay bounded.
    #[inline(always)]
    fn sampled(&self, distribution: Distribution, wo: Vec3) -> Distribution {
        if self.roughness.sample_visible() {
            return distribution;
        }
        distribution.scaled(1.2 - 0.2 * wo.z.abs().sqrt())
    }

    #[inline]
    pub(super) fn sample(
        &self,
        point: &TexturePoint,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let eta = self.eta(wo);
        // Seen from below the surface is its own mirror image with the indices exchanged.
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        if !(up.z > 0.0) {
            return None;
        }
        let distribution = self.roughness.at(point);
        let sampled = self.sampled(distribution, wo);
        let m = sampled.sample(up, u2);
        let cos = up.dot(m);
        let normal_pdf = sampled.normal_pdf(up, m);
        if !(cos > 0.0 && normal_pdf > 0.0) {
            return None;
        }
        let (reflectance, cos_t) = fresnel::dielectric(cos, eta);
        let reflects = u1 < reflectance;
        let (wi, factor, jacobian) = if reflects {
            let wi = fresnel::reflect(up, m);
            (wi, self.specular_reflectance.eval(point), 1.0 / (4.0 * cos))
        } else {
            let wi = fresnel::refract(up, m, cos, cos_t, eta);
            let factor = self.specular_transmittance.eval(point) * transport.refraction_scale(eta);
            (wi, factor, refraction_jacobian(cos, wi.dot(m), eta))
        };
        if (wi.z > 0.0) != reflects {
            return None;
        }
        let masking = if self.roughness.sample_visible() {
            distribution.masking(wi, m)
        } else {
            let facets = distribution.density(m) * distribution.masking(up, m) * distribution.masking(wi, m);
            facets * cos / (up.z * normal_pdf)
        };
        let share = if reflects { reflectance } else { 1.0 - reflectance };
        let pdf = normal_pdf * jacobian * share;
        let event = if reflects { Event::REFLECTION } else { Event::transmission(eta) };
        let wi = Vec3::new(wi.x, wi.y, if wo.z > 0.0 { wi.z } else { -wi.z });
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample {
            wi,
            weight: factor * masking,
            pdf: PerSolidAngle(pdf),
            event,
        })
    }

    #[inline]
    pub(super) fn eval(
        &self,
        point: &TexturePoint,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let eta = self.eta(wo);
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let wi = Vec3::new(wi.x, wi.y, if wo.z > 0.0 { wi.z } else { -wi.z });
        if !(up.z > 0.0 && wi.z != 0.0) {
            return super::NOTHING;
        }
        let reflects = wi.z > 0.0;
        let Some(m) = half_vector(up, wi, if reflects { 1.0 } else { eta }) else {
            return super::NOTHING;
        };
        let (cos, cos_i) = (up.dot(m), wi.dot(m));
        if !(cos > 0.0 && cos_i * wi.z > 0.0) {
            return super::NOTHING;
        }
        let distribution = self.roughness.at(point);
        let (reflectance, _) = fresnel::dielectric(cos, eta);
        let (share, jacobian, factor) = if reflects {
            (reflectance, 1.0 / (4.0 * cos), self.specular_reflectance.eval(point))
        } else {
            let factor = self.specular_transmittance.eval(point) * transport.refraction_scale(eta);
            (1.0 - reflectance, refraction_jacobian(cos, cos_i, eta), factor)
        };
        let pdf = self.sampled(distribution, wo).normal_pdf(up, m) * share * jacobian;
        let facets = distribution.density(m) * distribution.masking(up, m) * distribution.masking(wi, m);
        let value = facets * share * jacobian * cos / up.z;
        if !value.is_finite() || !pdf.is_finite() {
            return super::NOTHING;
        }
        (factor * value, PerSolidAngle(pdf))
    }
}

/// Solid angle of the facet normal per solid angle of the refracted direction (Walter et al. 2007, equation 17).
#[inline(always)]
pub(super) fn refraction_jacobian(cos: f32, cos_i: f32, eta: f32) -> f32 {
    let denominator = cos + eta * cos_i;
    eta * eta * cos_i.abs() / (denominator * denominator)
}

/// The upward normal that turns `wo` into `wi`; `eta` is 1 for reflection.
#[inline(always)]
pub(super) fn half_vector(wo: Vec3, wi: Vec3, eta: f32) -> Option<Vec3> {
    let m = (wo + wi * eta).try_normalize()?;
    Some(if m.z < 0.0 { -m } else { m })
}
