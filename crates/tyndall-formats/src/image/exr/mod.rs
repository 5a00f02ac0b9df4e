//! OpenEXR.

mod read;
mod write;

pub(super) use read::{parse, parse_metadata};
pub(super) use write::encode;
