//! What exists: shapes, BSDFs, media, phase functions, emitters, sensors, textures.

pub mod bsdf;
pub mod build;
pub mod desc;
pub mod emitter;
pub mod medium;
pub mod phase;
pub mod sensor;
pub mod shape;
pub mod texture;

pub use build::BuildError;
pub use desc::SceneDesc;

use crate::film::filter::FilterSampler;
use crate::math::{Aabb, Vec2, Vec3};
use bsdf::{Bsdfs, SurfaceContext};
use desc::{BsdfId, FilmDesc, IntegratorDesc, MediumId, SamplerDesc};
use emitter::{Emission, Lights};
use medium::Medium;
use sensor::Sensor;
use shape::{Geometry, SurfacePoint};
use std::sync::Arc;

/// A scene that can be rendered: built once by [`Scene::build`], never changed.
#[derive(Debug)]
pub struct Scene {
    /// Everything that can be hit.
    pub geometry: Arc<Geometry>,
    /// Surface scattering models.
    pub bsdfs: Bsdfs,
    /// Emitters.
    pub lights: Lights,
    /// The camera.
    pub sensor: Sensor,
    /// Medium around the camera.
    pub camera_medium: Option<MediumId>,
    /// Size and crop of the picture.
    pub film: FilmDesc,
    /// The reconstruction filter.
    pub filter: FilterSampler,
    /// Samples per pixel and seed that the scene asks for.
    pub sampler: SamplerDesc,
    /// The integrator that the scene asks for.
    pub integrator: IntegratorDesc,
    media: Vec<Medium>,
    /// By medium, the box in which it lies, if it is bounded.
    regions: Vec<Option<Aabb>>,
    attachments: Vec<Attachments>,
    /// By emitter, the medium in which its light starts; empty without media.
    emission_media: Vec<Option<MediumId>>,
    notes: Vec<String>,
}

/// What is attached to a shape.
#[derive(Clone, Copy, Debug)]
struct Attachments {
    bsdf: BsdfId,
    interior: Option<MediumId>,
    exterior: Option<MediumId>,
    /// The BSDF does nothing.
    index_matched: bool,
    /// The BSDF has a part that is not a delta distribution.
    smooth: bool,
    /// That part is not rough glass only.
    diffuse: bool,
    /// It has a rough reflection.
    glossy: bool,
    /// It has a delta distribution, straight on included.
    lets_on: bool,
    emits: bool,
}

impl Scene {
    /// What a user may want to know about the scene, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// All media.
    pub fn media(&self) -> &[Medium] {
        &self.media
    }

    /// A medium.
    #[inline(always)]
    pub fn medium(&self, id: MediumId) -> &Medium {
        &self.media[id.0]
    }

    /// Columns and rows of the rendered part of the film.
    pub fn picture_size(&self) -> (u32, u32) {
        self.film.crop.map_or((self.film.width, self.film.height), |[_, _, width, height]| (width, height))
    }

    /// Column and row of the film at which the rendered part begins.
    pub fn crop_origin(&self) -> (u32, u32) {
        self.film.crop.map_or((0, 0), |[x, y, _, _]| (x, y))
    }

    #[inline(always)]
    fn attached(&self, shape: u32) -> &Attachments {
        &self.attachments[shape as usize]
    }

    /// The surface scattering model of a shape.
    #[inline(always)]
    pub fn bsdf_of(&self, shape: u32) -> BsdfId {
        self.attached(shape).bsdf
    }

    /// Whether light passes the shape unchanged, apart from the media on its sides.
    #[inline(always)]
    pub fn is_index_matched(&self, shape: u32) -> bool {
        self.attached(shape).index_matched
    }

    /// Whether the shape emits light.
    #[inline(always)]
    pub fn is_emitter(&self, shape: u32) -> bool {
        self.attached(shape).emits
    }

    /// Whether the shape's BSDF has a part that is not a delta distribution, to which emitters can be connected.
    #[inline(always)]
    pub fn is_smooth(&self, shape: u32) -> bool {
        self.attached(shape).smooth
    }

    /// Whether what the shape scatters can be told from light that arrives nearby; not so for glass, rough or smooth.
    #[inline(always)]
    pub fn is_diffuse(&self, shape: u32) -> bool {
        self.attached(shape).diffuse
    }

