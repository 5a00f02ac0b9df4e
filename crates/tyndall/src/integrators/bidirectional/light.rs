//! Light's walk, joined with the lens at every vertex.

use crate::estimators::connect::sight;
use crate::estimators::transport::is_smooth;
use crate::film::Splats;
use crate::math::Sampler;
use crate::mis::{self, Recorder, Technique};
use crate::scene::Scene;
use crate::walk::{Account, Effort, End, FromLight, Onward, Rules, Segment, Sink, Start, Vertex, walk};

/// A vertex of light's walk where the camera's can be joined.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightVertex {
    pub(super) vertex: Vertex,
    pub(super) end: End,
}

/// A light path that adds to the picture.
pub(super) struct LightPath<'a, 's, R> {
    pub(super) scene: &'a Scene,
    pub(super) rules: &'a Rules,
    pub(super) effort: &'a Effort,
    pub(super) splats: &'a mut Splats<'s>,
    pub(super) record: &'a R,
}

impl<R: Recorder> LightPath<'_, '_, R> {
    /// Traces the path and tells `keep` its vertices.
    pub(super) fn trace(self, sampler: &mut Sampler, keep: impl FnMut(LightVertex)) {
        let (u_position, u_direction, choice) = (sampler.vec2(), sampler.vec2(), sampler.f32());
        let Some(emission) = self.scene.sample_emission(choice, u_position, u_direction) else { return };
        let (scene, rules) = (self.scene, *self.rules);
        let account = Account::of_light(scene, self.effort, &emission);
        walk::<FromLight, _>(
            scene,
            Start::emitted(&emission),
            &rules,
            sampler,
            &mut Tracer { path: self, keep, account },
        );
    }
}

struct Tracer<'a, 's, R, K> {
    path: LightPath<'a, 's, R>,
    keep: K,
    account: Account<'a, FromLight>,
}

impl<R: Recorder, K: FnMut(LightVertex)> Tracer<'_, '_, R, K> {
    /// Joins the vertex with the lens.
    fn show(&mut self, vertex: &Vertex, end: &End, sampler: &mut Sampler) {
        let (u_lens, u_pixel) = (sampler.vec2(), sampler.vec2());
        let LightPath { scene, effort, splats, record, .. } = &mut self.path;
        let Some(sight) = sight(scene, vertex, u_lens, |film| splats.shows(film), sampler.rng()) else { return };
        let weight = mis::weigh_sight(effort, end, &sight) / effort.lens;
        let seen = vertex.throughput * sight.value;
        let place = splats.add(sight.film_position, seen * weight, u_pixel);
        let technique = Technique::Join { light: vertex.scatterings + 2, camera: 1 };
        record.splat(technique, place, seen * weight, seen / effort.lens);
    }
}

impl<R: Recorder, K: FnMut(LightVertex)> Sink for Tracer<'_, '_, R, K> {
    fn looks_beyond(&self, _leg: u32) -> bool {
        false
    }

    fn segment(&mut self, segment: &Segment, _: &mut Sampler) {
        self.account.pass(segment);
    }

    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        let end = self.account.arrive(vertex);
        if !is_smooth(self.path.scene, vertex) {
            return;
        }
        if self.path.effort.lens > 0.0 {
            self.show(vertex, &end, sampler);
        }
        (self.keep)(LightVertex { vertex: *vertex, end });
    }

    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        self.account.depart(vertex, onward);
        // Beyond, nothing can be joined.
        vertex.scatterings + 3 <= self.path.rules.max_depth
    }
}
