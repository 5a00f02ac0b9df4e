//! Every model, tried with the same parameters by every test.

mod energy;
mod mitsuba;
mod robustness;
mod sampling;

use super::*;
use crate::math::{Frame, Transform};
use crate::scene::desc::{
    BsdfDesc, Filter, ImageDesc, Microfacets, PrincipledDesc, PrincipledThinDesc, RoughnessDesc, TextureDesc, Wrap,
};
use crate::scene::shape::SurfacePoint;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex};

const BECKMANN: Microfacets = Microfacets::Beckmann;
const GGX: Microfacets = Microfacets::Ggx;

fn grey(value: f32) -> TextureDesc {
    TextureDesc::grey(value)
}

fn rgb(r: f32, g: f32, b: f32) -> TextureDesc {
    TextureDesc::Constant([r, g, b])
}

fn rough(distribution: Microfacets, alpha_u: f32, alpha_v: f32, sample_visible: bool) -> RoughnessDesc {
    RoughnessDesc { distribution, alpha_u: grey(alpha_u), alpha_v: grey(alpha_v), sample_visible }
}

fn copper(roughness: RoughnessDesc, specular_reflectance: TextureDesc) -> BsdfDesc {
    let (eta, k) = (rgb(0.2, 0.92, 1.1), rgb(3.9, 2.45, 2.14));
    BsdfDesc::RoughConductor { eta, k, specular_reflectance, roughness }
}

fn glass(int_ior: f32, ext_ior: f32, tints: [TextureDesc; 2], roughness: RoughnessDesc) -> BsdfDesc {
    let [specular_reflectance, specular_transmittance] = tints;
    BsdfDesc::RoughDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, roughness }
}

fn rough_plastic(int_ior: f32, colors: [TextureDesc; 2], coat: (Microfacets, f32, bool), nonlinear: bool) -> BsdfDesc {
    let [diffuse_reflectance, specular_reflectance] = colors;
    let (distribution, alpha, sample_visible) = coat;
    BsdfDesc::RoughPlastic {
        diffuse_reflectance,
        specular_reflectance,
        int_ior,
        ext_ior: 1.0,
        nonlinear,
        distribution,
        alpha,
        sample_visible,
    }
}

fn principled() -> PrincipledDesc {
    PrincipledDesc {
        base_color: rgb(0.6, 0.3, 0.1),
        roughness: grey(0.4),
        anisotropic: grey(0.0),
        metallic: grey(0.0),
        spec_trans: grey(0.0),
        // That of specular 0.5.
        eta: 2.0 / (1.0 - 0.04_f32.sqrt()) - 1.0,
        spec_tint: grey(0.0),
        sheen: grey(0.0),
        sheen_tint: grey(0.0),
        flatness: grey(0.0),
        clearcoat: grey(0.0),
        clearcoat_gloss: grey(0.0),
        diffuse_reflectance_sampling_rate: 1.0,
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
    }
}

fn principled_thin() -> PrincipledThinDesc {
    PrincipledThinDesc {
        base_color: rgb(0.6, 0.3, 0.1),
        roughness: grey(0.4),
        anisotropic: grey(0.0),
        spec_trans: grey(0.0),
        eta: grey(1.5),
        spec_tint: grey(0.0),
        sheen: grey(0.0),
        sheen_tint: grey(0.0),
        flatness: grey(0.0),
        diff_trans: grey(0.0),
        diffuse_reflectance_sampling_rate: 1.0,
        specular_reflectance_sampling_rate: 1.0,
        specular_transmittance_sampling_rate: 1.0,
        diffuse_transmittance_sampling_rate: 1.0,
    }
}

/// A 4x4 picture of heights.
fn heights() -> TextureDesc {
    let pixels = (0..16).map(|i| [((3 * (i % 4) + 5 * (i / 4)) % 7) as f32 / 10.0; 3]).collect();
    TextureDesc::Bitmap {
        image: Arc::new(ImageDesc { width: 4, height: 4, pixels }),
        filter: Filter::Linear,
        wrap: Wrap::Repeat,
        to_uv: Transform::IDENTITY,
    }
}

