//! From a description to a scene that can be rendered.

use super::bsdf::{BsdfError, Bsdfs};
use super::desc::{BsdfDesc, BsdfId, MediumId, SceneDesc, ShapeDesc, TextureDesc};
use super::emitter::{Emitter, EmitterError, Lights};
use super::medium::{Medium, MediumError};
use super::sensor::{Sensor, SensorError};
use super::shape::{Geometry, GeometryError};
use super::{Attachments, Scene};
use crate::film::filter::{FilterError, FilterSampler};
use crate::math::{Aabb, Ray, Rng, Vec2, Vec3, warp};
use std::sync::Arc;

/// Why a scene cannot be built. Messages name the shape, medium or emitter.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// A shape.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A surface scattering model.
    #[error(transparent)]
    Bsdf(#[from] BsdfError),
    /// A medium.
    #[error("medium `{name}`: {error}")]
    Medium {
        /// Name of the medium.
        name: String,
        /// What is wrong.
        error: MediumError,
    },
    /// An emitter.
    #[error(transparent)]
    Emitter(#[from] EmitterError),
    /// The camera.
    #[error("sensor: {0}")]
    Sensor(#[from] SensorError),
    /// The reconstruction filter.
    #[error("reconstruction filter: {0}")]
    Filter(#[from] FilterError),
    /// The size or the crop of the film.
    #[error("film: {0}")]
    Film(String),
    /// Something refers to what is not there.
    #[error("`{user}` refers to {kind} number {index}, but there are {count}")]
    Dangling {
        /// What refers.
        user: String,
        /// What it refers to.
        kind: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
}

/// The largest film, pixels.
pub const MAX_PIXELS: u64 = 1 << 28;

impl Scene {
    /// Checks `desc` and compiles it: acceleration structures, sampling tables, the media around the camera.
    pub fn build(desc: &SceneDesc) -> Result<Self, BuildError> {
        check_film(desc)?;
        let shapes = || desc.shapes.iter().chain(desc.shape_groups.iter().flatten());
        for shape in shapes() {
            check_reference(&shape.name, "medium", shape.interior.map(|m| m.0), desc.media.len())?;
            check_reference(&shape.name, "medium", shape.exterior.map(|m| m.0), desc.media.len())?;
            check_reference(&shape.name, "BSDF", shape.bsdf.map(|b| b.0), desc.bsdfs.len())?;
        }
        for emitter in &desc.emitters {
            check_reference(&emitter.name, "medium", emitter.medium.map(|m| m.0), desc.media.len())?;
        }
        check_reference("sensor", "medium", desc.sensor.medium.map(|m| m.0), desc.media.len())?;

        // Shapes without a model are grey, emitters without one black.
        let mut models = desc.bsdfs.clone();
        let grey = BsdfId(models.len());
        models.push(BsdfDesc::Diffuse { reflectance: TextureDesc::grey(0.5) });
        let black = BsdfId(models.len());
        models.push(BsdfDesc::Diffuse { reflectance: TextureDesc::grey(0.0) });
        let bsdfs = Bsdfs::compile(&models)?;
        let model = |shape: &ShapeDesc| shape.bsdf.unwrap_or(if shape.emission.is_some() { black } else { grey });
        let attach = |shape: &ShapeDesc| {
            let bsdf = model(shape);
            let traits = bsdfs.traits(bsdf);
            Attachments {
                bsdf,
                interior: shape.interior,
                exterior: shape.exterior,
                index_matched: traits.is_purely_null(),
                smooth: traits.smooth,
                diffuse: traits.diffuse,
                glossy: traits.glossy,
                lets_on: traits.delta || traits.null,
                emits: shape.emission.is_some(),
            }
        };
        let attachments: Vec<Attachments> = shapes().map(attach).collect();
        let geometry =
            Arc::new(Geometry::build(&desc.shapes, &desc.shape_groups, |shape| !bsdfs.traits(model(shape)).null)?);

        let media = desc
            .media
            .iter()
            .map(|medium| {
                Medium::compile(medium).map_err(|error| BuildError::Medium { name: medium.name.clone(), error })
            })
            .collect::<Result<Vec<_>, _>>()?;
        let areas = (0..).zip(&desc.shapes).filter_map(|(i, s)| Some((&*s.name, i, s.emission.as_ref()?)));
        let lights = Lights::new(&desc.emitters, areas, Arc::clone(&geometry))?;

        let mut scene = Scene {
            sensor: Sensor::compile(&desc.sensor, &desc.film)?,
            filter: FilterSampler::new(desc.film.filter)?,
            camera_medium: desc.sensor.medium,
            film: desc.film,
            sampler: desc.sampler,
            integrator: desc.integrator.clone(),
            notes: Vec::new(),
            geometry,
            attachments,
            emission_media: Vec::new(),
            bsdfs,
            regions: Vec::new(),
            media,
            lights,
        };
        scene.find_camera_medium(desc);
        scene.find_bounded_media(desc);
        scene.find_emission_media(desc);
        Ok(scene)
    }

    /// The medium around `x`, from the boundaries that rays in all directions meet first; `None` is vacuum.
    pub fn medium_at(&self, x: Vec3) -> Option<MediumId> {
        const RAYS: u64 = 33;
        // A majority, because a ray may slip past a boundary that is not closed or meet one that is wrongly tagged.
        let mut votes: Vec<(Option<MediumId>, u32)> = Vec::new();
        for i in 0..RAYS {
            let direction = warp::square_to_sphere(Rng::keyed(0, 0, i).vec2());
            let Side::Of(medium) = self.first_boundary(Ray { origin: x, direction }) else { continue };
            match votes.iter_mut().find(|(m, _)| *m == medium) {
                Some((_, count)) => *count += 1,
                None => votes.push((medium, 1)),
            }
        }
        votes.into_iter().max_by_key(|(_, count)| *count).and_then(|(medium, _)| medium)
    }

    /// The medium on this side of the first boundary between media that `ray` meets.
    fn first_boundary(&self, mut ray: Ray) -> Side {
        // Rays graze through many surfaces in a dense mesh; beyond this many the answer is as good as none.
        for _ in 0..1000 {
            let Some(hit) = self.geometry.intersect(&ray, f32::INFINITY) else { return Side::Of(None) };
            let point = self.geometry.surface(&ray, &hit);
            if self.is_boundary(point.shape) {
                return Side::Of(self.medium_towards(&point, -ray.direction, None));
            }
            if !self.bsdfs.traits(self.bsdf_of(point.shape)).transmits {
                return Side::Unknown;
            }
            ray.origin = point.leave(ray.direction);
        }
        Side::Unknown
    }

    /// Files rarely say in which medium an emitter stands. One point decides for a whole shape.
    fn find_emission_media(&mut self, desc: &SceneDesc) {
        if self.media.is_empty() {
            return;
        }
        // The description's emitters come first among all.
        let named = desc.emitters.iter().map(|emitter| emitter.medium).chain(std::iter::repeat(None));
        let medium = |(emitter, named): (&Emitter, Option<MediumId>)| match emitter {
            Emitter::Area(area) if self.is_boundary(area.shape) => self.attached(area.shape).exterior,
            Emitter::Area(area) => {
                // Off the middle, where edges tend to be.
                let (point, _) = self.geometry.sample_area(area.shape, Vec2::new(0.37, 0.61))?;
                self.medium_at(self.geometry.leave_emitter(area.shape, &point))
            }
            // Emitters at infinity have no position: their light comes through vacuum.
            other => {
                let position = other.position()?;
                named.or_else(|| self.medium_at(position))
            }
        };
        self.emission_media = self.lights.emitters().iter().zip(named).map(medium).collect();
    }

    /// A medium inside of shapes and around none is bounded, unless the camera stands in it where no boundary is around.
    fn find_bounded_media(&mut self, desc: &SceneDesc) {
        let region = |medium: MediumId| {
            let inside = |a: &Attachments| a.interior == Some(medium);
            let outside = |a: &Attachments| a.exterior == Some(medium);
            let bounded = self.attachments.iter().any(inside)
                && !self.attachments.iter().any(outside)
                && (self.camera_medium != Some(medium) || self.medium_at(self.sensor.position()) == Some(medium));
            // Members of shape groups may be anywhere.
            let shapes = (0..).zip(&self.attachments).filter(|(_, a)| inside(a)).map(|(shape, _)| shape);
            let bounds = |shape| match shape < desc.shapes.len() {
                true => self.geometry.form(shape as u32).bounds(),
                false => self.geometry.bounds(),
            };
            let region = shapes.map(bounds).fold(Aabb::EMPTY, Aabb::union);
            // One side of a room says nothing of the others, which may be opaque.
            let flat = !(region.extent().min_element() > 0.0);
            bounded.then(|| if flat { self.geometry.bounds() } else { region })
        };
        self.regions = (0..self.media.len()).map(|i| region(MediumId(i))).collect();
    }

    /// Files rarely say that the camera stands in a medium.
    fn find_camera_medium(&mut self, desc: &SceneDesc) {
        if self.camera_medium.is_some() || self.media.is_empty() {
            return;
        }
        self.camera_medium = self.medium_at(self.sensor.position());
        if let Some(MediumId(index)) = self.camera_medium {
            let name = &desc.media[index].name;
            self.notes.push(format!("the camera stands inside the medium `{name}` though the scene does not say so"));
        }
    }
}

/// What a ray tells of the medium at its start.
enum Side {
    /// It is this one.
    Of(Option<MediumId>),
    /// Nothing: an opaque surface without media on its sides comes first.
    Unknown,
}

fn check_reference(user: &str, kind: &'static str, index: Option<usize>, count: usize) -> Result<(), BuildError> {
    match index {
        Some(index) if index >= count => Err(BuildError::Dangling { user: user.into(), kind, index, count }),
        _ => Ok(()),
    }
}

fn check_film(desc: &SceneDesc) -> Result<(), BuildError> {
    let (width, height) = (desc.film.width, desc.film.height);
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(BuildError::Film(format!("{width} x {height} pixels, expected 1 to {MAX_PIXELS} in total")));
    }
    if let Some([x, y, crop_width, crop_height]) = desc.film.crop {
        let inside =
            |offset: u32, size: u32, whole: u32| size > 0 && u64::from(offset) + u64::from(size) <= whole.into();
        if !inside(x, crop_width, width) || !inside(y, crop_height, height) {
            return Err(BuildError::Film(format!(
                "the crop of {crop_width} x {crop_height} pixels at ({x}, {y}) does not lie in the {width} x {height} film"
            )));
        }
    }
    Ok(())
}
