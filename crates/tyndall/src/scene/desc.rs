//! A scene as plain data: what a reader produces and `Scene::build` consumes.
//!
//! Everything here can be written by hand. Numbers are not checked until the scene is built; ids are indices into the
//! vectors of [`SceneDesc`].

mod bsdf;

pub use crate::film::filter::ReconstructionFilter;
pub use bsdf::{BsdfDesc, Microfacets, PrincipledDesc, PrincipledThinDesc, RoughnessDesc};

use crate::math::Transform;
use std::sync::Arc;

/// Linear sRGB `[red, green, blue]`.
pub type Rgb = [f32; 3];

/// Index into [`SceneDesc::bsdfs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsdfId(pub usize);

/// Index into [`SceneDesc::media`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumId(pub usize);

/// Index into [`SceneDesc::shape_groups`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeGroupId(pub usize);

/// A whole scene.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// Everything that can be hit, instances included.
    pub shapes: Vec<ShapeDesc>,
    /// Shapes that exist only where a [`GeometryDesc::Instance`] places them.
    pub shape_groups: Vec<Vec<ShapeDesc>>,
    /// Surface scattering models.
    pub bsdfs: Vec<BsdfDesc>,
    /// Participating media.
    pub media: Vec<MediumDesc>,
    /// Emitters other than area lights.
    pub emitters: Vec<EmitterDesc>,
    /// The camera.
    pub sensor: SensorDesc,
    /// The picture's size, crop and reconstruction filter.
    pub film: FilmDesc,
    /// How many samples a pixel takes and from which seed.
    pub sampler: SamplerDesc,
    /// The integrator named by the scene.
    pub integrator: IntegratorDesc,
}

/// A shape with everything attached to it.
#[derive(Clone, Debug)]
pub struct ShapeDesc {
    /// Name for messages: the id in the file, or what the reader finds helpful.
    pub name: String,
    /// The form in object space.
    pub geometry: GeometryDesc,
    /// Object to world.
    pub to_world: Transform,
    /// Turns the normals round.
    pub flip_normals: bool,
    /// Surface scattering; `None` is diffuse 0.5, or black when the shape emits.
    pub bsdf: Option<BsdfId>,
    /// Radiance leaving the side of the normal, W/(m^2 sr).
    pub emission: Option<AreaEmitterDesc>,
    /// Medium on the side opposite to the geometric normal.
    pub interior: Option<MediumId>,
    /// Medium on the side of the geometric normal.
    pub exterior: Option<MediumId>,
}

impl ShapeDesc {
    /// A shape without attachments.
    pub fn new(name: impl Into<String>, geometry: GeometryDesc) -> Self {
        Self {
            name: name.into(),
            geometry,
            to_world: Transform::IDENTITY,
            flip_normals: false,
            bsdf: None,
            emission: None,
            interior: None,
            exterior: None,
        }
    }
}

/// The form of a shape, in object space. Normals point outwards.
#[derive(Clone, Debug)]
pub enum GeometryDesc {
    /// A triangle mesh.
    Mesh(Arc<MeshDesc>),
    /// A sphere.
    Sphere {
        /// Centre, metres.
        center: [f64; 3],
        /// Radius, metres.
        radius: f64,
    },
    /// The square `[-1, 1]^2` in the plane z = 0, normal +z, uv in `[0, 1]^2`.
    Rectangle,
    /// The unit disk in the plane z = 0, normal +z.
    Disk,
    /// The cube `[-1, 1]^3`.
    Cube,
    /// The open tube of `radius` from `p0` to `p1`, without caps.
    Cylinder {
        /// One end of the axis, metres.
        p0: [f64; 3],
        /// Other end of the axis, metres.
        p1: [f64; 3],
        /// Radius, metres.
        radius: f64,
    },
    /// A copy of a shape group.
    Instance(ShapeGroupId),
}

/// A triangle mesh in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshDesc {
    /// Vertex positions, metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit vertex normals: empty (flat shading) or one per position.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates: empty or one per position.
    pub uvs: Vec<[f32; 2]>,
    /// Three positions each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Named data for `mesh_attribute` textures.
    pub attributes: Vec<MeshAttribute>,
}

/// Named data of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshAttribute {
    /// Name as a texture refers to it: `vertex_...` or `face_...`.
    pub name: String,
    /// 1 or 3.
    pub channels: usize,
    /// `channels` values per vertex or per triangle, by the name's prefix.
    pub values: Vec<f32>,
}