/// The models by name; the last description is the one meant.
fn case(name: &str) -> Vec<BsdfDesc> {
    let color = || rgb(0.2, 0.5, 0.8);
    let white = || [grey(1.0), grey(1.0)];
    let diffuse = || BsdfDesc::Diffuse { reflectance: color() };
    let metal = || copper(rough(GGX, 0.3, 0.3, true), grey(1.0));
    let (first, second) = (BsdfId(0), BsdfId(1));
    match name {
        "diffuse" => vec![diffuse()],
        "roughdielectric-beckmann" => {
            vec![glass(1.5, 1.0, [grey(1.0), rgb(0.9, 0.5, 0.7)], rough(BECKMANN, 0.3, 0.3, true))]
        }
        "roughdielectric-ggx" => vec![glass(1.33, 1.1, [rgb(0.3, 0.8, 1.0), grey(1.0)], rough(GGX, 0.2, 0.45, true))],
        "roughdielectric-all" => vec![glass(1.5, 1.0, white(), rough(BECKMANN, 0.25, 0.25, false))],
        "roughdielectric-all-ggx" => vec![glass(1.0, 1.4, white(), rough(GGX, 0.25, 0.1, false))],
        "roughconductor-beckmann" => vec![copper(rough(BECKMANN, 0.1, 0.4, true), grey(1.0))],
        "roughconductor-ggx" => vec![copper(rough(GGX, 0.3, 0.3, true), rgb(0.9, 0.5, 0.7))],
        "roughconductor-mirror" => vec![BsdfDesc::RoughConductor {
            eta: grey(0.0),
            k: grey(1.0),
            specular_reflectance: grey(1.0),
            roughness: rough(GGX, 0.05, 0.05, false),
        }],
        "roughconductor-all" => vec![copper(rough(BECKMANN, 0.5, 0.5, false), grey(1.0))],
        "plastic" => vec![BsdfDesc::Plastic {
            diffuse_reflectance: color(),
            specular_reflectance: grey(1.0),
            int_ior: 1.49,
            ext_ior: 1.0,
            nonlinear: false,
        }],
        "plastic-nonlinear" => vec![BsdfDesc::Plastic {
            diffuse_reflectance: color(),
            specular_reflectance: rgb(0.5, 0.6, 0.7),
            int_ior: 1.9,
            ext_ior: 1.0,
            nonlinear: true,
        }],
        "roughplastic-beckmann" => vec![rough_plastic(1.49, [color(), grey(1.0)], (BECKMANN, 0.1, true), false)],
        "roughplastic-ggx" => vec![rough_plastic(1.7, [color(), rgb(0.5, 0.6, 0.7)], (GGX, 0.3, true), true)],
        "roughplastic-all" => vec![rough_plastic(1.49, [grey(0.7), grey(1.0)], (BECKMANN, 0.4, false), false)],
        "principled-plain" => vec![BsdfDesc::Principled(Box::new(principled()))],
        "principled-metal" => vec![BsdfDesc::Principled(Box::new(PrincipledDesc {
            roughness: grey(0.5),
            metallic: grey(0.7),
            anisotropic: grey(0.6),
            spec_tint: grey(0.4),
            eta: 1.4,
            ..principled()
        }))],
        "principled-glass" => vec![BsdfDesc::Principled(Box::new(PrincipledDesc {
            roughness: grey(0.6),
            spec_trans: grey(0.8),
            eta: 1.4,
            main_specular_sampling_rate: 0.7,
            ..principled()
        }))],
        "principled-all" => vec![BsdfDesc::Principled(Box::new(PrincipledDesc {
            roughness: grey(0.45),
            metallic: grey(0.2),
            anisotropic: grey(0.3),
            spec_trans: grey(0.4),
            eta: 1.5,
            spec_tint: grey(0.5),
            sheen: grey(0.6),
            sheen_tint: grey(0.3),
            flatness: grey(0.4),
            clearcoat: grey(0.9),
            clearcoat_gloss: grey(0.2),
            ..principled()
        }))],
        "principledthin-plain" => {
            vec![BsdfDesc::PrincipledThin(Box::new(PrincipledThinDesc { diff_trans: grey(0.6), ..principled_thin() }))]
        }
        "principledthin-all" => vec![BsdfDesc::PrincipledThin(Box::new(PrincipledThinDesc {
            roughness: grey(0.5),
            anisotropic: grey(0.5),
            spec_trans: grey(0.6),
            eta: grey(1.4),
            spec_tint: grey(0.4),
            sheen: grey(0.7),
            sheen_tint: grey(0.5),
            flatness: grey(0.3),
            diff_trans: grey(1.2),
            diffuse_transmittance_sampling_rate: 0.5,
            ..principled_thin()
        }))],
        "mask" => vec![metal(), BsdfDesc::Mask { opacity: grey(0.3), nested: first }],
        "twosided" => vec![diffuse(), metal(), BsdfDesc::TwoSided { front: first, back: Some(second) }],
        "blend" => vec![diffuse(), metal(), BsdfDesc::Blend { weight: grey(0.3), first, second }],
        "bump" => vec![
            rough_plastic(1.49, [grey(0.7), grey(1.0)], (BECKMANN, 0.4, true), false),
            BsdfDesc::BumpMap {
                height: heights(),
                scale: 0.8,
                flip_invalid_normals: true,
                use_shadowing_function: true,
                nested: first,
            },
        ],
        "bump-bare" => vec![
            glass(1.5, 1.0, white(), rough(BECKMANN, 0.5, 0.5, true)),
            BsdfDesc::BumpMap {
                height: heights(),
                scale: 4.0,
                flip_invalid_normals: false,
                use_shadowing_function: false,
                nested: first,
            },
        ],
        "normalmap" => vec![
            copper(rough(BECKMANN, 0.2, 0.5, true), grey(1.0)),
            BsdfDesc::TwoSided { front: first, back: None },
            BsdfDesc::NormalMap {
                normals: rgb(0.8, 0.4, 0.75),
                flip_invalid_normals: true,
                use_shadowing_function: true,
                nested: second,
            },
        ],
        "dielectric" => vec![BsdfDesc::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: rgb(0.9, 0.5, 0.7),
            specular_transmittance: rgb(0.8, 0.9, 0.6),
        }],
        "dielectric-inverted" => vec![BsdfDesc::Dielectric {
            int_ior: 1.0,
            ext_ior: 1.33,
            specular_reflectance: grey(1.0),
            specular_transmittance: grey(1.0),
        }],
        "thindielectric" => vec![BsdfDesc::ThinDielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: grey(1.0),
            specular_transmittance: rgb(0.8, 0.9, 0.6),
        }],
        "conductor" => vec![BsdfDesc::Conductor {
            eta: rgb(0.2, 0.92, 1.1),
            k: rgb(3.9, 2.45, 2.14),
            specular_reflectance: rgb(0.9, 0.5, 0.7),
        }],
        _ => panic!("no case {name}"),
    }
}

