//! How densely light paths scatter, on the whole.
//!
//! The balance heuristic takes the merges of one camera path with many light paths for independent samples. They are not:
//! all share the camera's walk, and where it has scattered, its noise is left however many light paths there are (Grittmann
//! et al. 2021). So beyond the first vertex of a camera's walk fewer light paths are merged, and merges count as no more
//! samples than they need to find light at all: with `k` merges expected at a place, as `k / (1 + k)`.

use crate::math::{Aabb, Vec3};
use std::f32::consts::PI;

/// Places that a cell has on the mean: enough to tell dark cells from unlucky ones.
const IN_CELL: f32 = 16.0;
/// Share of the places that are left out at each end of each axis, so that a few far ones do not spread the cells.
const OUTLIERS: f32 = 0.01;
/// Points that a widened radius takes in.
const TAKEN_IN: f32 = 8.0;
/// How many times a radius is widened at most.
const WIDEST: f32 = 6.0;

/// Where a light path has scattered.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Position, metres.
    pub position: Vec3,
    /// Factor that radii have there.
    pub factor: f32,
    /// Extinction of the medium, 1/m; zero on surfaces.
    pub sigma_t: f32,
}

/// What is known of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Scatterings for each light path, 1/m^3 in media and 1/m^2 on surfaces.
    pub density: f32,
    /// Factor of the radii of balls, in which points are merged ...
    pub ball: f32,
    /// ... and of disks, across the camera's beams and on surfaces.
    pub disk: f32,
    /// Extinction on the mean, 1/m.
    pub sigma_t: f32,
}

impl Cell {
    const UNKNOWN: Self = Self { density: 0.0, ball: 1.0, disk: 1.0, sigma_t: 0.0 };

    /// Points of so many light paths, 1/m^3 or 1/m^2; never zero.
    fn points(&self, paths: u32) -> f32 {
        (self.density * paths as f32).max(f32::MIN_POSITIVE)
    }
}

/// Light paths' scatterings, counted in a coarse grid. Where nothing is counted, all merges count.
#[derive(Clone, Debug)]
pub struct LightDensity {
    bounds: Aabb,
    /// Cells along each axis.
    cells: usize,
    media: Vec<Cell>,
    surfaces: Vec<Cell>,
    /// Size of all, metres.
    extent: f32,
}

impl Default for LightDensity {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl LightDensity {
    /// Nothing is known.
    pub const UNKNOWN: Self =
        Self { bounds: Aabb::EMPTY, cells: 0, media: Vec::new(), surfaces: Vec::new(), extent: 0.0 };

    /// Of so many light paths that scattered at these places in media and on surfaces.
    pub fn new(media: &[Place], surfaces: &[Place], paths: u32) -> Self {
        let all = || media.iter().chain(surfaces);
        let range = |axis: usize| {
            let mut values: Vec<f32> = all().map(|place| place.position[axis]).collect();
            values.sort_unstable_by(f32::total_cmp);
            let skip = (values.len() as f32 * OUTLIERS) as usize;
            Some((*values.get(skip)?, values[values.len() - 1 - skip]))
        };
        let (Some(x), Some(y), Some(z)) = (range(0), range(1), range(2)) else { return Self::UNKNOWN };
        let (min, max) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
        let extent = (max - min).max_element();
        // A little more, so that flat scenes have cells and the outermost places lie inside.
        let margin = Vec3::splat(1e-3 * extent);
        let bounds = Aabb { min: min - margin, max: max + margin };
        let cells = (all().count() as f32 / IN_CELL).cbrt().max(1.0) as usize;
        let mut density = Self { bounds, cells, media: Vec::new(), surfaces: Vec::new(), extent };
        let size = (bounds.max - bounds.min) / cells as f32;
        let volume = size.x * size.y * size.z;
        if !(volume > 0.0 && volume.is_finite()) {
            return Self::UNKNOWN;
        }
        let count = |places: &[Place], measure: f32| {
            let mut sums = vec![[0.0; 3]; cells * cells * cells];
            for (i, place) in places.iter().filter_map(|place| Some((density.cell(place.position)?, place))) {
                let [n, factor, sigma_t] = sums[i];
                sums[i] = [n + 1.0, factor + place.factor, sigma_t + place.sigma_t];
            }
            let cell = |[n, factor, sigma_t]: [f32; 3]| match n {
                0.0 => Cell::UNKNOWN,
                _ => {
                    let factor = factor / n;
                    Cell { density: n / (measure * paths as f32), ball: factor, disk: factor, sigma_t: sigma_t / n }
                }
            };
            sums.into_iter().map(cell).collect()
        };
        let (media, surfaces) = (count(media, volume), count(surfaces, volume.powf(2.0 / 3.0)));
        (density.media, density.surfaces) = (media, surfaces);
        density
    }

