//! Every scene in `tests/broken` has one defect; what is said about it stands beside it in an `.expected` file.
//!
//! With `TYNDALL_BLESS` set, what is said now is written there, to be read by eye before it is committed.

use std::path::Path;
use tyndall_formats::mitsuba::{Options, read};

/// Values from outside, which a file asks for by comments such as `<!-- define a=1 -->`.
fn defines(text: &str) -> Vec<(String, String)> {
    text.split("<!-- define ")
        .skip(1)
        .filter_map(|rest| rest.split_once(" -->")?.0.split_once('='))
        .map(|(name, value)| (name.to_string(), value.to_string()))
        .collect()
}

#[test]
fn every_broken_scene_is_explained() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken");
    let mut names: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "xml"))
        .collect();
    names.sort();
    assert!(names.len() >= 60, "only {} scenes", names.len());
    let mut failures = String::new();
    for path in &names {
        let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
        let found = match read(path, &Options { defines: defines(&text) }) {
            Ok(_) => "no error".to_string(),
            Err(error) => match error.advice() {
                Some(advice) => format!("{error}\nhelp: {advice}"),
                None => error.to_string(),
            },
        };
        let found =
            found.replace(&format!("{}/", folder.display()), "").replace(&folder.display().to_string(), "FOLDER");
        let expected = path.with_extension("expected");
        if std::env::var_os("TYNDALL_BLESS").is_some() {
            std::fs::write(&expected, format!("{found}\n")).unwrap();
        }
        let expected = std::fs::read_to_string(&expected).unwrap_or_default();
        if found.trim_end() != expected.trim_end() {
            failures += &format!("{}:\n  found:    {found}\n  expected: {expected}\n", path.display());
        }
    }
    assert!(failures.is_empty(), "{failures}");
}
