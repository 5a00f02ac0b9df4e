//! Pictures: reading textures, reading and writing renders.

mod exr;
mod ldr;
mod pfm;
mod picture;
mod srgb;

use crate::file::{FileError, read_bytes};
pub use picture::{Channel, Layer, Picture};
use std::path::Path;
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
