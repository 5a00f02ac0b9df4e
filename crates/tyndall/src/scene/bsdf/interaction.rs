//! What goes into a BSDF and what comes out.

use crate::Spectrum;
use crate::math::{Frame, PerSolidAngle, Vec3};
use crate::scene::shape::{Mesh, SurfacePoint};
use crate::scene::texture::TexturePoint;

/// What a walk carries, hence what `f` means where refraction squeezes solid angles (Veach 1997, section 5.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// The walk comes from the camera; refraction carries `(eta_o / eta_i)^2`.
    Radiance,
    /// The walk comes from a light.
    Importance,
}

impl Transport {
    /// Factor of a refraction whose relative index is `eta` (index beyond the surface divided by index before it).
    #[inline(always)]
    pub(super) fn refraction_scale(self, eta: f32) -> f32 {
        match self {
            Self::Radiance => 1.0 / (eta * eta),
            Self::Importance => 1.0,
        }
    }
}

/// The surface at the point of scattering, as far as a BSDF asks.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceContext<'a> {
    /// Where textures are looked up.
    pub texture: TexturePoint<'a>,
    /// Geometry; the directions given to a BSDF are in its shading frame. Only bump and normal maps look at it.
    pub surface: &'a SurfacePoint,
}

impl<'a> SurfaceContext<'a> {
    /// The context of a surface point, which lies on `mesh` if it lies on a mesh.
    #[inline(always)]
    pub fn new(surface: &'a SurfacePoint, mesh: Option<&'a Mesh>) -> Self {
        Self { texture: TexturePoint::new(surface, mesh), surface }
    }

    /// The shading frame.
    #[inline(always)]
    pub(super) fn shading(&self) -> &Frame {
        &self.surface.shading
    }
}

/// What kind of scattering was sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// To the other side of the surface.
    pub transmission: bool,
    /// From a discrete set of directions: `pdf` is zero and no other technique finds the direction.
    pub delta: bool,
    /// Straight through as if there were no surface; `delta` and `transmission` hold as well.
    pub null: bool,
    /// Refractive index of the side entered divided by that of the side left; 1 unless refracted.
    pub eta: f32,
}

impl Event {
    /// Reflection into a lobe.
    pub const REFLECTION: Self = Self { transmission: false, delta: false, null: false, eta: 1.0 };
    /// Mirror reflection.
    pub const DELTA_REFLECTION: Self = Self { delta: true, ..Self::REFLECTION };
    /// Straight through.
    pub const NULL: Self = Self { transmission: true, delta: true, null: true, eta: 1.0 };

    /// Transmission into a lobe across an interface of relative index `eta`.
    #[inline(always)]
    pub const fn transmission(eta: f32) -> Self {
        Self { transmission: true, eta, ..Self::REFLECTION }
    }

    /// Refraction into one direction across an interface of relative index `eta`.
    #[inline(always)]
    pub const fn delta_transmission(eta: f32) -> Self {
        Self { transmission: true, delta: true, null: false, eta }
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction, local, pointing away from the surface.
    pub wi: Vec3,
    /// `f |cos| / pdf`, with the probability of the lobe in the density.
    pub weight: Spectrum,
    /// Density of `wi` over all lobes that are not delta; zero for a delta event.
    pub pdf: PerSolidAngle,
    /// What happened.
    pub event: Event,
}

impl BsdfSample {
    /// A sample of a delta lobe.
    #[inline(always)]
    pub(super) fn delta(wi: Vec3, weight: Spectrum, event: Event) -> Self {
        Self { wi, weight, pdf: PerSolidAngle(0.0), event }
    }

    /// A direction with the `f |cos|` and density found there; `None` when it carries nothing.
    #[inline(always)]
    pub(super) fn evaluated(wi: Vec3, (value, pdf): (Spectrum, PerSolidAngle), event: Event) -> Option<Self> {
        (pdf.0 > 0.0).then(|| Self { wi, weight: value / pdf.0, pdf, event })
    }
}

/// Bounds `f |cos(wi)|` over all `wi`, for one `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ceiling {
    /// The bound, 1/sr.
    pub value: Spectrum,
    /// Whether `value |cos(wi)|` is a bound as well, and nothing goes to the other side of the surface.
    pub cosine: bool,
    /// Whether that is no bound but the value itself on the side of `wo`.
    pub exact: bool,
}

impl Ceiling {
    /// Nothing is scattered.
    pub const NOTHING: Self = Self { value: Spectrum::ZERO, cosine: true, exact: true };

    /// The bound `value |cos(wi)|`.
    #[inline(always)]
    pub(super) fn cosine(value: Spectrum) -> Self {
        Self { value, cosine: true, exact: false }
    }
}

/// What can be known of a BSDF without a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traits {
    /// Some scattering has a density: `eval` may be positive and light sampling is worth it.
    pub smooth: bool,
    /// Some of that is wide enough for photons that arrive nearby to tell what is seen: all but rough glass.
    pub diffuse: bool,
    /// Some of that is a rough reflection, which a few photons say little of: one of a grazing direction may outweigh all others.
    pub glossy: bool,
    /// Some scattering goes into discrete directions other than straight on.
    pub delta: bool,
    /// Some light goes straight through as if there were no surface.
    pub null: bool,
    /// Some light gets to the other side, straight through included.
    pub transmits: bool,
    /// The model looks at texture coordinates, mesh attributes or the tangent.
    pub varies: bool,
}

impl Traits {
    /// A boundary without any scattering.
    pub const PURELY_NULL: Self =
        Self { smooth: false, diffuse: false, glossy: false, delta: false, null: true, transmits: true, varies: false };

    /// Whether light only ever goes straight through.
    #[inline(always)]
    pub fn is_purely_null(&self) -> bool {
        self.null && !self.smooth && !self.delta
    }

    /// What holds of either.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            smooth: self.smooth | other.smooth,
            diffuse: self.diffuse | other.diffuse,
            glossy: self.glossy | other.glossy,
            delta: self.delta | other.delta,
            null: self.null | other.null,
            transmits: self.transmits | other.transmits,
            varies: self.varies | other.varies,
        }
    }
}
