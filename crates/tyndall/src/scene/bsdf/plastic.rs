//! A diffuse base under a dielectric coat, smooth or rough.

use super::microfacet::Distribution;
use super::{BsdfSample, Ceiling, Event, fresnel, quadrature};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::desc::Microfacets;
use crate::scene::texture::{Texture, TexturePoint};
use rayon::prelude::*;
use std::f32::consts::FRAC_1_PI;

/// The diffuse base, with the light that the coat throws back onto it.
#[derive(Clone, Debug)]
struct Base {
    reflectance: Texture,
    /// Share of diffuse light that the coat reflects back inside.
    internal: f32,
    /// `1 / (eta^2 (1 - internal))`, or `1 / eta^2` when nonlinear.
    scale: f32,
    nonlinear: bool,
}

impl Base {
    fn new(reflectance: Texture, eta: f32, internal: f32, nonlinear: bool) -> Self {
        let loss = if nonlinear { 1.0 } else { 1.0 - internal };
        Self { reflectance, internal, scale: 1.0 / (eta * eta * loss), nonlinear }
    }

    /// Albedo of all orders of internal reflection, over `eta^2`.
    #[inline(always)]
    fn albedo(&self, point: &TexturePoint) -> Spectrum {
        let reflectance = self.reflectance.eval(point);
        if self.nonlinear {
            return reflectance * self.scale / (Spectrum::ONE - reflectance * self.internal);
        }
        reflectance * self.scale
    }
}

/// Share of the samples for the coat's reflection before Fresnel's share is counted.
fn specular_weight(diffuse: &Texture, specular: &Texture) -> f32 {
    let (d, s) = (diffuse.mean_grey(), specular.mean_grey());
    if d + s > 0.0 { s / (d + s) } else { 1.0 }
}

/// Probability of sampling the coat, whose share of the light is `reflectance`.
#[inline(always)]
fn specular_probability(weight: f32, reflectance: f32) -> f32 {
    let specular = weight * reflectance;
    let sum = specular + (1.0 - weight) * (1.0 - reflectance);
    if sum > 0.0 { specular / sum } else { 1.0 }
}

/// Diffuse base under a smooth coat.
#[derive(Clone, Debug)]
pub struct Plastic {
    base: Base,
    specular_reflectance: Texture,
    specular_weight: f32,
    eta: f32,
}

impl Plastic {
    /// From the base's albedo, the coat's tint and relative index.
    pub(super) fn new(diffuse: Texture, specular: Texture, eta: f32, nonlinear: bool) -> Self {
        let specular_weight = specular_weight(&diffuse, &specular);
        let base = Base::new(diffuse, eta, fresnel::diffuse_mean(1.0 / eta), nonlinear);
        Self { base, specular_reflectance: specular, specular_weight, eta }
    }

    pub(super) fn varies(&self) -> bool {
        self.base.reflectance.varies() || self.specular_reflectance.varies()
    }

    #[inline]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u1: f32, u2: Vec2) -> Option<BsdfSample> {
        if !(wo.z > 0.0) {
            return None;
        }
        let (f_o, _) = fresnel::dielectric(wo.z, self.eta);
        let specular = specular_probability(self.specular_weight, f_o);
        if u1 < specular {
            let weight = self.specular_reflectance.eval(point) * (f_o / specular);
            return Some(BsdfSample::delta(Vec3::new(-wo.x, -wo.y, wo.z), weight, Event::DELTA_REFLECTION));
        }
        let wi = warp::square_to_cosine_hemisphere(u2);
        let pdf = warp::cosine_hemisphere_pdf(wi.z) * (1.0 - specular);
        let (f_i, _) = fresnel::dielectric(wi.z, self.eta);
        let weight = self.base.albedo(point) * ((1.0 - f_o) * (1.0 - f_i) / (1.0 - specular));
        (pdf.0 > 0.0).then_some(BsdfSample { wi, weight, pdf, event: Event::REFLECTION })
    }

    #[inline]
    pub(super) fn ceiling(&self, point: &TexturePoint, wo: Vec3) -> Ceiling {
        if !(wo.z > 0.0) {
            return Ceiling::NOTHING;
        }
        let (f_o, _) = fresnel::dielectric(wo.z, self.eta);
        Ceiling::cosine(self.base.albedo(point) * ((1.0 - f_o) * FRAC_1_PI))
    }

    #[inline]
    pub(super) fn eval(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return super::NOTHING;
        }
        let (f_o, _) = fresnel::dielectric(wo.z, self.eta);
        let (f_i, _) = fresnel::dielectric(wi.z, self.eta);
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let value = self.base.albedo(point) * (cosine.0 * (1.0 - f_o) * (1.0 - f_i));
        (value, cosine * (1.0 - specular_probability(self.specular_weight, f_o)))
    }
}

/// Equidistant cosines of the tabulated transmittance.
const NODES: usize = 64;

/// Diffuse base under a rough coat.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    base: Base,
    specular_reflectance: Texture,
    specular_weight: f32,
    eta: f32,
    distribution: Distribution,
    sample_visible: bool,
    /// Share that the coat lets in, by the cosine of incidence.
    transmittance: Box<[f32; NODES]>,
}