/// The names of all cases with a density.
const SMOOTH: [&str; 26] = [
    "diffuse",
    "roughdielectric-beckmann",
    "roughdielectric-ggx",
    "roughdielectric-all",
    "roughdielectric-all-ggx",
    "roughconductor-beckmann",
    "roughconductor-ggx",
    "roughconductor-mirror",
    "roughconductor-all",
    "plastic",
    "plastic-nonlinear",
    "roughplastic-beckmann",
    "roughplastic-ggx",
    "roughplastic-all",
    "principled-plain",
    "principled-metal",
    "principled-glass",
    "principled-all",
    "principledthin-plain",
    "principledthin-all",
    "mask",
    "twosided",
    "blend",
    "bump",
    "bump-bare",
    "normalmap",
];

/// A compiled model at a fixed surface point.
struct Probe {
    bsdfs: Bsdfs,
    root: BsdfId,
    surface: SurfacePoint,
}

impl Probe {
    fn new(descs: &[BsdfDesc]) -> Self {
        let surface = SurfacePoint {
            position: Vec3::ZERO,
            normal: Vec3::Z,
            shading: Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z },
            uv: Vec2::new(0.3, 0.6),
            dp_du: Vec3::new(1.25, 0.0, 0.0),
            dp_dv: Vec3::new(0.25, 0.5, 0.0),
            shape: 0,
            triangle: 0,
            barycentrics: Vec2::ZERO,
            epsilon: 0.0,
        };
        Self { bsdfs: Bsdfs::compile(descs).unwrap(), root: BsdfId(descs.len() - 1), surface }
    }

    /// Compiled once for all tests: the tables of a rough plastic take a moment.
    fn named(name: &str) -> Self {
        static COMPILED: LazyLock<Mutex<HashMap<String, Bsdfs>>> = LazyLock::new(Mutex::default);
        let mut compiled = COMPILED.lock().unwrap();
        let bsdfs = compiled.entry(name.into()).or_insert_with(|| Bsdfs::compile(&case(name)).unwrap()).clone();
        Self { root: BsdfId(bsdfs.len() - 1), bsdfs, ..Self::new(&[BsdfDesc::Null]) }
    }

    fn context(&self) -> SurfaceContext<'_> {
        SurfaceContext::new(&self.surface, None)
    }

    fn sample(&self, wo: Vec3, transport: Transport, u1: f32, u2: Vec2) -> Option<BsdfSample> {
        self.bsdfs.sample(self.root, &self.context(), wo, transport, u1, u2)
    }

    fn eval(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Spectrum, f32) {
        let (value, pdf) = self.bsdfs.eval(self.root, &self.context(), wo, wi, transport);
        (value, pdf.0)
    }

    fn traits(&self) -> Traits {
        self.bsdfs.traits(self.root)
    }
}

/// Directions from both sides, upright and grazing.
fn directions() -> [Vec3; 4] {
    [
        Vec3::new(0.3, -0.2, 0.9).normalize(),
        Vec3::new(-0.9, 0.3, 0.12).normalize(),
        Vec3::new(0.4, 0.5, -0.7).normalize(),
        Vec3::new(-0.7, 0.6, -0.1).normalize(),
    ]
}
