//! Checkpoints: the exact state of a rendering as bytes.
//!
//! Layout, little endian: the magic, then u64 fingerprint, u32 width, u32 height, u64 seed, u32 passes, f64 seconds, u64
//! non-finite samples, six f64 per pixel (sum, sum of squares) tile by tile, and a u64 checksum of all before.

use super::Rendering;
use crate::math::random::hash64;
use std::time::Duration;

const MAGIC: &[u8; 8] = b"TYNDALL1";
const HEADER: usize = 8 + 8 + 4 + 4 + 8 + 4 + 8 + 8;

/// Why a checkpoint cannot be continued.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// Not a checkpoint, or damaged.
    #[error("not a complete checkpoint: {0}")]
    Damaged(&'static str),
    /// Made from something else.
    #[error("the checkpoint belongs to another {0}")]
    Mismatch(&'static str),
}

fn checksum(bytes: &[u8]) -> u64 {
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    words.fold(bytes.len() as u64, |sum, word| hash64(sum ^ word))
}

pub(super) fn write(rendering: &Rendering, fingerprint: u64) -> Vec<u8> {
    let sums = rendering.pixels.sums();
    let mut bytes = Vec::with_capacity(HEADER + sums.len() * 48 + 8);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&fingerprint.to_le_bytes());
    bytes.extend_from_slice(&rendering.pixels.width().to_le_bytes());
    bytes.extend_from_slice(&rendering.pixels.height().to_le_bytes());
    bytes.extend_from_slice(&rendering.seed.to_le_bytes());
    bytes.extend_from_slice(&rendering.passes.to_le_bytes());
    bytes.extend_from_slice(&rendering.busy.as_secs_f64().to_le_bytes());
    bytes.extend_from_slice(&rendering.rare.non_finite.to_le_bytes());
    for value in sums.iter().flat_map(|pixel| pixel.sum.iter().chain(&pixel.sum_of_squares)) {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    let sum = checksum(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    bytes
}

/// Takes little-endian numbers off the front.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, tail) = self.0.split_at(N);
        self.0 = tail;
        head.try_into().expect("split_at gives N bytes")
    }
}

pub(super) fn read(rendering: &mut Rendering, bytes: &[u8], fingerprint: u64) -> Result<(), CheckpointError> {
    if bytes.len() < HEADER + 8 || &bytes[..8] != MAGIC {
        return Err(CheckpointError::Damaged("it does not begin like one"));
    }
    let (body, sum) = bytes.split_at(bytes.len() - 8);
    if sum != checksum(body).to_le_bytes() {
        return Err(CheckpointError::Damaged("its checksum is wrong"));
    }
    let mut reader = Reader(&body[8..]);
    if u64::from_le_bytes(reader.take()) != fingerprint {
        return Err(CheckpointError::Mismatch("scene or other parameters"));
    }
    let size = (u32::from_le_bytes(reader.take()), u32::from_le_bytes(reader.take()));
    if size != (rendering.pixels.width(), rendering.pixels.height()) {
        return Err(CheckpointError::Mismatch("picture size"));
    }
    if u64::from_le_bytes(reader.take()) != rendering.seed {
        return Err(CheckpointError::Mismatch("seed"));
    }
    let passes = u32::from_le_bytes(reader.take());
    let seconds = f64::from_le_bytes(reader.take());
    let busy = Duration::try_from_secs_f64(seconds).map_err(|_| CheckpointError::Damaged("its time is no time"))?;
    let non_finite = u64::from_le_bytes(reader.take());
    if reader.0.len() != rendering.pixels.sums().len() * 48 {
        return Err(CheckpointError::Damaged("its length does not fit its size"));
    }
    for pixel in rendering.pixels.sums_mut() {
        pixel.sum = std::array::from_fn(|_| f64::from_le_bytes(reader.take()));
        pixel.sum_of_squares = std::array::from_fn(|_| f64::from_le_bytes(reader.take()));
    }
    rendering.passes = passes;
    rendering.busy = busy;
    rendering.rare.non_finite = non_finite;
    Ok(())
}
