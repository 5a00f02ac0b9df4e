//! Light that leaves emitters: where light paths start.
//!
//! An emitter is chosen by its power, then a point and a direction by what it sends there. Emitters at infinity are
//! chosen one by one, each with its own radiance; their light enters through a disk that covers the scene.

use super::{Area, Constant, Emitter, EmitterId, Lights};
use crate::Spectrum;
use crate::math::random::more_bits;
use crate::math::{Frame, PerArea, PerSolidAngle, Ray, Vec2, Vec3, sobol, warp};
use crate::scene::desc::MediumId;
use crate::scene::shape::Geometry;
use crate::scene::texture::{Texture, TexturePoint};
use std::f32::consts::{FRAC_1_PI, PI};

/// Points at which a texture is looked up to find the power behind it.
const LOOK_UPS: u32 = 1 << 14;

/// Light that leaves an emitter: the start of a light path.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// The first ray. It starts just off the surface of an area light; for emitters at infinity on a disk outside the
    /// sphere around the scene.
    pub ray: Ray,
    /// The emitter chosen.
    pub emitter: EmitterId,
    /// What the path carries, W: radiance times cosine over all densities, the selection included. The sum over paths,
    /// divided by their number, estimates the emitted power.
    pub flux: Spectrum,
    /// Unit normal of an area light; zero for others.
    pub normal: Vec3,
    /// Probability of the emitter.
    pub selection: f32,
    /// Density of the position, given the emitter; 1 for a single point, and per area across the ray for emitters at
    /// infinity.
    pub position_density: PerArea,
    /// Density of the direction, given the emitter and the position; 1 for a single direction.
    pub direction_density: PerSolidAngle,
    /// Whether the emitter is a single point.
    pub delta_position: bool,
    /// Whether the emitter sends light in a single direction.
    pub delta_direction: bool,
    /// Medium in which the ray starts. Only [`Scene::sample_emission`](crate::scene::Scene::sample_emission) knows it.
    pub medium: Option<MediumId>,
}

/// A direction in which an emitter that is a point sends light.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Radiant intensity over density, W.
    pub flux: Spectrum,
    /// Density of the direction.
    pub density: PerSolidAngle,
}

/// How much each emitter of a scene sends, and the choice among them.
#[derive(Debug)]
pub struct EmissionTable {
    /// Sum over all emitters, W.
    power: Spectrum,
    /// Emitters that can be chosen, with running sums of power times sampling weight.
    choices: Vec<(EmitterId, f64)>,
    /// Radius of the disk through which light from infinity enters, and its distance from the centre, metres.
    disk_radius: f32,
}

impl EmissionTable {
    /// The emitters with their sampling weights. `centre` and `radius` are of the sphere around the scene, metres.
    pub fn new(emitters: &[Emitter], weights: &[f32], geometry: &Geometry, centre: Vec3, radius: f32) -> Self {
        // Larger than the sphere by more than the rounding of points on the disk.
        let disk_radius = radius * (1.0 + 1e-5) + 8.0 * f32::EPSILON * centre.abs().max_element();
        let mut table = Self { power: Spectrum::ZERO, choices: Vec::new(), disk_radius };
        let mut sum = 0.0;
        for ((id, emitter), weight) in (0..).map(EmitterId).zip(emitters).zip(weights) {
            let power = emitter.power(geometry, PI * disk_radius * disk_radius);
            table.power += power;
            let share = f64::from(power.mean()) * f64::from(*weight);
            if share > 0.0 {
                sum += share;
                table.choices.push((id, sum));
            }
        }
        table
    }

    /// An emitter chosen with `u`, and the probability of the choice. `None` when there is no light.
    #[inline(always)]
    fn choose(&self, u: f64) -> Option<(EmitterId, f32)> {
        let (_, total) = *self.choices.last()?;
        let index = self.choices.partition_point(|(_, sum)| *sum <= u * total).min(self.choices.len() - 1);
        let below = if index == 0 { 0.0 } else { self.choices[index - 1].1 };
        let (emitter, sum) = self.choices[index];
        Some((emitter, ((sum - below) / total) as f32))
    }

    /// Probability that an emitter is chosen.
    #[inline]
    pub(super) fn probability(&self, emitter: EmitterId) -> f32 {
        let Ok(index) = self.choices.binary_search_by_key(&emitter, |(id, _)| *id) else { return 0.0 };
        let below = if index == 0 { 0.0 } else { self.choices[index - 1].1 };
        let total = self.choices[self.choices.len() - 1].1;
        ((self.choices[index].1 - below) / total) as f32
    }

    /// Density per area of the places on the disk through which light from infinity enters.
    #[inline]
    pub(super) fn disk_density(&self) -> PerArea {
        PerArea(FRAC_1_PI / (self.disk_radius * self.disk_radius))
    }
}

impl Lights {
    /// Power that all emitters send, W; of those at infinity what enters the sphere around the scene. Behind textures by
    /// quadrature, to about a percent, else exact.
    pub fn power(&self) -> Spectrum {
        self.emission.power
    }

