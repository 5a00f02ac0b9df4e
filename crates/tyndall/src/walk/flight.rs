//! The free flight: where along a ray does light meet the medium, and with which weight.
//!
//! Homogeneous media are solved in closed form. Heterogeneous media are tracked by null collisions over a grid of local
//! majorants: one loop, `tentative_collisions`, serves the sampling of distances (delta tracking, Woodcock 1965) and
//! the estimation of transmittance (residual ratio tracking, Novak et al. 2014).
//!
//! Chromatic media draw a hero channel for each flight with probabilities proportional to the throughput and divide by
//! the density of the mixture over all channels: the balance heuristic of spectral MIS (Miller et al. 2019), which
//! needs no memory beyond the flight because its densities are divided out where it ends.

use crate::Spectrum;
use crate::math::{Aabb, PerLength, Ray, Rng, Vec2};
use crate::scene::medium::{Extinction, Heterogeneous, Homogeneous, Medium, Segment as Span};
use crate::scene::phase::Phase;

/// One free flight of a ray through one medium.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Distance of the collision, metres; the whole length when there was none.
    pub distance: f32,
    /// Whether light met the medium before the end.
    pub collided: bool,
    /// What the throughput is multiplied by: `sigma_s Tr / p` at a collision, `Tr / P` at the end.
    pub weight: Spectrum,
    /// Density of the collision's distance where it is known in closed form (homogeneous media).
    pub density: Option<PerLength>,
}

impl Flight {
    /// Mean over the channels of the transmittance up to the end, when the end was reached through a homogeneous
    /// medium; 1 otherwise. Weights of multiple importance sampling use it, nothing else.
    #[inline]
    pub fn survival(&self, medium: &Medium, ray: &Ray) -> f32 {
        match medium.kind() {
            Extinction::Homogeneous(model) if !self.collided => {
                Uniform::along(model, medium.phase(), ray).transmittance(self.distance).mean()
            }
            _ => 1.0,
        }
    }
}

/// Samples a free flight of at most `length` metres along `ray`, for light of the given `throughput`.
///
/// `u` decides the distance and the hero channel in homogeneous media, where `ahead` is what [`ahead`] says of them;
/// `rng` feeds null-collision tracking.
#[inline(always)]
pub fn fly(
    medium: &Medium,
    ray: &Ray,
    length: f32,
    ahead: f32,
    throughput: Spectrum,
    u: Vec2,
    rng: &mut Rng,
) -> Flight {
    match medium.kind() {
        Extinction::Homogeneous(model) => {
            let uniform = Uniform::along(model, medium.phase(), ray);
            fly_homogeneous(model, &uniform, ray, length, ahead, throughput, u)
        }
        Extinction::Heterogeneous(model) => fly_heterogeneous(model, medium.phase(), ray, length, throughput, u.y, rng),
    }
}

/// How far [`fly`] gets where nothing ends the flight, if that is known without flying: infinitely far in heterogeneous
/// media.
#[inline(always)]
pub fn ahead(medium: &Medium, ray: &Ray, throughput: Spectrum, u: Vec2) -> f32 {
    match medium.kind() {
        Extinction::Homogeneous(model) => Uniform::along(model, medium.phase(), ray).distance(throughput, u),
        Extinction::Heterogeneous(_) => f32::INFINITY,
    }
}

/// Extinction that is the same all along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Uniform {
    /// Extinction, 1/m.
    pub sigma_t: Spectrum,
    is_grey: bool,
}

impl Uniform {
    /// Optical depth beyond which no free flight gets: that of the largest number below one.
    pub const OPAQUE: f32 = 20.0;

    /// The extinction of a homogeneous medium along `ray`.
    #[inline(always)]
    pub fn along(medium: &Homogeneous, phase: &Phase, ray: &Ray) -> Self {
        let factor = phase.extinction_factor(ray.origin, ray.direction);
        Self { sigma_t: medium.sigma_t() * factor, is_grey: medium.is_grey() }
    }

    /// Distance of the collision that `u` decides, in the channel that it chooses.
    #[inline(always)]
    fn distance(&self, throughput: Spectrum, u: Vec2) -> f32 {
        let hero = if self.is_grey { 0 } else { choose_channel(hero_probabilities(throughput), u.y) };
        -(1.0 - u.x).ln() / self.sigma_t[hero]
    }

    /// Transmittance of `t` metres.
    #[inline(always)]
    pub fn transmittance(&self, t: f32) -> Spectrum {
        // `min` because 0 times an infinite length is not a number.
        let t = t.min(f32::MAX);
        if self.is_grey { Spectrum::grey((-self.sigma_t[0] * t).exp()) } else { (self.sigma_t * -t).exp() }
    }

