//! Burley's principled model (Burley 2012, "Physically-Based Shading at Disney"; 2015, "Extending the Disney BRDF to a
//! BSDF with Integrated Subsurface Scattering").

use super::microfacet::Distribution;
use super::rough_dielectric::{half_vector, refraction_jacobian};
use super::{BsdfSample, Event, Transport, fresnel};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::desc::PrincipledDesc;
use crate::scene::texture::{Texture, TextureError, TexturePoint};
use std::f32::consts::{FRAC_1_PI, PI};

/// Metal, glass and diffuse base in one, with sheen and clearcoat.
#[derive(Clone, Debug)]
pub struct Principled {
    eta: f32,
    base_color: Texture,
    roughness: Texture,
    anisotropic: Texture,
    metallic: Texture,
    spec_trans: Texture,
    spec_tint: Texture,
    sheen: Texture,
    sheen_tint: Texture,
    flatness: Texture,
    clearcoat: Texture,
    clearcoat_gloss: Texture,
    diffuse_rate: f32,
    specular_rate: f32,
    clearcoat_rate: f32,
}

/// What sampling and densities need at a point, seen from `wo`, which is above.
struct Lobes {
    front: bool,
    /// Relative index for light from the side of `wo`.
    eta: f32,
    /// Share of the diffuse base.
    opaque: f32,
    /// Share of the glass.
    glass: f32,
    metallic: f32,
    roughness: f32,
    clearcoat: f32,
    specular: Distribution,
    coat: Gtr1,
}

/// Probabilities of the lobes given the facet's reflectance; they sum to 1.
struct Shares {
    diffuse: f32,
    clearcoat: f32,
    transmission: f32,
    reflection: f32,
}

impl Principled {
    /// Compiles the textures; an index of exactly 1 is moved away where there is transmission.
    pub(super) fn new(desc: &PrincipledDesc) -> Result<Self, TextureError> {
        let spec_trans = Texture::compile(&desc.spec_trans)?;
        Ok(Self {
            eta: if desc.eta == 1.0 && !spec_trans.is_constant(0.0) { 1.001 } else { desc.eta },
            base_color: Texture::compile(&desc.base_color)?,
            roughness: Texture::compile(&desc.roughness)?,
            anisotropic: Texture::compile(&desc.anisotropic)?,
            metallic: Texture::compile(&desc.metallic)?,
            spec_trans,
            spec_tint: Texture::compile(&desc.spec_tint)?,
            sheen: Texture::compile(&desc.sheen)?,
            sheen_tint: Texture::compile(&desc.sheen_tint)?,
            flatness: Texture::compile(&desc.flatness)?,
            clearcoat: Texture::compile(&desc.clearcoat)?,
            clearcoat_gloss: Texture::compile(&desc.clearcoat_gloss)?,
            diffuse_rate: desc.diffuse_reflectance_sampling_rate,
            specular_rate: desc.main_specular_sampling_rate,
            clearcoat_rate: desc.clearcoat_sampling_rate,
        })
    }

    pub(super) fn transmits(&self) -> bool {
        !self.spec_trans.is_constant(0.0)
    }

    pub(super) fn varies(&self) -> bool {
        let textures = [
            &self.base_color,
            &self.roughness,
            &self.metallic,
            &self.spec_trans,
            &self.spec_tint,
            &self.sheen,
            &self.sheen_tint,
            &self.flatness,
            &self.clearcoat,
            &self.clearcoat_gloss,
        ];
        !self.anisotropic.is_constant(0.0) || textures.iter().any(|t| t.varies())
    }

    #[inline(always)]
    fn lobes(&self, point: &TexturePoint, front: bool) -> Lobes {
        let metallic = self.metallic.eval_grey(point);
        let spec_trans = self.spec_trans.eval_grey(point);
        let roughness = self.roughness.eval_grey(point);
        let clearcoat = if front { self.clearcoat.eval_grey(point) } else { 0.0 };
        let gloss = self.clearcoat_gloss.eval_grey(point);
        Lobes {
            front,
            eta: if front { self.eta } else { 1.0 / self.eta },
            opaque: if front { (1.0 - metallic) * (1.0 - spec_trans) } else { 0.0 },
            glass: (1.0 - metallic) * spec_trans,
            metallic,
            roughness,
            clearcoat,
            specular: specular_distribution(self.anisotropic.eval_grey(point), roughness),
            coat: Gtr1 { alpha: 0.1 + (0.001 - 0.1) * gloss },
        }
    }

