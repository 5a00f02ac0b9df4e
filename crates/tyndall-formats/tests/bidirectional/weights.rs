//! The weights of all techniques that find a path sum to one.

use crate::reciprocity::scenes;
use tyndall::Scene;
use tyndall::estimators::connect::{Join, Sight, sight};
use tyndall::estimators::transport::{departure, is_smooth, turn};
use tyndall::math::{Ray, Rng, Sampler, Vec3};
use tyndall::mis::{self, Lit, Meeting, Merging};
use tyndall::scene::bsdf::Transport;
use tyndall::scene::emitter::{EndDensity, LightEnd};
use tyndall::walk::{
    Arrival, Edge, Effort, End, FromCamera, FromLight, Leg, LightDensity, Media, Mode, Onward, Place, Rules,
    Scattering, Sink, Start, Vertex, corner, edge_passage, walk,
};

/// A vertex of a walk, and whether the walk went on by a delta distribution.
#[derive(Clone, Copy)]
struct Step {
    vertex: Vertex,
    delta: bool,
}

/// Keeps the vertices of a walk. A mask that was passed is no vertex.
#[derive(Default)]
struct Record(Vec<Step>, Option<Vertex>);

impl Sink for Record {
    fn vertex(&mut self, vertex: &Vertex, _: &mut Sampler) {
        self.1 = Some(*vertex);
    }

    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        self.0.push(Step { vertex: *vertex, delta: onward.pdf.is_none() });
        self.1 = None;
        true
    }
}

const RULES: Rules = Rules { max_depth: 7, rr_depth: u32::MAX, rr_cap: 1.0, media: Media::Scatter };

/// The way between two vertices, from the first to the second.
fn edge(scene: &Scene, from: &Vertex, to: &Vertex, rng: &mut Rng) -> Option<Edge> {
    let direction = (to.position - from.position).normalize();
    let (origin, medium) = departure(scene, from, direction);
    let (end, _) = departure(scene, to, -direction);
    Some(edge_passage(scene, Ray::between(origin, end), origin.distance(end) * (1.0 - 1e-4), medium, rng)?.1)
}

/// What a walk over the vertices of a full path carries at each of them.
fn replay<M: Mode>(scene: &Scene, effort: &Effort, first: Leg, vertices: &[Step], edges: &[Edge]) -> Vec<(End, Leg)> {
    let mut leg = first;
    let mut ends: Vec<(End, Leg)> = Vec::new();
    for (i, (Step { vertex, delta }, edge)) in vertices.iter().zip(edges).enumerate() {
        let mut corner = corner(scene, effort, vertex);
        corner.merges = corner.merges.at_end_of(&leg);
        let spread = leg.spread(vertex.position);
        let arrival: Arrival = leg.arrive::<M>(edge, spread, corner.cos(vertex.direction), corner.in_medium());
        ends.push((End { corner, arrival, first: leg.first, merges_all: false }, leg));
        if let Some(next) = vertices.get(i + 1) {
            let direction = next.vertex.direction;
            let turn = turn::<M>(scene, vertex, direction);
            let density = (!delta).then_some(turn.pdf.0);
            let next = arrival.depart::<M>(effort, &corner, direction, density, turn.reverse.0);
            leg = match M::TRANSPORT {
                Transport::Radiance => next.following(&leg, &corner, !delta),
                Transport::Importance => next,
            };
        }
    }
    ends
}

/// The same vertices as the walk from the other end meets them, which comes against `leaving`.
fn backwards(steps: &[Step], leaving: Vec3) -> Vec<Step> {
    let mut directions: Vec<Vec3> = steps.iter().skip(1).map(|s| -s.vertex.direction).collect();
    directions.push(-leaving);
    let turned = |(step, direction): (&Step, Vec3)| Step { vertex: Vertex { direction, ..step.vertex }, ..*step };
    steps.iter().zip(directions).map(turned).rev().collect()
}

