//! Transmittance along a ray, at every distance at once.

use super::Segment;
use super::flight::{Next, Uniform, bounds, reach, tentative_collisions};
use crate::Spectrum;
use crate::math::{Ray, Rng};
use crate::scene::Scene;
use crate::scene::medium::{Extinction, Heterogeneous, Medium, Segment as Span};
use crate::scene::phase::Phase;

/// Transmittance from the start of a ray to any point of it inside one medium: exact in homogeneous media, and in
/// heterogeneous ones a random function whose value at each distance is an unbiased estimate (residual ratio tracking,
/// Novak et al. 2014, kept at every step).
#[derive(Clone, Debug, Default)]
pub struct Profile {
    uniform: Option<Uniform>,
    steps: Vec<Step>,
}

/// A stretch of the ray on which the transmittance is `value * exp(-rate * (t - from))`.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Distance of the start, metres.
    pub from: f32,
    /// Distance of the end, metres; the value stays what it is there up to the next step.
    pub until: f32,
    /// Transmittance at the start.
    pub value: Spectrum,
    /// Rate of its decay, 1/m.
    pub rate: f32,
}

impl Step {
    #[inline(always)]
    fn at(&self, t: f32) -> Spectrum {
        self.value * (-self.rate * (t.min(self.until) - self.from)).exp()
    }
}

impl Profile {
    /// Becomes the profile of the first `length` metres of `ray` through `medium`. Memory is re-used.
    pub fn trace(&mut self, medium: &Medium, ray: &Ray, length: f32, rng: &mut Rng) {
        self.steps.clear();
        self.uniform = None;
        match medium.kind() {
            Extinction::Homogeneous(model) => self.uniform = Some(Uniform::along(model, medium.phase(), ray)),
            Extinction::Heterogeneous(model) => self.track(model, medium.phase(), ray, length, rng),
        }
    }

    /// Becomes the profile of the part of a camera's segment that lies in reach of its medium, and answers with that part:
    /// a ray and its length, metres.
    pub fn trace_segment(&mut self, scene: &Scene, segment: &Segment, rng: &mut Rng) -> Option<(Ray, f32)> {
        let medium = scene.medium(segment.medium);
        let (near, far) = reach(medium, segment.ray, segment.length)?;
        let ray = Ray { origin: segment.ray.at(near), direction: segment.ray.direction };
        self.trace(medium, &ray, far - near, rng);
        Some((ray, far - near))
    }

    fn track(&mut self, medium: &Heterogeneous, phase: &Phase, ray: &Ray, length: f32, rng: &mut Rng) {
        let (factor, share) = bounds(phase, ray);
        let steps = std::cell::RefCell::new(&mut self.steps);
        let enter = |span: &Span| {
            let mut steps = steps.borrow_mut();
            let rate = span.minorant * share;
            let (value, last_rate) = steps.last().map_or((Spectrum::ONE, 0.0), |s| (s.at(s.until), s.rate));
            match steps.last_mut() {
                Some(last) if rate == 0.0 && last_rate == 0.0 => last.until = span.t1,
                _ => steps.push(Step { from: span.t0, until: span.t1, value, rate }),
            }
        };
        let collide = |t: f32, majorant: f32, _: &mut Rng| {
            let mut steps = steps.borrow_mut();
            let Some(last) = steps.last_mut() else { return Next::Continue };
            let x = ray.at(t);
            let sigma_t = medium.sigma_t(x) * phase.extinction_factor(x, ray.direction);
            let ratio = (Spectrum::ONE - (sigma_t - Spectrum::grey(last.rate)) / majorant).max(Spectrum::ZERO);
            let next = Step { from: t, until: last.until, value: last.at(t) * ratio, rate: last.rate };
            last.until = t;
            let opaque = next.value.is_black();
            steps.push(next);
            if opaque { Next::Stop } else { Next::Continue }
        };
        let rate = |majorant: f32, minorant: f32| majorant * factor - minorant * share;
        tentative_collisions(medium, ray, length, rng, rate, enter, collide);
    }

    /// Transmittance from the start of the ray to the distance `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Spectrum {
        if let Some(uniform) = &self.uniform {
            return uniform.transmittance(t);
        }
        match self.steps.partition_point(|step| step.from <= t).checked_sub(1) {
            Some(i) => self.steps[i].at(t),
            None => Spectrum::ONE,
        }
    }

    /// The stretches of a ray through a heterogeneous medium, in order; the transmittance is one before the first.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The extinction along a ray through a homogeneous medium.
    pub fn uniform(&self) -> Option<&Uniform> {
        self.uniform.as_ref()
    }
}
