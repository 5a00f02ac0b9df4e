//! Surface scattering models.

use super::properties::{Bag, Value};
use super::source::{SceneError, advise};
use super::textures::Quantity::{self, Reflectance, Unbounded};
use super::xml::Node;
use super::{Reader, metals};
use tyndall::scene::desc::{
    BsdfDesc, BsdfId, Microfacets, PrincipledDesc, PrincipledThinDesc, RoughnessDesc, TextureDesc,
};

const KNOWN: &[&str] = &[
    "diffuse",
    "dielectric",
    "thindielectric",
    "roughdielectric",
    "conductor",
    "roughconductor",
    "plastic",
    "roughplastic",
    "principled",
    "principledthin",
    "null",
    "mask",
    "twosided",
    "blendbsdf",
    "bumpmap",
    "normalmap",
];
const UNSUPPORTED: &[&str] = &[
    "hair",
    "measured",
    "measured_polarized",
    "pplastic",
    "polarizer",
    "retarder",
    "circular",
    "coating",
    "roughcoating",
    "mixturebsdf",
    "phong",
    "ward",
    "difftrans",
    "hk",
    "irawan",
    "roughdiffuse",
];

/// Refractive indices by name, in lower case.
const IORS: &[(&str, f32)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];
const AIR: f32 = 1.000_277;
const BK7: f32 = 1.5046;
const POLYPROPYLENE: f32 = 1.49;

