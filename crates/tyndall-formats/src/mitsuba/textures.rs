//! Textures and colours.

use super::properties::{Bag, Property, Value};
use super::source::{Place, SceneError};
use super::xml::Node;
use super::{Reader, spectra};
use tyndall::math::Transform;
use tyndall::scene::desc::{Filter, Rgb, TextureDesc, Wrap};

const KNOWN: &[&str] = &[
    "bitmap",
    "checkerboard",
    "mesh_attribute",
    "blackbody",
    "d65",
    "irregular",
    "rawconstant",
    "regular",
    "srgb",
    "uniform",
];
const UNSUPPORTED: &[&str] = &["volume", "scale", "gridtexture", "vertexcolors", "wireframe", "curvature", "test"];

pub(super) const FILTERS: &[(&str, Filter)] = &[
    ("bilinear", Filter::Linear),
    ("trilinear", Filter::Linear),
    ("ewa", Filter::Linear),
    ("nearest", Filter::Nearest),
];
pub(super) const WRAPS: &[(&str, Wrap)] = &[("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];

/// What a colour is a colour of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Share of the light, in `[0, 1]`.
    Reflectance,
    /// 1/m: not negative.
    Extinction,
    /// Any number.
    Unbounded,
    /// Emitted light.
    Emission,
}

impl<'t> Reader<'t> {
    /// The texture, colour or number `name`.
    pub(super) fn texture(
        &mut self,
        bag: &Bag<'t>,
        name: &'static str,
        default: f32,
        quantity: Quantity,
    ) -> Result<TextureDesc, SceneError> {
        match bag.find(name) {
            Some(property) => self.texture_value(property, quantity),
            None => Ok(TextureDesc::grey(default)),
        }
    }

    /// The colour or number `name`, the same everywhere.
    pub(super) fn color(
        &mut self,
        bag: &Bag<'t>,
        name: &'static str,
        default: f32,
        quantity: Quantity,
    ) -> Result<Rgb, SceneError> {
        match bag.find(name) {
            Some(property) => self.color_value(property, quantity),
            None => Ok([default; 3]),
        }
    }

    pub(super) fn color_value(&mut self, property: &Property<'t>, quantity: Quantity) -> Result<Rgb, SceneError> {
        match self.texture_value(property, quantity)? {
            TextureDesc::Constant(rgb) => Ok(rgb),
            _ => Err(property.wrong("a number or colour, the same everywhere")),
        }
    }

    fn texture_value(&mut self, property: &Property<'t>, quantity: Quantity) -> Result<TextureDesc, SceneError> {
        let place = &property.place;
        let grey = |value: f64| Ok([super::numbers::narrow([value], place)?[0]; 3]);
        let rgb = match &property.value {
            Value::Object(node) if node.family() == "texture" => return self.texture_plugin(node, quantity),
            Value::Float(value) => grey(*value)?,
            Value::Integer(value) => grey(*value as f64)?,
            Value::Rgb(rgb) => {
                self.check_rgb(*rgb, quantity, place)?;
                *rgb
            }
            Value::Flat(value) if quantity == Quantity::Emission => {
                super::numbers::narrow(spectra::EQUAL_ENERGY.map(|c| c * value), place)?
            }
            Value::Flat(value) => grey(*value)?,
            Value::Wavelengths(pairs) => self.wavelengths(pairs, quantity, place)?,
            Value::SpectrumFile(file) => {
                let path = self.file(file)?;
                let text = std::fs::read_to_string(&path)
                    .map_err(|e| place.error(format!("cannot read \"{}\": {e}", file.value)))?;
                let pairs = super::numbers::spd(&text, &file.value, place)?;
                self.wavelengths(&pairs, quantity, place)?
            }
            Value::Blackbody(temperature, factor) => spectra::blackbody(*temperature, 360.0, 830.0)
                .and_then(|rgb| super::numbers::narrow(rgb.map(|c| c * factor), place).ok())
                .ok_or_else(|| place.error(format!("temperature {temperature}, expected one below 1e8")))?,
            _ => return Err(property.wrong("a number, colour, spectrum or texture")),
        };
        Ok(TextureDesc::Constant(rgb))
    }

    fn check_rgb(&mut self, rgb: Rgb, quantity: Quantity, place: &Place) -> Result<(), SceneError> {
        let [r, g, b] = rgb;
        let outside = rgb.iter().any(|c| !(0.0..=1.0).contains(c));
        match quantity {
            Quantity::Reflectance if outside => {
                Err(place.error(format!("colour {r}, {g}, {b}, expected numbers in [0, 1]")))
            }
            Quantity::Extinction if outside && rgb.iter().all(|c| *c >= 0.0) => {
                self.warn(
                    place,
                    "Mitsuba refuses an extinction colour above 1; there, write it as sigma_t times scale",
                );
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn wavelengths(&mut self, pairs: &[[f64; 2]], quantity: Quantity, place: &Place) -> Result<Rgb, SceneError> {
        let illuminant =
            if quantity == Quantity::Emission { spectra::Illuminant::Equal } else { spectra::Illuminant::D65 };
        let rgb = spectra::from_wavelengths(pairs, illuminant);
        if quantity == Quantity::Extinction && rgb.iter().any(|c| *c > 1.0) {
            self.warn(place, "Mitsuba clamps extinction spectra to 1; there, write it as sigma_t times scale");
        }
        let rgb = if quantity == Quantity::Reflectance { rgb.map(|c| c.min(1.0)) } else { rgb };
        super::numbers::narrow(rgb, place)
    }

    /// A `<texture>` or `<spectrum>` plugin.
    pub(super) fn texture_plugin(&mut self, node: &'t Node, quantity: Quantity) -> Result<TextureDesc, SceneError> {
        let bag = self.open(node)?;
        let texture = match bag.plugin {
            "bitmap" => self.bitmap(&bag)?,
            "checkerboard" => TextureDesc::Checkerboard {
                color0: Box::new(self.texture(&bag, "color0", 0.4, quantity)?),
                color1: Box::new(self.texture(&bag, "color1", 0.2, quantity)?),
                to_uv: to_uv(&bag)?,
            },
            "mesh_attribute" => {
                TextureDesc::MeshAttribute { name: attribute_name(&bag)?, scale: bag.float("scale", 1.0)? }
            }
            _ => TextureDesc::Constant(self.spectrum_plugin(&bag, quantity)?),
        };
        self.close(&bag)?;
        Ok(texture)
    }

    fn bitmap(&mut self, bag: &Bag<'t>) -> Result<TextureDesc, SceneError> {
        let filename = bag.required_text("filename")?;
        let mut raw = bag.boolean("raw", false)?;
        if bag.node.old {
            bag.ignore(&["cache", "max_anisotropy"]);
            raw |= match bag.number("gamma")? {
                Some((1.0, _)) => true,
                Some((gamma, place)) if gamma > 0.0 => {
                    return Err(place.error(format!("gamma {gamma}, expected 1 (linear) or -1 (sRGB)")));
                }
                _ => false,
            };
        }
        bag.choice("format", &[("auto", ()), ("variant", ()), ("fp16", ())], ())?;
        bag.ignore(&["accel"]);
        let path = self.file(filename)?;
        Ok(TextureDesc::Bitmap {
            image: self.assets.image(&path, raw).map_err(|e| filename.place.error(e))?,
            filter: bag.choice("filter_type", FILTERS, Filter::Linear)?,
            wrap: bag.choice("wrap_mode", WRAPS, Wrap::Repeat)?,
            to_uv: to_uv(bag)?,
        })
    }

    fn spectrum_plugin(&mut self, bag: &Bag<'t>, quantity: Quantity) -> Result<Rgb, SceneError> {
        match bag.plugin {
            "blackbody" => {
                let Some((temperature, place)) = bag.number("temperature")? else {
                    return Err(bag.missing("temperature"));
                };
                let from = bag.double("wavelength_min", 360.0)?;
                let to = bag.double("wavelength_max", 830.0)?;
                spectra::blackbody(temperature, from, to)
                    .and_then(|rgb| super::numbers::narrow(rgb, place).ok())
                    .ok_or_else(|| {
                        place.error(format!("temperature {temperature}, expected one above 0 and below 1e8"))
                    })
            }
            "d65" => {
                let color = match bag.find("color") {
                    Some(property) => self.color_value(property, Quantity::Emission)?,
                    None => [1.0; 3],
                };
                let scale = bag.float("scale", 1.0)?;
                Ok(color.map(|c| c * scale))
            }
            "uniform" => {
                bag.ignore(&["wavelength_min", "wavelength_max"]);
                if bag.find("value").is_none() {
                    return Err(bag.missing("value"));
                }
                Ok([bag.float("value", 0.0)?; 3])
            }
            "rawconstant" => match bag.find("value") {
                Some(Property { value: Value::Vector(v), place, .. }) => super::numbers::narrow(*v, place),
                Some(_) => Ok([bag.float("value", 0.0)?; 3]),
                None => Err(bag.missing("value")),
            },
            "srgb" => {
                let unbounded = bag.boolean("unbounded", false)?;
                let quantity = if unbounded { Quantity::Unbounded } else { Quantity::Reflectance };
                match (bag.find("color"), bag.find("value")) {
                    (Some(property), None) | (None, Some(property)) => self.color_value(property, quantity),
                    (None, None) => Err(bag.missing("color")),
                    (_, Some(value)) => Err(value.place.error("\"value\" beside \"color\", expected either")),
                }
            }
            "regular" | "irregular" => {
                let (pairs, place) = sampled(bag)?;
                self.wavelengths(&pairs, quantity, &place)
            }
            _ => Err(bag.unknown(KNOWN, UNSUPPORTED)),
        }
    }
}

/// The pairs of a `regular` or `irregular` spectrum.
fn sampled(bag: &Bag) -> Result<(Vec<[f64; 2]>, Place), SceneError> {
    let text = bag.required_text("values")?;
    let values = super::numbers::list(&text.value, &text.place)?;
    let wavelengths = if bag.plugin == "irregular" {
        let text = bag.required_text("wavelengths")?;
        super::numbers::list(&text.value, &text.place)?
    } else {
        let Some((from, _)) = bag.number("wavelength_min")? else { return Err(bag.missing("wavelength_min")) };
        let Some((to, _)) = bag.number("wavelength_max")? else { return Err(bag.missing("wavelength_max")) };
        let last = values.len().saturating_sub(1).max(1) as f64;
        (0..values.len()).map(|i| from + (to - from) * i as f64 / last).collect()
    };
    if wavelengths.len() != values.len() {
        return Err(text.place.error(format!("{} values for {} wavelengths", values.len(), wavelengths.len())));
    }
    let pairs: Vec<[f64; 2]> = wavelengths.into_iter().zip(values).map(|(w, v)| [w, v]).collect();
    super::numbers::check_wavelengths(&pairs, &text.place)?;
    Ok((pairs, text.place.clone()))
}

fn attribute_name(bag: &Bag) -> Result<String, SceneError> {
    // The parameter shares its name with the attribute that names parameters.
    let name = bag.required_text("name")?;
    if !name.value.starts_with("vertex_") && !name.value.starts_with("face_") {
        return Err(name.place.error(format!("attribute \"{}\", expected vertex_... or face_...", name.value)));
    }
    Ok(name.value.clone())
}

/// The transform of texture coordinates; before version 2, four numbers.
fn to_uv(bag: &Bag) -> Result<Transform, SceneError> {
    if let Some((transform, _)) = bag.transform("to_uv")? {
        return Ok(transform);
    }
    if !bag.node.old {
        return Ok(Transform::IDENTITY);
    }
    let offset = [bag.double("uoffset", 0.0)?, bag.double("voffset", 0.0)?, 0.0];
    let scale = [bag.double("uscale", 1.0)?, bag.double("vscale", 1.0)?, 1.0];
    Ok(Transform::translate(offset).then(&Transform::scale(scale)))
}
