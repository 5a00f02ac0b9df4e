//! Pictures of a comparison, checked when they are read.

use crate::failure::Failure;
use std::path::Path;
use tyndall_formats::image::{Layer, Picture, read_picture};
use tyndall_report::View;
use tyndall_report::metrics::Metric;

/// A picture, all finite.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loaded {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[f32; 3]>,
    /// Variance of every pixel's mean, where the render kept it.
    pub(crate) variance: Option<Vec<[f32; 3]>>,
}

impl Loaded {
    /// Reads a picture that must have this size; else says what is wrong with it.
    pub(crate) fn read(path: &Path, size: [u32; 2]) -> Result<Self, String> {
        let loaded = Self::any(path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let [width, height] = size.map(|n| n as usize);
        if (loaded.width, loaded.height) != (width, height) {
            let (w, h) = (loaded.width, loaded.height);
            return Err(format!("the picture {name} has {w}x{h} pixels, expected {width}x{height}"));
        }
        Ok(loaded)
    }

    /// Reads a picture of any size.
    pub(crate) fn any(path: &Path) -> Result<Self, String> {
        let picture = read_picture(path).map_err(|error| error.to_string())?;
        let Picture { width, height, .. } = picture;
        // Other renderers name their layers as they like: the first with colours will do.
        let main = picture.layer("").and_then(Layer::to_rgb);
        let pixels = main.or_else(|| picture.layers.iter().find_map(Layer::to_rgb));
        let name = path.display();
        let pixels = pixels.ok_or_else(|| format!("{name} has no layer of the channels R, G, B or Y"))?;
        View::new(width, height, &pixels).map_err(|error| format!("{name}: {error}"))?;
        let variance = picture.layer("variance").and_then(Layer::to_rgb);
        let variance = variance.filter(|values| View::new(width, height, values).is_ok());
        Ok(Self { width, height, pixels, variance })
    }

    /// For metrics.
    pub(crate) fn view(&self) -> View<'_> {
        View::new(self.width, self.height, &self.pixels).expect("it was checked when it was read")
    }

    /// The variance for metrics.
    pub(crate) fn variance_view(&self) -> Option<View<'_>> {
        let values = self.variance.as_deref()?;
        View::new(self.width, self.height, values).ok()
    }
}

/// The square root of relMSE.
pub(crate) fn relative_error(picture: &Loaded, reference: &Loaded) -> Result<f64, Failure> {
    Metric::RelMse.mean(picture.view(), reference.view()).map(f64::sqrt).map_err(Failure::other)
}