impl<'t> Reader<'t> {
    /// The model, read once however often it is referred to.
    pub(super) fn bsdf(&mut self, node: &'t Node) -> Result<BsdfId, SceneError> {
        if let Some(id) = self.bsdfs.get(&node.index) {
            return Ok(*id);
        }
        let bag = self.open(node)?;
        let bsdf = match bag.plugin {
            "diffuse" => BsdfDesc::Diffuse { reflectance: self.texture(&bag, "reflectance", 0.5, Reflectance)? },
            "dielectric" => BsdfDesc::Dielectric {
                int_ior: ior(&bag, "int_ior", BK7)?,
                ext_ior: ior(&bag, "ext_ior", AIR)?,
                specular_reflectance: self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?,
                specular_transmittance: self.texture(&bag, "specular_transmittance", 1.0, Reflectance)?,
            },
            "thindielectric" => BsdfDesc::ThinDielectric {
                int_ior: ior(&bag, "int_ior", BK7)?,
                ext_ior: ior(&bag, "ext_ior", AIR)?,
                specular_reflectance: self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?,
                specular_transmittance: self.texture(&bag, "specular_transmittance", 1.0, Reflectance)?,
            },
            "roughdielectric" => BsdfDesc::RoughDielectric {
                int_ior: ior(&bag, "int_ior", BK7)?,
                ext_ior: ior(&bag, "ext_ior", AIR)?,
                specular_reflectance: self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?,
                specular_transmittance: self.texture(&bag, "specular_transmittance", 1.0, Reflectance)?,
                roughness: self.roughness(&bag)?,
            },
            "conductor" => {
                let (eta, k) = self.metal(&bag)?;
                let specular_reflectance = self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?;
                BsdfDesc::Conductor { eta, k, specular_reflectance }
            }
            "roughconductor" => {
                let (eta, k) = self.metal(&bag)?;
                let specular_reflectance = self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?;
                BsdfDesc::RoughConductor { eta, k, specular_reflectance, roughness: self.roughness(&bag)? }
            }
            "plastic" => BsdfDesc::Plastic {
                diffuse_reflectance: self.texture(&bag, "diffuse_reflectance", 0.5, Reflectance)?,
                specular_reflectance: self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?,
                int_ior: ior(&bag, "int_ior", POLYPROPYLENE)?,
                ext_ior: ior(&bag, "ext_ior", AIR)?,
                nonlinear: bag.boolean("nonlinear", false)?,
            },
            "roughplastic" => BsdfDesc::RoughPlastic {
                diffuse_reflectance: self.texture(&bag, "diffuse_reflectance", 0.5, Reflectance)?,
                specular_reflectance: self.texture(&bag, "specular_reflectance", 1.0, Reflectance)?,
                int_ior: ior(&bag, "int_ior", POLYPROPYLENE)?,
                ext_ior: ior(&bag, "ext_ior", AIR)?,
                nonlinear: bag.boolean("nonlinear", false)?,
                distribution: distribution(&bag)?,
                alpha: bag.checked("alpha", 0.1, |a| a > 0.0, "a number above 0")?,
                sample_visible: bag.boolean("sample_visible", true)?,
            },
            "principled" => BsdfDesc::Principled(Box::new(self.principled(&bag)?)),
            "principledthin" => BsdfDesc::PrincipledThin(Box::new(self.principled_thin(&bag)?)),
            "null" => BsdfDesc::Null,
            "mask" => BsdfDesc::Mask {
                opacity: self.texture(&bag, "opacity", 0.5, Reflectance)?,
                nested: self.one_nested(&bag)?,
            },
            "twosided" => {
                if bag.boolean("allow_transmission", false)? {
                    return Err(bag.place().error("allow_transmission is not supported, expected false"));
                }
                let mut sides = Vec::new();
                for (property, node) in bag.children("bsdf") {
                    let side = self.bsdf(node)?;
                    if self.transmits(side) {
                        return Err(property.place.error(format!("bsdf \"twosided\" around one that transmits light (\"{}\"), expected one that only reflects", node.required("type")?.value)));
                    }
                    sides.push(side);
                }
                match sides.as_slice() {
                    [front] => BsdfDesc::TwoSided { front: *front, back: None },
                    [front, back] => BsdfDesc::TwoSided { front: *front, back: Some(*back) },
                    other => return Err(wrong_count(&bag, other.len(), "1 or 2")),
                }
            }
            "blendbsdf" => {
                if bag.find("weight").is_none() {
                    return Err(bag.missing("weight"));
                }
                let weight = self.texture(&bag, "weight", 0.5, Reflectance)?;
                match self.nested(&bag)?.as_slice() {
                    [first, second] => BsdfDesc::Blend { weight, first: *first, second: *second },
                    other => return Err(wrong_count(&bag, other.len(), "2")),
                }
            }
            "bumpmap" => BsdfDesc::BumpMap {
                height: self.nested_texture(&bag)?,
                scale: bag.float("scale", 1.0)?,
                flip_invalid_normals: bag.boolean("flip_invalid_normals", true)?,
                use_shadowing_function: bag.boolean("use_shadowing_function", true)?,
                nested: self.one_nested(&bag)?,
            },
            "normalmap" => BsdfDesc::NormalMap {
                normals: self.nested_texture(&bag)?,
                flip_invalid_normals: bag.boolean("flip_invalid_normals", true)?,
                use_shadowing_function: bag.boolean("use_shadowing_function", true)?,
                nested: self.one_nested(&bag)?,
            },
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        };
        self.close(&bag)?;
        let id = BsdfId(self.scene.bsdfs.len());
        self.scene.bsdfs.push(bsdf);
        self.bsdfs.insert(node.index, id);
        Ok(id)
    }

    /// Whether light may pass, whatever its share.
    fn transmits(&self, bsdf: BsdfId) -> bool {
        match &self.scene.bsdfs[bsdf.0] {
            BsdfDesc::Dielectric { .. }
            | BsdfDesc::ThinDielectric { .. }
            | BsdfDesc::RoughDielectric { .. }
            | BsdfDesc::PrincipledThin(_)
            | BsdfDesc::Null
            | BsdfDesc::Mask { .. } => true,
            BsdfDesc::Principled(p) => !matches!(p.spec_trans, TextureDesc::Constant([0.0, 0.0, 0.0])),
            BsdfDesc::Blend { first, second, .. } => self.transmits(*first) || self.transmits(*second),
            BsdfDesc::BumpMap { nested, .. } | BsdfDesc::NormalMap { nested, .. } => self.transmits(*nested),
            BsdfDesc::Diffuse { .. }
            | BsdfDesc::Conductor { .. }
            | BsdfDesc::RoughConductor { .. }
            | BsdfDesc::Plastic { .. }
            | BsdfDesc::RoughPlastic { .. }
            | BsdfDesc::TwoSided { .. } => false,
        }
    }

