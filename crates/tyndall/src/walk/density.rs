//! How densely light paths scatter, on the whole.
//!
//! The balance heuristic takes the merges of one camera path with many light paths for independent samples. They are not:
//! all share the camera's walk, and where it has scattered, its noise is left however many light paths there are (Grittmann
//! et al. 2021). So beyond the first vertex of a camera's walk fewer light paths are merged, and merges count as no more
//! samples than they need to find light at all: with `k` merges expected at a place, as `k / (1 + k)`.

use crate::math::{Aabb, Vec3};

/// Places that a cell has on the mean: enough to tell dark cells from unlucky ones.
const IN_CELL: f32 = 16.0;
/// Share of the places that are left out at each end of each axis, so that a few far ones do not spread the cells.
const OUTLIERS: f32 = 0.01;

/// Light paths' scatterings, counted in a coarse grid. Where nothing is counted, all merges count.
#[derive(Clone, Debug)]
pub struct LightDensity {
    bounds: Aabb,
    /// Cells along each axis.
    cells: usize,
    /// For each cell in media, 1/m^3 ...
    media: Vec<f32>,
    /// ... and on surfaces, 1/m^2, both for each light path.
    surfaces: Vec<f32>,
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
    pub fn new(media: &[Vec3], surfaces: &[Vec3], paths: u32) -> Self {
        let all = || media.iter().chain(surfaces);
        let range = |axis: usize| {
            let mut values: Vec<f32> = all().map(|x| x[axis]).collect();
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
        let count = |places: &[Vec3], measure: f32| {
            let mut counts = vec![0.0; cells * cells * cells];
            places.iter().filter_map(|x| density.cell(*x)).for_each(|i| counts[i] += 1.0);
            counts.iter_mut().for_each(|n| *n /= measure * paths as f32);
            counts
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

    fn at(&self, cells: &[f32], x: Vec3) -> f32 {
        if cells.is_empty() { 0.0 } else { self.cell(x).map_or(0.0, |i| cells[i]) }
    }

    /// In media at `x`, 1/m^3 for each light path.
    pub fn in_medium(&self, x: Vec3) -> f32 {
        self.at(&self.media, x)
    }

    /// On surfaces at `x`, 1/m^2 for each light path.
    pub fn on_surface(&self, x: Vec3) -> f32 {
        self.at(&self.surfaces, x)
    }

    /// About how long beams are in a medium of that extinction (1/m), metres.
    pub fn beam_length(&self, sigma_t: f32) -> f32 {
        if sigma_t * self.extent > 1.0 { 1.0 / sigma_t } else { self.extent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    /// Places in a box of 2 x 1 x 1 whose one half has three times as many.
    fn places(count: u64) -> Vec<Vec3> {
        let place = |i| {
            let mut rng = Rng::keyed(5, 1, i);
            let half = if i % 4 == 0 { 0.0 } else { 1.0 };
            Vec3::new(half + rng.f32(), rng.f32(), rng.f32())
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
                density.in_medium(Vec3::new(x + 0.1 * rng.f32(), 0.1 + 0.8 * rng.f32(), 0.1 + 0.8 * rng.f32()))
            });
            let mean = mean.sum::<f32>() / 1000.0;
            assert!((mean / expected - 1.0).abs() < 0.05, "{x}: {mean} is not {expected}");
        }
        assert_eq!(density.in_medium(Vec3::new(5.0, 0.5, 0.5)), 0.0, "outside");
        assert_eq!(density.on_surface(Vec3::new(1.5, 0.5, 0.5)), 0.0, "no surface");
        assert_eq!(density.beam_length(100.0), 0.01);
        assert!((density.beam_length(0.01) - 2.0).abs() < 0.1, "no longer than all");
        assert_eq!(LightDensity::new(&[], &[], paths).in_medium(Vec3::ZERO), 0.0);
    }

    #[test]
    fn far_places_do_not_spread_the_cells() {
        let mut media = places(10_000);
        media.extend([Vec3::splat(1e6), Vec3::splat(-1e6)]);
        let density = LightDensity::new(&media, &media, 100);
        assert!(density.in_medium(Vec3::new(1.5, 0.5, 0.5)) > 50.0);
        assert!(density.on_surface(Vec3::new(1.5, 0.5, 0.5)) > 0.0);
    }
}
