//! How likely flights pass an edge of a path, as far as weights of multiple importance sampling are concerned.

use super::flight::Uniform;
use crate::math::{Ray, Vec3};
use crate::scene::medium::{Extinction, Medium};

/// Least probability of passing that weights tell from nothing.
const LEAST: f32 = 1e-30;
/// Least rate of collisions that weights tell from none, 1/m: a blur may meet data where there is no extinction.
const LEAST_RATE: f32 = 1e-9;

/// Probabilities of free flight along the straight way from one vertex to the next, through any number of media.
///
/// All techniques that find a path compute the same numbers from it alone. They are those of the flights in grey
/// homogeneous media; means over the channels in chromatic ones, whatever the throughput; and in heterogeneous media
/// those of the means of the local bounds, which no random number enters. Weights sum to one whatever they are.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Probability of passing all of it.
    pub survival: f32,
    /// Probability of passing the first and the last stretch inside one medium.
    pub stretches: [f32; 2],
    /// Density of a collision at the first and at the last point, over the probability of getting there, 1/m. Means
    /// something at points inside media only.
    pub rates: [f32; 2],
    started: bool,
}

impl Edge {
    /// Of no length.
    pub const START: Self = Self { survival: 1.0, stretches: [1.0; 2], rates: [1.0; 2], started: false };

    /// Goes on by `length` metres of `ray` through `medium`.
    #[inline]
    pub fn pass(&mut self, medium: &Medium, ray: &Ray, length: f32) {
        let (survival, rates) = match medium.kind() {
            Extinction::Homogeneous(model) => {
                let uniform = Uniform::along(model, medium.phase(), ray);
                let transmittance = uniform.transmittance(length);
                let survival = transmittance.mean().max(LEAST);
                let rate = match uniform.is_grey() {
                    true => uniform.sigma_t[0],
                    false => (uniform.sigma_t * transmittance).mean() / survival,
                };
                (survival, [rate; 2])
            }
            Extinction::Heterogeneous(model) => {
                let spans = model.majorants().segments(ray.origin, ray.direction, length);
                let depth: f32 = spans.map(|span| 0.5 * (span.t1 - span.t0) * (span.majorant + span.minorant)).sum();
                let factor = |x: Vec3| medium.phase().extinction_factor(x, ray.direction);
                let rate = |x: Vec3| model.sigma_t(x).mean() * factor(x);
                let first = if self.started { 1.0 } else { rate(ray.origin) };
                let along = medium.phase().max_extinction_factor(ray.direction);
                ((-depth * along).exp().max(LEAST), [first, rate(ray.at(length.min(1e12)))])
            }
        };
        let rates = rates.map(|rate: f32| rate.max(LEAST_RATE));
        self.survival = (self.survival * survival).max(LEAST);
        if !self.started {
            self.started = true;
            self.stretches[0] = survival;
            self.rates[0] = rates[0];
        }
        self.stretches[1] = survival;
        self.rates[1] = rates[1];
    }

    /// The same edge walked the other way.
    #[inline]
    pub fn reversed(self) -> Self {
        let ([a, b], [c, d]) = (self.stretches, self.rates);
        Self { stretches: [b, a], rates: [d, c], ..self }
    }

    /// Density of a flight's end at the last point: per length in a medium, else the probability of getting there.
    #[inline]
    pub fn arrival(&self, in_medium: bool) -> f32 {
        if in_medium { self.survival * self.rates[1] } else { self.survival }
    }

    /// The same of the first point, for a flight the other way.
    #[inline]
    pub fn departure(&self, in_medium: bool) -> f32 {
        if in_medium { self.survival * self.rates[0] } else { self.survival }
    }
}
