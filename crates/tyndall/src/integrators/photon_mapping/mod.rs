//! Photon mapping: light paths leave points, beams or planes, and camera paths gather them.
//!
//! One composition serves every algorithm of the family; [`registry`] names them. The camera's walk passes media, which
//! dim it, follows smooth mirrors and glass, and branches at rough glass; along the way it asks in media, and at the first
//! other surface it asks once and ends. Light that comes there straight from an emitter is sampled, not gathered.

mod camera;
mod options;
pub mod registry;

pub(super) use self::options::declared;

use self::camera::Gatherer;
use self::options::{Estimator, Options, Selection};
use super::shrinking::Shrinking;
use super::{Counts, Integrator, Job, RareEvents, light_set, sample_pixels};
use crate::accel::{KdTree, Neighbours};
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::Vec3;
use crate::photons::radii::{adapt, beam_radius, usual_distance};
use crate::photons::{BeamRadius, Beams, LightPaths, Photon, Planes, Points, TraceError, Tracing, Wanted};
use crate::scene::Scene;
use crate::walk::Profile;

/// Light paths traced to find radii where none are given.
const PILOT_PATHS: u32 = 8192;
/// The set of light paths that the pilot is.
const PILOT_SET: u32 = u32::MAX;
/// Neighbours that an automatic radius of points takes in.
const USUAL_NEIGHBOURS: usize = 24;
/// Beams that a ray meets with the automatic radius.
const USUAL_BEAMS: f32 = 12.0;

/// The integrator.
pub(super) struct PhotonMapping {
    options: Options,
    paths: LightPaths,
    points: Points,
    surfaces: Points,
    beams: Beams,
    planes: Planes,
    tree: KdTree,
    positions: Vec<Vec3>,
    /// First radii, metres: of the data in media and of points on surfaces.
    radii: Option<(f32, f32)>,
    /// The set of light paths at hand.
    set: Option<u32>,
    shrinking: Shrinking,
    counts: Counts,
}

impl PhotonMapping {
    pub(super) fn new(options: Options) -> Self {
        Self {
            options,
            paths: LightPaths::default(),
            points: Points::default(),
            surfaces: Points::default(),
            beams: Beams::default(),
            planes: Planes::default(),
            tree: KdTree::default(),
            positions: Vec::new(),
            radii: None,
            set: None,
            shrinking: Shrinking::START,
            counts: Counts::default(),
        }
    }

    fn tracing(&self, scene: &Scene, seed: u64, set: u32) -> Tracing<'static> {
        let media = !scene.media().is_empty();
        let estimator = self.options.estimator.filter(|_| media);
        Tracing {
            paths: self.options.photons,
            rules: self.options.light_rules,
            seed,
            set,
            extent: self.options.extent,
            footprints: self.options.footprint > 0.0,
            point_radius: 0.0,
            surface_radius: 0.0,
            wanted: Wanted {
                points: estimator.is_some_and(Estimator::uses_points),
                surfaces: self.options.gathers_on_surfaces(),
                beams: estimator.is_some_and(Estimator::uses_beams),
                planes: estimator == Some(Estimator::BeamPlane0D),
                vertices: [false; 2],
                direct: false,
            },
            effort: None,
            memory: self.options.memory,
        }
    }

    /// The radii to begin with: as given, or from the density of a few light paths.
    fn first_radii(&mut self, scene: &Scene, seed: u64) -> Result<(f32, f32), TraceError> {
        if let Some(radii) = self.radii {
            return Ok(radii);
        }
        let (mut volume, mut surface) = (self.options.radius, self.options.surface_radius);
        if volume == 0.0 || surface == 0.0 {
            let pilot = self.options.photons.min(PILOT_PATHS);
            let tracing = Tracing { paths: pilot, ..self.tracing(scene, seed, PILOT_SET) };
            self.paths.trace(scene, &tracing)?;
            let more = f64::from(self.options.photons) / f64::from(pilot.max(1));
            let usual = |photons: &[Photon], dimension: f64| {
                let positions: Vec<Vec3> = photons.iter().map(|p| p.position).collect();
                let distance = usual_distance(&positions, USUAL_NEIGHBOURS).filter(|d| *d > 0.0);
                distance.map_or(FALLBACK * scene.geometry.bounds().extent().length(), |d| {
                    (f64::from(d) * more.powf(-1.0 / dimension)) as f32
                })
            };
            if volume == 0.0 {
                volume = self.options.blur
                    * match beam_radius(&self.paths.beams, more as f32, USUAL_BEAMS) {
                        Some(radius) => radius,
                        None => usual(&self.paths.points, 3.0),
                    };
            }
            if surface == 0.0 {
                surface = self.options.blur * usual(&self.paths.surfaces, 2.0);
            }
        }
        self.radii = Some((volume, surface));
        Ok((volume, surface))
    }
}