/// Colour over a surface.
#[derive(Clone, Debug)]
pub enum TextureDesc {
    /// The same everywhere.
    Constant(Rgb),
    /// A picture.
    Bitmap {
        /// The pixels.
        image: Arc<ImageDesc>,
        /// Interpolation.
        filter: Filter,
        /// What lies outside `[0, 1]^2`.
        wrap: Wrap,
        /// Applied to uv before the look-up.
        to_uv: Transform,
    },
    /// Two colours in a 2x2 pattern over the unit square.
    Checkerboard {
        /// Colour of the corner at the origin.
        color0: Box<TextureDesc>,
        /// The other colour.
        color1: Box<TextureDesc>,
        /// Applied to uv before the look-up.
        to_uv: Transform,
    },
    /// Data stored with the mesh.
    MeshAttribute {
        /// The attribute's name, with `vertex_` or `face_`.
        name: String,
        /// Factor.
        scale: f32,
    },
}

impl TextureDesc {
    /// The same value in every channel, everywhere.
    pub const fn grey(value: f32) -> Self {
        Self::Constant([value; 3])
    }
}

/// A picture: linear values, row 0 at the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageDesc {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` pixels, row by row. Grey pictures repeat their channel.
    pub pixels: Vec<Rgb>,
}

/// Interpolation of a picture or a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Filter {
    /// Bilinear or trilinear.
    #[default]
    Linear,
    /// The nearest sample.
    Nearest,
}

/// What lies outside the unit square or cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// The border.
    Clamp,
}

/// A participating medium.
#[derive(Clone, Debug)]
pub struct MediumDesc {
    /// Name for messages.
    pub name: String,
    /// Constant or varying coefficients.
    pub kind: MediumKind,
    /// Extinction before `scale`, 1/m.
    pub sigma_t: VolumeDesc,
    /// Share of the extinction that scatters.
    pub albedo: VolumeDesc,
    /// Factor of `sigma_t`.
    pub scale: f32,
    /// Angular distribution of the scattering.
    pub phase: PhaseDesc,
    /// Whether light is sampled at scattering events (next-event estimation).
    pub sample_emitters: bool,
}

/// Constant or varying coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MediumKind {
    /// `sigma_t` is constant and unbounded in space; `albedo` may vary.
    Homogeneous,
    /// Extinction is zero outside the box of the `sigma_t` volume.
    Heterogeneous,
}

/// A function of space.
#[derive(Clone, Debug)]
pub enum VolumeDesc {
    /// The same value in the whole box.
    Constant {
        /// The value.
        value: Rgb,
        /// Unit cube to world. Only [`MediumKind::Heterogeneous`] looks at the box.
        to_world: Transform,
    },
    /// A grid.
    Grid {
        /// The samples.
        grid: Arc<GridDesc>,
        /// Unit cube to world.
        to_world: Transform,
        /// Interpolation.
        filter: Filter,
        /// What lies outside the box.
        wrap: Wrap,
    },
}

impl VolumeDesc {
    /// The same value in the unit cube (or everywhere, in a homogeneous medium).
    pub const fn constant(value: Rgb) -> Self {
        Self::Constant { value, to_world: Transform::IDENTITY }
    }
}

/// A grid of samples at `(i + 0.5) / n` of the unit cube.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridDesc {
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// 1, 3 or 6 values a sample.
    pub channels: usize,
    /// `[z][y][x][channel]`.
    pub values: Vec<f32>,
    /// Box stored in the file, smallest and largest corner.
    pub bounds: [[f32; 3]; 2],
}

/// A phase function. The cosine is that between the two propagation directions: `g > 0` is forward.
#[derive(Clone, Debug)]
pub enum PhaseDesc {
    /// 1/(4 pi).
    Isotropic,
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein {
        /// Mean cosine, in (-1, 1).
        g: f32,
    },
    /// Rayleigh.
    Rayleigh,
    /// Piecewise linear in the cosine.
    Tabulated {
        /// At least two values at equidistant cosines from -1 to 1; any scale.
        values: Vec<f32>,
    },
    /// Specular microflakes (Heitz et al. 2015).
    Sggx {
        /// Six channels: xx, yy, zz, xy, xz, yz.
        matrix: VolumeDesc,
    },
    /// `(1 - weight) * first + weight * second`.
    Blend {
        /// Share of `second`.
        weight: f32,
        /// First function.
        first: Box<PhaseDesc>,
        /// Second function.
        second: Box<PhaseDesc>,
    },
}

/// Emission of a shape.
#[derive(Clone, Debug)]
pub struct AreaEmitterDesc {
    /// Radiance, W/(m^2 sr).
    pub radiance: TextureDesc,
    /// Relative weight in light selection.
    pub sampling_weight: f32,
}

/// An emitter that is not a shape.
#[derive(Clone, Debug)]
pub struct EmitterDesc {
    /// Name for messages.
    pub name: String,
    /// The kind.
    pub kind: EmitterKind,
    /// Emitter to world; light leaves along +z where a direction matters.
    pub to_world: Transform,
    /// Relative weight in light selection.
    pub sampling_weight: f32,
    /// Medium around the emitter, when the file says so.
    pub medium: Option<MediumId>,
}

