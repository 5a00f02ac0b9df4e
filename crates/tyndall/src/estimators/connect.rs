//! Connecting by an edge: a vertex of light's walk with one of the camera's, or with the lens.

use super::transport::{SHORT_OF, Turn, departure, turn};
use crate::Spectrum;
use crate::math::{Frame, Ray, Rng, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::sensor::{Projection, RayDensity};
use crate::walk::{Edge, FromCamera, FromLight, Vertex, edge_passage};

/// A vertex of light's walk and one of the camera's, joined.
#[derive(Clone, Copy, Debug)]
pub struct Join {
    /// Unit direction of light's travel.
    pub direction: Vec3,
    /// One over the squared distance, or over the area that stands for it, 1/m^2.
    pub spread: f32,
    /// The turn of light's walk.
    pub light: Turn,
    /// The turn of the camera's walk.
    pub camera: Turn,
    /// The way from light's vertex to the camera's.
    pub edge: Edge,
    /// Both turns, transmittance and spread, 1/(m^2 sr^2). Times the throughputs of both walks on arrival it is the
    /// radiance of this path.
    pub value: Spectrum,
}

/// Joins `light` and `camera`; `None` when nothing gets from one to the other.
#[inline]
pub fn join(scene: &Scene, light: &Vertex, camera: &Vertex, rng: &mut Rng) -> Option<Join> {
    let distance2 = camera.position.distance_squared(light.position);
    if !(distance2 > 0.0) {
        return None;
    }
    let direction = (camera.position - light.position) / distance2.sqrt();
    join_along(scene, light, camera, [direction; 2], 1.0 / distance2, rng)
}

/// Joins `camera` with light that comes from all of a ball of that radius around `light`, seen along a direction that `u`
/// chooses within the ball's cone; the half space when it stands in the ball (Novak et al. 2012b; Hasan et al. 2009).
#[inline]
pub fn join_ball(scene: &Scene, light: &Vertex, camera: &Vertex, radius: f32, u: Vec2, rng: &mut Rng) -> Option<Join> {
    let distance2 = camera.position.distance_squared(light.position);
    if !(distance2 > 0.0) {
        return None;
    }
    let direction = (camera.position - light.position) / distance2.sqrt();
    let sin2 = (radius * radius / distance2).min(1.0);
    let cos_cone = (1.0 - sin2).sqrt();
    // One minus the cosine, without cancellation.
    let cap = sin2 / (1.0 + cos_cone);
    let cos = 1.0 - u.x * cap;
    let sin = (u.x * cap * (1.0 + cos)).sqrt();
    let (y, x) = (std::f32::consts::TAU * u.y).sin_cos();
    let along = Frame::from_normal(direction).to_world(Vec3::new(sin * x, sin * y, cos));
    join_along(scene, light, camera, [direction, along], 2.0 * cap / (radius * radius), rng)
}

/// Light goes along `direction` and turns as if along `turning`, and is spread by `spread`, 1/m^2.
#[inline(always)]
fn join_along(
    scene: &Scene,
    light: &Vertex,
    camera: &Vertex,
    [direction, turning]: [Vec3; 2],
    spread: f32,
    rng: &mut Rng,
) -> Option<Join> {
    let at_camera = turn::<FromCamera>(scene, camera, -turning);
    if at_camera.value.is_black() {
        return None;
    }
    let at_light = turn::<FromLight>(scene, light, turning);
    let value = at_light.value * at_camera.value * spread;
    if value.is_black() {
        return None;
    }
    let (from, medium) = departure(scene, light, direction);
    let (to, _) = departure(scene, camera, -direction);
    let length = from.distance(to) * SHORT_OF;
    let (transmittance, edge) = edge_passage(scene, Ray::between(from, to), length, medium, rng)?;
    let value = value * transmittance;
    Some(Join { direction, spread, light: at_light, camera: at_camera, edge, value })
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