    fn nested(&mut self, bag: &Bag<'t>) -> Result<Vec<BsdfId>, SceneError> {
        bag.children("bsdf").into_iter().map(|(_, node)| self.bsdf(node)).collect()
    }

    fn one_nested(&mut self, bag: &Bag<'t>) -> Result<BsdfId, SceneError> {
        match self.nested(bag)?.as_slice() {
            [one] => Ok(*one),
            other => Err(wrong_count(bag, other.len(), "1")),
        }
    }

    /// The only texture, whatever its name.
    fn nested_texture(&mut self, bag: &Bag<'t>) -> Result<TextureDesc, SceneError> {
        match bag.child("texture")? {
            Some(node) => self.texture_plugin(node, Unbounded),
            None => Err(bag.place().error(format!("{} without a texture, expected one", bag.title()))),
        }
    }

    fn metal(&mut self, bag: &Bag<'t>) -> Result<(TextureDesc, TextureDesc), SceneError> {
        let Some(material) = bag.text("material")? else {
            return Ok((self.texture(bag, "eta", 0.0, Unbounded)?, self.texture(bag, "k", 1.0, Unbounded)?));
        };
        for name in ["eta", "k"] {
            if let Some(property) = bag.find(name) {
                return Err(property.place.error(format!("\"{name}\" beside \"material\", expected either")));
            }
        }
        let Some((eta, k)) = metals::index(&material.value) else {
            return Err(material.place.error_with_help(
                format!("unknown material \"{}\", expected a known one", material.value),
                advise(&material.value, "materials", &metals::names()),
            ));
        };
        Ok((TextureDesc::Constant(eta), TextureDesc::Constant(k)))
    }

    fn roughness(&mut self, bag: &Bag<'t>) -> Result<RoughnessDesc, SceneError> {
        for name in ["alpha", "alpha_u", "alpha_v"] {
            if let Some(property) = bag.find(name)
                && matches!(property.value, Value::Float(_) | Value::Integer(_))
            {
                bag.checked(name, 0.1, |a| a > 0.0, "a number above 0")?;
            }
        }
        let (alpha_u, alpha_v) = match (bag.find("alpha"), bag.find("alpha_u"), bag.find("alpha_v")) {
            (_, None, None) => {
                let alpha = self.texture(bag, "alpha", 0.1, Reflectance)?;
                (alpha.clone(), alpha)
            }
            (None, Some(_), Some(_)) => {
                (self.texture(bag, "alpha_u", 0.1, Reflectance)?, self.texture(bag, "alpha_v", 0.1, Reflectance)?)
            }
            (Some(alpha), ..) => {
                return Err(alpha.place.error("\"alpha\" beside \"alpha_u\" or \"alpha_v\", expected either"));
            }
            (None, ..) => return Err(bag.place().error("one of \"alpha_u\" and \"alpha_v\", expected both")),
        };
        let sample_visible = bag.boolean("sample_visible", true)?;
        Ok(RoughnessDesc { distribution: distribution(bag)?, alpha_u, alpha_v, sample_visible })
    }

