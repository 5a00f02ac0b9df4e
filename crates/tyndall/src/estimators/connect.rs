//! Connecting by an edge: a vertex of light's walk with one of the camera's, or with the lens.

use super::transport::{SHORT_OF, Turn, departure, turn, turned};
use crate::Spectrum;
use crate::math::{Ray, Rng, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::sensor::{Projection, RayDensity};
use crate::walk::{Edge, FromCamera, FromLight, Vertex, edge_passage, passage};

/// The straight way from a vertex of light's walk to one of the camera's.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Unit direction of light's travel.
    direction: Vec3,
    /// One over the squared distance, 1/m^2.
    pub spread: f32,
}

impl Way {
    /// `None` for vertices at the same place.
    #[inline]
    pub fn new(light: Vec3, camera: Vec3) -> Option<Self> {
        let distance2 = camera.distance_squared(light);
        if !(distance2 > 0.0) {
            return None;
        }
        let direction = (camera - light) / distance2.sqrt();
        Some(Self { direction, spread: 1.0 / distance2 })
    }

    /// The ray along which nothing may stand, its length and its first medium.
    #[inline(always)]
    fn shadow(&self, scene: &Scene, light: &Vertex, camera: &Vertex) -> (Ray, f32, Option<MediumId>) {
        let (from, medium) = departure(scene, light, self.direction);
        let (to, _) = departure(scene, camera, -self.direction);
        (Ray::between(from, to), from.distance(to) * SHORT_OF, medium)
    }
}

/// Both turns, transmittance and spread of the way from `light` to `camera`, 1/(m^2 sr^2). Times the throughputs of both
/// walks on arrival it is the radiance of this path. `None` when nothing gets from one to the other.
#[inline]
pub fn transfer(scene: &Scene, way: &Way, light: &Vertex, camera: &Vertex, rng: &mut Rng) -> Option<Spectrum> {
    let at_camera = turned::<FromCamera>(scene, camera, -way.direction);
    if at_camera.is_black() {
        return None;
    }
    let value = turned::<FromLight>(scene, light, way.direction) * at_camera * way.spread;
    if value.is_black() {
        return None;
    }
    let (ray, length, medium) = way.shadow(scene, light, camera);
    Some(value * passage(scene, ray, length, medium, true, rng)?.transmittance)
}

/// A vertex of light's walk and one of the camera's, joined, with all that weights need.
#[derive(Clone, Copy, Debug)]
pub struct Join {
    /// Unit direction of light's travel.
    pub direction: Vec3,
    /// One over the squared distance, 1/m^2.
    pub spread: f32,
    /// The turn of light's walk.
    pub light: Turn,
    /// The turn of the camera's walk.
    pub camera: Turn,
    /// The way from light's vertex to the camera's.
    pub edge: Edge,
    /// As [`transfer`] answers.
    pub value: Spectrum,
}

/// Joins `light` and `camera`; `None` when nothing gets from one to the other.
#[inline]
pub fn join(scene: &Scene, light: &Vertex, camera: &Vertex, rng: &mut Rng) -> Option<Join> {
    let way = Way::new(light.position, camera.position)?;
    let Way { direction, spread } = way;
    let at_camera = turn::<FromCamera>(scene, camera, -direction);
    if at_camera.value.is_black() {
        return None;
    }
    let at_light = turn::<FromLight>(scene, light, direction);
    let value = at_light.value * at_camera.value * spread;
    if value.is_black() {
        return None;
    }
    let (ray, length, medium) = way.shadow(scene, light, camera);
    let (transmittance, edge) = edge_passage(scene, ray, length, medium, rng)?;
    Some(Join { direction, spread, light: at_light, camera: at_camera, edge, value: value * transmittance })
}

/// A vertex of light's walk as the camera sees it.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Position on the whole film, pixels.
    pub film_position: Vec2,
    /// Unit direction from the vertex to the lens.
    pub direction: Vec3,
    /// The turn of light's walk.
    pub light: Turn,
    /// The way from the vertex to the lens.
    pub edge: Edge,
    /// Density of the camera's rays there.
    pub lens: RayDensity,
    /// What unit throughput on arrival adds to the picture, a radiance over a flux.
    pub value: Spectrum,
}

/// Joins `light` with the point of the lens that `u_lens` chooses. `shows` says whether a place on the film matters;
/// `None` when nothing gets there.
#[inline]
pub fn sight(
    scene: &Scene,
    light: &Vertex,
    u_lens: Vec2,
    shows: impl Fn(Vec2) -> bool,
    rng: &mut Rng,
) -> Option<Sight> {
    let Projection { film_position, ray, distance, pixels_per_area } = scene.sensor.project(light.position, u_lens)?;
    if !shows(film_position) {
        return None;
    }
    let direction = -ray.ray.direction;
    let turn = turn::<FromLight>(scene, light, direction);
    let value = turn.value * pixels_per_area;
    if value.is_black() {
        return None;
    }
    let (transmittance, edge) = edge_passage(scene, ray.ray, distance * SHORT_OF, scene.camera_medium, rng)?;
    let lens = scene.sensor.ray_density(&ray.ray);
    let value = value * transmittance;
    Some(Sight { film_position, direction, light: turn, edge: edge.reversed(), lens, value })
}