impl RoughPlastic {
    /// From the base's albedo, the coat's tint, relative index and isotropic roughness; tabulates what the coat lets
    /// through.
    pub(super) fn new(
        diffuse: Texture,
        specular: Texture,
        eta: f32,
        nonlinear: bool,
        kind: Microfacets,
        alpha: f32,
        sample_visible: bool,
    ) -> Self {
        let visible = Distribution::new(kind, alpha, alpha, true);
        let wo: [Vec3; NODES] = std::array::from_fn(|i| {
            let cos = (i as f32 / (NODES - 1) as f32).max(1e-6);
            Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
        });
        let transmittance = Box::new(rough_shares(&visible, &wo, eta, false));
        let inside = rough_shares(&visible, &wo, 1.0 / eta, true);
        let internal: f32 = inside.iter().zip(&wo).map(|(share, wo)| share * wo.z).sum();
        Self {
            specular_weight: specular_weight(&diffuse, &specular),
            base: Base::new(diffuse, eta, internal * 2.0 / NODES as f32, nonlinear),
            specular_reflectance: specular,
            eta,
            distribution: Distribution::new(kind, alpha, alpha, sample_visible),
            sample_visible,
            transmittance,
        }
    }

    pub(super) fn varies(&self) -> bool {
        self.base.reflectance.varies() || self.specular_reflectance.varies()
    }

    #[inline(always)]
    fn transmittance(&self, cos: f32) -> f32 {
        let x = cos * (NODES - 1) as f32;
        let i = (x as usize).min(NODES - 2);
        let (a, b) = (self.transmittance[i], self.transmittance[i + 1]);
        a + (b - a) * (x - i as f32)
    }

    #[inline]
    pub(super) fn sample(&self, point: &TexturePoint, wo: Vec3, u1: f32, u2: Vec2) -> Option<BsdfSample> {
        if !(wo.z > 0.0) {
            return None;
        }
        let specular = specular_probability(self.specular_weight, 1.0 - self.transmittance(wo.z));
        let wi = if u1 < specular {
            fresnel::reflect(wo, self.distribution.sample(wo, u2))
        } else {
            warp::square_to_cosine_hemisphere(u2)
        };
        BsdfSample::evaluated(wi, self.eval(point, wo, wi), Event::REFLECTION)
    }

    #[inline]
    pub(super) fn ceiling(&self, point: &TexturePoint, wo: Vec3) -> Ceiling {
        if !(wo.z > 0.0) {
            return Ceiling::NOTHING;
        }
        let coat = self.distribution.peak() * self.distribution.masking(wo, wo) / (4.0 * wo.z);
        let base = self.base.albedo(point) * (self.transmittance(wo.z) * FRAC_1_PI);
        Ceiling { value: self.specular_reflectance.eval(point) * coat + base, cosine: false, exact: false }
    }

    #[inline]
    pub(super) fn eval(&self, point: &TexturePoint, wo: Vec3, wi: Vec3) -> (Spectrum, PerSolidAngle) {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return super::NOTHING;
        }
        let Some(m) = (wo + wi).try_normalize() else {
            return super::NOTHING;
        };
        let t_o = self.transmittance(wo.z);
        let specular = specular_probability(self.specular_weight, 1.0 - t_o);
        let density = self.distribution.density(m);
        let masking = self.distribution.masking(wo, m);
        let cos = wo.dot(m);
        let lobe = if self.sample_visible { density * masking / (4.0 * wo.z) } else { density * m.z / (4.0 * cos) };
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let pdf = cosine * (1.0 - specular) + PerSolidAngle(lobe * specular);
        let (reflectance, _) = fresnel::dielectric(cos, self.eta);
        let coat = reflectance * density * masking * self.distribution.masking(wi, m) / (4.0 * wo.z);
        if !(coat.is_finite() && pdf.0.is_finite()) {
            return super::NOTHING;
        }
        let base = self.base.albedo(point) * (cosine.0 * t_o * self.transmittance(wi.z));
        (self.specular_reflectance.eval(point) * coat + base, pdf)
    }
}

/// Shares of the light from each of the directions `wo` that a rough interface reflects, or lets through, in one bounce.
fn rough_shares(visible: &Distribution, wo: &[Vec3; NODES], eta: f32, reflected: bool) -> [f32; NODES] {
    // Total reflection is a kink that asks for more nodes.
    let (nodes, weights) = quadrature::gauss_legendre(if eta > 1.0 { 32 } else { 128 });
    let mut shares = [0.0; NODES];
    shares.par_iter_mut().zip(wo).for_each(|(share, &wo)| {
        for (&x, &weight_x) in nodes.iter().zip(&weights) {
            let mut sum = 0.0;
            for (&y, &weight_y) in nodes.iter().zip(&weights) {
                let m = visible.sample(wo, Vec2::new(x, y));
                let cos = wo.dot(m).max(0.0);
                let (reflectance, cos_t) = fresnel::dielectric(cos, eta);
                let (wi, kept) = if reflected {
                    (fresnel::reflect(wo, m), reflectance)
                } else {
                    (fresnel::refract(wo, m, cos, cos_t, eta), 1.0 - reflectance)
                };
                if (wi.z > 0.0) == reflected {
                    sum += visible.masking(wi, m) * kept * weight_y;
                }
            }
            *share += sum * weight_x;
        }
    });
    shares
}
