//! Emitters that are not shapes.

use super::Reader;
use super::numbers::perpendicular;
use super::properties::Bag;
use super::sensors::{FieldOfView, field_of_view};
use super::source::SceneError;
use super::textures::Quantity::{Emission, Unbounded};
use super::xml::Node;
use tyndall::math::Transform;
use tyndall::scene::desc::{EmitterDesc, EmitterKind, TextureDesc};

const KNOWN: &[&str] = &["area", "point", "spot", "directional", "constant", "envmap", "projector"];
const UNSUPPORTED: &[&str] =
    &["directionalarea", "sun", "sky", "sunsky", "timed_sunsky", "volumelight", "collimated", "bsphere"];

impl<'t> Reader<'t> {
    pub(super) fn emitter(&mut self, node: &'t Node) -> Result<EmitterDesc, SceneError> {
        let bag = self.open(node)?;
        let mut to_world = bag.to_world()?;
        let kind = match bag.plugin {
            "point" => {
                if let Some((position, place)) = bag.vector("position")? {
                    if bag.transform("to_world")?.is_some() {
                        return Err(place.error("\"position\" beside \"to_world\", expected either"));
                    }
                    to_world = Transform::translate(position);
                }
                EmitterKind::Point { intensity: self.color(&bag, "intensity", 1.0, Emission)? }
            }
            "spot" => {
                let cutoff_angle =
                    bag.checked("cutoff_angle", 20.0, |a| a > 0.0 && a <= 180.0, "degrees above 0, at most 180")?;
                let allowed = format!("degrees from 0 to the cutoff angle, {cutoff_angle}");
                EmitterKind::Spot {
                    intensity: self.color(&bag, "intensity", 1.0, Emission)?,
                    cutoff_angle,
                    beam_width: bag.checked(
                        "beam_width",
                        cutoff_angle * 0.75,
                        |w| (0.0..=cutoff_angle).contains(&w),
                        &allowed,
                    )?,
                    texture: match bag.find("texture") {
                        Some(_) => Some(self.texture(&bag, "texture", 1.0, Unbounded)?),
                        None => None,
                    },
                }
            }
            "directional" => {
                if let Some((direction, place)) = bag.vector("direction")? {
                    if bag.transform("to_world")?.is_some() {
                        return Err(place.error("\"direction\" beside \"to_world\", expected either"));
                    }
                    to_world = Transform::look_at([0.0; 3], direction, perpendicular(direction))
                        .ok_or_else(|| place.error("zero direction, expected one other than zero"))?;
                }
                EmitterKind::Directional { irradiance: self.color(&bag, "irradiance", 1.0, Emission)? }
            }
            "constant" => EmitterKind::Constant { radiance: self.color(&bag, "radiance", 1.0, Emission)? },
            "envmap" => {
                let filename = bag.required_text("filename")?;
                bag.boolean("mis_compensation", false)?;
                let path = self.file(filename)?;
                let image = self.assets.image(&path, false).map_err(|e| filename.place.error(e))?;
                EmitterKind::Envmap { image, scale: bag.checked("scale", 1.0, |s| s >= 0.0, "a number not below 0")? }
            }
            "projector" => self.projector(&bag)?,
            "area" => return Err(bag.place().error("area emitter without a shape, expected it inside a <shape>")),
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        };
        let emitter = EmitterDesc {
            name: bag.label(),
            kind,
            to_world,
            sampling_weight: bag.checked("sampling_weight", 1.0, |w| w >= 0.0, "a number not below 0")?,
            medium: self.surrounding(&bag)?,
        };
        self.close(&bag)?;
        Ok(emitter)
    }

    fn projector(&mut self, bag: &Bag<'t>) -> Result<EmitterKind, SceneError> {
        let irradiance = self.texture(bag, "irradiance", 1.0, Emission)?;
        let aspect = match &irradiance {
            TextureDesc::Bitmap { image, .. } if image.height > 0 => image.width as f32 / image.height as f32,
            _ => 1.0,
        };
        let FieldOfView { fov_x, .. } = field_of_view(bag, f64::from(aspect))?;
        Ok(EmitterKind::Projector { irradiance, scale: bag.float("scale", 1.0)?, fov_x, aspect })
    }
}
