//! `$name` substitution.

use super::source::{Place, SceneError, Source, nearest};
use std::sync::Arc;

/// More text than this from substitutions is an attack or an accident: each definition may use the one before it twice.
const MOST_TEXT: usize = 1 << 26;

/// Values for `$name`: from outside, or from `<default>`.
pub(crate) struct Definitions {
    /// Longest name first, so that `$ab` is not read as `$a` followed by `b`.
    list: Vec<Definition>,
    /// Names from outside that are defined twice.
    repeated: Option<String>,
    /// Bytes substituted so far.
    substituted: usize,
}

struct Definition {
    name: String,
    value: String,
    from_outside: bool,
    used: bool,
}

impl Definitions {
    pub(crate) fn new(defines: &[(String, String)]) -> Self {
        let mut this = Self { list: Vec::new(), repeated: None, substituted: 0 };
        for (name, value) in defines {
            if !this.add(name, value, true) {
                this.repeated.get_or_insert_with(|| name.clone());
            }
        }
        this
    }

    /// Whether the name was new.
    fn add(&mut self, name: &str, value: &str, from_outside: bool) -> bool {
        if self.list.iter().any(|d| d.name == name) {
            return false;
        }
        let at = self.list.partition_point(|d| d.name.len() >= name.len());
        self.list.insert(at, Definition { name: name.into(), value: value.into(), from_outside, used: false });
        true
    }

    /// A value to be used unless there already is one.
    pub(crate) fn default(&mut self, name: &str, value: &str) {
        if let Some(known) = self.list.iter_mut().find(|d| d.name == name) {
            // A parameter that a file declares is a legitimate one even if nothing needs it.
            known.used = true;
        } else {
            self.add(name, value, false);
        }
    }

    /// Replaces each `$name`; `\$` stands for a dollar sign.
    pub(crate) fn substitute(&mut self, text: &str, place: &Place) -> Result<String, SceneError> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let before = &rest[..dollar];
            rest = &rest[dollar + 1..];
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                continue;
            }
            out.push_str(before);
            let Some(definition) = self.list.iter_mut().find(|d| !d.name.is_empty() && rest.starts_with(&d.name))
            else {
                return Err(self.undefined(rest, place));
            };
            definition.used = true;
            self.substituted += definition.value.len();
            if self.substituted > MOST_TEXT {
                return Err(place.error(format!("more than {MOST_TEXT} bytes substituted, expected fewer")));
            }
            out.push_str(&definition.value);
            rest = &rest[definition.name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }

    fn undefined(&self, rest: &str, place: &Place) -> SceneError {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let name = &rest[..end];
        let help = match nearest(name, self.list.iter().map(|d| d.name.as_str())) {
            Some(known) => format!("did you mean \"${known}\"?"),
            None => format!("define it on the command line or by <default name=\"{name}\" value=\"...\"/> above"),
        };
        place.error_with_help(format!("undefined \"${name}\", expected a defined name"), Some(help))
    }

    /// Complains about names from outside that nothing used.
    pub(crate) fn all_used(&self, source: &Arc<Source>) -> Result<(), SceneError> {
        let start = Place::new(source, 0..0);
        if let Some(name) = &self.repeated {
            return Err(start.error(format!("\"{name}\" is defined twice, expected one value")));
        }
        let Some(unused) = self.list.iter().find(|d| d.from_outside && !d.used) else { return Ok(()) };
        let known: Vec<&str> =
            self.list.iter().filter(|d| d.used || !d.from_outside).map(|d| d.name.as_str()).collect();
        Err(start.error_with_help(
            format!("defined \"{}\" is used nowhere, expected \"${}\" in the scene", unused.name, unused.name),
            super::source::advise(&unused.name, "names", &known),
        ))
    }
}
