//! `cargo xtask layers`: inside the library a room may use only those below it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The rooms of crates/tyndall/src, from the ground up; rooms of one floor do not know each other.
const FLOORS: [&[&str]; 10] = [
    &["spectrum"],
    &["math"],
    &["accel", "film"],
    &["scene"],
    &["walk"],
    &["photons"],
    &["estimators"],
    &["mis", "caches"],
    &["integrators"],
    &["render"],
];

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

/// Checks every file of the library.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let src = root.join("crates/tyndall/src");
    let lib = read(&src.join("lib.rs"))?;
    let names = reexports(&lib);
    let mut files = Vec::new();
    walk(&src, &mut files)?;
    let mut faults = Vec::new();
    for file in files {
        let inner = file.strip_prefix(&src).expect("found below");
        let shown = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        faults.extend(
            faults_of(inner, &read(&file)?, &names).into_iter().map(|(line, what)| format!("{shown}:{line}: {what}")),
        );
    }
    if faults.is_empty() { Ok(()) } else { Err(format!("the library's rooms are mixed up\n{}", faults.join("\n"))) }
}

fn read(file: &Path) -> Result<String, String> {
    std::fs::read_to_string(file).map_err(|e| format!("cannot read {}: {e}", file.display()))
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let fail = |e| format!("cannot read {}: {e}", folder.display());
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(fail)?
        .map(|e| e.map(|e| e.path()))
        .collect::<Result<_, _>>()
        .map_err(fail)?;
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            walk(&entry, files)?;
        } else if entry.extension().is_some_and(|e| e == "rs") {
            files.push(entry);
        }
    }
    Ok(())
}

/// Types that lib.rs re-exports, with the room they live in.
fn reexports(lib: &str) -> HashMap<String, String> {
    let text = without_comments(lib);
    let mut names = HashMap::new();
    for statement in text.split(';').filter_map(|s| s.rsplit_once("pub use ")).map(|(_, s)| s) {
        let mut words = identifiers(statement);
        let Some(room) = words.next() else { continue };
        for name in words.filter(|w| w.starts_with(char::is_uppercase)) {
            names.insert(name.to_string(), room.to_string());
        }
    }
    names
}

fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty())
}

/// The text with comments blanked out, lines kept.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// The upward uses of one file, `inner` its path below src: line and complaint.
fn faults_of(inner: &Path, text: &str, names: &HashMap<String, String>) -> Vec<(usize, String)> {
    let parts: Vec<String> = inner.with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect();
    let room = parts[0].as_str();
    if room == "lib" {
        return Vec::new();
    }
    let Some(here) = floor(room) else {
        return vec![(1, format!("`{room}` has no floor: add it to xtask/src/layers.rs"))];
    };
    // modules between this file and the root of the crate
    let depth = parts.len() - usize::from(parts.last().is_some_and(|p| p == "mod"));
    let text = without_comments(text);
    let up = "super::".repeat(depth);
    let mut faults = Vec::new();
    for prefix in ["crate::", up.as_str()] {
        for (at, _) in text.match_indices(prefix) {
            if text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':' || c == '$') {
                continue;
            }
            for (offset, name) in heads(&text[at + prefix.len()..]) {
                let used = names.get(name).map_or(name, String::as_str);
                let Some(there) = floor(used) else { continue };
                if used != room && there >= here {
                    let line = text[..at + prefix.len() + offset].matches('\n').count() + 1;
                    faults.push((line, format!("`{room}` may not use `{used}` ({name})")));
                }
            }
        }
    }
    faults
}

/// The first identifier of a path, or of each path in a group in braces, with its offset.
fn heads(text: &str) -> Vec<(usize, &str)> {
    let head = |start: usize| {
        let rest = &text[start..];
        let skip = rest.len() - rest.trim_start().len();
        let name = identifiers(&rest[skip..]).next().filter(|name| rest[skip..].starts_with(name));
        name.map(|name| (start + skip, name))
    };
    if !text.starts_with('{') {
        return head(0).into_iter().collect();
    }
    let mut starts = vec![1];
    let mut depth = 0;
    for (i, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => break,
            '}' => depth -= 1,
            ',' if depth == 1 => starts.push(i + 1),
            _ => {}
        }
    }
    starts.into_iter().filter_map(head).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(inner: &str, text: &str) -> Vec<usize> {
        let names = reexports("pub use scene::desc::{SceneDesc, Other};\npub use spectrum::Spectrum;\n");
        faults_of(Path::new(inner), text, &names).into_iter().map(|(line, _)| line).collect()
    }

    #[test]
    fn downward_uses_pass() {
        let text =
            "use crate::math::Frame;\nuse crate::{Spectrum, accel::Bvh};\n// see crate::render\nuse super::desc;\n";
        assert!(lines("scene/shape/mesh.rs", text).is_empty());
        assert!(lines("scene/build.rs", "use crate::scene::desc::X; use crate::SceneDesc;").is_empty());
        assert!(lines("lib.rs", "use crate::render::X;").is_empty());
    }

    #[test]
    fn upward_uses_are_found() {
        assert_eq!(lines("math/ray.rs", "use crate::math::X;\n\nuse crate::scene::Y;\n"), [3]);
        assert_eq!(
            lines("walk/flight.rs", "use crate::{\n    math::{A, B},\n    photons::C,\n    scene::D,\n};\n"),
            [3]
        );
        assert_eq!(lines("math/mod.rs", "fn f() { crate::render::go() }"), [1]);
        assert_eq!(lines("math/ray.rs", "use crate::SceneDesc;"), [1]);
        assert_eq!(lines("math/ray.rs", "use super::super::film::X;"), [1]);
        assert_eq!(lines("math/mod.rs", "use super::film::X;"), [1]);
        // rooms of one floor
        assert_eq!(lines("film/mod.rs", "use crate::accel::X;"), [1]);
        assert_eq!(lines("accel/mod.rs", "use crate::film::X;"), [1]);
        // a new room without a floor
        assert_eq!(lines("attic/mod.rs", ""), [1]);
    }

    #[test]
    fn the_library_is_in_order() {
        check(&crate::root()).unwrap();
    }
}
