//! OpenEXR.

mod read;

pub(super) use read::parse;
