//! Files to write, checked before there is anything to lose.

use crate::args::Encoding;
use crate::failure::Failure;
use std::path::{Path, PathBuf};
use tyndall_formats::image::{self, Picture, ToneMap, WriteOptions};

/// Endings of the pictures that can be written.
const ENDINGS: [&str; 4] = ["exr", "png", "hdr", "pfm"];

/// Tone curves by their names.
const TONE_MAPS: [(&str, ToneMap); 3] =
    [("clamp", ToneMap::Clamp), ("reinhard", ToneMap::Reinhard), ("filmic", ToneMap::Filmic)];

/// A picture to be written.
#[derive(Debug)]
pub(crate) struct Target {
    path: PathBuf,
    ending: &'static str,
    options: WriteOptions,
}

impl Target {
    /// Checks that `path` has a known ending and can be written, and that every choice in `encoding` means something
    /// for it, or for the .png that is to lie beside it.
    pub(crate) fn new(path: &Path, encoding: &Encoding, preview: bool) -> Result<Self, Failure> {
        let ending = ending(path)?;
        if encoding.half && ending != "exr" {
            return Err(Failure::usage(format_args!("--half is for .exr, not for .{ending}")));
        }
        let png = ending == "png" || preview;
        let tone_map = match &encoding.tonemap {
            None => ToneMap::default(),
            Some(name) => tone_map(name)?,
        };
        if !png && (encoding.tonemap.is_some() || encoding.exposure != 0.0) {
            return Err(Failure::usage("--exposure and --tonemap are for .png, and none is written"));
        }
        check_writable(path)?;
        let options = WriteOptions { half: encoding.half, exposure: encoding.exposure, tone_map };
        Ok(Self { path: path.to_owned(), ending, options })
    }

    /// A target without choices.
    pub(crate) fn plain(path: &Path) -> Result<Self, Failure> {
        Self::new(path, &Encoding { exposure: 0.0, tonemap: None, half: false }, false)
    }

    /// The .png beside it.
    pub(crate) fn preview(&self) -> Result<Self, Failure> {
        let path = self.path.with_extension("png");
        check_writable(&path)?;
        Ok(Self { path, ending: "png", options: self.options })
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it keeps layers and metadata.
    pub(crate) fn keeps_layers(&self) -> bool {
        self.ending == "exr"
    }

    /// Writes it: the whole file at once, or nothing.
    pub(crate) fn write(&self, picture: &Picture) -> Result<(), Failure> {
        image::write(&self.path, picture, &self.options).map_err(Failure::other)
    }
}

/// The ending in small letters, if it is known.
fn ending(path: &Path) -> Result<&'static str, Failure> {
    let found = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ENDINGS.into_iter().find(|ending| *ending == found) {
        Some(ending) => Ok(ending),
        None if found.is_empty() => {
            let known = ENDINGS.join(", .");
            Err(Failure::usage(format_args!(
                "{} has no ending to choose a format by (there is .{known})",
                path.display()
            )))
        }
        None => Err(Failure::unknown("picture format", &found, ENDINGS)),
    }
}

fn tone_map(name: &str) -> Result<ToneMap, Failure> {
    let found = TONE_MAPS.iter().find(|(known, _)| *known == name.to_lowercase());
    found.map(|(_, map)| *map).ok_or_else(|| Failure::unknown("tone map", name, TONE_MAPS.map(|(known, _)| known)))
}

/// Fails where `path` could not be written later.
fn check_writable(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::other(format_args!("{} is a folder", path.display())));
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(Failure::other(format_args!("there is no folder {} to write to", folder.display())));
    }
    // A file without a name: gone when it is closed.
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::other(format_args!("cannot write to the folder {}: {error}", folder.display()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoding() -> Encoding {
        Encoding { exposure: 0.0, tonemap: None, half: false }
    }

    fn message(result: Result<Target, Failure>) -> String {
        match result {
            Err(Failure::Usage(message) | Failure::Other(message)) => message,
            _ => String::new(),
        }
    }

    #[test]
    fn paths_are_checked() {
        let folder = tempfile::tempdir().unwrap();
        let target = |name: &str| Target::plain(&folder.path().join(name));
        assert!(target("a.EXR").unwrap().keeps_layers());
        assert!(!target("a.png").unwrap().keeps_layers());
        assert!(message(target("a.jpg")).contains("no picture format `jpg`"));
        assert!(message(target("a.pmf")).contains("did you mean `pfm`?"));
        assert!(message(target("a")).contains("no ending"));
        assert!(message(target("missing/a.exr")).contains("no folder"));
        std::fs::create_dir(folder.path().join("b.exr")).unwrap();
        assert!(message(target("b.exr")).contains("is a folder"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn choices_have_to_mean_something() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let half = Encoding { half: true, ..encoding() };
        assert!(message(Target::new(&path("a.png"), &half, false)).contains("--half"));
        let bright = Encoding { exposure: 1.0, ..encoding() };
        assert!(message(Target::new(&path("a.exr"), &bright, false)).contains("--exposure"));
        assert!(Target::new(&path("a.exr"), &bright, true).is_ok());
        let curve = |name: &str| Encoding { tonemap: Some(name.into()), ..encoding() };
        assert!(Target::new(&path("a.png"), &curve("Filmic"), false).is_ok());
        assert!(message(Target::new(&path("a.png"), &curve("filmc"), false)).contains("did you mean `filmic`?"));
    }
}