    /// Distance that no free flight exceeds in a channel that scatters, metres; infinite without extinction.
    #[inline(always)]
    pub fn opaque_distance(&self) -> f32 {
        let rate = |c: usize| if self.sigma_t[c] > 0.0 { self.sigma_t[c] } else { f32::INFINITY };
        match rate(0).min(rate(1)).min(rate(2)) {
            f32::INFINITY => f32::INFINITY,
            least => Self::OPAQUE / least,
        }
    }

    /// Transmittance of `t` metres over the probability that a flight of light of that throughput gets so far.
    #[inline(always)]
    pub fn survivor_weight(&self, throughput: Spectrum, t: f32) -> Spectrum {
        if self.is_grey {
            return Spectrum::ONE;
        }
        let transmittance = self.transmittance(t);
        let probability = expectation(hero_probabilities(throughput), transmittance);
        if probability > 0.0 { transmittance / probability } else { Spectrum::ZERO }
    }

    /// Whether the channels are equal.
    #[inline(always)]
    pub fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// Density with which [`fly`] puts a collision at distance `t`, and the transmittance up to it.
    #[inline(always)]
    pub fn collision(&self, throughput: Spectrum, t: f32) -> (PerLength, Spectrum) {
        let transmittance = self.transmittance(t);
        if self.is_grey {
            return (PerLength(self.sigma_t[0] * transmittance[0]), transmittance);
        }
        let density = expectation(hero_probabilities(throughput), self.sigma_t * transmittance);
        (PerLength(density), transmittance)
    }
}

/// Probabilities of the channels as hero: proportional to the throughput.
#[inline(always)]
fn hero_probabilities(throughput: Spectrum) -> Spectrum {
    let positive = throughput.max(Spectrum::ZERO);
    let sum = 3.0 * positive.mean();
    if sum > 0.0 { positive / sum } else { Spectrum::grey(1.0 / 3.0) }
}

/// The channel that `u` in [0, 1) falls on.
#[inline(always)]
fn choose_channel(probabilities: Spectrum, u: f32) -> usize {
    if u < probabilities[0] {
        0
    } else if u < probabilities[0] + probabilities[1] || probabilities[2] == 0.0 {
        1
    } else {
        2
    }
}

/// Mean of `values` under the hero probabilities.
#[inline(always)]
fn expectation(probabilities: Spectrum, values: Spectrum) -> f32 {
    3.0 * (probabilities * values).mean()
}

#[inline(always)]
fn fly_homogeneous(
    medium: &Homogeneous,
    uniform: &Uniform,
    ray: &Ray,
    length: f32,
    t: f32,
    throughput: Spectrum,
    u: Vec2,
) -> Flight {
    let passed = |weight| Flight { distance: length, collided: false, weight, density: None };
    if uniform.is_grey {
        if t < length {
            return Flight {
                distance: t,
                collided: true,
                weight: medium.albedo(ray.at(t)),
                density: Some(PerLength(uniform.sigma_t[0] * (1.0 - u.x))),
            };
        }
        return passed(Spectrum::ONE);
    }
    if t < length {
        let (density, transmittance) = uniform.collision(throughput, t);
        return Flight {
            distance: t,
            collided: true,
            weight: medium.albedo(ray.at(t)) * uniform.sigma_t * transmittance / density.0,
            density: Some(density),
        };
    }
    let transmittance = uniform.transmittance(length);
    passed(transmittance / expectation(hero_probabilities(throughput), transmittance))
}

/// The stretch of the first `length` metres of `ray` (possibly infinite) on which `medium` scatters noticeably: its start and
/// its end, finite. `None` when there is none.
#[inline]
pub fn reach(medium: &Medium, ray: &Ray, length: f32) -> Option<(f32, f32)> {
    let (near, far) = match medium.kind() {
        Extinction::Homogeneous(model) => {
            (0.0, length.min(Uniform::along(model, medium.phase(), ray).opaque_distance()))
        }
        Extinction::Heterogeneous(model) => {
            let Aabb { min, max } = model.bounds();
            let inverse = ray.direction.recip();
            let (a, b) = ((min - ray.origin) * inverse, (max - ray.origin) * inverse);
            (a.min(b).max_element().max(0.0), a.max(b).min_element().min(length))
        }
    };
    (near < far && far.is_finite()).then_some((near, far))
}

/// What a tracker does at a tentative collision.
pub(super) enum Next {
    Continue,
    Stop,
}

/// THE free-flight loop: visits tentative collisions along the ray in order.
///
/// In each cell of the majorant grid they come at the constant rate `rate(majorant, minorant)`, 1/m. Cells of rate zero
/// are skipped. `cell` is told every cell, `collision` gets the distance and the rate.
#[inline(always)]
pub(super) fn tentative_collisions(
    medium: &Heterogeneous,
    ray: &Ray,
    length: f32,
    rng: &mut Rng,
    rate: impl Fn(f32, f32) -> f32,
    mut cell: impl FnMut(&Span),
    mut collision: impl FnMut(f32, f32, &mut Rng) -> Next,
) {
    // Optical depth of the tentative medium until the next collision: carried from cell to cell, so that each
    // exponential number is used up exactly.
    let mut depth = -(1.0 - rng.f32()).ln();
    for span in medium.majorants().segments(ray.origin, ray.direction, length) {
        cell(&span);
        let rate = rate(span.majorant, span.minorant);
        if rate <= 0.0 {
            continue;
        }
        let mut t = span.t0;
        loop {
            let step = depth / rate;
            if t + step >= span.t1 {
                depth -= (span.t1 - t) * rate;
                break;
            }
            t += step;
            if let Next::Stop = collision(t, rate, rng) {
                return;
            }
            depth = -(1.0 - rng.f32()).ln();
        }
    }
}

