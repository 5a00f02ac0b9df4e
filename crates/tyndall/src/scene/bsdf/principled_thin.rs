//! Burley's principled model for thin sheets (Burley 2015, section 5).

use super::principled::{diffuse_base, sheen_color, specular_distribution, tinted_schlick};
use super::{BsdfSample, Event, fresnel};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::desc::PrincipledThinDesc;
use crate::scene::texture::{Texture, TextureError, TexturePoint};
use std::f32::consts::FRAC_1_PI;

/// A thin sheet that reflects and lets through, both specularly and diffusely, alike on both sides.
#[derive(Clone, Debug)]
pub struct PrincipledThin {
    base_color: Texture,
    roughness: Texture,
    anisotropic: Texture,
    spec_trans: Texture,
    eta: Texture,
    spec_tint: Texture,
    sheen: Texture,
    sheen_tint: Texture,
    flatness: Texture,
    diff_trans: Texture,
    diffuse_reflection_rate: f32,
    specular_reflection_rate: f32,
    specular_transmission_rate: f32,
    diffuse_transmission_rate: f32,
}

/// Probabilities of the lobes; they sum to 1.
struct Shares {
    specular_reflection: f32,
    specular_transmission: f32,
    diffuse_reflection: f32,
    diffuse_transmission: f32,
}

impl PrincipledThin {
    /// Compiles the textures.
    pub(super) fn new(desc: &PrincipledThinDesc) -> Result<Self, TextureError> {
        Ok(Self {
            base_color: Texture::compile(&desc.base_color)?,
            roughness: Texture::compile(&desc.roughness)?,
            anisotropic: Texture::compile(&desc.anisotropic)?,
            spec_trans: Texture::compile(&desc.spec_trans)?,
            eta: Texture::compile(&desc.eta)?,
            spec_tint: Texture::compile(&desc.spec_tint)?,
            sheen: Texture::compile(&desc.sheen)?,
            sheen_tint: Texture::compile(&desc.sheen_tint)?,
            flatness: Texture::compile(&desc.flatness)?,
            diff_trans: Texture::compile(&desc.diff_trans)?,
            diffuse_reflection_rate: desc.diffuse_reflectance_sampling_rate,
            specular_reflection_rate: desc.specular_reflectance_sampling_rate,
            specular_transmission_rate: desc.specular_transmittance_sampling_rate,
            diffuse_transmission_rate: desc.diffuse_transmittance_sampling_rate,
        })
    }

    pub(super) fn transmits(&self) -> bool {
        !(self.spec_trans.is_constant(0.0) && self.diff_trans.is_constant(0.0))
    }

    pub(super) fn varies(&self) -> bool {
        let textures = [
            &self.base_color,
            &self.roughness,
            &self.spec_trans,
            &self.eta,
            &self.spec_tint,
            &self.sheen,
            &self.sheen_tint,
            &self.flatness,
            &self.diff_trans,
        ];
        !self.anisotropic.is_constant(0.0) || textures.iter().any(|t| t.varies())
    }

    /// Share of the diffuse light that is let through; the parameter runs from 0 to 2.
    #[inline(always)]
    fn diffuse_split(&self, point: &TexturePoint) -> f32 {
        0.5 * self.diff_trans.eval_grey(point)
    }

    #[inline(always)]
    fn shares(&self, spec_trans: f32, split: f32) -> Shares {
        let specular_reflection = 0.5 * spec_trans * self.specular_reflection_rate;
        let specular_transmission = 0.5 * spec_trans * self.specular_transmission_rate;
        let diffuse_reflection = (1.0 - spec_trans) * (1.0 - split) * self.diffuse_reflection_rate;
        let diffuse_transmission = (1.0 - spec_trans) * split * self.diffuse_transmission_rate;
        let sum = specular_reflection + specular_transmission + diffuse_reflection + diffuse_transmission;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Shares {
            specular_reflection: specular_reflection * scale,
            specular_transmission: specular_transmission * scale,
            diffuse_reflection: diffuse_reflection * scale,
            diffuse_transmission: diffuse_transmission * scale,
        }
    }

    /// Roughness of the light let through (Burley 2015, figure 15).
    #[inline(always)]
    fn transmitted_roughness(roughness: f32, eta: f32) -> f32 {
        (0.65 * eta - 0.35) * roughness
    }

