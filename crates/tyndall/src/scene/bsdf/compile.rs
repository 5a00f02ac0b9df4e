//! From descriptions to models.

use super::microfacet::Roughness;
use super::*;
use crate::scene::desc::{BsdfDesc, TextureDesc};
use crate::scene::texture::{Texture, TextureError};

/// Models within models within models: enough for any sane scene, and finite.
const MAX_NESTING: usize = 16;

/// Why a BSDF cannot be compiled. `index` is that of the description.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BsdfError {
    /// A texture is broken.
    #[error("BSDF {index}: {source}")]
    Texture {
        /// Which description.
        index: usize,
        /// What is wrong with it.
        source: TextureError,
    },
    /// A model refers to one that does not exist.
    #[error("BSDF {index} refers to BSDF {nested}, which does not exist")]
    Missing {
        /// Which description.
        index: usize,
        /// What it refers to.
        nested: usize,
    },
    /// A model contains itself, or models are nested too deeply.
    #[error("BSDF {index} contains itself or more than {MAX_NESTING} levels of other models")]
    Nesting {
        /// Which description.
        index: usize,
    },
    /// The refractive indices make no interface.
    #[error("BSDF {index}: refractive indices {int_ior} (interior) and {ext_ior} (exterior) must be positive{}",
            if *.must_differ { " and differ" } else { "" })]
    Ior {
        /// Which description.
        index: usize,
        /// Index inside.
        int_ior: f32,
        /// Index outside.
        ext_ior: f32,
        /// Whether equal indices are refused as well.
        must_differ: bool,
    },
    /// A number is infinite, not a number or out of range.
    #[error("BSDF {index}: {name} is {value}, expected {expected}")]
    Number {
        /// Which description.
        index: usize,
        /// Which parameter.
        name: &'static str,
        /// What it is.
        value: f32,
        /// What it may be.
        expected: &'static str,
    },
}

impl Bsdfs {
    /// Checks all descriptions and makes them ready; ids stay what they are.
    pub fn compile(descs: &[BsdfDesc]) -> Result<Self, BsdfError> {
        let models = descs
            .iter()
            .enumerate()
            .map(|(index, desc)| Compiler { index, count: descs.len() }.model(desc))
            .collect::<Result<Vec<_>, _>>()?;
        let traits = (0..models.len())
            .map(|index| traits(&models, index, 0).ok_or(BsdfError::Nesting { index }))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { models, traits })
    }
}

/// Compiles one description.
struct Compiler {
    index: usize,
    count: usize,
}

