//! Distributions of microfacet normals with Smith's masking (Walter et al. 2007, Heitz 2014).

use super::erf::{erf, erf_inverse};
use crate::math::{Vec2, Vec3, warp};
use crate::scene::desc::{Microfacets, RoughnessDesc};
use crate::scene::texture::{Texture, TextureError, TexturePoint};
use std::f32::consts::{FRAC_2_SQRT_PI, PI};

/// Below this a distribution is too sharp for single precision.
const MIN_ALPHA: f32 = 1e-4;

/// Roughness over a surface.
#[derive(Clone, Debug)]
pub struct Roughness {
    kind: Microfacets,
    alpha_u: Texture,
    alpha_v: Texture,
    sample_visible: bool,
}

impl Roughness {
    /// Compiles the textures.
    pub fn new(desc: &RoughnessDesc) -> Result<Self, TextureError> {
        Ok(Self {
            kind: desc.distribution,
            alpha_u: Texture::compile(&desc.alpha_u)?,
            alpha_v: Texture::compile(&desc.alpha_v)?,
            sample_visible: desc.sample_visible,
        })
    }

    /// The distribution at a point.
    #[inline(always)]
    pub fn at(&self, point: &TexturePoint) -> Distribution {
        let (u, v) = (self.alpha_u.eval_grey(point), self.alpha_v.eval_grey(point));
        Distribution::new(self.kind, u, v, self.sample_visible)
    }

    /// Whether only visible normals are sampled.
    #[inline(always)]
    pub fn sample_visible(&self) -> bool {
        self.sample_visible
    }

    /// Whether the distribution depends on the point or on the tangent.
    pub fn varies(&self) -> bool {
        let anisotropic = match (&self.alpha_u, &self.alpha_v) {
            (Texture::Constant { grey: u, .. }, Texture::Constant { grey: v, .. }) => u != v,
            _ => true,
        };
        anisotropic || self.alpha_u.varies() || self.alpha_v.varies()
    }
}

/// A distribution of unit normals `m` about +z. Directions `v`, `wo` have `z > 0` unless said otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Distribution {
    kind: Microfacets,
    alpha: Vec2,
    sample_visible: bool,
}

impl Distribution {
    /// Roughness along the tangent and the bitangent, kept above 1e-4.
    #[inline(always)]
    pub fn new(kind: Microfacets, alpha_u: f32, alpha_v: f32, sample_visible: bool) -> Self {
        Self { kind, alpha: Vec2::new(alpha_u.max(MIN_ALPHA), alpha_v.max(MIN_ALPHA)), sample_visible }
    }

    /// GGX with visible normals sampled.
    #[inline(always)]
    pub fn ggx(alpha_u: f32, alpha_v: f32) -> Self {
        Self::new(Microfacets::Ggx, alpha_u, alpha_v, true)
    }

    /// The same kind with its roughness scaled.
    #[inline(always)]
    pub fn scaled(self, factor: f32) -> Self {
        Self { alpha: self.alpha * factor, ..self }
    }

    /// Area of facets per normal solid angle and surface area, 1/sr.
    #[inline(always)]
    pub fn density(&self, m: Vec3) -> f32 {
        let slope = Vec2::new(m.x, m.y) / self.alpha;
        let area = PI * self.alpha.x * self.alpha.y;
        let z2 = m.z * m.z;
        let density = match self.kind {
            Microfacets::Beckmann => (-slope.length_squared() / z2).exp() / (area * z2 * z2),
            Microfacets::Ggx => {
                let s = slope.length_squared() + z2;
                1.0 / (area * s * s)
            }
        };
        // Also refuses normals at and below the horizon.
        if density * m.z > 1e-20 { density } else { 0.0 }
    }

    /// The largest density of any normal, 1/sr.
    #[inline]
    pub fn peak(&self) -> f32 {
        // Slopes are bounded by those of the greater roughness; beyond a certain one the largest density is off the axis.
        let rough2 = self.alpha.max_element() * self.alpha.max_element();
        let off_axis = match self.kind {
            Microfacets::Beckmann if 2.0 * rough2 > 1.0 => 4.0 * rough2 * rough2 * (1.0 / rough2 - 2.0).exp(),
            Microfacets::Beckmann => 1.0,
            Microfacets::Ggx => (rough2 * rough2).max(1.0),
        };
        off_axis / (PI * self.alpha.x * self.alpha.y)
    }

