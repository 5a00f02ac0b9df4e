//! The camera's walk, joined with emitters and with light's vertices.

use super::joint::Pairing;
use super::light::LightVertex;
use super::merging::Merger;
use super::options::Options;
use crate::Spectrum;
use crate::estimators::connect::join;
use crate::estimators::transport::{SHORT_OF, departure, is_smooth, turn};
use crate::math::{Ray, Sampler, Vec2};
use crate::mis::{self, Lit, Recorder, Technique};
use crate::scene::Scene;
use crate::scene::emitter::{EmitterSample, LightEnd};
use crate::walk::{
    Account, Effort, End, Escape, FromCamera, Media, Onward, Rules, Scattering, Segment, Sink, Start, SurfaceHit,
    Vertex, edge_passage, walk,
};

/// A walk that is still to be followed.
pub(super) struct Fork<'s> {
    start: Start,
    account: Account<'s, FromCamera>,
    /// As in [`Merger::boost`].
    boost: f32,
    /// As in [`CameraPath::waits`].
    waits: bool,
    /// Whether it has been scattered by chance.
    by_chance: bool,
}

/// The sink that turns a camera's walk into radiance.
pub(super) struct CameraPath<'a, 's, R> {
    pub(super) scene: &'s Scene,
    pub(super) options: &'a Options,
    effort: &'s Effort,
    light: &'a [LightVertex],
    merger: Merger<'a, R>,
    pub(super) pairing: Pairing<'a>,
    record: &'a R,
    radiance: Spectrum,
    /// Whether the walk ends behind this vertex if it is the first that scatters by chance.
    ends: bool,
    /// Whether it has, and only looks for an emitter.
    looks: bool,
    /// Whether the walk only counts once it has collided in a medium.
    waits: bool,
    /// Whether another walk may come to a medium before it scatters by chance: there is one on the way, or a surface that lets some
    /// walks pass or sends them on as a mirror does.
    clouded: bool,
    /// Walks that are still to be followed: hardly ever more than a reflection and a copy.
    forks: &'a mut Vec<Fork<'s>>,
    pub(super) account: Account<'s, FromCamera>,
}

impl<'a, 's, R: Recorder> CameraPath<'a, 's, R> {
    /// Radiance arriving at the film position (pixels of the whole film), one sample, with light's vertices to join.
    pub(super) fn radiance(
        scene: &'s Scene,
        options: &'a Options,
        effort: &'s Effort,
        light: &'a [LightVertex],
        merger: Merger<'a, R>,
        pairing: Pairing<'a>,
        forks: &'a mut Vec<Fork<'s>>,
        film: Vec2,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let camera = scene.sensor.sample_ray(film, sampler.vec2());
        let account = Account::of_camera(scene, effort, &camera.ray);
        let record = merger.record;
        let radiance = Spectrum::ZERO;
        let (ends, looks, waits) = (false, false, false);
        let mut path = Self {
            scene,
            options,
            effort,
            light,
            merger,
            pairing,
            record,
            radiance,
            ends,
            looks,
            waits,
            clouded: false,
            forks,
            account,
        };
        let start = Start::seen(scene, &camera);
        if !effort.split {
            path.follow(start, &options.rules, sampler);
            return path.radiance;
        }
        // Merging sees all of the first beam: one walk passes it, whatever else would be left to chance, ...
        path.follow(start, &Rules { media: Media::AttenuateFirst, ..options.rules }, sampler);
        // ... and another one shows what collides there, if anything can.
        if !path.clouded {
            return path.radiance;
        }
        path.account = Account::of_camera(scene, effort, &camera.ray);
        path.waits = true;
        path.follow(start, &options.rules, sampler);
        path.radiance
    }

    /// A walk, and those that fork off: with the first reflection that it meets at smooth glass, and copies from a rough mirror.
    fn follow(&mut self, start: Start, rules: &Rules, sampler: &mut Sampler) {
        self.merger.boost = 1.0;
        self.looks = false;
        walk::<FromCamera, _>(self.scene, start, rules, sampler, self);
        while let Some(Fork { start, account, boost, waits, by_chance }) = self.forks.pop() {
            (self.account, self.merger.boost, self.waits) = (account, boost, waits);
            self.looks = false;
            self.pairing.leave();
            let rules = if by_chance { &self.options.rules } else { rules };
            walk::<FromCamera, _>(self.scene, start, rules, sampler, self);
        }
    }

    /// Light that counts by `weight`.
    #[inline(always)]
    fn add(&mut self, technique: Technique, seen: Spectrum, weight: f32) {
        let seen = seen * self.merger.boost;
        let weighted = seen * weight;
        self.radiance += weighted;
        self.record.add(technique, weighted, seen);
    }

    /// Light that the walk runs into, at the end seen from `x`.
    fn add_hit(&mut self, scatterings: u32, seen: Spectrum, end: &LightEnd) {
        let hidden = self.options.hide_emitters && scatterings == 0;
        if scatterings >= self.options.rules.max_depth || hidden || seen.is_black() {
            return;
        }
        let technique = Technique::Join { light: 0, camera: scatterings + 2 };
        if scatterings == 0 {
            return self.add(technique, seen, 1.0);
        }
        let lights = &self.scene.lights;
        let lit =
            Lit { density: lights.end_density(end), sampled: lights.sampled_density(self.account.leg.start, end) };
        let Account { leg, edge, .. } = &self.account;
        let spread = if lit.density.parallel { 1.0 } else { leg.spread(end.position) };
        let weight = self.effort.connect * mis::weigh_hit(&lit, leg, edge, spread);
        // All walks look for emitters, also those that do not go on.
        self.add(technique, seen / leg.hits, weight);
    }

