//! Walks end, whatever the scene.

mod common;

use tyndall::Spectrum;
use tyndall::math::{Ray, Sampler, Vec3};
use tyndall::scene::desc::MediumId;
use tyndall::walk::{Escape, FromLight, Media, Onward, Rules, Sink, Start, Vertex, walk};
use tyndall_testkit::corpus::{Furnace, furnace, furnace_room};

/// Counts.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    vertices: u32,
    escaped: Option<Spectrum>,
    /// Where the last vertex was.
    last: Vec3,
    nearsighted: bool,
}

impl Sink for Seen {
    fn looks_beyond(&self, _leg: u32) -> bool {
        !self.nearsighted
    }
    fn vertex(&mut self, vertex: &Vertex, _sampler: &mut Sampler) {
        self.vertices += 1;
        self.last = vertex.position;
    }
    fn escape(&mut self, escape: &Escape) {
        self.escaped = Some(escape.throughput);
    }
}

/// Light as photons have it, absorption analogue.
const ANALOGUE: Rules = Rules { max_depth: u32::MAX, rr_depth: 0, rr_cap: 1.0, media: Media::Scatter };

fn start(origin: Vec3, direction: Vec3) -> Start {
    let medium = Some(MediumId(0));
    Start::new(Ray { origin, direction }, f32::INFINITY, medium, Spectrum::ONE)
}

/// The box of the furnace reaches to 1. A collision behind its face came there by rounding.
#[test]
fn light_that_slipped_out_of_a_medium_goes_away() {
    let scene = common::scene(&furnace("isotropic", Furnace::default()), true);
    assert!(scene.is_bounded(MediumId(0)));
    for nearsighted in [false, true] {
        for path in 0..100 {
            let mut seen = Seen { nearsighted, ..Seen::default() };
            let out = start(Vec3::new(0.0, 1.0 + 1e-6, 0.0), Vec3::Y);
            walk::<FromLight, _>(&scene, out, &ANALOGUE, &mut Sampler::new(1, 2, path), &mut seen);
            assert_eq!((seen.vertices, seen.escaped), (0, Some(Spectrum::ONE)));
        }
    }
}

/// Not to look for surfaces beyond the end of a flight spares work and changes nothing.
#[test]
fn light_goes_the_same_ways_whether_looked_for_beyond_its_flights_or_not() {
    let chromatic = Furnace { sigma_t: [3.0, 1.0, 0.5], lens: true, ..Furnace::default() };
    for case in [furnace("isotropic", Furnace::default()), furnace("chromatic", chromatic), furnace_room(0.5)] {
        let scene = common::scene(&case, true);
        for path in 0..2000 {
            let [far, near] = [false, true].map(|nearsighted| {
                let mut seen = Seen { nearsighted, ..Seen::default() };
                let rules = Rules { max_depth: 100, ..ANALOGUE };
                let inside = start(Vec3::new(0.1, 0.6, 0.3), Vec3::new(0.6, 0.0, 0.8));
                walk::<FromLight, _>(&scene, inside, &rules, &mut Sampler::new(1, 2, path), &mut seen);
                Seen { nearsighted: false, ..seen }
            });
            assert_eq!(far, near, "path {path}");
        }
    }
}

/// Keeps the walk that another sink is to follow, and adds up what leaves the scene.
#[derive(Default)]
struct Forked {
    reflected: Option<Start>,
    forks: u32,
    left: f32,
}

impl Sink for Forked {
    const FORKS: bool = true;

    fn fork(&mut self, _vertex: &Vertex, onward: &Onward, start: Start) {
        assert_eq!((onward.direction, onward.eta, onward.pdf.is_none()), (start.ray.direction, 1.0, true));
        self.forks += 1;
        self.reflected = Some(start);
    }
    fn escape(&mut self, escape: &Escape) {
        self.left += escape.throughput.max_channel();
    }
}