impl EmitterDesc {
    /// An emitter in its own frame, with weight 1.
    pub fn new(name: impl Into<String>, kind: EmitterKind) -> Self {
        Self { name: name.into(), kind, to_world: Transform::IDENTITY, sampling_weight: 1.0, medium: None }
    }
}

/// Kinds of emitters that are not shapes.
#[derive(Clone, Debug)]
pub enum EmitterKind {
    /// An isotropic point.
    Point {
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A point with a cone about +z.
    Spot {
        /// Radiant intensity on the axis, W/sr.
        intensity: Rgb,
        /// Half angle beyond which there is no light, degrees.
        cutoff_angle: f32,
        /// Half angle up to which the intensity is full, degrees; linear in the angle between.
        beam_width: f32,
        /// Factor over the cone.
        texture: Option<TextureDesc>,
    },
    /// Parallel light along +z from infinitely far.
    Directional {
        /// Irradiance of a surface at right angles, W/m^2.
        irradiance: Rgb,
    },
    /// The same radiance from everywhere.
    Constant {
        /// Radiance, W/(m^2 sr).
        radiance: Rgb,
    },
    /// A latitude-longitude picture around the scene, +y up.
    Envmap {
        /// Radiance before `scale`, W/(m^2 sr).
        image: Arc<ImageDesc>,
        /// Factor.
        scale: f32,
    },
    /// A picture projected from a point along +z.
    Projector {
        /// Irradiance at distance 1 m.
        irradiance: TextureDesc,
        /// Factor.
        scale: f32,
        /// Horizontal field of view, degrees.
        fov_x: f32,
        /// Width divided by height of the picture.
        aspect: f32,
    },
}

/// The camera. It looks along +z of its frame, +x points left in the picture, +y up.
#[derive(Clone, Debug)]
pub struct SensorDesc {
    /// The kind.
    pub kind: SensorKind,
    /// Camera to world; a projective part is not allowed.
    pub to_world: Transform,
    /// Nothing nearer than this is seen, metres along the axis.
    pub near_clip: f32,
    /// Nothing farther than this is seen, metres along the axis.
    pub far_clip: f32,
    /// Medium around the camera, when the file says so.
    pub medium: Option<MediumId>,
}

impl Default for SensorDesc {
    fn default() -> Self {
        Self {
            kind: SensorKind::Perspective { fov_x: 39.597_75, principal_point: [0.0; 2] },
            to_world: Transform::IDENTITY,
            near_clip: 1e-2,
            far_clip: 1e4,
            medium: None,
        }
    }
}

/// Kinds of cameras.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorKind {
    /// Pinhole.
    Perspective {
        /// Horizontal field of view of the whole film (not the crop), degrees.
        fov_x: f32,
        /// Offset of the principal point, in fractions of the film's size.
        principal_point: [f32; 2],
    },
    /// A thin lens.
    ThinLens {
        /// Horizontal field of view of the whole film (not the crop), degrees.
        fov_x: f32,
        /// Radius of the lens, metres.
        aperture_radius: f32,
        /// Distance of the plane in focus, metres.
        focus_distance: f32,
    },
    /// Parallel rays; the picture is `[-1, 1]` wide in the camera's frame.
    Orthographic,
}

/// The picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmDesc {
    /// Columns of the whole film.
    pub width: u32,
    /// Rows of the whole film.
    pub height: u32,
    /// The part that is rendered: x, y, width, height; the whole film when `None`.
    pub crop: Option<[u32; 4]>,
    /// Reconstruction filter.
    pub filter: ReconstructionFilter,
}

impl Default for FilmDesc {
    fn default() -> Self {
        Self { width: 768, height: 576, crop: None, filter: ReconstructionFilter::default() }
    }
}

/// How many samples, from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerDesc {
    /// Samples a pixel.
    pub sample_count: u32,
    /// Seed.
    pub seed: u64,
}

impl Default for SamplerDesc {
    fn default() -> Self {
        Self { sample_count: 4, seed: 0 }
    }
}

/// An integrator by name, with parameters as written.
#[derive(Clone, Debug, PartialEq)]
pub struct IntegratorDesc {
    /// Name in the registry.
    pub name: String,
    /// Parameters; those not named take their defaults.
    pub parameters: Vec<(String, ParameterValue)>,
}

impl Default for IntegratorDesc {
    fn default() -> Self {
        Self { name: "volpath".into(), parameters: Vec::new() }
    }
}

/// A parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// Yes or no.
    Boolean(bool),
    /// A word.
    Text(String),
}
