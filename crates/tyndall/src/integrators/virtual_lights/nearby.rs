//! Light from nearby that a bound on 1/d^2 cuts off in media, approximately (Raab et al. 2008; Engelhardt et al. 2012).
//!
//! With the bound b the lights give a point the part `min(1, b r^2)` of what they should give at the distance r. The rest
//! comes from within `R = 1 / sqrt(b)`, an integral over directions and distances of
//! `f Tr(r) sigma_s(y) (1 - b r^2) L(y)`, where L(y) is light scattered at y: what comes straight from an emitter, what the
//! lights give, cut off again, and the rest of that. A walk of short steps estimates it, with direct light and a few of the
//! lights at each. It ends soon, because little is scattered within R.
//!
//! The steps are no free flights, whose distances follow the transmittance: they follow the share that is missing and end at R.
//!
//! Approximate is that extinction is taken from both ends of a step; that the walk ends at the first surface, whose own
//! rest is missing; and that direct light is found by sampling emitters alone, so not over smooth mirrors and glass.

use super::camera::{Seeker, start};
use super::{VirtualLights, wanted};
use crate::Spectrum;
use crate::estimators::transport::{connect, departure, is_smooth, respond};
use crate::math::{Ray, Sampler, Vec2};
use crate::scene::Scene;
use crate::walk::{FromCamera, Media, Onward, Profile, Rules, Scattering, Sink, Vertex, walk};
use std::cell::Cell;

/// Of the lights that a point on the camera's ray visits, one in so many is visited at each step.
const FEWER: u32 = 8;
/// Largest probability to go on.
const CAP: f32 = 0.95;

/// The sink that walks around the first collision.
pub(super) struct Nearby<'a> {
    lights: &'a VirtualLights,
    scene: &'a Scene,
    seeker: Seeker<'a>,
    radiance: Spectrum,
}

impl<'a> Nearby<'a> {
    /// Radiance arriving at the film position (pixels of the whole film) that the bound cuts off, one sample.
    #[inline]
    pub(super) fn radiance(
        lights: &'a VirtualLights,
        scene: &'a Scene,
        profile: &'a mut Profile,
        connections: &'a Cell<u64>,
        film: Vec2,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let rules = Rules { media: Media::Scatter, ..lights.options.camera_rules };
        let seeker = Seeker::new(lights, scene, profile, connections);
        let mut nearby = Nearby { lights, scene, seeker, radiance: Spectrum::ZERO };
        walk::<FromCamera, _>(scene, start(scene, film, sampler), &rules, sampler, &mut nearby);
        nearby.radiance
    }

    /// Light scattered within the reach of the bound around the collision, and from there on.
    fn around(&self, collision: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let options = &self.lights.options;
        let all = self.lights.points.len().max(self.lights.rays.len()) as u32;
        let few = (if options.lights == 0 { all } else { options.lights }).div_ceil(FEWER);
        let mut sum = Spectrum::ZERO;
        let mut at = *collision;
        while at.scatterings + 3 <= options.camera_rules.max_depth {
            let Some(mut next) = self.step(&at, sampler) else { break };
            let survival = next.throughput.max_channel() / at.throughput.max_channel();
            let survival = survival.min(CAP);
            if !(sampler.rng().f32() < survival) {
                break;
            }
            next.throughput = next.throughput / survival;
            sum += self.direct(&next, sampler);
            sum += self.seeker.gather(&next, few, sampler) / options.photons as f32;
            if let Scattering::Surface { .. } = next.scattering {
                break;
            }
            at = next;
        }
        sum
    }

