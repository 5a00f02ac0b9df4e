//! Texture readers against files made by other libraries.

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use tyndall_formats::image as picture;

#[test]
fn png_of_8_and_16_bits_is_decoded_from_srgb() {
    let mut eight = Vec::new();
    PngEncoder::new(&mut eight).write_image(&[0, 255, 188, 10, 99, 128], 2, 1, ExtendedColorType::Rgb8).unwrap();
    let image = picture::parse(&eight, "a.png", false).unwrap();
    assert_eq!((image.width, image.height), (2, 1));
    let expected = [[0.0, 1.0, 0.502_886_5], [0.003_035_27, 0.124_771_82, 0.215_860_5]];
    for (found, expected) in image.pixels.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
    let raw = picture::parse(&eight, "a.png", true).unwrap();
    assert_eq!(raw.pixels[1], [10.0 / 255.0, 99.0 / 255.0, 128.0 / 255.0]);

    let mut sixteen = Vec::new();
    let samples: Vec<u8> = [188u16 * 257, 65535].iter().flat_map(|x| x.to_ne_bytes()).collect();
    PngEncoder::new(&mut sixteen).write_image(&samples, 1, 2, ExtendedColorType::L16).unwrap();
    let image = picture::parse(&sixteen, "a.png", false).unwrap();
    assert!(image.pixels[0].iter().all(|x| (x - 0.502_886_5).abs() < 1e-6));
    assert_eq!(image.pixels[1], [1.0; 3]);
}

/// Every compression, scan lines and tiles, all three kinds of samples.
#[test]
fn exr_of_every_kind_is_read() {
    use exr::prelude::*;
    let size = Vec2(37, 21);
    let value = |x: usize, y: usize| (x * 8 + y) as f32 / 64.0;
    let floats: Vec<f32> = (0..21).flat_map(|y| (0..37).map(move |x| value(x, y))).collect();
    let lossless =
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16, Compression::PIZ];
    for compression in lossless.into_iter().chain([Compression::PXR24]) {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8))] {
            let channels = AnyChannels::sort(SmallVec::from_vec(vec![
                AnyChannel::new("R", FlatSamples::F32(floats.clone())),
                AnyChannel::new("G", FlatSamples::F16(floats.iter().map(|&x| f16::from_f32(x)).collect())),
                AnyChannel::new("B", FlatSamples::U32(floats.iter().map(|&x| (64.0 * x) as u32).collect())),
            ]));
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
            let mut bytes = std::io::Cursor::new(Vec::new());
            Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
            let image = picture::parse(bytes.get_ref(), "a.exr", false).unwrap();
            assert_eq!((image.width, image.height), (37, 21));
            for (pixel, expected) in image.pixels.iter().zip(&floats) {
                assert_eq!(*pixel, [*expected, *expected, 64.0 * expected], "{compression:?} {blocks:?}");
            }
        }
    }
}

#[test]
fn pfm_rows_come_from_the_bottom() {
    let mut bytes = b"PF\n1 2\n-1.0\n".to_vec();
    bytes.extend([1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|x| x.to_le_bytes()));
    let image = picture::parse(&bytes, "a.pfm", false).unwrap();
    assert_eq!(image.pixels, [[4.0, 5.0, 6.0], [1.0, 2.0, 3.0]]);
    let mut bytes = b"Pf\n2 1\n1.0\n".to_vec();
    bytes.extend([0.5f32, 0.25].iter().flat_map(|x| x.to_be_bytes()));
    let image = picture::parse(&bytes, "a.pfm", false).unwrap();
    assert_eq!(image.pixels, [[0.5; 3], [0.25; 3]]);
}

#[test]
fn a_picture_that_is_not_finite_is_refused() {
    let mut bytes = b"Pf\n2 1\n-1.0\n".to_vec();
    bytes.extend([0.5f32, f32::NAN].iter().flat_map(|x| x.to_le_bytes()));
    let error = picture::parse(&bytes, "a.pfm", false).unwrap_err().to_string();
    assert_eq!(error, "a.pfm: found NaN NaN NaN in column 1, row 0, expected finite numbers");
}