impl Compiler {
    fn model(&self, desc: &BsdfDesc) -> Result<Bsdf, BsdfError> {
        Ok(match desc {
            BsdfDesc::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance: self.texture(reflectance)? }),
            BsdfDesc::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                let eta = self.relative_ior(*int_ior, *ext_ior, false)?;
                Bsdf::Dielectric(Dielectric {
                    eta,
                    inverse_eta: 1.0 / eta,
                    specular_reflectance: self.texture(specular_reflectance)?,
                    specular_transmittance: self.texture(specular_transmittance)?,
                })
            }
            BsdfDesc::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                Bsdf::ThinDielectric(ThinDielectric {
                    eta: self.relative_ior(*int_ior, *ext_ior, false)?,
                    specular_reflectance: self.texture(specular_reflectance)?,
                    specular_transmittance: self.texture(specular_transmittance)?,
                })
            }
            BsdfDesc::RoughDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, roughness } => {
                let eta = self.relative_ior(*int_ior, *ext_ior, true)?;
                Bsdf::RoughDielectric(RoughDielectric {
                    eta,
                    inverse_eta: 1.0 / eta,
                    specular_reflectance: self.texture(specular_reflectance)?,
                    specular_transmittance: self.texture(specular_transmittance)?,
                    roughness: Roughness::new(roughness).map_err(|source| self.broken(source))?,
                })
            }
            BsdfDesc::Conductor { eta, k, specular_reflectance } => {
                Bsdf::Conductor(Conductor { metal: self.metal(eta, k, specular_reflectance)? })
            }
            BsdfDesc::RoughConductor { eta, k, specular_reflectance, roughness } => {
                Bsdf::RoughConductor(RoughConductor {
                    metal: self.metal(eta, k, specular_reflectance)?,
                    roughness: Roughness::new(roughness).map_err(|source| self.broken(source))?,
                })
            }
            BsdfDesc::Plastic { diffuse_reflectance, specular_reflectance, int_ior, ext_ior, nonlinear } => {
                Bsdf::Plastic(Plastic::new(
                    self.texture(diffuse_reflectance)?,
                    self.texture(specular_reflectance)?,
                    self.relative_ior(*int_ior, *ext_ior, false)?,
                    *nonlinear,
                ))
            }
            BsdfDesc::RoughPlastic {
                diffuse_reflectance,
                specular_reflectance,
                int_ior,
                ext_ior,
                nonlinear,
                distribution,
                alpha,
                sample_visible,
            } => Bsdf::RoughPlastic(RoughPlastic::new(
                self.texture(diffuse_reflectance)?,
                self.texture(specular_reflectance)?,
                self.relative_ior(*int_ior, *ext_ior, true)?,
                *nonlinear,
                *distribution,
                self.number("alpha", *alpha, 0.0)?,
                *sample_visible,
            )),
            BsdfDesc::Principled(desc) => {
                self.relative_ior(desc.eta, 1.0, false)?;
                self.number("diffuse_reflectance_sampling_rate", desc.diffuse_reflectance_sampling_rate, 0.0)?;
                self.number("main_specular_sampling_rate", desc.main_specular_sampling_rate, 0.0)?;
                self.number("clearcoat_sampling_rate", desc.clearcoat_sampling_rate, 0.0)?;
                Bsdf::Principled(Box::new(Principled::new(desc).map_err(|source| self.broken(source))?))
            }
            BsdfDesc::PrincipledThin(desc) => {
                self.number("diffuse_reflectance_sampling_rate", desc.diffuse_reflectance_sampling_rate, 0.0)?;
                self.number("specular_reflectance_sampling_rate", desc.specular_reflectance_sampling_rate, 0.0)?;
                self.number("specular_transmittance_sampling_rate", desc.specular_transmittance_sampling_rate, 0.0)?;
                self.number("diffuse_transmittance_sampling_rate", desc.diffuse_transmittance_sampling_rate, 0.0)?;
                Bsdf::PrincipledThin(Box::new(PrincipledThin::new(desc).map_err(|source| self.broken(source))?))
            }
            BsdfDesc::Null => Bsdf::Null,
            BsdfDesc::Mask { opacity, nested } => {
                Bsdf::Mask(Mask { opacity: self.texture(opacity)?, nested: self.nested(*nested)? })
            }
            BsdfDesc::TwoSided { front, back } => {
                Bsdf::TwoSided(TwoSided { front: self.nested(*front)?, back: self.nested(back.unwrap_or(*front))? })
            }
            BsdfDesc::Blend { weight, first, second } => Bsdf::Blend(Blend {
                weight: self.texture(weight)?,
                first: self.nested(*first)?,
                second: self.nested(*second)?,
            }),
            BsdfDesc::BumpMap { height, scale, flip_invalid_normals, use_shadowing_function, nested } => {
                let scale = self.number("scale", *scale, f32::MIN)?;
                Bsdf::Perturbed(Perturbed {
                    relief: Relief::Heights { texture: self.texture(height)?, scale },
                    flip_invalid_normals: *flip_invalid_normals,
                    use_shadowing_function: *use_shadowing_function,
                    nested: self.nested(*nested)?,
                })
            }
            BsdfDesc::NormalMap { normals, flip_invalid_normals, use_shadowing_function, nested } => {
                Bsdf::Perturbed(Perturbed {
                    relief: Relief::Normals(self.texture(normals)?),
                    flip_invalid_normals: *flip_invalid_normals,
                    use_shadowing_function: *use_shadowing_function,
                    nested: self.nested(*nested)?,
                })
            }
        })
    }

    fn broken(&self, source: TextureError) -> BsdfError {
        BsdfError::Texture { index: self.index, source }
    }

    fn texture(&self, desc: &TextureDesc) -> Result<Texture, BsdfError> {
        Texture::compile(desc).map_err(|source| self.broken(source))
    }

    fn metal(
        &self,
        eta: &TextureDesc,
        k: &TextureDesc,
        specular_reflectance: &TextureDesc,
    ) -> Result<Metal, BsdfError> {
        let specular_reflectance = self.texture(specular_reflectance)?;
        Ok(Metal { eta: self.texture(eta)?, k: self.texture(k)?, specular_reflectance })
    }

    fn relative_ior(&self, int_ior: f32, ext_ior: f32, must_differ: bool) -> Result<f32, BsdfError> {
        let eta = int_ior / ext_ior;
        let good = int_ior > 0.0 && ext_ior > 0.0 && eta > 0.0 && eta.is_finite();
        if good && !(must_differ && eta == 1.0) {
            return Ok(eta);
        }
        Err(BsdfError::Ior { index: self.index, int_ior, ext_ior, must_differ })
    }

    fn number(&self, name: &'static str, value: f32, least: f32) -> Result<f32, BsdfError> {
        if value >= least && value.is_finite() {
            return Ok(value);
        }
        let expected = if least < 0.0 { "a finite number" } else { "a finite number, not negative" };
        Err(BsdfError::Number { index: self.index, name, value, expected })
    }

    fn nested(&self, id: BsdfId) -> Result<BsdfId, BsdfError> {
        if id.0 < self.count { Ok(id) } else { Err(BsdfError::Missing { index: self.index, nested: id.0 }) }
    }
}