/// Delta tracking. One majorant serves all channels, so that null collisions weigh the channels against each other by
/// their null probabilities only.
#[inline]
fn fly_heterogeneous(
    medium: &Heterogeneous,
    phase: &Phase,
    ray: &Ray,
    length: f32,
    throughput: Spectrum,
    u: f32,
    rng: &mut Rng,
) -> Flight {
    let mut flight = Flight { distance: length, collided: false, weight: Spectrum::ONE, density: None };
    let factor = phase.max_extinction_factor(ray.direction);
    if medium.is_grey() {
        let collide = |t: f32, rate: f32, rng: &mut Rng| {
            let x = ray.at(t);
            let sigma_t = medium.sigma_t(x)[0] * phase.extinction_factor(x, ray.direction);
            if rng.f32() * rate >= sigma_t {
                return Next::Continue;
            }
            flight.distance = t;
            flight.collided = true;
            flight.weight = medium.albedo(x);
            Next::Stop
        };
        tentative_collisions(medium, ray, length, rng, |majorant, _| majorant * factor, |_| (), collide);
        return flight;
    }
    let probabilities = hero_probabilities(throughput);
    let hero = choose_channel(probabilities, u);
    // Density of the events so far in each channel, relative to the hero's.
    let mut events = Spectrum::ONE;
    let collide = |t: f32, rate: f32, rng: &mut Rng| {
        let x = ray.at(t);
        let real = medium.sigma_t(x) * (phase.extinction_factor(x, ray.direction) / rate);
        if rng.f32() >= real[hero] {
            let null = Spectrum::ONE - real;
            events *= null / null[hero];
            return Next::Continue;
        }
        flight.distance = t;
        flight.collided = true;
        events *= real / real[hero];
        flight.weight = medium.albedo(x);
        Next::Stop
    };
    tentative_collisions(medium, ray, length, rng, |majorant, _| majorant * factor, |_| (), collide);
    flight.weight *= events / expectation(probabilities, events);
    flight
}

/// Transmittance of `length` metres along `ray` and the survival that weights of multiple importance sampling use (see
/// [`Flight::survival`]): exact in homogeneous media, an unbiased estimate in heterogeneous ones.
#[inline]
pub fn transmittance(medium: &Medium, ray: &Ray, length: f32, rng: &mut Rng) -> (Spectrum, f32) {
    match medium.kind() {
        Extinction::Homogeneous(model) => {
            let transmittance = Uniform::along(model, medium.phase(), ray).transmittance(length);
            (transmittance, transmittance.mean())
        }
        Extinction::Heterogeneous(model) => (residual_ratio_tracking(model, medium.phase(), ray, length, rng), 1.0),
    }
}

/// Residual ratio tracking with the minorant of each cell as its control: the result stays in [0, 1].
#[inline(always)]
fn residual_ratio_tracking(medium: &Heterogeneous, phase: &Phase, ray: &Ray, length: f32, rng: &mut Rng) -> Spectrum {
    let (factor, share) = bounds(phase, ray);
    let mut depth = 0.0;
    let mut ratio = Spectrum::ONE;
    // The control of the current cell, shared by both closures.
    let control = std::cell::Cell::new(0.0);
    let enter = |span: &Span| {
        depth += (span.t1 - span.t0) * span.minorant * share;
        control.set(span.minorant * share);
    };
    let collide = |t: f32, rate: f32, _: &mut Rng| {
        let x = ray.at(t);
        let sigma_t = medium.sigma_t(x) * phase.extinction_factor(x, ray.direction);
        ratio *= (Spectrum::ONE - (sigma_t - Spectrum::grey(control.get())) / rate).max(Spectrum::ZERO);
        if ratio.is_black() { Next::Stop } else { Next::Continue }
    };
    let rate = |majorant: f32, minorant: f32| majorant * factor - minorant * share;
    tentative_collisions(medium, ray, length, rng, rate, enter, collide);
    let control: f32 = depth;
    ratio * (-control).exp()
}

/// Factors of a medium's majorants and minorants along `ray`.
pub(super) fn bounds(phase: &Phase, ray: &Ray) -> (f32, f32) {
    // Microflakes have no useful minorant.
    if phase.is_anisotropic_medium() { (phase.max_extinction_factor(ray.direction), 0.0) } else { (1.0, 1.0) }
}