    fn cell(&self, x: Vec3) -> Option<usize> {
        let cells = self.cells as f32;
        let place = (x - self.bounds.min) / (self.bounds.max - self.bounds.min) * cells;
        let inside = place.cmpge(Vec3::ZERO).all() && place.cmplt(Vec3::splat(cells)).all();
        let [i, j, k] = place.to_array().map(|p| p as usize);
        inside.then_some((k * self.cells + j) * self.cells + i)
    }

    /// Widens the radii in media, `radius` metres before, where a ball would take in less than a few of the points of so many light
    /// paths, or a disk less on the length of a beam: which is seldom, so that beams see finer structures than points.
    pub fn widen_in_media(&mut self, radius: f32, paths: u32) {
        for cell in &mut self.media {
            let points = cell.points(paths);
            let along = beam_length(self.extent, cell.sigma_t);
            cell.ball = widened(cell.ball, (TAKEN_IN / (points * 4.0 / 3.0 * PI)).cbrt() / radius);
            cell.disk = widened(cell.disk, (TAKEN_IN / (points * along * PI)).sqrt() / radius);
        }
    }

    /// Widens the radii on surfaces, `radius` metres before, where a disk would take in less than a few of the points of so many
    /// light paths.
    pub fn widen_on_surfaces(&mut self, radius: f32, paths: u32) {
        for cell in &mut self.surfaces {
            let points = cell.points(paths);
            cell.disk = widened(cell.disk, (TAKEN_IN / (points * PI)).sqrt() / radius);
        }
    }

    #[inline]
    fn at(&self, cells: &[Cell], x: Vec3) -> Cell {
        if cells.is_empty() { Cell::UNKNOWN } else { self.cell(x).map_or(Cell::UNKNOWN, |i| cells[i]) }
    }

    /// In media at `x`.
    #[inline]
    pub fn in_medium(&self, x: Vec3) -> Cell {
        self.at(&self.media, x)
    }

    /// On surfaces at `x`.
    #[inline]
    pub fn on_surface(&self, x: Vec3) -> Cell {
        self.at(&self.surfaces, x)
    }