/// Largest radius that adapts to density, in units of the fixed one.
const LARGEST_ADAPTIVE: f32 = 8.0;

/// Least radius of a beam that follows its footprint, in units of the largest: footprints vanish at foci.
const LEAST_FOOTPRINT: f32 = 0.02;

/// Automatic radius where hardly any light arrives, in units of the scene's diagonal.
const FALLBACK: f32 = 1e-3;

impl Integrator for PhotonMapping {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        self.options.warnings(scene)
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        let reuse = if self.options.alpha.is_some() { 1 } else { self.options.reuse };
        let (set, serves) = light_set(reuse, pass);
        if self.set == Some(set) {
            return Ok(serves);
        }
        let (volume, surface) = self.first_radii(scene, seed)?;
        let dimension = self.options.estimator.map_or(2, Estimator::blur);
        let [shrink_volume, shrink_surface] = match self.options.alpha {
            None => [1.0; 2],
            Some(alpha) => {
                let dimensions = [dimension, 2];
                let best = |d: u32| 4.0 / (f64::from(d) + 4.0);
                let alphas = dimensions.map(|d| if alpha == 0.0 { best(d) } else { f64::from(alpha) });
                self.shrinking.at(set, dimensions, alphas)
            }
        };
        let radius = volume * shrink_volume;
        let tracing = Tracing {
            point_radius: radius,
            surface_radius: surface * shrink_surface,
            ..self.tracing(scene, seed, set)
        };
        self.paths.trace(scene, &tracing)?;
        self.counts.light_paths += u64::from(tracing.paths);
        self.counts.photons += self.paths.data() as u64;
        if tracing.wanted.points {
            let points = &mut self.paths.points;
            match self.options.selection {
                Selection::Fixed => self.points.rebuild(points),
                Selection::Neighbours(k) => {
                    let most = LARGEST_ADAPTIVE * volume;
                    adapt(points, &mut self.tree, &mut self.positions, k, shrink_volume, most);
                    self.points.rebuild(points);
                }
                Selection::Nearest(_) => {
                    self.positions.clear();
                    self.positions.extend(points.iter().map(|p| p.position));
                    self.tree.rebuild(&self.positions);
                }
            }
        }
        if tracing.wanted.surfaces {
            self.surfaces.rebuild(&self.paths.surfaces);
        }
        if tracing.wanted.beams {
            let radius = match self.options.footprint {
                0.0 => BeamRadius::Fixed(radius),
                factor => BeamRadius::Footprint {
                    factor: factor * shrink_volume,
                    least: LEAST_FOOTPRINT * radius,
                    most: radius,
                },
            };
            self.beams.rebuild(&self.paths.beams, radius);
        }
        if tracing.wanted.planes {
            self.planes.rebuild(&self.paths.planes);
        }
        self.set = Some(set);
        Ok(serves)
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], _: &mut Splats) -> RareEvents {
        let mut scratch = Scratch::default();
        sample_pixels(scene, job, pixels, |sample, sampler| {
            Gatherer::radiance(self, scene, &mut scratch, sample.film, sampler)
        })
    }
}

/// Memory of the camera's walks, used again for each.
#[derive(Default)]
struct Scratch {
    profile: Profile,
    neighbours: Neighbours,
}
