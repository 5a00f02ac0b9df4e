//! Shapes and what is attached to them.

use super::Reader;
use super::assets::MeshOptions;
use super::properties::{Bag, Property};
use super::source::SceneError;
use super::textures::Quantity;
use super::xml::Node;
use tyndall::scene::desc::{AreaEmitterDesc, GeometryDesc, MediumId, ShapeDesc, ShapeGroupId};

const KNOWN: &[&str] =
    &["sphere", "rectangle", "disk", "cube", "cylinder", "obj", "ply", "serialized", "instance", "shapegroup"];
const UNSUPPORTED: &[&str] = &[
    "bsplinecurve",
    "linearcurve",
    "sdfgrid",
    "ellipsoids",
    "ellipsoidsmesh",
    "merge",
    "mesh",
    "blender",
    "hair",
    "heightfield",
    "deformable",
    "animatedinstance",
];

impl<'t> Reader<'t> {
    /// A shape that stands directly in the scene.
    pub(super) fn top_shape(&mut self, property: &Property<'t>, node: &'t Node) -> Result<(), SceneError> {
        if node.attribute("type").is_some_and(|a| a.value == "shapegroup") {
            self.shape_group(node)?;
            return Ok(());
        }
        let mut shape = self.shape(node)?;
        if let (true, Some(name)) = (node.attribute("id").is_none(), &property.name) {
            shape.name.clone_from(name);
        }
        self.scene.shapes.push(shape);
        Ok(())
    }

    fn shape(&mut self, node: &'t Node) -> Result<ShapeDesc, SceneError> {
        let bag = self.open(node)?;
        let geometry = self.geometry(&bag)?;
        if let GeometryDesc::Cylinder { p0, p1, .. } = &geometry
            && p0 == p1
        {
            return Err(bag.place().error("cylinder with p0 = p1, expected two different points"));
        }
        let mut shape = ShapeDesc::new(bag.label(), geometry);
        shape.to_world = bag.to_world()?;
        if !matches!(shape.geometry, GeometryDesc::Instance(_)) {
            shape.flip_normals = bag.boolean("flip_normals", false)?;
            shape.bsdf = bag.child("bsdf")?.map(|node| self.bsdf(node)).transpose()?;
            shape.emission = bag.child("emitter")?.map(|node| self.area_emitter(node)).transpose()?;
            (shape.interior, shape.exterior) = self.boundary_media(&bag)?;
            if let Some(sensor) = bag.child("sensor")? {
                return Err(sensor.place.error("sensor on a shape is not supported, expected it in the scene"));
            }
        }
        bag.ignore(&["silhouette_sampling_weight"]);
        self.close(&bag)?;
        Ok(shape)
    }

    fn geometry(&mut self, bag: &Bag<'t>) -> Result<GeometryDesc, SceneError> {
        let point = |name, default| Ok::<_, SceneError>(bag.vector(name)?.map_or(default, |(p, _)| p));
        let radius = || {
            bag.checked("radius", 1.0, |r| r > 0.0, "a number above 0")?;
            bag.double("radius", 1.0)
        };
        Ok(match bag.plugin {
            "sphere" => GeometryDesc::Sphere { center: point("center", [0.0; 3])?, radius: radius()? },
            "rectangle" => GeometryDesc::Rectangle,
            "disk" => GeometryDesc::Disk,
            "cube" => GeometryDesc::Cube,
            "cylinder" => GeometryDesc::Cylinder {
                p0: point("p0", [0.0; 3])?,
                p1: point("p1", [0.0, 0.0, 1.0])?,
                radius: radius()?,
            },
            "obj" | "ply" | "serialized" => self.mesh(bag)?,
            "instance" => match bag.children("shape").as_slice() {
                [(property, node)] => {
                    if node.attribute("type").is_none_or(|a| a.value != "shapegroup") {
                        return Err(property.place.error("instance of a shape, expected a shapegroup"));
                    }
                    GeometryDesc::Instance(self.shape_group(node)?)
                }
                other => {
                    return Err(bag
                        .place()
                        .error(format!("instance of {} shapes, expected 1 shapegroup", other.len())));
                }
            },
            "shapegroup" => return Err(bag.place().error("shapegroup inside a shape, expected it in the scene")),
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        })
    }

    fn mesh(&mut self, bag: &Bag<'t>) -> Result<GeometryDesc, SceneError> {
        let filename = bag.required_text("filename")?;
        let serialized = bag.plugin == "serialized";
        let options = MeshOptions {
            face_normals: bag.boolean("face_normals", false)?,
            flip_tex_coords: !serialized && bag.boolean("flip_tex_coords", bag.plugin == "obj")?,
            shape_index: if serialized { bag.whole("shape_index", 0, 0, u32::MAX)? as usize } else { 0 },
        };
        if bag.node.old {
            bag.ignore(&["collapse", "srgb"]);
        }
        let path = self.file(filename)?;
        let mesh = self.assets.mesh(bag.plugin, &path, options).map_err(|e| filename.place.error(e))?;
        Ok(GeometryDesc::Mesh(mesh))
    }

    fn shape_group(&mut self, node: &'t Node) -> Result<ShapeGroupId, SceneError> {
        if let Some(id) = self.groups.get(&node.index) {
            return Ok(*id);
        }
        let bag = self.open(node)?;
        let mut shapes = Vec::new();
        for (property, child) in bag.children("shape") {
            let shape = self.shape(child)?;
            if matches!(shape.geometry, GeometryDesc::Instance(_)) {
                return Err(property.place.error("instance in a shapegroup, expected shapes only"));
            }
            if shape.emission.is_some() {
                return Err(property.place.error("emitter in a shapegroup, expected shapes without emitters"));
            }
            shapes.push(shape);
        }
        bag.ignore(&["to_world"]);
        self.close(&bag)?;
        let id = ShapeGroupId(self.scene.shape_groups.len());
        self.scene.shape_groups.push(shapes);
        self.groups.insert(node.index, id);
        Ok(id)
    }

    /// Interior and exterior.
    fn boundary_media(&mut self, bag: &Bag<'t>) -> Result<(Option<MediumId>, Option<MediumId>), SceneError> {
        let (mut interior, mut exterior) = (None, None);
        for (property, node) in bag.children("medium") {
            match property.name.as_deref() {
                Some("interior") => interior = Some(self.medium(node)?),
                Some("exterior") => exterior = Some(self.medium(node)?),
                _ => {
                    return Err(property
                        .place
                        .error("medium of a shape without a side, expected name=\"interior\" or name=\"exterior\""));
                }
            }
        }
        Ok((interior, exterior))
    }

    fn area_emitter(&mut self, node: &'t Node) -> Result<AreaEmitterDesc, SceneError> {
        let bag = self.open(node)?;
        if bag.plugin != "area" {
            return Err(bag.place().error(format!("{} on a shape, expected an area emitter", bag.title())));
        }
        let emission = AreaEmitterDesc {
            radiance: self.texture(&bag, "radiance", 1.0, Quantity::Emission)?,
            sampling_weight: bag.checked("sampling_weight", 1.0, |w| w >= 0.0, "a number not below 0")?,
        };
        // Its shape's interior and exterior say the same.
        self.surrounding(&bag)?;
        self.close(&bag)?;
        Ok(emission)
    }
}