    /// Whether the shape has a rough reflection: what is seen in it is better looked for than told from light that arrives nearby.
    #[inline(always)]
    pub fn is_glossy(&self, shape: u32) -> bool {
        self.attached(shape).glossy
    }

    /// Whether a walk may go on from the shape without being scattered by chance: straight on, by a smooth mirror or by glass.
    #[inline(always)]
    pub fn lets_on(&self, shape: u32) -> bool {
        self.attached(shape).lets_on
    }

    /// Whether the shape has media on its sides.
    #[inline(always)]
    pub fn is_boundary(&self, shape: u32) -> bool {
        let attached = self.attached(shape);
        attached.interior.is_some() || attached.exterior.is_some()
    }

    /// Whether the medium ends somewhere in all directions, as far as can be told: then nothing inside of it sees infinity.
    #[inline(always)]
    pub fn is_bounded(&self, medium: MediumId) -> bool {
        self.regions[medium.0].is_some()
    }

    /// Whether the medium is bounded and lies elsewhere than at `x`.
    #[inline(always)]
    pub fn ends_before(&self, medium: MediumId, x: Vec3) -> bool {
        self.regions[medium.0].is_some_and(|region| !region.contains(x))
    }

    /// The medium that all of space is filled with: the camera's, where no shape bounds one.
    pub fn everywhere(&self) -> Option<MediumId> {
        let bounds = |a: &Attachments| a.interior.is_some() || a.exterior.is_some();
        self.camera_medium.filter(|_| !self.attachments.iter().any(bounds))
    }

    /// The medium that light enters when it leaves `point` along `direction`: that of the side, where the shape bounds
    /// media, else `current`.
    #[inline(always)]
    pub fn medium_towards(&self, point: &SurfacePoint, direction: Vec3, current: Option<MediumId>) -> Option<MediumId> {
        let attached = self.attached(point.shape);
        if attached.interior.is_none() && attached.exterior.is_none() {
            return current;
        }
        if direction.dot(point.normal) > 0.0 { attached.exterior } else { attached.interior }
    }

    /// Light that leaves an emitter, as [`Lights::sample_emission`] has it, and the medium in which it starts.
    #[inline(always)]
    pub fn sample_emission(&self, choice: f32, u_position: Vec2, u_direction: Vec2) -> Option<Emission> {
        let emission = self.lights.sample_emission(choice, u_position, u_direction)?;
        let medium = self.emission_media.get(emission.emitter.0 as usize).copied().flatten();
        Some(Emission { medium, ..emission })
    }

    /// What BSDFs need to know of a point.
    #[inline(always)]
    pub fn surface_context<'a>(&'a self, point: &'a SurfacePoint) -> SurfaceContext<'a> {
        SurfaceContext::new(point, self.geometry.mesh(point.shape))
    }

    /// Transmittance of the surface at `point` straight on along `direction`.
    #[inline]
    pub fn null_transmission(&self, point: &SurfacePoint, direction: Vec3) -> crate::Spectrum {
        if self.is_index_matched(point.shape) {
            return crate::Spectrum::ONE;
        }
        let wo = point.shading.to_local(-direction);
        self.bsdfs.null_transmission(self.bsdf_of(point.shape), &self.surface_context(point), wo)
    }

    /// Whether there are smooth mirrors or smooth glass.
    pub fn any_delta(&self) -> bool {
        self.attachments.iter().any(|a| self.bsdfs.traits(a.bsdf).delta)
    }

    /// A warning if there are caustics that paths from the camera cannot find, or only rarely: emitters without extent,
    /// or tiny ones, near smooth glass and a medium.
    pub fn hidden_caustics(&self) -> Option<String> {
        let glass = self.attachments.iter().any(|a| {
            let traits = self.bsdfs.traits(a.bsdf);
            traits.delta && traits.transmits
        });
        let hidden = self
            .lights
            .smallest_extent()
            .is_some_and(|extent| extent < 0.01 * self.geometry.bounds().extent().length());
        (glass && hidden && !self.media.is_empty()).then(|| {
            "point-like emitters shine through smooth glass: their caustics in the medium are not found by path tracing, \
             or only as rare bright dots"
                .to_string()
        })
    }
}