    #[inline(always)]
    fn shares(&self, lobes: &Lobes, reflectance: f32) -> Shares {
        if !lobes.front {
            return Shares { diffuse: 0.0, clearcoat: 0.0, transmission: 1.0 - reflectance, reflection: reflectance };
        }
        // The sum does not depend on the reflectance: choosing the lobe after the facet keeps the density simple.
        let diffuse = lobes.opaque * self.diffuse_rate;
        let clearcoat = 0.25 * lobes.clearcoat * self.clearcoat_rate;
        let sum = diffuse + clearcoat + self.specular_rate;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let transmission = self.specular_rate * lobes.glass * (1.0 - reflectance);
        Shares {
            diffuse: diffuse * scale,
            clearcoat: clearcoat * scale,
            transmission: transmission * scale,
            reflection: (self.specular_rate - transmission) * scale,
        }
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
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let lobes = self.lobes(point, wo.z > 0.0);
        if !(up.z > 0.0 && (lobes.front || lobes.glass > 0.0)) {
            return None;
        }
        let m = lobes.specular.sample(up, u2);
        let cos = up.dot(m).max(0.0);
        let (reflectance, cos_t) = fresnel::dielectric(cos, lobes.eta);
        let shares = self.shares(&lobes, reflectance);
        let mut rest = u1 - shares.diffuse;
        let (wi, event) = if rest < 0.0 {
            (warp::square_to_cosine_hemisphere(u2), Event::REFLECTION)
        } else if {
            rest -= shares.clearcoat;
            rest
        } < 0.0
        {
            (fresnel::reflect(up, lobes.coat.sample(u2)), Event::REFLECTION)
        } else if rest < shares.transmission {
            (fresnel::refract(up, m, cos, cos_t, lobes.eta), Event::transmission(lobes.eta))
        } else {
            (fresnel::reflect(up, m), Event::REFLECTION)
        };
        if (wi.z < 0.0) != event.transmission {
            return None;
        }
        let evaluated = self.eval_above(point, &lobes, up, wi, transport);
        let wi = Vec3::new(wi.x, wi.y, if lobes.front { wi.z } else { -wi.z });
        BsdfSample::evaluated(wi, evaluated, event)
    }

    #[inline]
    pub(super) fn eval(
        &self,
        point: &TexturePoint,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let wi = Vec3::new(wi.x, wi.y, if wo.z > 0.0 { wi.z } else { -wi.z });
        let lobes = self.lobes(point, wo.z > 0.0);
        if !(up.z > 0.0 && wi.z != 0.0 && (lobes.front || lobes.glass > 0.0)) {
            return super::NOTHING;
        }
        self.eval_above(point, &lobes, up, wi, transport)
    }

    /// `f |cos|` and density for `wo` above; below the surface stands on its head.
    #[inline]
    fn eval_above(
        &self,
        point: &TexturePoint,
        lobes: &Lobes,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let reflects = wi.z > 0.0;
        let Some(m) = half_vector(wo, wi, if reflects { 1.0 } else { lobes.eta }) else {
            return super::NOTHING;
        };
        let (cos, cos_i) = (wo.dot(m), wi.dot(m));
        let facet = cos > 0.0 && cos_i * wi.z > 0.0;
        let (reflectance, _) = fresnel::dielectric(cos, lobes.eta);
        let shares = self.shares(lobes, reflectance);
        let base_color = self.base_color.eval(point);
        let mut value = Spectrum::ZERO;
        let mut pdf = 0.0;
        if facet {
            let jacobian = if reflects { 1.0 / (4.0 * cos) } else { refraction_jacobian(cos, cos_i, lobes.eta) };
            let density = lobes.specular.density(m);
            let visible = density * lobes.specular.masking(wo, m) * cos / wo.z;
            let facets = visible * lobes.specular.masking(wi, m) * jacobian;
            let share = if reflects { shares.reflection } else { shares.transmission };
            pdf += share * visible * jacobian;
            if !reflects {
                let through = lobes.glass * (1.0 - reflectance) * transport.refraction_scale(lobes.eta);
                value += base_color.sqrt() * (facets * through);
            } else if reflectance > 0.0 {
                value += self.specular_color(point, lobes, base_color, cos, reflectance) * facets;
            }
            if reflects && lobes.clearcoat > 0.0 {
                let fresnel = schlick(Spectrum::grey(0.04), cos, lobes.eta)[0];
                let masking = Distribution::ggx(0.25, 0.25);
                let masking = masking.masking(wo, m) * masking.masking(wi, m);
                let coat = lobes.coat.density(m.z);
                value += Spectrum::grey(0.25 * lobes.clearcoat * fresnel * coat * masking * wi.z);
                pdf += shares.clearcoat * coat * m.z * jacobian;
            }
        }
        if reflects && lobes.front {
            let flatness = self.flatness.eval_grey(point);
            let base = base_color * (lobes.opaque * diffuse_base(lobes.roughness, flatness, wo.z, wi.z, cos_i));
            let sheen = self.sheen.eval_grey(point) * (1.0 - lobes.metallic);
            let sheen = sheen_color(sheen, self.sheen_tint.eval_grey(point), base_color, cos_i);
            value += (base + sheen) * wi.z;
            pdf += shares.diffuse * warp::cosine_hemisphere_pdf(wi.z).0;
        }
        if !(value.is_finite() && pdf.is_finite()) {
            return super::NOTHING;
        }
        (value, PerSolidAngle(pdf))
    }

