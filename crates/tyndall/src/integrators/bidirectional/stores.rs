//! The data that camera paths merge with, traced anew for every pass.

use super::options::{Options, Techniques};
use crate::integrators::Counts;
use crate::integrators::shrinking::Shrinking;
use crate::math::{Kernel, Vec2, Vec3};
use crate::photons::{BeamRadius, Beams, Extent, LightPaths, Photon, Points, TraceError, Tracing, Wanted};
use crate::scene::Scene;
use crate::walk::{Effort, LightDensity, Place};
use rayon::prelude::*;

/// Light paths traced to find radii and how densely light is scattered.
const PILOT_PATHS: u32 = 1 << 14;
/// The set of light paths that the pilot is.
const PILOT_SET: u32 = u32::MAX;
/// Added to the number of a pass for its set of beams, which is independent of that of points.
const BEAM_SETS: u32 = 1 << 31;
/// Added for the light paths that are merged beyond the camera's first vertex.
const BEYOND_SETS: u32 = 1 << 30;
/// Automatic radius in media, in mean free paths ...
const FREE_PATHS: f32 = 0.1;
/// ... and in sizes of a pixel; the smaller one counts.
const PIXELS: f32 = 2.0;
/// Automatic radius on surfaces, in sizes of a pixel.
const SURFACE_PIXELS: f32 = 2.0;
/// How many times a local radius is larger or smaller than the usual one at most.
const LOCAL: f32 = 4.0;
/// Points that the light paths of a pass leave in each pixel on the mean, if that takes ...
const SEEN_IN_PIXEL: f32 = 1.0;
/// ... at least so many light paths for each pixel ...
const LEAST_PATHS: f32 = 2.0;
/// ... and at most so many ...
const MOST_PATHS: f32 = 8.0;
/// ... or as many as leave so many points, seen or not.
const MOST_POINTS: f32 = 24.0;

/// Points and beams of some light paths.
#[derive(Debug, Default)]
pub(super) struct Set {
    pub(super) points: LightPaths,
    pub(super) beams: LightPaths,
    /// Points in media as merged with points ...
    pub(super) for_points: Points,
    /// ... and with camera beams, each with its own radius.
    pub(super) for_beams: Points,
    pub(super) on_surfaces: Points,
    pub(super) arranged_beams: Beams,
    /// Light paths that left points, and beams.
    pub(super) paths: [f32; 2],
}

/// What the pilot has found.
#[derive(Clone, Copy, Debug)]
struct Survey {
    /// Light paths that leave points.
    paths: u32,
    /// First radii in media and on surfaces, metres.
    volume: f32,
    on_surface: f32,
}

/// Radii of a pass, metres.
#[derive(Clone, Copy, Debug)]
struct Radii {
    ball: f32,
    disk: f32,
    width: f32,
    patch: f32,
}

/// Points and beams of a pass.
#[derive(Debug)]
pub(super) struct Stores {
    /// What the camera's walk is merged with at its first vertex, or after a rough mirror, ...
    all: Set,
    /// ... and where it has scattered before: fewer.
    beyond: Set,
    survey: Option<Survey>,
    volume: Shrinking,
    other: Shrinking,
    /// What the techniques take of each path in this pass.
    pub(super) effort: Effort,
    pass: Option<u32>,
}

impl Set {
    /// Traces so many light paths for points and for beams, and counts them.
    #[allow(clippy::too_many_arguments, reason = "what a pass is")]
    fn trace(
        &mut self,
        scene: &Scene,
        options: &Options,
        effort: &Effort,
        radii: Radii,
        [paths, beam_paths]: [u32; 2],
        (seed, pass): (u64, u32),
        counts: &mut Counts,
    ) -> Result<(), TraceError> {
        let Techniques { surface, point_point, beam_point, beam_beam, .. } = options.techniques;
        let Radii { ball, disk, width, patch } = radii;
        self.paths = [paths as f32, beam_paths as f32];
        let media = !scene.media().is_empty();
        let tracing = |paths, set, wanted| Tracing {
            paths,
            rules: options.rules,
            seed,
            set,
            extent: Extent::Short,
            footprints: false,
            point_radius: ball,
            surface_radius: patch,
            wanted,
            effort: Some(effort),
            memory: options.memory,
        };
        let points = media && (point_point || beam_point);
        if points || surface {
            let wanted = Wanted { points, surfaces: surface, direct: true, ..Wanted::default() };
            self.points.trace(scene, &tracing(paths, pass, wanted))?;
            counts.light_paths += u64::from(paths);
            counts.photons += self.points.data() as u64;
            let light = &effort.light;
            if points && point_point {
                let photons = self.points.points.par_iter_mut();
                photons.for_each(|p| p.radius = ball * light.in_medium(p.position).ball);
                self.for_points.rebuild(&self.points.points);
            }
            if points && beam_point {
                let radius = |x: Vec3| disk * light.in_medium(x).disk;
                if point_point {
                    self.for_beams.rebuild_with_radii(&self.for_points, radius);
                } else {
                    self.points.points.par_iter_mut().for_each(|p| p.radius = radius(p.position));
                    self.for_beams.rebuild(&self.points.points);
                }
            }
            if surface {
                let photons = self.points.surfaces.par_iter_mut();
                photons.for_each(|p| p.radius = patch * light.on_surface(p.position).disk);
                self.on_surfaces.rebuild(&self.points.surfaces);
            }
        }
        if media && beam_beam {
            let wanted = Wanted { beams: true, ..Wanted::default() };
            self.beams.trace(scene, &tracing(beam_paths, BEAM_SETS | pass, wanted))?;
            counts.light_paths += u64::from(beam_paths);
            counts.photons += self.beams.data() as u64;
            self.arranged_beams.rebuild(&self.beams.beams, BeamRadius::Fixed(width));
        }
        Ok(())
    }
}

