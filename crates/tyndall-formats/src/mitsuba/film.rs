//! Films and reconstruction filters.

use super::Reader;
use super::properties::Bag;
use super::source::SceneError;
use super::xml::Node;
use tyndall::scene::desc::{FilmDesc, ReconstructionFilter};

const KNOWN: &[&str] = &["hdrfilm"];
const UNSUPPORTED: &[&str] = &["specfilm", "ldrfilm", "tiledhdrfilm", "mfilm"];
const FILTERS: &[&str] = &["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"];
/// Films have at most this many pixels.
const MOST_PIXELS: u64 = 1 << 28;

impl<'t> Reader<'t> {
    pub(super) fn film(&mut self, node: &'t Node) -> Result<FilmDesc, SceneError> {
        let bag = self.open(node)?;
        match bag.plugin {
            "hdrfilm" => {}
            // Before version 2, pictures could be tone mapped while rendering; here that comes after.
            "ldrfilm" | "tiledhdrfilm" if node.old => {
                bag.ignore(&["tonemap_method", "gamma", "exposure", "key", "burn"]);
            }
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        }
        if node.old {
            bag.ignore(&["banner", "attach_log", "high_quality_edges", "label", "fov"]);
        }
        bag.ignore(&["file_format", "pixel_format", "component_format", "sample_border", "compensate"]);
        let width = bag.whole("width", 768, 1, 1 << 20)?;
        let height = bag.whole("height", 576, 1, 1 << 20)?;
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(bag.place().error(format!("film of {width}x{height}, expected at most {MOST_PIXELS} pixels")));
        }
        let film = FilmDesc {
            width,
            height,
            crop: crop(&bag, width, height)?,
            filter: match bag.child("rfilter")? {
                Some(node) => self.filter(node)?,
                None => ReconstructionFilter::default(),
            },
        };
        self.close(&bag)?;
        Ok(film)
    }

    fn filter(&mut self, node: &'t Node) -> Result<ReconstructionFilter, SceneError> {
        let bag = self.open(node)?;
        let positive = |name, default| bag.checked(name, default, |v| v > 0.0, "a number above 0");
        let filter = match bag.plugin {
            "box" => {
                bag.ignore(&["radius"]);
                ReconstructionFilter::Box
            }
            "tent" => ReconstructionFilter::Tent { radius: positive("radius", 1.0)? },
            "gaussian" => ReconstructionFilter::Gaussian { stddev: positive("stddev", 0.5)? },
            "mitchell" => {
                ReconstructionFilter::Mitchell { b: bag.float("B", 1.0 / 3.0)?, c: bag.float("C", 1.0 / 3.0)? }
            }
            "catmullrom" => ReconstructionFilter::CatmullRom,
            "lanczos" => ReconstructionFilter::Lanczos { lobes: bag.whole("lobes", 3, 1, 64)? },
            _ => return Err(bag.unknown(FILTERS, &[])),
        };
        self.close(&bag)?;
        Ok(filter)
    }
}

/// The part of the film that is rendered, when it is not all of it.
fn crop(bag: &Bag, width: u32, height: u32) -> Result<Option<[u32; 4]>, SceneError> {
    let x = bag.whole("crop_offset_x", 0, 0, width - 1)?;
    let y = bag.whole("crop_offset_y", 0, 0, height - 1)?;
    let crop_width = bag.whole("crop_width", width, 1, width)?;
    let crop_height = bag.whole("crop_height", height, 1, height)?;
    if x + crop_width > width || y + crop_height > height {
        return Err(bag.place().error(format!(
            "crop {crop_width}x{crop_height} at {x}, {y}, expected it within the film of {width}x{height}"
        )));
    }
    let crop = [x, y, crop_width, crop_height];
    Ok((crop != [0, 0, width, height]).then_some(crop))
}
