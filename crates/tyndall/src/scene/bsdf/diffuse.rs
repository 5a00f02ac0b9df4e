//! Lambert's law.

use super::{BsdfSample, Ceiling, Event};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::texture::{Texture, TexturePoint};
use std::f32::consts::FRAC_1_PI;

/// Equal radiance into the upper half space.
#[derive(Clone, Debug)]
pub struct Diffuse {
    pub(super) reflectance: Texture,
}

impl Diffuse {
    #[inline(always)]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        if !(wo.z > 0.0) {
            return None;
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        let pdf = warp::cosine_hemisphere_pdf(wi.z);
        let sample = BsdfSample { wi, weight: self.reflectance.eval(point), pdf, event: Event::REFLECTION };
        (pdf.0 > 0.0).then_some(sample)
    }

    #[inline(always)]
    pub(super) fn ceiling(&self, point: &TexturePoint, wo: Vec3) -> Ceiling {
        if !(wo.z > 0.0) {
            return Ceiling::NOTHING;
        }
        Ceiling { exact: true, ..Ceiling::cosine(self.reflectance.eval(point) * FRAC_1_PI) }
    }

    #[inline(always)]
    pub(super) fn eval(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return super::NOTHING;
        }
        let pdf = warp::cosine_hemisphere_pdf(wi.z);
        (self.reflectance.eval(point) * pdf.0, pdf)
    }
}
