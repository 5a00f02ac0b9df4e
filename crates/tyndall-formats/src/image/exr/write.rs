//! Writing OpenEXR: one part, scan lines in blocks of 16, deflated.
//!
//! Written out here because the same picture must give the same bytes, attributes in order of their names; the crate
//! `exr` keeps them in an order that changes from run to run.

use crate::image::picture::{Picture, full_name};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;
use std::io::Write;

/// Rows that are deflated together.
const BLOCK_ROWS: usize = 16;
/// Names of up to this many bytes are understood by every reader.
const SHORT_NAME: usize = 31;
/// Attributes with a meaning and a type of their own.
const RESERVED: [&str; 13] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "name",
    "version",
    "chunkCount",
];

/// The bytes of a file, or why there is none.
pub(crate) fn encode(picture: &Picture, half: bool) -> Result<Vec<u8>, String> {
    let mut channels: Vec<(String, &[f32])> = picture
        .layers
        .iter()
        .flat_map(|layer| layer.channels.iter().map(|c| (full_name(&layer.name, &c.name), c.values.as_slice())))
        .collect();
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    let mut attributes: Vec<(&str, &str)> = picture.attributes.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    attributes.sort_unstable();
    let names: Vec<&str> = channels.iter().map(|c| c.0.as_str()).collect();
    check_names(&names)?;
    check_names(&attributes.iter().map(|a| a.0).collect::<Vec<_>>())?;
    if let Some((name, _)) = attributes.iter().find(|(name, _)| RESERVED.contains(name)) {
        return Err(format!("has the attribute {name}, which OpenEXR itself uses"));
    }

    let mut out = header(picture, &names, &attributes, half)?;
    let blocks = picture.height.div_ceil(BLOCK_ROWS);
    let table = out.len();
    out.resize(table + 8 * blocks, 0);
    for block in 0..blocks {
        let offset = out.len() as u64;
        out[table + 8 * block..][..8].copy_from_slice(&offset.to_le_bytes());
        let rows = block * BLOCK_ROWS..picture.height.min((block + 1) * BLOCK_ROWS);
        out.extend_from_slice(&(rows.start as i32).to_le_bytes());
        let raw = samples(&channels, picture.width, rows, half);
        let deflated = deflate(&raw);
        // A block that does not shrink is kept as it is; readers see it by its size.
        let data = if deflated.len() < raw.len() { deflated } else { raw };
        out.extend_from_slice(&(data.len() as i32).to_le_bytes());
        out.extend_from_slice(&data);
    }
    Ok(out)
}

/// Names, in order, must differ and must fit the format.
fn check_names(names: &[&str]) -> Result<(), String> {
    if let Some(name) = names.iter().find(|n| n.is_empty() || n.len() > 255 || n.contains('\0')) {
        return Err(format!("has a name of {} bytes, expected 1 to 255 and none of them 0", name.len()));
    }
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("has {} twice", pair[0])),
        None => Ok(()),
    }
}

fn header(picture: &Picture, channels: &[&str], attributes: &[(&str, &str)], half: bool) -> Result<Vec<u8>, String> {
    let size = |n: usize| i32::try_from(n).ok().filter(|&n| n > 0).ok_or(format!("is {n} pixels wide or high"));
    let (width, height) = (size(picture.width)?, size(picture.height)?);
    let long_names = channels.iter().chain(attributes.iter().map(|(n, _)| n)).any(|n| n.len() > SHORT_NAME);
    let mut out = vec![0x76, 0x2f, 0x31, 0x01];
    out.extend_from_slice(&(2u32 | if long_names { 0x400 } else { 0 }).to_le_bytes());

    let mut list = Vec::new();
    for name in channels {
        list.extend_from_slice(name.as_bytes());
        list.push(0);
        // Half is type 1, float 2; linear; sampled at every pixel.
        for number in [if half { 1i32 } else { 2 }, 0, 1, 1] {
            list.extend_from_slice(&number.to_le_bytes());
        }
    }
    list.push(0);
    let window: Vec<u8> = [0, 0, width - 1, height - 1].iter().flat_map(|n| n.to_le_bytes()).collect();
    let one = 1f32.to_le_bytes();
    let mut attribute = |name: &str, kind: &str, data: &[u8]| -> Result<(), String> {
        let length = i32::try_from(data.len()).map_err(|_| format!("has too long an attribute {name}"))?;
        for text in [name, kind] {
            out.extend_from_slice(text.as_bytes());
            out.push(0);
        }
        out.extend_from_slice(&length.to_le_bytes());
        out.extend_from_slice(data);
        Ok(())
    };
    attribute("channels", "chlist", &list)?;
    attribute("compression", "compression", &[3])?;
    attribute("dataWindow", "box2i", &window)?;
    attribute("displayWindow", "box2i", &window)?;
    attribute("lineOrder", "lineOrder", &[0])?;
    attribute("pixelAspectRatio", "float", &one)?;
    attribute("screenWindowCenter", "v2f", &[0; 8])?;
    attribute("screenWindowWidth", "float", &one)?;
    for (name, text) in attributes {
        attribute(name, "string", text.as_bytes())?;
    }
    out.push(0);
    Ok(out)
}

/// The samples of some rows: row by row, channel by channel.
fn samples(channels: &[(String, &[f32])], width: usize, rows: std::ops::Range<usize>, half: bool) -> Vec<u8> {
    let mut raw = Vec::with_capacity(rows.len() * width * channels.len() * if half { 2 } else { 4 });
    for row in rows {
        for (_, values) in channels {
            for &value in &values[row * width..][..width] {
                if half {
                    raw.extend_from_slice(&f16::from_f32(value).to_le_bytes());
                } else {
                    raw.extend_from_slice(&value.to_le_bytes());
                }
            }
        }
    }
    raw
}

/// Even bytes before odd ones, differences of neighbours, zlib.
fn deflate(raw: &[u8]) -> Vec<u8> {
    let sorted = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2));
    let mut last = None;
    let differences: Vec<u8> = sorted
        .map(|&byte| match last.replace(byte) {
            Some(before) => byte.wrapping_sub(before).wrapping_add(128),
            None => byte,
        })
        .collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(4));
    encoder.write_all(&differences).and_then(|()| encoder.finish()).expect("memory can be written to")
}
