//! Light that paths from emitters add to pixels anywhere.
//!
//! Tiles keep what they add in lists of their own, which are summed up in the order of the tiles: sums do not depend on
//! the number of threads, and no thread waits for another.

use super::filter::FilterSampler;
use super::pixels::Pixels;
use crate::Spectrum;
use crate::math::Vec2;

/// One contribution to one pixel.
#[derive(Clone, Copy, Debug)]
struct Splat {
    /// Index among the sums of [`Pixels`].
    pixel: u32,
    value: Spectrum,
}

/// Where a contribution went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the pixel among the sums of [`Pixels`].
    pub pixel: u32,
    /// The factor of its filter.
    pub filter: f32,
}

/// The part of the film that is rendered, and how light is spread over its pixels.
#[derive(Clone, Copy, Debug)]
pub struct Screen<'a> {
    /// The reconstruction filter.
    pub filter: &'a FilterSampler,
    /// Column and row of the whole film where the rendered part begins.
    pub origin: (u32, u32),
    /// Columns and rows of the rendered part.
    pub size: (u32, u32),
}

/// A list of contributions, in the order in which they were added.
#[derive(Debug)]
pub struct Splats<'a> {
    screen: Screen<'a>,
    list: Vec<Splat>,
    /// Contributions that were not finite and were dropped.
    pub non_finite: u64,
}

impl<'a> Splats<'a> {
    /// An empty list.
    pub fn new(screen: Screen<'a>) -> Self {
        Self { screen, list: Vec::new(), non_finite: 0 }
    }

    /// Whether a position of the whole film, in pixels, shows in the rendered part.
    #[inline]
    pub fn shows(&self, position: Vec2) -> bool {
        let Screen { filter, origin, size } = self.screen;
        let low = Vec2::new(origin.0 as f32, origin.1 as f32) + Vec2::splat(0.5 - filter.radius());
        let high = low + Vec2::new(size.0 as f32, size.1 as f32) + Vec2::splat(2.0 * filter.radius() - 1.0);
        position.cmpge(low).all() && position.cmple(high).all()
    }

    /// Adds `value` at a `position` of the whole film, in pixels. One of the pixels whose filter takes the position in is
    /// chosen with `u` in [0, 1)^2. Answers where it went; `None` when it is not shown.
    #[inline]
    pub fn add(&mut self, position: Vec2, value: Spectrum, u: Vec2) -> Option<Place> {
        if !value.is_finite() {
            self.non_finite += 1;
            return None;
        }
        let (x, weight_x) = self.screen.filter.choose_pixel(position.x, u.x);
        let (y, weight_y) = self.screen.filter.choose_pixel(position.y, u.y);
        let inside =
            |at: i64, origin: u32, size: u32| u32::try_from(at - i64::from(origin)).ok().filter(|&at| at < size);
        let Screen { origin, size, .. } = self.screen;
        let (x, y) = (inside(x, origin.0, size.0)?, inside(y, origin.1, size.1)?);
        let pixel = Pixels::index(size, x, y) as u32;
        let filter = weight_x * weight_y;
        self.list.push(Splat { pixel, value: value * filter });
        Some(Place { pixel, filter })
    }
}

/// Sums of the splats of one pass.
#[derive(Debug)]
pub struct SplatSums(Vec<[f64; 3]>);

impl SplatSums {
    /// No light on `count` pixels.
    pub fn new(count: usize) -> Self {
        Self(vec![[0.0; 3]; count])
    }

    /// Adds a list, in its order.
    pub fn add(&mut self, splats: &Splats) {
        for Splat { pixel, value } in &splats.list {
            for (sum, channel) in self.0[*pixel as usize].iter_mut().zip(value.to_rgb()) {
                *sum += f64::from(channel);
            }
        }
    }

    /// The sums, in the order of [`Pixels::sums`].
    pub fn values(&self) -> &[[f64; 3]] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::filter::ReconstructionFilter;
    use crate::film::pixels::TILE;
    use crate::math::Rng;

    /// The picture of a point of light is the filter about it, wherever it lies.
    #[test]
    fn splats_are_spread_by_the_filter() {
        for filter in [
            ReconstructionFilter::Box,
            ReconstructionFilter::Tent { radius: 1.0 },
            ReconstructionFilter::default(),
            ReconstructionFilter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        ] {
            let sampler = FilterSampler::new(filter).unwrap();
            let mut rng = Rng::keyed(1, 2, 3);
            let position = Vec2::new(7.3, 4.85);
            let size = (12, 9);
            let screen = Screen { filter: &sampler, origin: (2, 1), size };
            let mut splats = Splats::new(screen);
            const N: u32 = 200_000;
            for _ in 0..N {
                splats.add(position, Spectrum::ONE, rng.vec2());
            }
            let mut sums = SplatSums::new(12 * 9);
            sums.add(&splats);
            // What the camera's samples of a pixel say: the density of the filter at the position.
            let mut seen = vec![0.0; 12 * 9];
            for y in 0..size.1 {
                for x in 0..size.0 {
                    let centre = Vec2::new((x + 2) as f32 + 0.5, (y + 1) as f32 + 0.5);
                    let o = position - centre;
                    seen[Pixels::index(size, x, y)] = f64::from(sampler.value(o.x) * sampler.value(o.y));
                }
            }
            for (found, expected) in sums.values().iter().zip(seen) {
                let found = found[0] / f64::from(N);
                assert!((found - expected).abs() < 0.006, "{filter:?}: {found} is not {expected}");
            }
        }
    }

    /// The mean of a function of the camera's samples equals the integral over the film with the filter's values.
    #[test]
    fn the_filter_integrates_to_one() {
        for filter in [
            ReconstructionFilter::Lanczos { lobes: 3 },
            ReconstructionFilter::default(),
            ReconstructionFilter::CatmullRom,
        ] {
            let sampler = FilterSampler::new(filter).unwrap();
            let n = 8000;
            let sum: f64 = (0..n).map(|i| f64::from(sampler.value((i as f32 + 0.5) * 8.0 / n as f32 - 4.0))).sum();
            assert!((sum * 8.0 / f64::from(n) - 1.0).abs() < 1e-3, "{filter:?}");
        }
    }

    #[test]
    fn indices_are_those_of_the_tiles() {
        for (width, height) in [(1, 1), (16, 16), (17, 5), (100, 33)] {
            let mut pixels = Pixels::new(width, height);
            let mut next = 0;
            for (tile, sums) in pixels.tiles_mut() {
                for i in 0..sums.len() as u32 {
                    let (x, y) = (tile.x + i % tile.width, tile.y + i / tile.width);
                    assert_eq!(Pixels::index((width, height), x, y), next, "{width} x {height}, tile of {TILE}");
                    next += 1;
                }
            }
        }
    }
}
