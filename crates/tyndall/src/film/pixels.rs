//! Pixel sums of progressive rendering.

use crate::Spectrum;

/// Edge of a square tile, pixels.
pub const TILE: u32 = 16;

/// What one pixel has received.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSum {
    /// Sum of the samples, in the order of their passes.
    pub sum: [f64; 3],
    /// Sum of the squared samples.
    pub sum_of_squares: [f64; 3],
}

impl PixelSum {
    /// Adds one sample.
    #[inline(always)]
    pub fn add(&mut self, sample: Spectrum) {
        self.add_values(sample.to_rgb().map(f64::from));
    }

    /// Adds one sample, channel by channel.
    #[inline(always)]
    pub fn add_values(&mut self, sample: [f64; 3]) {
        for (channel, value) in sample.into_iter().enumerate() {
            self.sum[channel] += value;
            self.sum_of_squares[channel] += value * value;
        }
    }

    /// Mean and variance of the mean after `samples` samples; the variance of fewer than two is zero.
    pub fn mean_and_variance(&self, samples: u32) -> ([f64; 3], [f64; 3]) {
        let n = f64::from(samples.max(1));
        let mean = self.sum.map(|sum| sum / n);
        let variance = std::array::from_fn(|c| {
            if samples < 2 {
                return 0.0;
            }
            (self.sum_of_squares[c] / n - mean[c] * mean[c]).max(0.0) / (n - 1.0)
        });
        (mean, variance)
    }
}

/// A rectangle of pixels of the rendered part of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Sums of all pixels, tile by tile, so that each tile is one contiguous slice for one thread.
///
/// Every sample belongs to exactly one pixel (the reconstruction filter is importance sampled) and every pixel adds its
/// samples in the order of the passes: the sums do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct Pixels {
    width: u32,
    height: u32,
    tiles: Vec<Tile>,
    sums: Vec<PixelSum>,
}

impl Pixels {
    /// A black picture of `width` x `height` pixels.
    pub fn new(width: u32, height: u32) -> Self {
        let tiles: Vec<Tile> = (0..height.div_ceil(TILE))
            .flat_map(|row| (0..width.div_ceil(TILE)).map(move |column| (column * TILE, row * TILE)))
            .map(|(x, y)| Tile { x, y, width: TILE.min(width - x), height: TILE.min(height - y) })
            .collect();
        Self { width, height, tiles, sums: vec![PixelSum::default(); width as usize * height as usize] }
    }

    /// Index among the sums of a picture of that size, of the pixel in a column and row.
    #[inline(always)]
    pub fn index((width, height): (u32, u32), x: u32, y: u32) -> usize {
        let (left, top) = (x - x % TILE, y - y % TILE);
        let (columns, rows) = (TILE.min(width - left), TILE.min(height - top));
        let before = top as usize * width as usize + left as usize * rows as usize;
        before + ((y - top) * columns + (x - left)) as usize
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All sums, tile by tile and row by row within a tile.
    pub fn sums(&self) -> &[PixelSum] {
        &self.sums
    }

    /// All sums, to be overwritten by those of a checkpoint.
    pub fn sums_mut(&mut self) -> &mut [PixelSum] {
        &mut self.sums
    }

    /// Every tile with its slice of sums.
    pub fn tiles_mut(&mut self) -> Vec<(Tile, &mut [PixelSum])> {
        let mut rest = &mut self.sums[..];
        let mut pairs = Vec::with_capacity(self.tiles.len());
        for &tile in &self.tiles {
            let (slice, tail) = rest.split_at_mut(tile.pixels());
            pairs.push((tile, slice));
            rest = tail;
        }
        pairs
    }

    /// `function` of every pixel, row by row over the whole picture.
    pub fn map<T: Clone + Default>(&self, function: impl Fn(&PixelSum) -> T) -> Vec<T> {
        self.map_index(|index| function(&self.sums[index]))
    }

    /// `function` of every pixel's index among the sums, row by row over the whole picture.
    pub fn map_index<T: Clone + Default>(&self, function: impl Fn(usize) -> T) -> Vec<T> {
        let mut rows = vec![T::default(); self.sums.len()];
        let mut indices = 0..self.sums.len();
        for tile in &self.tiles {
            for y in tile.y..tile.y + tile.height {
                for x in tile.x..tile.x + tile.width {
                    let index = indices.next().expect("the tiles partition the picture");
                    rows[y as usize * self.width as usize + x as usize] = function(index);
                }
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_partition_the_picture() {
        for (width, height) in [(1, 1), (16, 16), (17, 5), (100, 33)] {
            let mut pixels = Pixels::new(width, height);
            for (tile, sums) in pixels.tiles_mut() {
                for (i, sum) in sums.iter_mut().enumerate() {
                    let (x, y) = (tile.x + i as u32 % tile.width, tile.y + i as u32 / tile.width);
                    sum.sum[0] += f64::from(y * width + x);
                }
            }
            let expected: Vec<f64> = (0..width * height).map(f64::from).collect();
            assert_eq!(pixels.map(|s| s.sum[0]), expected);
        }
    }

    #[test]
    fn variance_of_the_mean() {
        let mut pixel = PixelSum::default();
        for value in [1.0, 3.0, 5.0] {
            pixel.add(Spectrum::new(value, 2.0, 0.0));
        }
        let (mean, variance) = pixel.mean_and_variance(3);
        assert_eq!(mean, [3.0, 2.0, 0.0]);
        assert!((variance[0] - 4.0 / 3.0).abs() < 1e-12 && variance[1] == 0.0);
    }
}
