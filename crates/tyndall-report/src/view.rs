//! The pictures that are compared.

/// A picture's pixels, linear, row by row, all finite.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    width: usize,
    height: usize,
    pixels: &'a [[f32; 3]],
}

/// Pictures that cannot be compared or merged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// The number of pixels is not the product of the sizes, or is 0.
    #[error("found {found} pixels, expected {width} x {height} and at least one")]
    Pixels {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels given.
        found: usize,
    },
    /// Two pictures differ in size.
    #[error("found pictures of {first:?} and {second:?} pixels, expected one size")]
    Sizes {
        /// Columns and rows of one.
        first: [usize; 2],
        /// Columns and rows of the other.
        second: [usize; 2],
    },
    /// Infinite, or not a number: an average over it says nothing.
    #[error("found {value:?} in column {column}, row {row}, expected finite numbers")]
    NotFinite {
        /// Column from 0.
        column: usize,
        /// Row from 0.
        row: usize,
        /// The pixel.
        value: [f32; 3],
    },
    /// Nothing to merge, or weights that are not positive and finite.
    #[error("found the weights {weights:?}, expected at least one and all positive")]
    Weights {
        /// The weights given.
        weights: Vec<f64>,
    },
}

impl<'a> View<'a> {
    /// A view of `width * height` pixels.
    pub fn new(width: usize, height: usize, pixels: &'a [[f32; 3]]) -> Result<Self, MetricError> {
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return Err(MetricError::Pixels { width, height, found: pixels.len() });
        }
        match pixels.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            Some(i) => Err(MetricError::NotFinite { column: i % width, row: i / width, value: pixels[i] }),
            None => Ok(Self { width, height, pixels }),
        }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> &'a [[f32; 3]] {
        self.pixels
    }

    /// Both must have one size.
    pub(crate) fn check_same_size(&self, other: &Self) -> Result<(), MetricError> {
        let (first, second) = ([self.width, self.height], [other.width, other.height]);
        if first == second { Ok(()) } else { Err(MetricError::Sizes { first, second }) }
    }
}