    /// About how long beams are in a medium of that extinction (1/m), metres.
    pub fn beam_length(&self, sigma_t: f32) -> f32 {
        beam_length(self.extent, sigma_t)
    }
}

fn beam_length(extent: f32, sigma_t: f32) -> f32 {
    if sigma_t * extent > 1.0 { 1.0 / sigma_t } else { extent }
}

/// The factor of a radius that is to be `wanted`, no smaller than it was.
fn widened(factor: f32, wanted: f32) -> f32 {
    factor * (wanted / factor).clamp(1.0, WIDEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    /// Places in a box of 2 x 1 x 1 whose one half has three times as many.
    fn places(count: u64) -> Vec<Place> {
        let place = |i| {
            let mut rng = Rng::keyed(5, 1, i);
            let half = if i % 4 == 0 { 0.0 } else { 1.0 };
            Place { position: Vec3::new(half + rng.f32(), rng.f32(), rng.f32()), factor: 1.0, sigma_t: 2.0 }
        };
        (0..count).map(place).collect()
    }

    #[test]
    fn densities_are_those_of_the_places() {
        let (media, paths) = (places(200_000), 1000);
        let density = LightDensity::new(&media, &[], paths);
        for (x, expected) in [(0.3, 50.0), (0.6, 50.0), (1.3, 150.0), (1.7, 150.0)] {
            let mean = (0..1000_u64).map(|i| {
                let mut rng = Rng::keyed(5, 2, i);
                let at = Vec3::new(x + 0.1 * rng.f32(), 0.1 + 0.8 * rng.f32(), 0.1 + 0.8 * rng.f32());
                density.in_medium(at).density
            });
            let mean = mean.sum::<f32>() / 1000.0;
            assert!((mean / expected - 1.0).abs() < 0.05, "{x}: {mean} is not {expected}");
        }
        assert_eq!(density.in_medium(Vec3::new(5.0, 0.5, 0.5)), Cell::UNKNOWN, "outside");
        assert_eq!(density.on_surface(Vec3::new(1.5, 0.5, 0.5)).density, 0.0, "no surface");
        assert_eq!(density.beam_length(100.0), 0.01);
        assert!((density.beam_length(0.01) - 2.0).abs() < 0.1, "no longer than all");
        assert_eq!(LightDensity::new(&[], &[], paths).in_medium(Vec3::ZERO), Cell::UNKNOWN);
    }

    #[test]
    fn far_places_do_not_spread_the_cells() {
        let mut media = places(10_000);
        media.extend([1e6, -1e6].map(|x| Place { position: Vec3::splat(x), factor: 1.0, sigma_t: 2.0 }));
        let density = LightDensity::new(&media, &media, 100);
        assert!(density.in_medium(Vec3::new(1.5, 0.5, 0.5)).density > 50.0);
        assert!(density.on_surface(Vec3::new(1.5, 0.5, 0.5)).density > 0.0);
    }

    #[test]
    fn radii_are_those_of_the_places_and_take_in_a_few_points() {
        // Radii grow along x.
        let grown = |place: Place| Place { factor: place.position.x, sigma_t: 0.0, ..place };
        let surfaces: Vec<_> = places(200_000).into_iter().map(grown).collect();
        let mut density = LightDensity::new(&[], &surfaces, 1000);
        let mean = |density: &LightDensity, x: f32| {
            let at = |i: u64| {
                let mut rng = Rng::keyed(5, 3, i);
                let y = Vec3::new(x + 0.1 * rng.f32(), 0.1 + 0.8 * rng.f32(), 0.1 + 0.8 * rng.f32());
                density.on_surface(y).disk
            };
            (0..1000).map(at).sum::<f32>() / 1000.0
        };
        for x in [0.3, 0.6, 1.3, 1.7] {
            let found = mean(&density, x);
            assert!((found / (x + 0.05) - 1.0).abs() < 0.1, "{x}: {found}");
        }
        let before = density.on_surface(Vec3::splat(0.5));
        density.widen_on_surfaces(0.02, 1000);
        let after = density.on_surface(Vec3::splat(0.5));
        let disk = PI * (0.02 * after.disk).powi(2);
        assert!((1000.0 * after.density * disk / TAKEN_IN - 1.0).abs() < 1e-4, "{before:?} {after:?}");
        density.widen_on_surfaces(1e-6, 1000);
        let widest = density.on_surface(Vec3::splat(0.5));
        assert_eq!(widest.disk, WIDEST * after.disk);
        density.widen_on_surfaces(1.0, 1000);
        assert_eq!(density.on_surface(Vec3::splat(0.5)), widest, "never narrower");
    }

    #[test]
    fn balls_and_disks_across_beams_take_in_a_few_points() {
        const PATHS: u32 = 1000;
        let widened = |radius: f32, sigma_t: f32| {
            let media: Vec<_> = places(200_000).into_iter().map(|place| Place { sigma_t, ..place }).collect();
            let mut density = LightDensity::new(&media, &[], PATHS);
            density.widen_in_media(radius, PATHS);
            density.in_medium(Vec3::new(1.5, 0.5, 0.5))
        };
        // Some 150 000 points in a cubic metre, beams of half a metre.
        let Cell { density, ball, disk, .. } = widened(0.005, 2.0);
        let points = density * PATHS as f32;
        let in_ball = points * 4.0 / 3.0 * PI * (0.005 * ball).powi(3);
        assert!((in_ball / TAKEN_IN - 1.0).abs() < 1e-3, "{in_ball} in a ball");
        let along = points * 0.5 * PI * (0.005 * disk).powi(2);
        assert!((along / TAKEN_IN - 1.0).abs() < 1e-3, "{along} along a beam");
        assert!(1.0 < disk && disk < ball, "{disk}, {ball}");
        // In dense media beams are short.
        assert!((widened(0.005, 8.0).disk / (2.0 * disk) - 1.0).abs() < 1e-3);
        let Cell { ball, disk, .. } = widened(1.0, 2.0);
        assert_eq!((ball, disk), (1.0, 1.0), "no narrower");
        let Cell { ball, disk, .. } = widened(1e-6, 2.0);
        assert_eq!((ball, disk), (WIDEST, WIDEST), "no wider");
    }
}