    /// Light from a sampled emitter.
    fn add_sampled(&mut self, vertex: &Vertex, camera: &End, sampler: &mut Sampler) {
        let lights = &self.scene.lights;
        let Some(light) = lights.sample(vertex.position, sampler.f32(), sampler.vec2()) else { return };
        let share = self.pairing.share_of_walk(self.scene, &light);
        self.add_lit(vertex, camera, &light, share, sampler);
    }

    /// Light from the emitter, of which `share` is added.
    pub(super) fn add_lit(
        &mut self,
        vertex: &Vertex,
        camera: &End,
        light: &EmitterSample,
        share: f32,
        sampler: &mut Sampler,
    ) {
        let lights = &self.scene.lights;
        let turn = turn::<FromCamera>(self.scene, vertex, light.direction);
        if turn.value.is_black() {
            return;
        }
        let (origin, medium) = departure(self.scene, vertex, light.direction);
        let ray = Ray { origin, direction: light.direction };
        let length = light.distance * SHORT_OF;
        let Some((transmittance, edge)) = edge_passage(self.scene, ray, length, medium, sampler.rng()) else { return };
        let end = LightEnd::of_sample(light, lights);
        let lit = Lit { density: lights.end_density(&end), sampled: lights.sampled_density(vertex.position, &end) };
        let distance2 = light.distance * light.distance;
        let weight = mis::weigh_sampled(self.effort, &lit, camera, light.direction, &turn, &edge, distance2);
        let arriving = light.radiance * transmittance / light.pdf.0;
        let technique = Technique::Join { light: 1, camera: vertex.scatterings + 2 };
        self.add(technique, vertex.throughput * turn.value * arriving * share, weight);
    }

    /// Light from the vertices of light's walk.
    fn add_joined(&mut self, vertex: &Vertex, camera: &End, sampler: &mut Sampler) {
        let Some(room) = self.options.rules.max_depth.checked_sub(vertex.scatterings + 3) else { return };
        for light in self.light.iter().take_while(|light| light.vertex.scatterings <= room) {
            let Some(join) = join(self.scene, &light.vertex, vertex, sampler.rng()) else { continue };
            let weight = mis::weigh_join(self.effort, &light.end, camera, &join);
            let technique = Technique::Join { light: light.vertex.scatterings + 2, camera: vertex.scatterings + 2 };
            self.add(technique, vertex.throughput * light.vertex.throughput * join.value, weight);
        }
    }
}

impl<R: Recorder> Sink for CameraPath<'_, '_, R> {
    const FORKS: bool = true;

    fn fork(&mut self, vertex: &Vertex, onward: &Onward, start: Start) {
        let by_chance = onward.pdf.is_some();
        // By the smooth part of a rough mirror goes one walk alone.
        if self.account.copies() > 1 && !by_chance {
            return;
        }
        let mut account = self.account.clone();
        let boost = account.boost(onward);
        account.depart(vertex, onward);
        self.forks.push(Fork { start, account, boost, waits: self.waits, by_chance });
    }

    fn copies(&self) -> u32 {
        if self.waits || self.looks { 1 } else { self.account.copies() }
    }

    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        self.clouded |= self.account.leg.first;
        if self.waits || self.looks {
            return self.account.pass(segment);
        }
        self.radiance += self.merger.along(segment, &self.account, sampler);
        self.add_pair(segment, sampler);
        self.account.pass(segment);
    }

    fn surface(&mut self, hit: &SurfaceHit) {
        self.pairing.leave();
        self.clouded |= self.account.leg.first && self.scene.lets_on(hit.point.shape);
        if !self.waits && self.scene.is_emitter(hit.point.shape) {
            let lights = &self.scene.lights;
            let end = LightEnd::of_hit(hit.point, hit.direction, lights);
            self.add_hit(hit.scatterings, hit.throughput * lights.radiance_surface(hit.point, hit.direction), &end);
        }
    }

    fn escape(&mut self, escape: &Escape) {
        if self.waits {
            return;
        }
        let seen = escape.throughput * self.scene.lights.radiance_escape(escape.direction);
        self.add_hit(escape.scatterings, seen, &LightEnd::of_escape(escape.direction));
    }

    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        if self.looks {
            return;
        }
        let end = self.account.arrive(vertex);
        self.waits &= !matches!(vertex.scattering, Scattering::Medium { .. });
        if self.waits {
            return;
        }
        // Most of what is to be found beyond the first vertex, merging has found there.
        let more = end.corner.merges.connect;
        self.ends = end.first && more > 1.0 && sampler.rng().f32() * more >= 1.0;
        self.radiance += self.merger.at(vertex, &end, sampler);
        if self.effort.connect > 0.0 && is_smooth(self.scene, vertex) {
            self.add_sampled(vertex, &end, sampler);
            self.add_joined(vertex, &end, sampler);
        }
    }

    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        if self.looks || (self.waits && onward.pdf.is_some()) {
            return false;
        }
        let boost = self.account.boost(onward);
        self.account.depart(vertex, onward);
        self.pairing.depart(onward);
        self.merger.boost *= boost;
        self.looks = boost > 1.0 && self.ends;
        true
    }
}