    /// Share of the facets of normal `m` that see `v`; `v` may be on either side.
    #[inline(always)]
    pub fn masking(&self, v: Vec3, m: Vec3) -> f32 {
        if v.dot(m) * v.z <= 0.0 {
            return 0.0;
        }
        let xy2 = (Vec2::new(v.x, v.y) * self.alpha).length_squared();
        if xy2 == 0.0 {
            return 1.0;
        }
        let tan2 = xy2 / (v.z * v.z);
        match self.kind {
            Microfacets::Ggx => 2.0 / (1.0 + (1.0 + tan2).sqrt()),
            Microfacets::Beckmann => {
                // Rational fit of Walter et al. 2007, section 5.2.
                let a = 1.0 / tan2.sqrt();
                if a >= 1.6 { 1.0 } else { (3.535 + 2.181 * a) * a / (1.0 + (2.276 + 2.577 * a) * a) }
            }
        }
    }

    /// Density of [`Self::sample`] per solid angle of the normal, 1/sr.
    #[inline(always)]
    pub fn normal_pdf(&self, wo: Vec3, m: Vec3) -> f32 {
        let density = self.density(m);
        if self.sample_visible { density * self.masking(wo, m) * wo.dot(m).abs() / wo.z } else { density * m.z }
    }

    /// A normal, among those visible from `wo` if so configured.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Vec3 {
        if !self.sample_visible {
            let r2 = match self.kind {
                Microfacets::Beckmann => -(1.0 - u.x).ln(),
                Microfacets::Ggx => u.x / (1.0 - u.x),
            };
            let (sin, cos) = (2.0 * PI * u.y).sin_cos();
            let slope = self.alpha * Vec2::new(cos, sin) * r2.max(0.0).sqrt();
            return slope.extend(1.0).normalize();
        }
        let stretched = Vec3::new(self.alpha.x * wo.x, self.alpha.y * wo.y, wo.z).normalize();
        let sin = Vec2::new(stretched.x, stretched.y).length();
        let azimuth = if sin > 0.0 { Vec2::new(stretched.x, stretched.y) / sin } else { Vec2::X };
        // In the plane of incidence of the stretched surface, whose roughness is 1.
        let m = match self.kind {
            Microfacets::Ggx => visible_ggx(sin, stretched.z, u),
            Microfacets::Beckmann => visible_beckmann(sin, stretched.z, u),
        };
        let xy = azimuth * m.x + azimuth.perp() * m.y;
        (xy * self.alpha).extend(m.z).normalize()
    }
}

/// A visible normal, not normalised, of the GGX distribution of roughness 1 seen from `(sin, 0, cos)` (Heitz 2018).
#[inline(always)]
fn visible_ggx(sin: f32, cos: f32, u: Vec2) -> Vec3 {
    let p = warp::square_to_disk(u);
    let half = (1.0 - p.x * p.x).max(0.0).sqrt();
    let y = half + (p.y - half) * (0.5 * (1.0 + cos));
    let z = (1.0 - p.x * p.x - y * y).max(0.0).sqrt();
    Vec3::new(sin * z - cos * y, p.x, (sin * y + cos * z).max(1e-7))
}

/// Error of the distribution function below which its inversion stops: what single precision resolves.
const CONVERGED: f32 = 3e-7;

/// A visible normal, not normalised, of the Beckmann distribution of roughness 1 seen from `(sin, 0, cos)`.
///
/// The slope towards the viewer has the distribution function
/// `cos (1 + erf x) + sin exp(-x^2) / sqrt(pi)` up to `x = cot` (Heitz and d'Eon 2014); it is inverted by Newton's method
/// in `b = erf x`, where it is nearly straight (Jakob 2014).
fn visible_beckmann(sin: f32, cos: f32, u: Vec2) -> Vec3 {
    let u = u.clamp(Vec2::splat(1e-6), Vec2::splat(1.0 - 1e-6));
    let tail = 0.5 * FRAC_2_SQRT_PI * sin;
    let cot = if sin > 0.0 { cos / sin } else { f32::INFINITY };
    let top = erf(cot);
    let target = u.x * (cos * (1.0 + top) + tail * (-cot * cot).exp());
    let (mut low, mut high) = (-1.0, top);
    // Exact at grazing incidence, where the function is most curved.
    let mut b = top - (top + 1.0) * erf((-u.x.ln()).sqrt());
    let mut x = erf_inverse(b);
    for _ in 0..4 {
        let error = cos * (1.0 + b) + tail * (-x * x).exp() - target;
        if error.abs() < CONVERGED {
            break;
        }
        if error > 0.0 {
            high = b;
        } else {
            low = b;
        }
        let next = b - error / (cos - x * sin);
        b = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        x = erf_inverse(b);
    }
    Vec3::new(-x, erf_inverse(2.0 * u.y - 1.0), 1.0)
}