/// Tells `found` the sum of the weights of all techniques for full paths: those into which two random walks can be joined,
/// or one of light and the lens.
fn sums(scene: &Scene, effort: &Effort, sampler: &mut Sampler, mut found: impl FnMut(f64)) {
    let Some(emission) = scene.sample_emission(sampler.f32(), sampler.vec2(), sampler.vec2()) else { return };
    let mut light = Record::default();
    walk::<FromLight, _>(scene, Start::emitted(&emission), &RULES, sampler, &mut light);
    let film = sampler.vec2() * 24.0;
    let camera_ray = scene.sensor.sample_ray(film, sampler.vec2());
    let start = Start::seen(scene, &camera_ray);
    let mut camera = Record::default();
    walk::<FromCamera, _>(scene, start, &RULES, sampler, &mut camera);
    let end = LightEnd::of_emission(&emission, &scene.lights);
    for s in 0..light.0.len() {
        // Light's walk alone, joined with the lens.
        let mut steps = light.0[..=s].to_vec();
        let last = steps[s].vertex;
        let seen = is_smooth(scene, &last).then(|| sight(scene, &last, sampler.vec2(), |_| true, sampler.rng()));
        if let Some(Sight { direction, lens, .. }) = seen.flatten() {
            let to_last = Ray { origin: lens.lens, direction: -direction };
            steps[s].delta = false;
            let (ray, medium) = (&emission.ray, emission.medium);
            if let Some(sum) = sum_of(scene, effort, &end, ray, medium, &steps, &to_last, sampler.rng()) {
                found(sum);
            }
        }
        for t in 0..camera.0.len() {
            // The full path as light walks it. Both ends of the joint scatter anew.
            let (y, z) = (light.0[s].vertex, camera.0[t].vertex);
            if !is_smooth(scene, &y) || !is_smooth(scene, &z) {
                continue;
            }
            let mut steps = light.0[..=s].to_vec();
            let mut tail = backwards(&camera.0[..=t], (y.position - z.position).normalize());
            (steps[s].delta, tail[0].delta) = (false, false);
            steps.extend(tail);
            let (ray, medium) = (&emission.ray, emission.medium);
            if let Some(sum) = sum_of(scene, effort, &end, ray, medium, &steps, &camera_ray.ray, sampler.rng()) {
                found(sum);
            }
        }
    }
}

#[allow(clippy::too_many_arguments, reason = "a path has two ends and a middle")]
fn sum_of(
    scene: &Scene,
    effort: &Effort,
    end: &LightEnd,
    emitted: &Ray,
    medium: Option<tyndall::scene::desc::MediumId>,
    steps: &[Step],
    lens: &Ray,
    rng: &mut Rng,
) -> Option<f64> {
    let n = steps.len();
    let leaving = |i: usize| if i + 1 < n { steps[i + 1].vertex.direction } else { -lens.direction };
    let dark =
        |(i, step): (usize, &Step)| !step.delta && turn::<FromLight>(scene, &step.vertex, leaving(i)).value.is_black();
    if steps.iter().enumerate().any(dark) {
        return None;
    }
    let density: EndDensity = scene.lights.end_density(end);
    let x = steps[0].vertex.position;
    let mut edges = vec![edge_passage(scene, *emitted, emitted.origin.distance(x) * (1.0 - 1e-4), medium, rng)?.1];
    for pair in steps.windows(2) {
        edges.push(edge(scene, &pair[0].vertex, &pair[1].vertex, rng)?);
    }
    let last = &steps[n - 1].vertex;
    let seen = lens.origin.distance(last.position) * (1.0 - 1e-4);
    edges.push(edge_passage(scene, *lens, seen, scene.camera_medium, rng)?.1.reversed());
    let sampled = scene.lights.sampled_density(x, end);
    let first = Leg::from_emitter(effort, &density, emitted.origin).lit(effort, &density, sampled);
    let light = replay::<FromLight>(scene, effort, first, steps, &edges);
    let to_lens = scene.sensor.ray_density(lens);
    let camera_steps = backwards(steps, -lens.direction);
    let camera_edges: Vec<Edge> = edges.iter().rev().map(|e| e.reversed()).collect();
    let camera = replay::<FromCamera>(scene, effort, Leg::from_lens(effort, &to_lens), &camera_steps, &camera_edges);

    let mut total = 0.0;
    let lit = Lit { density, sampled };
    // The camera's walk samples the emitter from the first vertex, or runs into it.
    let (end_1, _) = &camera[n - 1];
    let step_1 = &camera_steps[n - 1];
    let to_light = -emitted.direction;
    let turn_1 = turn::<FromCamera>(scene, &step_1.vertex, to_light);
    let distance2 = x.distance_squared(emitted.origin);
    let back = edges[0].reversed();
    if !step_1.delta {
        total += f64::from(mis::weigh_sampled(effort, &lit, end_1, to_light, &turn_1, &back, distance2));
    }
    if density.hittable {
        let pdf = (!step_1.delta).then_some(turn_1.pdf.0);
        let leg = end_1.arrival.depart::<FromCamera>(effort, &end_1.corner, to_light, pdf, turn_1.reverse.0);
        let spread = if density.parallel { 1.0 } else { leg.spread(emitted.origin) };
        total += f64::from(mis::weigh_hit(&lit, &leg, &back, spread));
    }
    // Light's walk is joined with the lens from the last vertex.
    if !steps[n - 1].delta {
        let turn = turn::<FromLight>(scene, last, -lens.direction);
        let sight = Sight {
            film_position: tyndall::math::Vec2::ZERO,
            direction: -lens.direction,
            light: turn,
            edge: edges[n],
            lens: to_lens,
            value: tyndall::Spectrum::ONE,
        };
        total += f64::from(mis::weigh_sight(effort, &light[n - 1].0, &sight));
    }
    // Joins.
    for i in 0..n - 1 {
        if steps[i].delta || steps[i + 1].delta {
            continue;
        }
        let camera_step = &camera_steps[n - 2 - i];
        let direction = steps[i + 1].vertex.direction;
        let join = Join {
            direction,
            spread: 1.0 / steps[i].vertex.position.distance_squared(steps[i + 1].vertex.position),
            light: turn::<FromLight>(scene, &steps[i].vertex, direction),
            camera: turn::<FromCamera>(scene, &camera_step.vertex, -direction),
            edge: edges[i + 1],
            value: tyndall::Spectrum::ONE,
        };
        total += f64::from(mis::weigh_join(effort, &light[i].0, &camera[n - 2 - i].0, &join));
    }
    // Merges.
    for i in (0..n).filter(|i| !steps[*i].delta) {
        let (here, other) = (&light[i].0, &camera[n - 1 - i].0);
        let turn = turn::<FromLight>(scene, &steps[i].vertex, leaving(i));
        let meeting = Meeting {
            light: here.arrival,
            camera: other.arrival,
            onward: turn.pdf,
            back: turn.reverse,
            sin: here.corner.arriving.cross(leaving(i)).length(),
            merges: other.corner.merges,
        };
        let techniques: &[Merging] = match (here.corner.in_medium(), here.corner.merges.surface > 0.0) {
            (true, _) => &[Merging::PointPoint, Merging::BeamPoint, Merging::BeamBeam],
            (false, true) => &[Merging::Surface],
            (false, false) => &[],
        };
        total += techniques.iter().map(|t| f64::from(mis::weigh_merge(*t, &meeting))).sum::<f64>();
    }
    Some(total)
}