    /// Colour of a reflecting facet: glass, tinted glass and metal blended.
    #[inline]
    fn specular_color(
        &self,
        point: &TexturePoint,
        lobes: &Lobes,
        base_color: Spectrum,
        cos: f32,
        reflectance: f32,
    ) -> Spectrum {
        if !lobes.front {
            return Spectrum::grey(lobes.glass * reflectance);
        }
        let spec_tint = self.spec_tint.eval_grey(point);
        let mut color = Spectrum::grey((1.0 - lobes.metallic) * (1.0 - spec_tint) * reflectance);
        if lobes.metallic > 0.0 {
            color += schlick(base_color, cos, lobes.eta) * lobes.metallic;
        }
        if spec_tint > 0.0 {
            color += tinted_schlick(base_color, cos, lobes.eta) * ((1.0 - lobes.metallic) * spec_tint);
        }
        color
    }
}

/// GGX roughness along and across the grain (Burley 2012, section 5.4).
#[inline(always)]
pub(super) fn specular_distribution(anisotropic: f32, roughness: f32) -> Distribution {
    let alpha = roughness * roughness;
    let aspect = (1.0 - 0.9 * anisotropic).max(0.0).sqrt();
    Distribution::ggx((alpha / aspect).max(0.001), (alpha * aspect).max(0.001))
}

/// Schlick's approximation; the cosine is that on the thinner side (Burley 2015).
#[inline(always)]
pub(super) fn schlick(normal: Spectrum, cos: f32, eta: f32) -> Spectrum {
    let cos = if eta > 1.0 { cos } else { (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt() };
    normal.lerp(Spectrum::ONE, fresnel::schlick_weight(cos))
}

/// Schlick's approximation for glass of index `eta` tinted with the hue of the base.
#[inline(always)]
pub(super) fn tinted_schlick(base_color: Spectrum, cos: f32, eta: f32) -> Spectrum {
    let normal = (eta - 1.0) / (eta + 1.0);
    schlick(hue(base_color) * (normal * normal), cos, eta)
}

/// The colour at luminance 1; white for black.
#[inline(always)]
fn hue(color: Spectrum) -> Spectrum {
    let luminance = color.luminance();
    if luminance > 0.0 { color / luminance } else { Spectrum::ONE }
}

/// The sheen at grazing angles, without the cosine (Burley 2012, section 5.5).
#[inline(always)]
pub(super) fn sheen_color(sheen: f32, tint: f32, base_color: Spectrum, cos_difference: f32) -> Spectrum {
    if !(sheen > 0.0) {
        return Spectrum::ZERO;
    }
    let color = if tint > 0.0 { Spectrum::ONE.lerp(hue(base_color), tint) } else { Spectrum::ONE };
    color * (sheen * fresnel::schlick_weight(cos_difference.abs()))
}

/// The diffuse base without albedo and cosine: retro-reflecting (Burley 2012, equation 4; separated in Burley 2015),
/// blended by `flatness` with an imitation of subsurface scattering after Hanrahan and Krueger 1993.
#[inline(always)]
pub(super) fn diffuse_base(roughness: f32, flatness: f32, cos_o: f32, cos_i: f32, cos_difference: f32) -> f32 {
    let (f_o, f_i) = (fresnel::schlick_weight(cos_o), fresnel::schlick_weight(cos_i));
    let retro = 2.0 * roughness * cos_difference * cos_difference;
    let rough = (1.0 - 0.5 * f_o) * (1.0 - 0.5 * f_i) + retro * (f_o + f_i + f_o * f_i * (retro - 1.0));
    if !(flatness > 0.0) {
        return rough * FRAC_1_PI;
    }
    let grazing = 0.5 * retro - 1.0;
    let product = (1.0 + grazing * f_o) * (1.0 + grazing * f_i);
    let flat = 1.25 * (product * (1.0 / (cos_o + cos_i) - 0.5) + 0.5);
    (rough + (flat - rough) * flatness) * FRAC_1_PI
}

/// The clearcoat's distribution of normals, generalised Trowbridge-Reitz with exponent 1 (Burley 2012, appendix B).
struct Gtr1 {
    alpha: f32,
}

impl Gtr1 {
    /// Density of normals with cosine `cos`, 1/sr.
    #[inline(always)]
    fn density(&self, cos: f32) -> f32 {
        let alpha2 = self.alpha * self.alpha;
        let density = (alpha2 - 1.0) / (PI * alpha2.ln() * (1.0 + (alpha2 - 1.0) * cos * cos));
        if density * cos > 1e-20 { density } else { 0.0 }
    }

    /// A normal with density `density * cos`.
    #[inline(always)]
    fn sample(&self, u: Vec2) -> Vec3 {
        let alpha2 = self.alpha * self.alpha;
        let cos2 = (1.0 - alpha2.powf(1.0 - u.y)) / (1.0 - alpha2);
        let (sin, cos) = (2.0 * PI * u.x).sin_cos();
        let r = (1.0 - cos2).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, cos2.max(0.0).sqrt())
    }
}