impl Stores {
    pub(super) fn new() -> Self {
        Self {
            all: Set::default(),
            beyond: Set::default(),
            survey: None,
            volume: Shrinking::START,
            other: Shrinking::START,
            effort: Effort::default(),
            pass: None,
        }
    }

    /// What a camera's walk is merged with: all, or what there is for places where it has scattered before.
    #[inline(always)]
    pub(super) fn set(&self, all: bool) -> &Set {
        if all { &self.all } else { &self.beyond }
    }

    /// Traces the light paths of a pass. Answers how many there were and what they left.
    pub(super) fn prepare(
        &mut self,
        scene: &Scene,
        options: &Options,
        seed: u64,
        pass: u32,
    ) -> Result<Counts, TraceError> {
        let mut counts = Counts::default();
        if self.pass == Some(pass) {
            return Ok(counts);
        }
        let Techniques { bpt, surface, point_point, beam_point, beam_beam } = options.techniques;
        let (width, height) = scene.picture_size();
        let pixels = width as f32 * height as f32;
        let Survey { paths, volume, on_surface } = self.survey(scene, options, seed)?;
        let beam_paths = match options.beams {
            0 => (paths / BEAM_SHARE).max(1),
            n => n,
        };
        let alpha = |dimension: u32| match options.alpha {
            0.0 => 4.0 / (f64::from(dimension) + 4.0),
            alpha => f64::from(alpha),
        };
        let [ball, disk] = self.volume.at(pass, [3, 2], [alpha(3), alpha(2)]).map(|factor| factor * volume);
        let [width, patch] = self.other.at(pass, [1, 2], [alpha(1), alpha(2)]);
        let (width, patch) = (width * volume, patch * on_surface);
        let number = |wanted: bool, paths: u32| if wanted { paths as f32 } else { 0.0 };
        self.effort = Effort {
            connect: number(bpt, 1),
            join: if options.techniques.merge() { Effort::JOIN } else { 1.0 },
            lens: if bpt { pixels } else { 0.0 },
            surface: number(surface, paths) * Kernel::extent(2, patch),
            point_point: number(point_point, paths) * Kernel::extent(3, ball),
            beam_point: number(beam_point, paths) * Kernel::extent(2, disk),
            beam_beam: number(beam_beam, beam_paths) * Kernel::extent(1, width),
            light: std::mem::take(&mut self.effort.light),
            most_first: 1.0 / options.continuation,
            copies: if options.techniques.merge() { Effort::COPIES } else { 1.0 },
            split: options.techniques.merge() && !scene.media().is_empty(),
        };
        let radii = Radii { ball, disk, width, patch };
        let beyond = |paths: u32| ((paths as f32 * Effort::BEYOND) as u32).max(1);
        let sets =
            [(&mut self.all, [paths, beam_paths], 0), (&mut self.beyond, [paths, beam_paths].map(beyond), BEYOND_SETS)];
        for (set, paths, offset) in sets {
            set.trace(scene, options, &self.effort, radii, paths, (seed, offset | pass), &mut counts)?;
        }
        self.pass = Some(pass);
        Ok(counts)
    }