/// How densely light's walk scatters.
fn density(scene: &Scene) -> LightDensity {
    const PATHS: u32 = 500;
    let [mut media, mut surfaces] = [const { Vec::new() }; 2];
    for index in 0..PATHS {
        let mut sampler = Sampler::new(9, 8, index);
        let Some(emission) = scene.sample_emission(sampler.f32(), sampler.vec2(), sampler.vec2()) else { continue };
        let mut light = Record::default();
        walk::<FromLight, _>(scene, Start::emitted(&emission), &RULES, &mut sampler, &mut light);
        for Step { vertex, .. } in light.0 {
            let inside = matches!(vertex.scattering, Scattering::Medium { .. });
            let (position, sigma_t) = (vertex.position, if inside { 1.0 } else { 0.0 });
            let place = Place { position, factor: 0.5 + position.x.abs(), sigma_t };
            if inside { &mut media } else { &mut surfaces }.push(place);
        }
    }
    let mut light = LightDensity::new(&media, &surfaces, PATHS);
    light.widen_in_media(0.2, PATHS);
    light
}

/// Random paths over all scenes; answers how many there were.
fn check(effort: &Effort, per_scene: u32) -> u32 {
    let mut count = 0;
    for (name, scene) in scenes() {
        let effort = &Effort { light: density(&scene), ..effort.clone() };
        let (mut found, mut worst) = (0, 0.0_f64);
        for index in 0..per_scene {
            let mut sampler = Sampler::new(9, 7, index);
            sums(&scene, effort, &mut sampler, |sum| {
                found += 1;
                worst = worst.max((sum - 1.0).abs());
                assert!((sum - 1.0).abs() < 1e-3, "{name}, walks {index}: the weights sum to {sum}");
            });
        }
        println!("{name}: {found} paths, the sums are off by at most {worst:.1e}");
        assert!(found > per_scene / 200, "{name}: only {found} paths");
        count += found;
    }
    count
}

fn connections() -> Effort {
    Effort { connect: 1.0, lens: 576.0, ..Effort::NONE }
}

fn all() -> Effort {
    let merges = Effort { surface: 7.0, point_point: 0.6, beam_point: 3.0, beam_beam: 11.0, ..connections() };
    Effort { most_first: 32.0, copies: Effort::COPIES, split: true, join: Effort::JOIN, ..merges }
}

#[test]
fn weights_of_connections_sum_to_one() {
    check(&connections(), 1500);
}

#[test]
fn weights_of_connections_and_merges_sum_to_one() {
    assert!(check(&all(), 60_000) >= 1_000_000);
    for effort in [
        Effort { surface: 0.0, point_point: 0.0, beam_point: 0.0, ..all() },
        Effort { surface: 0.0, point_point: 0.0, beam_beam: 0.0, ..all() },
        Effort { surface: 0.0, beam_point: 0.0, beam_beam: 0.0, ..all() },
        Effort { most_first: 1.0, split: false, ..all() },
    ] {
        check(&effort, 300);
    }
}
