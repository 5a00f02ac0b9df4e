//! Portable float maps: "PF" (colour) or "Pf" (grey), rows from the bottom up.

use super::picture::{Channel, Layer, Picture};
use crate::file::{Bytes, FileError, Word, Words};
use tyndall::scene::desc::Rgb;

pub(super) fn parse(bytes: &[u8], name: &str) -> Result<Picture, FileError> {
    let words = &mut Words::new(bytes, name);
    let magic = expect(words, "PF or Pf")?;
    let names: &[&str] = match magic.bytes {
        b"PF" => &["R", "G", "B"],
        b"Pf" => &["Y"],
        _ => return Err(unexpected(words, magic, "PF or Pf")),
    };
    let [width, height] = [size(words, "a width")?, size(words, "a height")?];
    let word = expect(words, "a scale")?;
    // Its sign is the byte order; its size says nothing about the values.
    let scale = words.finite(word)?;
    if scale == 0.0 {
        return Err(unexpected(words, word, "a scale other than 0"));
    }
    let needed = width as u128 * height as u128 * 4 * names.len() as u128;
    let mut data = Bytes { bytes, at: bytes.len().min(words.offset() + 1), name };
    if needed > data.left() as u128 {
        let left = data.left();
        return Err(
            data.error(format!("found {left} bytes of samples, expected {needed} for {width} x {height} pixels"))
        );
    }
    let samples = data.take(needed as usize, "the samples")?;
    let mut channels: Vec<Channel> =
        names.iter().map(|&name| Channel { name: name.into(), values: Vec::with_capacity(width * height) }).collect();
    for row in samples.chunks_exact(4 * width * names.len()).rev() {
        for (i, sample) in row.chunks_exact(4).enumerate() {
            let sample = [sample[0], sample[1], sample[2], sample[3]];
            let value = if scale < 0.0 { f32::from_le_bytes(sample) } else { f32::from_be_bytes(sample) };
            channels[i % names.len()].values.push(value);
        }
    }
    Ok(Picture { width, height, layers: vec![Layer { name: String::new(), channels }], attributes: Vec::new() })
}

/// The bytes of a colour file.
pub(super) fn encode(width: usize, pixels: &[Rgb]) -> Vec<u8> {
    let mut out = format!("PF\n{width} {}\n-1.0\n", pixels.len() / width).into_bytes();
    for row in pixels.chunks_exact(width).rev() {
        out.extend(row.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    }
    out
}

fn size(words: &mut Words, what: &str) -> Result<usize, FileError> {
    let word = expect(words, what)?;
    word.parse::<u32>().filter(|&n| n > 0).map(|n| n as usize).ok_or_else(|| unexpected(words, word, what))
}

fn expect<'a>(words: &mut Words<'a>, what: &str) -> Result<Word<'a>, FileError> {
    words.anywhere().ok_or_else(|| words.error(format!("found the end of the file, expected {what}")))
}

fn unexpected(words: &Words, word: Word, what: &str) -> FileError {
    words.error_at(word, format!("found {}, expected {what}", word.shown()))
}