    /// Finds out how densely light is scattered, and from that how many light paths to take and with which radii to begin.
    fn survey(&mut self, scene: &Scene, options: &Options, seed: u64) -> Result<Survey, TraceError> {
        if let Some(survey) = self.survey {
            return Ok(survey);
        }
        let wanted = Wanted { points: true, surfaces: true, direct: true, ..Wanted::default() };
        let tracing = Tracing {
            paths: if options.techniques.merge() { PILOT_PATHS } else { 0 },
            rules: options.rules,
            seed,
            set: PILOT_SET,
            extent: Extent::Short,
            footprints: false,
            point_radius: 0.0,
            surface_radius: 0.0,
            wanted,
            effort: None,
            memory: options.memory,
        };
        let pilot = &mut self.all.points;
        pilot.trace(scene, &tracing)?;
        let free = |photon: &Photon| {
            let medium = photon.tag.medium().map(|id| scene.medium(id));
            FREE_PATHS / medium.map_or(0.0, |medium| medium.sigma_t(photon.position).mean())
        };
        // The best radius at every place; what the picture does not show says nothing of its pixels.
        let in_media = |photon: &Photon| match options.radius {
            0.0 => Some(free(photon).min(PIXELS * pixel_size(scene, photon.position)?)),
            radius => Some(radius),
        };
        let on_surfaces = |photon: &Photon| match options.surface_radius {
            0.0 => Some(SURFACE_PIXELS * pixel_size(scene, photon.position)?),
            radius => Some(radius),
        };
        let LightPaths { points, surfaces, .. } = pilot;
        let local: [Vec<Option<f32>>; 2] =
            [points.iter().map(in_media).collect(), surfaces.iter().map(on_surfaces).collect()];
        let usual = |radii: &[Option<f32>]| median(radii.iter().flatten().copied());
        let volume = usual(&local[0]).or_else(|| median(points.iter().map(free))).unwrap_or(NOWHERE);
        let on_surface = usual(&local[1]).unwrap_or(volume);

        let Techniques { surface, point_point, beam_point, .. } = options.techniques;
        let merged = [(&*points, point_point || beam_point), (&*surfaces, surface)];
        let merged = merged.into_iter().filter(|(_, wanted)| *wanted).flat_map(|(photons, _)| photons);
        let seen = merged.filter(|photon| pixel_size(scene, photon.position).is_some()).count();
        let (width, height) = scene.picture_size();
        let pixels = width as f32 * height as f32;
        let paths = match options.photons {
            0 => {
                let leaving = |wanted: f32, found: usize| wanted * PILOT_PATHS as f32 / found.max(1) as f32;
                let most = MOST_PATHS.min(leaving(MOST_POINTS, points.len() + surfaces.len())).max(LEAST_PATHS);
                ((pixels * leaving(SEEN_IN_PIXEL, seen).clamp(LEAST_PATHS, most)) as u32).clamp(1, 1 << 20)
            }
            n => n,
        };
        let places = |photons: &[Photon], radii: &[Option<f32>], usual: f32| {
            let place = |(photon, radius): (&Photon, &Option<f32>)| Place {
                position: photon.position,
                factor: radius.map_or(1.0, |r| (r / usual).clamp(1.0 / LOCAL, LOCAL)),
                sigma_t: photon.tag.medium().map_or(0.0, |id| scene.medium(id).sigma_t(photon.position).mean()),
            };
            photons.iter().zip(radii).map(place).collect::<Vec<_>>()
        };
        let (points, surfaces) = (places(points, &local[0], volume), places(surfaces, &local[1], on_surface));
        self.effort.light = LightDensity::new(&points, &surfaces, PILOT_PATHS);
        if options.radius == 0.0 {
            self.effort.light.widen_in_media(volume, paths);
        }
        if options.surface_radius == 0.0 {
            self.effort.light.widen_on_surfaces(on_surface, paths);
        }
        Ok(*self.survey.insert(Survey { paths, volume, on_surface }))
    }
}

/// Paths that leave points for each that leaves beams: a beam meets about so many more camera rays than a point.
const BEAM_SHARE: u32 = 64;

/// Radius where there is nothing to merge, metres.
const NOWHERE: f32 = 1e-3;

/// Edge of a pixel at `x`, metres; `None` for places outside the picture.
fn pixel_size(scene: &Scene, x: Vec3) -> Option<f32> {
    let seen = scene.sensor.project(x, Vec2::splat(0.5))?;
    let film = Vec2::new(scene.film.width as f32, scene.film.height as f32);
    let inside = seen.film_position.cmpge(Vec2::ZERO).all() && seen.film_position.cmple(film).all();
    (inside && seen.pixels_per_area > 0.0).then(|| 1.0 / seen.pixels_per_area.sqrt())
}

fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.filter(|v| *v > 0.0 && v.is_finite()).collect();
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