    #[inline]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u1: f32, u2: Vec2) -> Option<BsdfSample> {
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        if !(up.z > 0.0) {
            return None;
        }
        let shares = self.shares(self.spec_trans.eval_grey(point), self.diffuse_split(point));
        let specular = shares.specular_reflection + shares.specular_transmission;
        let (wi, event) = if u1 < specular {
            let transmits = u1 >= shares.specular_reflection;
            let roughness = self.roughness.eval_grey(point);
            let roughness =
                if transmits { Self::transmitted_roughness(roughness, self.eta.eval_grey(point)) } else { roughness };
            let m = specular_distribution(self.anisotropic.eval_grey(point), roughness).sample(up, u2);
            let wi = fresnel::reflect(up, m);
            if !(wi.z > 0.0) {
                return None;
            }
            let turned = Vec3::new(wi.x, wi.y, -wi.z);
            // The turned direction must be behind the facet as well.
            match transmits {
                false => (wi, Event::REFLECTION),
                true if turned.dot(m) < 0.0 => (turned, Event::transmission(1.0)),
                true => return None,
            }
        } else if u1 < specular + shares.diffuse_reflection {
            (warp::square_to_cosine_hemisphere(u2), Event::REFLECTION)
        } else {
            (-warp::square_to_cosine_hemisphere(u2), Event::transmission(1.0))
        };
        let evaluated = self.eval_above(point, up, wi);
        let wi = Vec3::new(wi.x, wi.y, if wo.z > 0.0 { wi.z } else { -wi.z });
        BsdfSample::evaluated(wi, evaluated, event)
    }

    #[inline]
    pub(super) fn eval(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let wi = Vec3::new(wi.x, wi.y, if wo.z > 0.0 { wi.z } else { -wi.z });
        if !(up.z > 0.0 && wi.z != 0.0) {
            return super::NOTHING;
        }
        self.eval_above(point, up, wi)
    }

    #[inline]
    fn eval_above(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        let reflects = wi.z > 0.0;
        // Light let through is light reflected and then turned to the other side: no bending.
        let Some(m) = (wo + Vec3::new(wi.x, wi.y, wi.z.abs())).try_normalize() else {
            return super::NOTHING;
        };
        let spec_trans = self.spec_trans.eval_grey(point);
        let split = self.diffuse_split(point);
        let shares = self.shares(spec_trans, split);
        let base_color = self.base_color.eval(point);
        let roughness = self.roughness.eval_grey(point);
        let cos = wo.dot(m);
        let mut value = Spectrum::ZERO;
        let mut pdf = 0.0;
        if spec_trans > 0.0 && wi.dot(m) * wi.z > 0.0 {
            let eta = self.eta.eval_grey(point);
            let (reflectance, _) = fresnel::dielectric(cos, eta);
            let (color, roughness, share) = if reflects {
                let tint = self.spec_tint.eval_grey(point);
                let mut color = Spectrum::grey(reflectance);
                if tint > 0.0 {
                    color = color.lerp(tinted_schlick(base_color, cos, eta), tint);
                }
                (color, roughness, shares.specular_reflection)
            } else {
                let roughness = Self::transmitted_roughness(roughness, eta);
                (base_color * (1.0 - reflectance), roughness, shares.specular_transmission)
            };
            let distribution = specular_distribution(self.anisotropic.eval_grey(point), roughness);
            let visible = distribution.density(m) * distribution.masking(wo, m) / (4.0 * wo.z);
            value += color * (spec_trans * visible * distribution.masking(wi, m));
            pdf += share * visible;
        }
        let cosine = warp::cosine_hemisphere_pdf(wi.z.abs()).0;
        if reflects {
            let cos_difference = wi.dot(m);
            let base = diffuse_base(roughness, self.flatness.eval_grey(point), wo.z, wi.z, cos_difference);
            let sheen =
                sheen_color(self.sheen.eval_grey(point), self.sheen_tint.eval_grey(point), base_color, cos_difference);
            value += (base_color * base + sheen) * ((1.0 - spec_trans) * (1.0 - split) * wi.z);
            pdf += shares.diffuse_reflection * cosine;
        } else {
            value += base_color * ((1.0 - spec_trans) * split * FRAC_1_PI * -wi.z);
            pdf += shares.diffuse_transmission * cosine;
        }
        if !(value.is_finite() && pdf.is_finite()) {
            return super::NOTHING;
        }
        (value, PerSolidAngle(pdf))
    }
}
