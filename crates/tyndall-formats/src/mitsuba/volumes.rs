//! Functions of space.

use super::Reader;
use super::properties::{Bag, Value};
use super::source::SceneError;
use super::textures::{FILTERS, Quantity, WRAPS};
use super::xml::Node;
use tyndall::math::Transform;
use tyndall::scene::desc::{Filter, GridDesc, VolumeDesc, Wrap};

const KNOWN: &[&str] = &["constvolume", "gridvolume"];
const UNSUPPORTED: &[&str] = &["volcache", "hgridvolume", "spectralvolume"];

impl<'t> Reader<'t> {
    /// The volume, colour or number `name`.
    pub(super) fn volume(
        &mut self,
        bag: &Bag<'t>,
        name: &'static str,
        default: f32,
        quantity: Quantity,
    ) -> Result<VolumeDesc, SceneError> {
        match bag.find(name) {
            None => Ok(VolumeDesc::constant([default; 3])),
            Some(property) => match property.value {
                Value::Object(node) if node.family() == "volume" => self.volume_plugin(node),
                _ => Ok(VolumeDesc::constant(self.color_value(property, quantity)?)),
            },
        }
    }

    pub(super) fn volume_plugin(&mut self, node: &'t Node) -> Result<VolumeDesc, SceneError> {
        let bag = self.open(node)?;
        let volume = match bag.plugin {
            "constvolume" => {
                let value = self.color(&bag, "value", 1.0, Quantity::Unbounded)?;
                VolumeDesc::Constant { value, to_world: bag.to_world()? }
            }
            "gridvolume" => self.grid(&bag)?,
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        };
        self.close(&bag)?;
        Ok(volume)
    }

    fn grid(&mut self, bag: &Bag<'t>) -> Result<VolumeDesc, SceneError> {
        let filename = bag.required_text("filename")?;
        bag.boolean("raw", false)?;
        bag.float("max_value", 0.0)?;
        bag.ignore(&["accel", "send_data"]);
        let path = self.file(filename)?;
        let grid = self.assets.grid(&path).map_err(|e| filename.place.error(e))?;
        let mut to_world = bag.to_world()?;
        // Before version 2 the box is always the file's, unless its corners are given.
        if bag.boolean("use_grid_bbox", bag.node.old)? {
            let mut corners = grid.bounds.map(|corner| corner.map(f64::from));
            if bag.node.old {
                for (corner, name) in corners.iter_mut().zip(["min", "max"]) {
                    if let Some((given, _)) = bag.vector(name)? {
                        *corner = given;
                    }
                }
            }
            to_world = box_to_world(corners).then(&to_world);
            if to_world.inverse().is_none() {
                let [a, b] = corners;
                return Err(filename.place.error(format!("box from {a:?} to {b:?}, expected one with a volume")));
            }
        }
        Ok(VolumeDesc::Grid {
            grid,
            to_world,
            filter: bag.choice("filter_type", FILTERS, Filter::Linear)?,
            wrap: bag.choice("wrap_mode", WRAPS, Wrap::Clamp)?,
        })
    }
}

/// The unit cube to the box between two corners.
fn box_to_world([smallest, largest]: [[f64; 3]; 2]) -> Transform {
    let extent = [0, 1, 2].map(|i| largest[i] - smallest[i]);
    Transform::scale(extent).then(&Transform::translate(smallest))
}

/// Whether some sample or value fails `valid`, and which.
pub(super) fn offender(volume: &VolumeDesc, valid: impl Fn(f32) -> bool) -> Option<f32> {
    let find = |values: &[f32]| values.iter().copied().find(|v| !valid(*v));
    match volume {
        VolumeDesc::Constant { value, .. } => find(value),
        VolumeDesc::Grid { grid, .. } => {
            let GridDesc { values, .. } = &**grid;
            find(values)
        }
    }
}
