//! A picture taken apart: what each of several layers adds to each pixel, weighted and as if it were alone.
//!
//! Threads take tiles, as with [`Pixels`](super::pixels::Pixels). What light paths add anywhere goes through lists, as with
//! [`Splats`](super::splats::Splats): the sums do not depend on the number of threads.

use super::splats::Place;
use crate::Spectrum;
use std::cell::{Cell, RefCell};
use std::ops::Range;

/// What a layer has added to a pixel, sums over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerSum {
    /// With the weights by which all layers add up to the picture.
    pub weighted: [f64; 3],
    /// Without: what the layer would show if it were alone.
    pub alone: [f64; 3],
}

impl LayerSum {
    /// Adds what is finite.
    fn add(&mut self, weighted: Spectrum, alone: Spectrum) {
        for (sum, light) in [(&mut self.weighted, weighted), (&mut self.alone, alone)] {
            if light.is_finite() {
                sum.iter_mut().zip(light.to_rgb()).for_each(|(sum, channel)| *sum += f64::from(channel));
            }
        }
    }
}

/// One contribution of a layer to a pixel anywhere.
#[derive(Clone, Copy, Debug)]
pub struct LayerSplat {
    pixel: u32,
    layer: u16,
    weighted: Spectrum,
    alone: Spectrum,
}

/// The layers of a tile while it is rendered.
#[derive(Debug)]
pub struct TileLayers<'a> {
    sums: &'a [Cell<LayerSum>],
    /// What the sample at hand has brought to each layer: weighted, alone.
    sample: Vec<Cell<[Spectrum; 2]>>,
    splats: RefCell<Vec<LayerSplat>>,
}

impl<'a> TileLayers<'a> {
    /// Adds to `sums`, those of one pixel after the other.
    pub fn new(layers: usize, sums: &'a mut [LayerSum]) -> Self {
        let sums = Cell::from_mut(sums).as_slice_of_cells();
        Self { sums, sample: vec![Cell::new([Spectrum::ZERO; 2]); layers], splats: RefCell::default() }
    }

    /// Adds to the sample at hand.
    #[inline]
    pub fn add(&self, layer: usize, weighted: Spectrum, alone: Spectrum) {
        let cell = &self.sample[layer];
        let [a, b] = cell.get();
        cell.set([a + weighted, b + alone]);
    }

    /// Adds to a pixel anywhere.
    #[inline]
    pub fn splat(&self, layer: usize, place: Place, weighted: Spectrum, alone: Spectrum) {
        let Place { pixel, filter } = place;
        let splat = LayerSplat { pixel, layer: layer as u16, weighted: weighted * filter, alone: alone * filter };
        self.splats.borrow_mut().push(splat);
    }

    /// The sample at hand is one of the pixel of that number in the tile, with the weight of its filter; the next begins.
    pub fn finish(&self, pixel: usize, weight: f32) {
        let layers = self.sample.len();
        for (sample, sum) in self.sample.iter().zip(&self.sums[pixel * layers..]) {
            let [weighted, alone] = sample.replace([Spectrum::ZERO; 2]);
            let mut total = sum.get();
            total.add(weighted * weight, alone * weight);
            sum.set(total);
        }
    }

    /// What was added to pixels anywhere.
    pub fn into_splats(self) -> Vec<LayerSplat> {
        self.splats.into_inner()
    }
}

/// The layers of all pixels.
#[derive(Clone, Debug)]
pub struct Layers {
    layers: usize,
    /// Pixel by pixel in the order of the sums of [`Pixels`](super::pixels::Pixels), and layer by layer in a pixel.
    sums: Vec<LayerSum>,
}

impl Layers {
    /// Bytes that `layers` of `pixels` take; `None`: more than can be counted.
    pub fn bytes(layers: usize, pixels: usize) -> Option<usize> {
        layers.checked_mul(pixels)?.checked_mul(size_of::<LayerSum>())
    }

    /// Black layers.
    pub fn new(layers: usize, pixels: usize) -> Self {
        Self { layers, sums: vec![LayerSum::default(); layers * pixels] }
    }

    /// The sums of a range of pixels, all layers of one pixel after the other.
    pub fn pixels_mut(&mut self, pixels: Range<usize>) -> &mut [LayerSum] {
        &mut self.sums[pixels.start * self.layers..pixels.end * self.layers]
    }

    /// Adds a list, in its order.
    pub fn add(&mut self, splats: &[LayerSplat]) {
        for splat in splats {
            self.sums[splat.pixel as usize * self.layers + usize::from(splat.layer)].add(splat.weighted, splat.alone);
        }
    }

    /// What a layer has added to a pixel.
    pub fn sum(&self, layer: usize, pixel: usize) -> &LayerSum {
        &self.sums[pixel * self.layers + layer]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_and_splats_come_to_their_layers() {
        let mut layers = Layers::new(2, 3);
        let nan = Spectrum::grey(f32::NAN);
        let tile = TileLayers::new(2, layers.pixels_mut(1..3));
        tile.add(1, Spectrum::ONE, Spectrum::grey(2.0));
        tile.add(1, Spectrum::ONE, Spectrum::ZERO);
        tile.finish(1, 0.5);
        tile.add(0, nan, Spectrum::ONE);
        tile.finish(0, 1.0);
        tile.splat(0, Place { pixel: 0, filter: 0.25 }, Spectrum::grey(4.0), Spectrum::grey(8.0));
        let splats = tile.into_splats();
        layers.add(&splats);
        let sum = |layer, pixel| {
            let LayerSum { weighted, alone } = layers.sum(layer, pixel);
            [weighted[0], alone[2]]
        };
        assert_eq!([sum(0, 0), sum(1, 0)], [[1.0, 2.0], [0.0; 2]]);
        assert_eq!([sum(0, 1), sum(1, 1)], [[0.0, 1.0], [0.0; 2]], "what is not finite is dropped");
        assert_eq!([sum(0, 2), sum(1, 2)], [[0.0; 2], [1.0, 1.0]]);
        assert_eq!(Layers::bytes(2, 3), Some(288));
        assert_eq!(Layers::bytes(usize::MAX, 2), None);
    }
}
