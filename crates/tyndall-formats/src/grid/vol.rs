//! Mitsuba's `.vol`: "VOL", version 3, type 1 (32-bit floats).

use crate::file::{Bytes, FileError, open};
use std::io::Read;
use std::path::Path;
use tyndall::scene::desc::GridDesc;

/// Bytes before the samples.
const HEADER: usize = 48;

/// Reads a file, its samples straight into the grid.
pub fn read(path: &Path) -> Result<GridDesc, FileError> {
    let (file, length) = open(path)?;
    decode(std::io::BufReader::new(file), length, &path.to_string_lossy())
}

/// Reads a binary; `name` stands for the path in messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<GridDesc, FileError> {
    decode(bytes, bytes.len() as u64, name)
}

fn decode(mut reader: impl Read, length: u64, name: &str) -> Result<GridDesc, FileError> {
    let fail = |e: std::io::Error| FileError::whole(name, format!("cannot be read: {e}"));
    let mut header = Vec::with_capacity(HEADER);
    reader.by_ref().take(HEADER as u64).read_to_end(&mut header).map_err(fail)?;
    let mut grid = parse_header(&mut Bytes::new(&header, name))?;
    let samples = grid.size.iter().fold(grid.channels as u128, |product, &n| product * n as u128);
    let (found, expected) = (u128::from(length.saturating_sub(HEADER as u64)), 4 * samples);
    if found < expected {
        let [x, y, z] = grid.size;
        let message = format!(
            "found {found} bytes of samples, expected {expected} for {x} x {y} x {z} samples of {} channels",
            grid.channels
        );
        return Err(FileError::byte(name, HEADER, message));
    }
    grid.values = vec![0.0; samples as usize];
    reader.read_exact(bytemuck::cast_slice_mut(&mut grid.values)).map_err(fail)?;
    for (i, value) in grid.values.iter_mut().enumerate() {
        *value = f32::from_bits(u32::from_le(value.to_bits()));
        if !value.is_finite() {
            return Err(FileError::byte(name, HEADER + 4 * i, format!("found {value}, expected a finite number")));
        }
    }
    Ok(grid)
}

/// Everything but the samples.
fn parse_header(bytes: &mut Bytes) -> Result<GridDesc, FileError> {
    let magic = bytes.array::<3>("the letters VOL")?;
    if &magic != b"VOL" {
        return Err(FileError::byte(
            bytes.name,
            0,
            format!("found \"{}\", expected the letters VOL", magic.escape_ascii()),
        ));
    }
    let [version] = bytes.array("the version")?;
    if version != 3 {
        return Err(FileError::byte(bytes.name, 3, format!("found version {version}, expected 3")));
    }
    let kind = i32::from_le_bytes(bytes.array("the type of the samples")?);
    if kind != 1 {
        let meaning = match kind {
            2 => " (16-bit floats)",
            3 => " (8-bit integers)",
            4 => " (quantised directions)",
            _ => "",
        };
        return Err(FileError::byte(
            bytes.name,
            4,
            format!("found samples of type {kind}{meaning}, expected 1 (32-bit floats)"),
        ));
    }
    let mut counts = [0; 4];
    for (count, what) in counts.iter_mut().zip(["samples along x", "samples along y", "samples along z", "channels"]) {
        let at = bytes.at;
        let n = i32::from_le_bytes(bytes.array(what)?);
        *count = usize::try_from(n).unwrap_or(0);
        if *count == 0 {
            return Err(FileError::byte(bytes.name, at, format!("found {n} {what}, expected at least 1")));
        }
    }
    let [x, y, z, channels] = counts;
    if ![1, 3, 6].contains(&channels) {
        return Err(FileError::byte(bytes.name, 20, format!("found {channels} channels, expected 1, 3 or 6")));
    }
    let mut bounds = [[0.0; 3]; 2];
    for number in bounds.as_flattened_mut() {
        let at = bytes.at;
        *number = f32::from_le_bytes(bytes.array("the bounding box")?);
        if !number.is_finite() {
            return Err(FileError::byte(
                bytes.name,
                at,
                format!("found {number} in the bounding box, expected a finite number"),
            ));
        }
    }
    Ok(GridDesc { size: [x, y, z], channels, values: Vec::new(), bounds })
}