    fn principled(&mut self, bag: &Bag<'t>) -> Result<PrincipledDesc, SceneError> {
        let eta = match (bag.find("eta"), bag.find("specular")) {
            (Some(_), Some(specular)) => {
                return Err(specular.place.error("\"specular\" beside \"eta\", expected either"));
            }
            (Some(_), None) => bag.checked("eta", 1.5, |eta| eta > 0.0, "a number above 0")?,
            // The reflectance at normal incidence is 0.08 specular (Burley 2015).
            _ => 2.0 / (1.0 - (0.08 * bag.checked("specular", 0.5, in_unit, "a number in [0, 1]")?).sqrt()) - 1.0,
        };
        let mut texture = |name, default| self.texture(bag, name, default, Quantity::Reflectance);
        Ok(PrincipledDesc {
            base_color: texture("base_color", 0.5)?,
            roughness: texture("roughness", 0.5)?,
            anisotropic: texture("anisotropic", 0.0)?,
            metallic: texture("metallic", 0.0)?,
            spec_trans: texture("spec_trans", 0.0)?,
            eta,
            spec_tint: texture("spec_tint", 0.0)?,
            sheen: texture("sheen", 0.0)?,
            sheen_tint: texture("sheen_tint", 0.0)?,
            flatness: texture("flatness", 0.0)?,
            clearcoat: texture("clearcoat", 0.0)?,
            clearcoat_gloss: texture("clearcoat_gloss", 0.0)?,
            diffuse_reflectance_sampling_rate: rate(bag, "diffuse_reflectance_sampling_rate")?,
            main_specular_sampling_rate: rate(bag, "main_specular_sampling_rate")?,
            clearcoat_sampling_rate: rate(bag, "clearcoat_sampling_rate")?,
        })
    }

    fn principled_thin(&mut self, bag: &Bag<'t>) -> Result<PrincipledThinDesc, SceneError> {
        let eta = self.texture(bag, "eta", 1.5, Unbounded)?;
        let mut texture = |name, default| self.texture(bag, name, default, Quantity::Reflectance);
        Ok(PrincipledThinDesc {
            base_color: texture("base_color", 0.5)?,
            roughness: texture("roughness", 0.5)?,
            anisotropic: texture("anisotropic", 0.0)?,
            spec_trans: texture("spec_trans", 0.0)?,
            eta,
            spec_tint: texture("spec_tint", 0.0)?,
            sheen: texture("sheen", 0.0)?,
            sheen_tint: texture("sheen_tint", 0.0)?,
            flatness: texture("flatness", 0.0)?,
            diff_trans: texture("diff_trans", 0.0)?,
            diffuse_reflectance_sampling_rate: rate(bag, "diffuse_reflectance_sampling_rate")?,
            specular_reflectance_sampling_rate: rate(bag, "specular_reflectance_sampling_rate")?,
            specular_transmittance_sampling_rate: rate(bag, "specular_transmittance_sampling_rate")?,
            diffuse_transmittance_sampling_rate: rate(bag, "diffuse_transmittance_sampling_rate")?,
        })
    }
}

fn in_unit(number: f32) -> bool {
    (0.0..=1.0).contains(&number)
}

fn rate(bag: &Bag, name: &'static str) -> Result<f32, SceneError> {
    bag.checked(name, 1.0, |rate| rate >= 0.0, "a number not below 0")
}

fn wrong_count(bag: &Bag, count: usize, expected: &str) -> SceneError {
    bag.place().error(format!("{} with {count} bsdf children, expected {expected}", bag.title()))
}

fn distribution(bag: &Bag) -> Result<Microfacets, SceneError> {
    let words = [("beckmann", Microfacets::Beckmann), ("ggx", Microfacets::Ggx)];
    bag.choice("distribution", &words, Microfacets::Beckmann)
}

/// A refractive index: a number or the name of a material.
fn ior(bag: &Bag, name: &'static str, default: f32) -> Result<f32, SceneError> {
    let Some(property) = bag.find(name) else { return Ok(default) };
    let Value::Text(text) = property.value else {
        return bag.checked(name, default, |ior| ior > 0.0, "a refractive index above 0");
    };
    let lower = text.value.to_lowercase();
    IORS.iter().find(|(known, _)| *known == lower).map(|(_, ior)| *ior).ok_or_else(|| {
        let names: Vec<&str> = IORS.iter().map(|(known, _)| *known).collect();
        text.place.error_with_help(
            format!("{name} \"{}\", expected a refractive index or the name of a material", text.value),
            advise(&text.value, "materials", &names),
        )
    })
}