/// The traits of a model; `None` when it is nested too deeply.
fn traits(models: &[Bsdf], index: usize, depth: usize) -> Option<Traits> {
    if depth > MAX_NESTING {
        return None;
    }
    let nested = |id: BsdfId| traits(models, id.0, depth + 1);
    let smooth = |varies| Traits { smooth: true, diffuse: true, varies, ..Traits::default() };
    let glossy = |varies| Traits { glossy: true, ..smooth(varies) };
    Some(match &models[index] {
        Bsdf::Diffuse(model) => smooth(model.reflectance.varies()),
        Bsdf::Dielectric(model) => Traits {
            delta: true,
            transmits: true,
            varies: model.specular_reflectance.varies() || model.specular_transmittance.varies(),
            ..Traits::default()
        },
        Bsdf::ThinDielectric(model) => Traits {
            delta: true,
            varies: model.specular_reflectance.varies() || model.specular_transmittance.varies(),
            ..Traits::PURELY_NULL
        },
        Bsdf::RoughDielectric(model) => Traits {
            diffuse: false,
            transmits: true,
            ..smooth(
                model.specular_reflectance.varies()
                    || model.specular_transmittance.varies()
                    || model.roughness.varies(),
            )
        },
        Bsdf::Conductor(model) => Traits { delta: true, varies: model.metal.varies(), ..Traits::default() },
        Bsdf::RoughConductor(model) => glossy(model.metal.varies() || model.roughness.varies()),
        Bsdf::Plastic(model) => Traits { delta: true, ..smooth(model.varies()) },
        Bsdf::RoughPlastic(model) => glossy(model.varies()),
        Bsdf::Principled(model) => Traits { transmits: model.transmits(), ..glossy(model.varies()) },
        Bsdf::PrincipledThin(model) => Traits { transmits: model.transmits(), ..glossy(model.varies()) },
        Bsdf::Null => Traits::PURELY_NULL,
        Bsdf::Mask(model) => {
            let varies = model.opacity.varies();
            nested(model.nested)?.union(Traits { varies, ..Traits::PURELY_NULL })
        }
        Bsdf::TwoSided(model) => nested(model.front)?.union(nested(model.back)?),
        Bsdf::Blend(model) => {
            let varies = model.weight.varies();
            nested(model.first)?.union(nested(model.second)?).union(Traits { varies, ..Traits::default() })
        }
        Bsdf::Perturbed(model) => {
            nested(model.nested)?.union(Traits { varies: model.relief.varies(), ..Traits::default() })
        }
    })
}
