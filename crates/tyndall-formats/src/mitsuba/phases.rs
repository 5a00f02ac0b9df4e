//! Phase functions.

use super::Reader;
use super::properties::{Bag, Value};
use super::source::SceneError;
use super::textures::Quantity;
use super::xml::Node;
use tyndall::scene::desc::{PhaseDesc, VolumeDesc};

const KNOWN: &[&str] = &["isotropic", "hg", "rayleigh", "tabphase", "sggx", "blendphase"];
const UNSUPPORTED: &[&str] = &["tabphase_irregular", "kkay", "microflake", "mixturephase"];

impl<'t> Reader<'t> {
    pub(super) fn phase(&mut self, node: &'t Node) -> Result<PhaseDesc, SceneError> {
        let bag = self.open(node)?;
        let phase = match bag.plugin {
            "isotropic" => PhaseDesc::Isotropic,
            "rayleigh" => PhaseDesc::Rayleigh,
            "hg" => PhaseDesc::HenyeyGreenstein {
                g: bag.checked("g", 0.8, |g| g > -1.0 && g < 1.0, "a number between -1 and 1")?,
            },
            "tabphase" => PhaseDesc::Tabulated { values: table(&bag)? },
            "sggx" => {
                if bag.find("S").is_none() {
                    return Err(bag.missing("S"));
                }
                let matrix = self.volume(&bag, "S", 1.0, Quantity::Unbounded)?;
                match (&matrix, bag.find("S")) {
                    (VolumeDesc::Grid { grid, .. }, _) if grid.channels == 6 => {}
                    (_, Some(property)) => return Err(property.wrong("a grid volume of 6 channels")),
                    (_, None) => return Err(bag.missing("S")),
                }
                PhaseDesc::Sggx { matrix }
            }
            "blendphase" => {
                let weight = self.blend_weight(&bag)?;
                match bag.children("phase").as_slice() {
                    [(_, first), (_, second)] => PhaseDesc::Blend {
                        weight,
                        first: Box::new(self.phase(first)?),
                        second: Box::new(self.phase(second)?),
                    },
                    other => {
                        let count = other.len();
                        return Err(bag
                            .place()
                            .error(format!("{} with {count} phase children, expected 2", bag.title())));
                    }
                }
            }
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        };
        self.close(&bag)?;
        Ok(phase)
    }

    fn blend_weight(&mut self, bag: &Bag<'t>) -> Result<f32, SceneError> {
        let Some(property) = bag.find("weight") else { return Err(bag.missing("weight")) };
        match self.volume(bag, "weight", 0.5, Quantity::Reflectance)? {
            VolumeDesc::Constant { value: [w, g, b], .. } if w == g && w == b && (0.0..=1.0).contains(&w) => Ok(w),
            VolumeDesc::Constant { value: [w, ..], .. }
                if matches!(property.value, Value::Float(_) | Value::Integer(_)) =>
            {
                Err(property.place.error(format!("weight {w}, expected a number in [0, 1]")))
            }
            _ => Err(property.wrong("a number in [0, 1], the same everywhere")),
        }
    }
}

fn table(bag: &Bag) -> Result<Vec<f32>, SceneError> {
    let text = bag.required_text("values")?;
    let numbers = super::numbers::list(&text.value, &text.place)?;
    if numbers.len() < 2 {
        return Err(text.place.error(format!("{} values, expected at least 2", numbers.len())));
    }
    if let Some(negative) = numbers.iter().find(|v| **v < 0.0) {
        return Err(text.place.error(format!("value {negative}, expected none below 0")));
    }
    let values: Vec<f32> = numbers.into_iter().map(|v| v as f32).collect();
    if !values.iter().all(|v| v.is_finite()) || !values.iter().any(|v| *v > 0.0) {
        return Err(text.place.error("values that are all 0 or too large, expected some above 0"));
    }
    Ok(values)
}