/// A glass cube full of fog that absorbs nothing.
#[test]
fn walks_at_smooth_glass_part_the_light_between_both_ways() {
    let scene = common::scene(&furnace("glass", Furnace { glass: true, ..Furnace::default() }), true);
    let rules = Rules { rr_depth: u32::MAX, ..ANALOGUE };
    for path in 0..1000 {
        let mut sampler = Sampler::new(1, 2, path);
        let direction = Vec3::new(0.3 * sampler.f32(), -1.0, 0.3 * sampler.f32()).normalize();
        let out = Start::new(Ray { origin: Vec3::Y * 2.0, direction }, f32::INFINITY, None, Spectrum::ONE);
        let mut seen = Forked::default();
        walk::<FromLight, _>(&scene, out, &rules, &mut sampler, &mut seen);
        let reflected = seen.reflected.take().expect("the walk meets glass");
        let mirrored = Vec3::new(direction.x, -direction.y, direction.z);
        assert!(reflected.ray.direction.distance(mirrored) < 1e-6, "{:?}", reflected.ray);
        assert!((reflected.throughput.max_channel() - 0.04).abs() < 1e-3, "{:?}", reflected.throughput);
        assert_eq!((reflected.scatterings, reflected.leg, reflected.medium), (1, 1, None));
        let through = seen.left;
        walk::<FromLight, _>(&scene, reflected, &rules, &mut sampler, &mut seen);
        assert!(0.9 < through && (seen.left - 1.0).abs() < 1e-5, "{through} and then {}", seen.left);
        assert_eq!((seen.forks, seen.reflected.is_none()), (1, true), "only the first glass counts");
    }
}

/// Of walks that only dim, few go on where a millionth part passes, and they bring all of it.
#[test]
fn walks_that_pass_thick_fog_bring_what_passes() {
    const WALKS: u32 = 20_000;
    let sigma_t = [12.0, 13.0, 14.0];
    let scene = common::scene(&furnace("thick", Furnace { sigma_t, ..Furnace::default() }), true);
    let rules = Rules { media: Media::Attenuate, ..ANALOGUE };
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for path in 0..WALKS {
        let mut seen = Seen::default();
        walk::<FromLight, _>(&scene, start(Vec3::ZERO, Vec3::Y), &rules, &mut Sampler::new(1, 2, path), &mut seen);
        let Some(passed) = seen.escaped else { continue };
        count += 1.0;
        sum.iter_mut().zip(passed.to_rgb()).for_each(|(sum, channel)| *sum += f64::from(channel));
    }
    assert!(count < 0.1 * f64::from(WALKS), "{count} walks go on");
    for (sum, sigma_t) in sum.iter().zip(sigma_t) {
        let off = sum / f64::from(WALKS) / (-sigma_t).exp() - 1.0;
        assert!(off.abs() < 3.0 / count.sqrt(), "{sigma_t}: off by {:.1} % of {count} walks", 100.0 * off);
    }
}

/// Fog without bounds scatters on: the furnace with a lens has it around the lens, so it may reach anywhere.
#[test]
fn light_in_endless_fog_is_scattered_until_roulette_ends_it() {
    let scene = common::scene(&furnace("lens", Furnace { lens: true, ..Furnace::default() }), true);
    assert!(!scene.is_bounded(MediumId(0)));
    let mut seen = Seen::default();
    let out = start(Vec3::new(0.0, 2.0, 0.0), Vec3::Y);
    walk::<FromLight, _>(&scene, out, &ANALOGUE, &mut Sampler::new(1, 2, 3), &mut seen);
    assert!((10_000..20_000).contains(&seen.vertices), "{}", seen.vertices);
}

/// A room that absorbs nothing.
#[test]
fn light_in_a_white_room_ends() {
    let scene = common::scene(&furnace_room(1.0), true);
    let mut seen = Seen::default();
    let inside = start(Vec3::new(0.1, 0.2, 0.3), Vec3::Y);
    walk::<FromLight, _>(&scene, inside, &ANALOGUE, &mut Sampler::new(1, 2, 3), &mut seen);
    assert!((10_000..20_000).contains(&seen.vertices), "{}", seen.vertices);
}
