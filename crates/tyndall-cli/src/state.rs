//! JSON files that are written as a whole or not at all.

use crate::failure::Failure;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::ErrorKind;
use std::path::Path;
use tyndall_formats::file::write_atomically;

/// Replaces the file by `value`.
pub(crate) fn write(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::other(format_args!("{}: cannot be written: {error}", path.display())))?;
    text.push('\n');
    write_atomically(path, text.as_bytes()).map_err(Failure::other)
}

/// What a file holds; `None` if there is none.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, Failure> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Failure::other(format_args!("{}: cannot be read: {error}", path.display()))),
    };
    let value = serde_json::from_str(&text);
    value
        .map(Some)
        .map_err(|error| Failure::other(format_args!("{}: {error}; remove it to start anew", path.display())))
}
