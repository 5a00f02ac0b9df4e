//! The command line of another renderer, with places for what changes.

use std::ffi::OsString;
use std::path::Path;

/// A command line as words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Template {
    text: String,
    words: Vec<String>,
}

/// What goes into a template.
#[derive(Clone, Debug)]
pub(crate) struct Values<'a> {
    pub(crate) scene: &'a Path,
    pub(crate) out: &'a Path,
    pub(crate) spp: u32,
    pub(crate) seed: u64,
    pub(crate) threads: usize,
    pub(crate) size: [u32; 2],
    /// The scene's variables.
    pub(crate) define: &'a [(String, String)],
}

const PLACES: [&str; 8] = ["scene", "out", "spp", "seed", "threads", "width", "height", "defines"];

impl Template {
    /// Splits into words as a shell does and checks the places.
    pub(crate) fn new(text: &str) -> Result<Self, String> {
        let words = shlex::split(text).ok_or_else(|| format!("a quotation mark in `{text}` is not closed"))?;
        if words.is_empty() {
            return Err("expected a command, found nothing".into());
        }
        let places: Vec<&str> = words.iter().flat_map(|word| places(word)).collect();
        if let Some(unknown) = places.iter().find(|place| !PLACES.contains(place)) {
            return Err(format!("there is no place {{{unknown}}} (there is {{{}}})", PLACES.join("}, {")));
        }
        for needed in ["scene", "out", "spp"] {
            if !places.contains(&needed) {
                return Err(format!("found no {{{needed}}} in `{text}`, expected {{scene}}, {{out}} and {{spp}}"));
            }
        }
        Ok(Self { text: text.to_owned(), words })
    }

    /// As it was given.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Whether renders with different seeds differ.
    pub(crate) fn has_seed(&self) -> bool {
        self.words.iter().any(|word| word.contains("{seed}"))
    }

    /// The words of a command.
    pub(crate) fn fill(&self, values: &Values) -> Vec<OsString> {
        let fill = |word: &String| -> Vec<OsString> {
            if word == "{defines}" {
                return values.define.iter().map(|(name, value)| format!("-D{name}={value}").into()).collect();
            }
            let filled = word
                .replace("{scene}", &values.scene.to_string_lossy())
                .replace("{out}", &values.out.to_string_lossy())
                .replace("{spp}", &values.spp.to_string())
                .replace("{seed}", &values.seed.to_string())
                .replace("{threads}", &values.threads.to_string())
                .replace("{width}", &values.size[0].to_string())
                .replace("{height}", &values.size[1].to_string());
            vec![filled.into()]
        };
        self.words.iter().flat_map(fill).collect()
    }
}

/// The names in braces, if they look like names.
fn places(word: &str) -> impl Iterator<Item = &str> {
    let after = word.split('{').skip(1);
    after
        .filter_map(|rest| rest.split_once('}'))
        .map(|(name, _)| name)
        .filter(|name| !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_filled() {
        let template = Template::new("mi -m 'a b' -Dspp={spp} {defines} -o {out} {scene} {width}x{height}").unwrap();
        let define = [("res".to_owned(), "64".to_owned()), ("a".to_owned(), "x y".to_owned())];
        let values = Values {
            scene: Path::new("/s c/a.xml"),
            out: Path::new("o.exr"),
            spp: 12,
            seed: 3,
            threads: 2,
            size: [64, 32],
            define: &define,
        };
        let expected = ["mi", "-m", "a b", "-Dspp=12", "-Dres=64", "-Da=x y", "-o", "o.exr", "/s c/a.xml", "64x32"]
            .map(OsString::from);
        assert_eq!(template.fill(&values), expected);
        assert!(!template.has_seed());
    }

    #[test]
    fn mistakes_are_named() {
        let message = |text: &str| Template::new(text).unwrap_err();
        assert!(message("mi {spp} {out}").contains("no {scene}"));
        assert!(message("mi {spp} {out} {scene} {ssp}").contains("no place {ssp}"));
        assert!(message("mi 'x").contains("not closed"));
        assert!(message(" ").contains("found nothing"));
    }
}