    /// The next vertex of the walk, at most the reach away: in the medium, or on a surface that is in the way.
    fn step(&self, at: &Vertex, sampler: &mut Sampler) -> Option<Vertex> {
        let Scattering::Medium { medium: id } = at.scattering else { return None };
        let medium = self.scene.medium(id);
        let phase = medium.phase();
        let rng = sampler.rng();
        let (direction, _) = phase.sample(at.position, at.direction, rng.f32(), rng.vec2());
        let ray = Ray { origin: at.position, direction };
        let reach = self.lights.options.clamp.sqrt().recip();
        let distance = reach * Shell::sample(rng.f32());
        let hit = self.scene.geometry.intersect(&ray, distance);
        let length = hit.as_ref().map_or(distance, |hit| hit.t);
        let position = ray.at(length);
        let [here, there] = [at.position, position].map(|x| medium.sigma_t(x) * phase.extinction_factor(x, direction));
        let transmittance = ((here + there) * (-0.5 * length)).exp();
        let leaves = Vertex { position, direction, scatterings: at.scatterings + 1, leg: at.leg + 1, ..*at };
        let Some(hit) = hit else {
            let scattered = there * medium.albedo(position) * (reach / Shell::density(0.0));
            return Some(Vertex { throughput: at.throughput * transmittance * scattered, ..leaves });
        };
        let point = self.scene.geometry.surface(&ray, &hit);
        let x = length / reach;
        let weight = Shell::share(x) / Shell::beyond(x);
        let vertex = Vertex {
            position: point.position,
            throughput: at.throughput * transmittance * weight,
            scattering: Scattering::Surface { point, medium: Some(id) },
            ..leaves
        };
        (is_smooth(self.scene, &vertex) && weight.is_finite()).then_some(vertex)
    }

    /// Light that comes straight from an emitter and is scattered at the vertex.
    fn direct(&self, vertex: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let rng = sampler.rng();
        let (choice, u) = (rng.f32(), rng.vec2());
        let Some(light) = self.scene.lights.sample(vertex.position, choice, u) else { return Spectrum::ZERO };
        let value = respond(self.scene, vertex, light.direction).value;
        if value.is_black() {
            return Spectrum::ZERO;
        }
        let (origin, medium) = departure(self.scene, vertex, light.direction);
        match connect(self.scene, origin, &light, medium, true, sampler.rng()) {
            Some((arriving, _)) => vertex.throughput * value * arriving / light.pdf.0,
            None => Spectrum::ZERO,
        }
    }
}

impl Sink for Nearby<'_> {
    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        let in_medium = matches!(vertex.scattering, Scattering::Medium { .. });
        if in_medium && wanted(self.lights.options.components, &vertex.scattering) {
            self.radiance += self.around(vertex, sampler);
        }
    }

    fn scattered(&mut self, _vertex: &Vertex, onward: &Onward) -> bool {
        onward.pdf.is_none()
    }
}

/// Distances in units of the reach, with a density proportional to the share `1 - x^2` of light that is missing.
struct Shell;

impl Shell {
    /// The share that is missing.
    fn share(x: f32) -> f32 {
        (1.0 - x) * (1.0 + x)
    }

    /// Density of the distance `x`.
    fn density(x: f32) -> f32 {
        1.5 * Self::share(x)
    }

    /// The distance for `u` in [0, 1): the root of `x (3 - x^2) / 2 = u`, by the sine of three times an angle.
    fn sample(u: f32) -> f32 {
        2.0 * (u.asin() / 3.0).sin()
    }

    /// Probability of a distance above `x`.
    fn beyond(x: f32) -> f32 {
        // 1 - x (3 - x^2) / 2, without cancellation.
        0.5 * (1.0 - x) * (1.0 - x) * (2.0 + x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_testkit::chi2;

    #[test]
    fn distances_follow_the_missing_share() {
        let sample = |u| Some(f64::from(Shell::sample(u)));
        chi2::interval(sample, |x| f64::from(Shell::density(x as f32)), 0.0, 1.0, 100_000, 1).assert(0.01, 2);
        for x in [0.0_f32, 0.3, 0.9] {
            let beyond = chi2::interval(
                |u| sample(u).filter(|y| *y > f64::from(x)),
                |y| f64::from(Shell::density(y as f32)),
                f64::from(x),
                1.0,
                100_000,
                2,
            );
            assert!((beyond.integral - f64::from(Shell::beyond(x))).abs() < 1e-6, "{x}: {beyond:?}");
        }
    }
}
