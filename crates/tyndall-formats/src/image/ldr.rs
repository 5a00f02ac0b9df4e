//! PNG, JPEG and HDR through the crate `image`.

use super::tone::ToneMap;
use super::{check_backed, srgb};
use crate::file::{FileError, decode};
use image::codecs::{hdr::HdrEncoder, png::PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader, ImageResult};
use std::io::Cursor;
use tyndall::scene::desc::{ImageDesc, Rgb};

pub(super) fn parse(bytes: &[u8], name: &str, format: ImageFormat, raw: bool) -> Result<ImageDesc, FileError> {
    let open = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        // Checked here against the length of the file instead.
        reader.no_limits();
        reader.into_decoder()
    };
    let (width, height, pixel) = decode(name, || {
        let decoder = open()?;
        let (width, height) = decoder.dimensions();
        ImageResult::Ok((width as usize, height as usize, decoder.color_type().bytes_per_pixel() as usize))
    })?;
    check_backed(name, width, height, pixel, bytes.len())?;
    let decoded = decode(name, || DynamicImage::from_decoder(open()?))?;
    let curve = |encoded: f32| if raw { encoded } else { srgb::decode(encoded) };
    let pixels = match decoded {
        DynamicImage::ImageRgb32F(image) => image.pixels().map(|p| p.0).collect(),
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            decoded.into_rgb16().pixels().map(|p| p.0.map(|x| curve(f32::from(x) / 65535.0))).collect()
        }
        _ => {
            let table: Vec<f32> = (0..=255u8).map(|x| curve(f32::from(x) / 255.0)).collect();
            decoded.into_rgb8().pixels().map(|p| p.0.map(|x| table[usize::from(x)])).collect()
        }
    };
    Ok(ImageDesc { width, height, pixels })
}

/// The bytes of a PNG of 8 bits.
pub(super) fn encode_png(width: usize, pixels: &[Rgb], exposure: f32, tone_map: ToneMap) -> ImageResult<Vec<u8>> {
    let factor = exposure.exp2();
    let bytes: Vec<u8> = pixels.as_flattened().iter().map(|x| tone_map.byte(x * factor)).collect();
    let mut out = Vec::new();
    let height = pixels.len() / width;
    PngEncoder::new(&mut out).write_image(&bytes, width as u32, height as u32, ExtendedColorType::Rgb8)?;
    Ok(out)
}

/// The bytes of a Radiance HDR file. It has no negative values and none that are not finite: those become 0.
pub(super) fn encode_hdr(width: usize, pixels: &[Rgb]) -> ImageResult<Vec<u8>> {
    let clean = |x: f32| if x.is_finite() { x.max(0.0) } else { 0.0 };
    let clean: Vec<image::Rgb<f32>> = pixels.iter().map(|p| image::Rgb(p.map(clean))).collect();
    let mut out = Vec::new();
    HdrEncoder::new(&mut out).encode(&clean, width, pixels.len() / width)?;
    Ok(out)
}
