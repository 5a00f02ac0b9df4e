//! Who wants to know what each technique adds to the picture.

use super::technique::{Catalogue, Technique};
use crate::Spectrum;
use crate::film::layers::{LayerSplat, LayerSum, TileLayers};
use crate::film::splats::Place;

/// Told every contribution: `weighted` as it counts, `alone` as it would count without the other techniques.
pub trait Recorder {
    /// Of the camera's path at hand.
    fn add(&self, technique: Technique, weighted: Spectrum, alone: Spectrum);
    /// Of a light path, at a pixel anywhere; `None`: it is not shown.
    fn splat(&self, technique: Technique, place: Option<Place>, weighted: Spectrum, alone: Spectrum);
    /// The camera's path belongs to the pixel of that number in the tile, with that weight of the filter.
    fn finish(&self, pixel: usize, weight: f32);
}

/// Nobody: costs nothing.
impl Recorder for () {
    #[inline(always)]
    fn add(&self, _: Technique, _: Spectrum, _: Spectrum) {}
    #[inline(always)]
    fn splat(&self, _: Technique, _: Option<Place>, _: Spectrum, _: Spectrum) {}
    #[inline(always)]
    fn finish(&self, _: usize, _: f32) {}
}

/// The record of a tile.
#[derive(Debug)]
pub struct Record<'a> {
    catalogue: &'a Catalogue,
    layers: TileLayers<'a>,
}

impl<'a> Record<'a> {
    /// Adds to `sums`: those of all techniques of the catalogue, one pixel after the other.
    pub fn new(catalogue: &'a Catalogue, sums: &'a mut [LayerSum]) -> Self {
        Self { catalogue, layers: TileLayers::new(catalogue.techniques().len(), sums) }
    }

    /// What light paths added to pixels anywhere.
    pub fn into_splats(self) -> Vec<LayerSplat> {
        self.layers.into_splats()
    }
}

impl Recorder for Record<'_> {
    fn add(&self, technique: Technique, weighted: Spectrum, alone: Spectrum) {
        if let Some(number) = self.catalogue.number(technique) {
            self.layers.add(number, weighted, alone);
        }
    }

    fn splat(&self, technique: Technique, place: Option<Place>, weighted: Spectrum, alone: Spectrum) {
        if let (Some(number), Some(place)) = (self.catalogue.number(technique), place) {
            self.layers.splat(number, place, weighted, alone);
        }
    }

    fn finish(&self, pixel: usize, weight: f32) {
        self.layers.finish(pixel, weight);
    }
}