    /// Light that leaves an emitter: one chosen with `choice` by its power, a point on it and a direction. `None` when
    /// no light leaves there. The medium is not known here.
    #[inline(always)]
    pub fn sample_emission(&self, choice: f32, u_position: Vec2, u_direction: Vec2) -> Option<Emission> {
        let (id, selection) = self.emission.choose(more_bits(choice, u_position.x))?;
        let emission = match &self.emitters()[id.0 as usize] {
            Emitter::Area(area) => self.leave_area(area, u_position, u_direction)?,
            other => self.leave_other(other, u_position, u_direction)?,
        };
        let flux = emission.flux / selection;
        (!flux.is_black()).then_some(Emission { emitter: id, selection, flux, ..emission })
    }

    /// Light that leaves anything but an area light.
    #[inline(never)]
    fn leave_other(&self, emitter: &Emitter, u_position: Vec2, u_direction: Vec2) -> Option<Emission> {
        Some(match emitter {
            Emitter::Area(area) => self.leave_area(area, u_position, u_direction)?,
            Emitter::Point(point) => Emission::from_point(point.position, point.emit(u_direction)),
            Emitter::Spot(spot) => Emission::from_point(spot.position, spot.emit(u_direction)),
            Emitter::Projector(projector) => Emission::from_point(projector.position, projector.emit(u_direction)),
            Emitter::Directional(light) => {
                let enters = self.enter(light.direction, light.irradiance, PerSolidAngle(1.0), u_position);
                Emission { delta_direction: true, ..enters }
            }
            Emitter::Constant(light) => {
                self.enter(-Constant::sample(u_direction), light.radiance, Constant::PDF, u_position)
            }
            Emitter::Envmap(map) => {
                let out = map.sample(u_direction);
                let density = map.pdf(out);
                if !(density.0 > 0.0) {
                    return None;
                }
                self.enter(-out, map.radiance(out), density, u_position)
            }
        })
    }

    /// A point uniform on an area light and a direction by the cosine.
    #[inline(always)]
    fn leave_area(&self, area: &Area, u_position: Vec2, u_direction: Vec2) -> Option<Emission> {
        let (point, position_density) = self.geometry.sample_area(area.shape, u_position)?;
        let local = warp::square_to_cosine_hemisphere(u_direction);
        if !(local.z > 0.0) {
            return None;
        }
        let direction = Frame::from_normal(point.normal).to_world(local);
        let texture_point = TexturePoint::on_emitter(&point, self.geometry.mesh(area.shape));
        let radiance = area.radiance(&texture_point, point.normal, point.normal);
        Some(Emission {
            ray: Ray { origin: self.geometry.leave_emitter(area.shape, &point), direction },
            flux: radiance * (PI / position_density.0),
            normal: point.normal,
            position_density,
            direction_density: PerSolidAngle(local.z * FRAC_1_PI),
            ..Emission::NONE
        })
    }

    /// Light from infinity that travels in `direction`, of that radiance and density of the direction.
    #[inline]
    fn enter(&self, direction: Vec3, radiance: Spectrum, direction_density: PerSolidAngle, u: Vec2) -> Emission {
        let radius = self.emission.disk_radius;
        let frame = Frame::from_normal(direction);
        let at = radius * warp::square_to_disk(u);
        let position_density = self.emission.disk_density();
        Emission {
            ray: Ray { origin: self.centre + frame.to_world(at.extend(-radius)), direction },
            flux: radiance / (direction_density.0 * position_density.0),
            position_density,
            direction_density,
            ..Emission::NONE
        }
    }
}

impl Emission {
    /// What the kinds of emitters fill in.
    const NONE: Self = Self {
        ray: Ray { origin: Vec3::ZERO, direction: Vec3::Z },
        emitter: EmitterId(0),
        flux: Spectrum::ZERO,
        normal: Vec3::ZERO,
        selection: 1.0,
        position_density: PerArea(1.0),
        direction_density: PerSolidAngle(1.0),
        delta_position: false,
        delta_direction: false,
        medium: None,
    };

    #[inline]
    fn from_point(position: Vec3, Departure { direction, flux, density }: Departure) -> Self {
        Self {
            ray: Ray { origin: position, direction },
            flux,
            direction_density: density,
            delta_position: true,
            ..Self::NONE
        }
    }
}

impl Emitter {
    /// Power that it sends, W; from infinity through a disk of `disk_area` m^2.
    fn power(&self, geometry: &Geometry, disk_area: f32) -> Spectrum {
        match self {
            Self::Area(area) => area.power(geometry),
            Self::Point(point) => point.power(),
            Self::Spot(spot) => spot.power(),
            Self::Projector(projector) => projector.power(),
            Self::Directional(light) => light.fluence() * disk_area,
            Self::Constant(light) => light.fluence() * disk_area,
            Self::Envmap(map) => map.fluence() * disk_area,
        }
    }
}

/// Power behind `texture`: the mean of `flux` over the unit square, `white` times the texture where that is constant.
pub fn textured_power(texture: &Texture, white: Spectrum, flux: impl Fn(Vec2) -> Spectrum) -> Spectrum {
    let even = white * texture.mean();
    if !texture.varies() {
        return even;
    }
    let mut sum = [0.0; Spectrum::CHANNELS];
    for i in 0..LOOK_UPS {
        let [x, y, ..] = sobol::point(i, 0);
        for (total, channel) in sum.iter_mut().zip(flux(Vec2::new(x, y)).to_rgb()) {
            *total += f64::from(channel);
        }
    }
    let mean = Spectrum::from_rgb(sum.map(|total| (total / f64::from(LOOK_UPS)) as f32));
    // What light there is may lie between the look-ups. An emitter of some power must not count as dark.
    if mean.is_black() { even } else { mean }
}
