//! Surface scattering models as plain data.

use super::{BsdfId, TextureDesc};

/// Microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Microfacets {
    /// Beckmann.
    #[default]
    Beckmann,
    /// GGX (Trowbridge-Reitz).
    Ggx,
}

/// Roughness of a microfacet surface.
#[derive(Clone, Debug)]
pub struct RoughnessDesc {
    /// Distribution of the normals.
    pub distribution: Microfacets,
    /// Roughness along the tangent.
    pub alpha_u: TextureDesc,
    /// Roughness along the bitangent.
    pub alpha_v: TextureDesc,
    /// Sample only the visible normals.
    pub sample_visible: bool,
}

/// A surface scattering model. Parameters mean what they mean in Mitsuba 3.
#[derive(Clone, Debug)]
pub enum BsdfDesc {
    /// Lambert.
    Diffuse {
        /// Albedo.
        reflectance: TextureDesc,
    },
    /// Smooth interface between two dielectrics.
    Dielectric {
        /// Refractive index opposite to the normal.
        int_ior: f32,
        /// Refractive index on the side of the normal.
        ext_ior: f32,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Factor of the refraction.
        specular_transmittance: TextureDesc,
    },
    /// A thin sheet of glass: no bending.
    ThinDielectric {
        /// Refractive index of the sheet.
        int_ior: f32,
        /// Refractive index around it.
        ext_ior: f32,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Factor of the transmission.
        specular_transmittance: TextureDesc,
    },
    /// Rough interface between two dielectrics (Walter et al. 2007).
    RoughDielectric {
        /// Refractive index opposite to the normal.
        int_ior: f32,
        /// Refractive index on the side of the normal.
        ext_ior: f32,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Factor of the refraction.
        specular_transmittance: TextureDesc,
        /// Microfacets.
        roughness: RoughnessDesc,
    },
    /// Smooth metal.
    Conductor {
        /// Real part of the refractive index.
        eta: TextureDesc,
        /// Imaginary part; `eta` 0 and `k` 1 are a perfect mirror.
        k: TextureDesc,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
    },
    /// Rough metal.
    RoughConductor {
        /// Real part of the refractive index.
        eta: TextureDesc,
        /// Imaginary part; `eta` 0 and `k` 1 are a perfect mirror.
        k: TextureDesc,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Microfacets.
        roughness: RoughnessDesc,
    },
    /// Diffuse base under a smooth dielectric coat.
    Plastic {
        /// Albedo of the base.
        diffuse_reflectance: TextureDesc,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Refractive index of the coat.
        int_ior: f32,
        /// Refractive index around it.
        ext_ior: f32,
        /// Colour shifts of the internal reflections.
        nonlinear: bool,
    },
    /// Diffuse base under a rough dielectric coat.
    RoughPlastic {
        /// Albedo of the base.
        diffuse_reflectance: TextureDesc,
        /// Factor of the reflection.
        specular_reflectance: TextureDesc,
        /// Refractive index of the coat.
        int_ior: f32,
        /// Refractive index around it.
        ext_ior: f32,
        /// Colour shifts of the internal reflections.
        nonlinear: bool,
        /// Microfacet distribution of the coat.
        distribution: Microfacets,
        /// Isotropic roughness of the coat.
        alpha: f32,
        /// Sample only the visible normals.
        sample_visible: bool,
    },
    /// Burley's principled model (2012, 2015).
    Principled(Box<PrincipledDesc>),
    /// Burley's principled model for thin sheets.
    PrincipledThin(Box<PrincipledThinDesc>),
    /// An index-matched boundary.
    Null,
    /// A surface that is there with probability `opacity`.
    Mask {
        /// 1 = there, 0 = not there.
        opacity: TextureDesc,
        /// The surface.
        nested: BsdfId,
    },
    /// Makes reflecting models work on both sides.
    TwoSided {
        /// On the side of the normal.
        front: BsdfId,
        /// On the other side; the front model when `None`.
        back: Option<BsdfId>,
    },
    /// `(1 - weight) * first + weight * second`.
    Blend {
        /// Share of `second`.
        weight: TextureDesc,
        /// First model.
        first: BsdfId,
        /// Second model.
        second: BsdfId,
    },
    /// Perturbs the normal by the gradient of a height field.
    BumpMap {
        /// Heights.
        height: TextureDesc,
        /// Factor of the heights.
        scale: f32,
        /// Flips perturbed normals that face away.
        flip_invalid_normals: bool,
        /// Softens the terminator (Estevez et al. 2019).
        use_shadowing_function: bool,
        /// The surface.
        nested: BsdfId,
    },
    /// Takes the normal from a picture (value 0.5 = 0).
    NormalMap {
        /// Encoded normals.
        normals: TextureDesc,
        /// Flips perturbed normals that face away.
        flip_invalid_normals: bool,
        /// Softens the terminator (Estevez et al. 2019).
        use_shadowing_function: bool,
        /// The surface.
        nested: BsdfId,
    },
}

/// Parameters of [`BsdfDesc::Principled`].
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names are Burley's")]
pub struct PrincipledDesc {
    pub base_color: TextureDesc,
    pub roughness: TextureDesc,
    pub anisotropic: TextureDesc,
    pub metallic: TextureDesc,
    pub spec_trans: TextureDesc,
    /// Refractive index; derived from `specular` when that is given in a file.
    pub eta: f32,
    pub spec_tint: TextureDesc,
    pub sheen: TextureDesc,
    pub sheen_tint: TextureDesc,
    pub flatness: TextureDesc,
    pub clearcoat: TextureDesc,
    pub clearcoat_gloss: TextureDesc,
    pub diffuse_reflectance_sampling_rate: f32,
    pub main_specular_sampling_rate: f32,
    pub clearcoat_sampling_rate: f32,
}

/// Parameters of [`BsdfDesc::PrincipledThin`].
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names are Burley's")]
pub struct PrincipledThinDesc {
    pub base_color: TextureDesc,
    pub roughness: TextureDesc,
    pub anisotropic: TextureDesc,
    pub spec_trans: TextureDesc,
    pub eta: TextureDesc,
    pub spec_tint: TextureDesc,
    pub sheen: TextureDesc,
    pub sheen_tint: TextureDesc,
    pub flatness: TextureDesc,
    pub diff_trans: TextureDesc,
    pub diffuse_reflectance_sampling_rate: f32,
    pub specular_reflectance_sampling_rate: f32,
    pub specular_transmittance_sampling_rate: f32,
    pub diffuse_transmittance_sampling_rate: f32,
}
