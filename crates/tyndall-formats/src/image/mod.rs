//! Pictures: reading textures, reading and writing renders.

mod exr;
mod ldr;
mod pfm;
mod picture;
mod srgb;
mod tone;

use crate::file::{FileError, open, read_bytes, write_atomically};
pub use picture::{Channel, Layer, Picture};
use std::path::Path;
pub use tone::ToneMap;
use tyndall::scene::desc::ImageDesc;

/// Reads a picture as linear values, whatever its ending: PNG and JPEG (decoded from sRGB unless `raw`), EXR, HDR, PFM.
pub fn read(path: &Path, raw: bool) -> Result<ImageDesc, FileError> {
    parse(&read_bytes(path)?, &path.to_string_lossy(), raw)
}

/// Reads a binary; `name` stands for the path in messages.
pub fn parse(bytes: &[u8], name: &str, raw: bool) -> Result<ImageDesc, FileError> {
    let image = match Format::of(bytes, name)? {
        Format::Exr => exr::parse(bytes, name)?.rgb(name)?,
        Format::Pfm => pfm::parse(bytes, name)?.rgb(name)?,
        Format::Library(format) => ldr::parse(bytes, name, format, raw)?,
    };
    if let Some(i) = image.pixels.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        let (x, y, [r, g, b]) = (i % image.width, i / image.width, image.pixels[i]);
        return Err(FileError::whole(
            name,
            format!("found {r} {g} {b} in column {x}, row {y}, expected finite numbers"),
        ));
    }
    Ok(image)
}

/// Reads a picture with all its layers and texts; one of 8 or 16 bits is decoded from sRGB.
pub fn read_picture(path: &Path) -> Result<Picture, FileError> {
    parse_picture(&read_bytes(path)?, &path.to_string_lossy())
}

/// Reads a binary with all its layers and texts; `name` stands for the path in messages.
pub fn parse_picture(bytes: &[u8], name: &str) -> Result<Picture, FileError> {
    match Format::of(bytes, name)? {
        Format::Exr => exr::parse(bytes, name),
        Format::Pfm => pfm::parse(bytes, name),
        Format::Library(format) => {
            let image = ldr::parse(bytes, name, format, false)?;
            Ok(Picture::from_rgb(image.width, image.height, &image.pixels))
        }
    }
}

/// What an EXR file says about itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Names and texts, in order of their names.
    pub attributes: Vec<(String, String)>,
}

/// Reads size and texts of an EXR file, not its pixels.
pub fn metadata(path: &Path) -> Result<Metadata, FileError> {
    exr::parse_metadata(std::io::BufReader::new(open(path)?.0), &path.to_string_lossy())
}

/// How a picture is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// 16-bit floats (EXR).
    pub half: bool,
    /// Stops brighter (PNG).
    pub exposure: f32,
    /// The curve before sRGB (PNG).
    pub tone_map: ToneMap,
}

/// Writes a picture in the format of the path's ending: EXR keeps everything, PNG, HDR and PFM the main layer's colours.
///
/// The same picture gives the same bytes. The file appears at once, when all of it is on the disk.
pub fn write(path: &Path, picture: &Picture, options: &WriteOptions) -> Result<(), FileError> {
    let fail = |message: String| FileError::whole(path, format!("cannot be written: the picture {message}"));
    let samples = picture.width * picture.height;
    if samples == 0 || picture.layers.iter().flat_map(|l| &l.channels).any(|c| c.values.len() != samples) {
        return Err(fail("has channels of another size, or no pixels".into()));
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let colours = || {
        let main = picture.layer("").and_then(Layer::to_rgb);
        main.ok_or_else(|| fail("has no main layer of the channels R, G, B or Y".into()))
    };
    let bytes = match ending.as_str() {
        "exr" => exr::encode(picture, options.half).map_err(fail)?,
        "pfm" => pfm::encode(picture.width, &colours()?),
        "hdr" => ldr::encode_hdr(picture.width, &colours()?).map_err(|e| fail(format!("does not fit: {e}")))?,
        "png" => ldr::encode_png(picture.width, &colours()?, options.exposure, options.tone_map)
            .map_err(|e| fail(format!("does not fit: {e}")))?,
        _ => return Err(FileError::whole(path, format!("found the ending '{ending}', expected exr, png, hdr or pfm"))),
    };
    write_atomically(path, &bytes)
}

/// Formats by their first bytes.
enum Format {
    Exr,
    Pfm,
    Library(image::ImageFormat),
}

impl Format {
    fn of(bytes: &[u8], name: &str) -> Result<Self, FileError> {
        Ok(match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => Self::Exr,
            [b'P', b'F' | b'f', b, ..] if b.is_ascii_whitespace() => Self::Pfm,
            [0x89, b'P', b'N', b'G', ..] => Self::Library(image::ImageFormat::Png),
            [0xff, 0xd8, 0xff, ..] => Self::Library(image::ImageFormat::Jpeg),
            [b'#', b'?', ..] => Self::Library(image::ImageFormat::Hdr),
            _ => {
                let found = bytes[..bytes.len().min(4)].escape_ascii();
                let message = format!("found \"{found}\", expected the start of a PNG, JPEG, EXR, HDR or PFM picture");
                return Err(FileError::byte(name, 0, message));
            }
        })
    }
}

/// Refuses pictures far larger than any compression of `length` bytes makes, before memory is taken for them.
fn check_backed(name: &str, width: usize, height: usize, pixel: usize, length: usize) -> Result<(), FileError> {
    /// Enough for any small picture; never touched where the decoder fails early.
    const ALWAYS: u128 = 64 << 20;
    /// Deflate makes 1032 bytes of one at most; blocks of a single colour in a DWA picture come near this.
    const RATIO: u128 = 16384;
    let needed = width as u128 * height as u128 * pixel as u128;
    if width == 0 || height == 0 || needed > ALWAYS + RATIO * length as u128 {
        let message = format!("found a picture of {width} x {height} pixels, expected what {length} bytes can hold");
        return Err(FileError::whole(name, message));
    }
    Ok(())
}
