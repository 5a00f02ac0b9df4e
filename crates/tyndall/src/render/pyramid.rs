//! The pyramid of techniques: a picture taken apart by the ways in which its light was found (Veach 1997, chapter 10).

use super::Rendering;
use crate::film::layers::{LayerSplat, LayerSum, Layers};
use crate::film::pixels::{PixelSum, Tile};
use crate::integrators;
use crate::mis::{Catalogue, Technique};

/// Why techniques cannot be told apart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PyramidError {
    /// There is but one.
    #[error("`{name}` does not tell techniques apart: those that do are {known}")]
    OneTechnique {
        /// The integrator.
        name: String,
        /// Others.
        known: String,
    },
    /// Too many pictures.
    #[error(
        "{techniques} techniques of {width}x{height} pixels need {} MiB, more than the {} MiB allowed: take fewer pixels or \
         a lower depth",
        needed.map_or("too many".into(), |bytes| (bytes >> 20).to_string()), .limit >> 20
    )]
    Memory {
        /// How many techniques there are.
        techniques: usize,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes needed; `None`: more than can be counted.
        needed: Option<usize>,
        /// Bytes allowed.
        limit: usize,
    },
}

/// What a technique adds to the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniquePicture {
    /// The technique.
    pub technique: Technique,
    /// Its part of the picture, as pixels of a [`super::Picture`]: those of all techniques add up to the picture.
    pub weighted: Vec<[f32; 3]>,
    /// What it would show if it were the only one: of all light that it can find the same as others that can find it, with
    /// noise of its own.
    pub alone: Vec<[f32; 3]>,
}

/// The record of a rendering.
pub(super) struct Pyramid {
    catalogue: Catalogue,
    layers: Layers,
    passes: u32,
}

impl Pyramid {
    /// What the records of consecutive tiles are made with, the first of which begins with pixel `first`.
    pub(super) fn tiles(
        &mut self,
        first: usize,
        tiles: &[(Tile, &mut [PixelSum])],
    ) -> Vec<Option<(&Catalogue, &mut [LayerSum])>> {
        let count = self.catalogue.techniques().len();
        let pixels: usize = tiles.iter().map(|(tile, _)| tile.pixels()).sum();
        let mut rest = self.layers.pixels_mut(first..first + pixels);
        let slices = tiles.iter().map(|(tile, _)| rest.split_off_mut(..tile.pixels() * count));
        slices.map(|sums| sums.map(|sums| (&self.catalogue, sums))).collect()
    }

    pub(super) fn add(&mut self, splats: &[LayerSplat]) {
        self.layers.add(splats);
    }

    pub(super) fn end_passes(&mut self, count: u32) {
        self.passes += count;
    }
}

impl Rendering<'_> {
    /// From the next pass on keeps what each technique adds to the picture: those for paths of at most `max_depth`, and all
    /// longer ones together. That takes 48 bytes a pixel for each, in all at most `memory` bytes. A checkpoint has none
    /// of it.
    pub fn keep_techniques(&mut self, max_depth: u32, memory: usize) -> Result<(), PyramidError> {
        let Some(apart) = self.integrator.by_technique() else {
            let known = integrators::by_technique().collect::<Vec<_>>().join(", ");
            return Err(PyramidError::OneTechnique { name: self.desc.name.clone(), known });
        };
        let catalogue = apart.catalogue(self.scene, max_depth);
        let (width, height) = self.scene.picture_size();
        let (techniques, pixels) = (catalogue.techniques().len(), self.pixels.sums().len());
        let needed = Layers::bytes(techniques, pixels);
        if needed.is_none_or(|needed| needed > memory) {
            return Err(PyramidError::Memory { techniques, width, height, needed, limit: memory });
        }
        self.pyramid = Some(Pyramid { catalogue, layers: Layers::new(techniques, pixels), passes: 0 });
        Ok(())
    }

    /// What each technique added since [`Rendering::keep_techniques`], the shortest paths first. Contributions that are not
    /// finite are left out.
    pub fn pyramid(&self) -> impl Iterator<Item = TechniquePicture> {
        let techniques = |pyramid: &Pyramid| pyramid.catalogue.techniques().len();
        let count = self.pyramid.as_ref().map_or(0, techniques);
        (0..count).filter_map(|number| {
            let Pyramid { catalogue, layers, passes } = self.pyramid.as_ref()?;
            let n = f64::from((*passes).max(1));
            let mean = |part: fn(&LayerSum) -> [f64; 3]| {
                self.pixels.map_index(|pixel| part(layers.sum(number, pixel)).map(|sum| (sum / n) as f32))
            };
            let technique = catalogue.techniques()[number];
            Some(TechniquePicture { technique, weighted: mean(|sum| sum.weighted), alone: mean(|sum| sum.alone) })
        })
    }
}
