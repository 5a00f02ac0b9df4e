//! Pictures inside the page: half floats or bytes, differences of neighbours by plane, deflated, in base 64.
//!
//! A browser undoes it with `DecompressionStream` and a running sum. Like EXR's ZIP: bytes of one significance lie together and
//! hardly change from pixel to pixel.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;
use std::io::Write;

/// A picture as the page keeps it.
#[derive(Clone, Debug, PartialEq)]
pub struct Embedded {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `half` for RGB, `byte` for one channel in [0, 1].
    pub kind: &'static str,
    /// The values.
    pub base64: String,
}

/// The pictures of a page by their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    all: Vec<Embedded>,
}

impl Pictures {
    /// Adds linear colours; values beyond half floats become the largest. Returns the number.
    pub fn add_colours(&mut self, width: usize, pixels: &[[f32; 3]]) -> usize {
        let bits = |c: usize| {
            pixels.iter().map(move |p| f16::from_f32(p[c].clamp(f16::MIN.to_f32(), f16::MAX.to_f32())).to_bits())
        };
        let planes = [0, 1, 2].map(|c| bits(c).collect::<Vec<u16>>());
        let high = planes.iter().map(|plane| plane.iter().map(|b| (b >> 8) as u8).collect());
        let low = planes.iter().map(|plane| plane.iter().map(|b| *b as u8).collect());
        self.add(width, "half", high.chain(low).collect())
    }

    /// Adds a map of values in [0, 1]. Returns the number.
    pub fn add_map(&mut self, width: usize, values: &[f64]) -> usize {
        let bytes = values.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
        self.add(width, "byte", vec![bytes])
    }

    fn add(&mut self, width: usize, kind: &'static str, planes: Vec<Vec<u8>>) -> usize {
        let height = planes[0].len() / width;
        let differences = planes.iter().flat_map(|plane| {
            plane.iter().scan(0u8, |last, &byte| Some(byte.wrapping_sub(std::mem::replace(last, byte))))
        });
        let bytes: Vec<u8> = differences.collect();
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        let written = encoder.write_all(&bytes).and_then(|()| encoder.finish());
        let deflated = written.expect("memory takes everything");
        self.all.push(Embedded { width, height, kind, base64: STANDARD.encode(deflated) });
        self.all.len() - 1
    }

    /// All of them in order.
    pub fn all(&self) -> &[Embedded] {
        &self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// What the page does.
    fn planes(picture: &Embedded) -> Vec<u8> {
        let mut bytes = Vec::new();
        let deflated = STANDARD.decode(&picture.base64).unwrap();
        ZlibDecoder::new(&deflated[..]).read_to_end(&mut bytes).unwrap();
        for plane in bytes.chunks_mut(picture.width * picture.height) {
            plane.iter_mut().fold(0u8, |last, byte| {
                *byte = byte.wrapping_add(last);
                *byte
            });
        }
        bytes
    }

    #[test]
    fn colours_come_back() {
        let pixels = [[0.0, 1.0, -2.5], [1e9, 0.1, f32::NEG_INFINITY], [65504.0, 6e-8, 3.0], [0.5, 0.25, 8.0]];
        let mut pictures = Pictures::default();
        assert_eq!(pictures.add_colours(2, &pixels), 0);
        let picture = &pictures.all()[0];
        assert_eq!((picture.width, picture.height, picture.kind), (2, 2, "half"));
        let bytes = planes(picture);
        let value = |i: usize, c: usize| {
            f16::from_bits(u16::from(bytes[4 * c + i]) << 8 | u16::from(bytes[12 + 4 * c + i])).to_f32()
        };
        for (i, pixel) in pixels.iter().enumerate() {
            for (c, &expected) in pixel.iter().enumerate() {
                assert_eq!(value(i, c), f16::from_f32(expected.clamp(-65504.0, 65504.0)).to_f32());
            }
        }
    }

    #[test]
    fn maps_come_back() {
        let mut pictures = Pictures::default();
        pictures.add_map(3, &[0.0, 0.5, 1.0, 2.0, -1.0, 0.2]);
        assert_eq!(planes(&pictures.all()[0]), [0, 128, 255, 255, 0, 51]);
    }
}
