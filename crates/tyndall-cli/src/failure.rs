//! Why the program stops, and what it says then.

use crate::console::error_line;
use crate::interrupt;
use std::fmt::Display;
use std::process::ExitCode;
use tyndall_formats::mitsuba::SceneError;

/// An error that ends the program.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for something that does not exist or make sense.
    Usage(String),
    /// Anything else.
    Other(String),
    /// Ctrl-C.
    Interrupted,
}

impl Failure {
    /// A mistake on the command line.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// Any other error.
    pub(crate) fn other(message: impl Display) -> Self {
        Self::Other(message.to_string())
    }

    /// A mistake in a scene file, with the line it is in.
    pub(crate) fn scene(error: &SceneError) -> Self {
        Self::other(error.report().trim_end())
    }

    /// `found` is none of `known`; names the nearest.
    pub(crate) fn unknown<'a>(what: &str, found: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let guess = nearest(found, &known).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default();
        Self::Usage(format!("there is no {what} `{found}`{guess} (there is {})", known.join(", ")))
    }

    /// Prints it and gives the exit code: 2 for mistakes on the command line, 130 for Ctrl-C, 1 for the rest.
    pub(crate) fn report(self) -> ExitCode {
        error_line(format_args!("error: {self}"));
        ExitCode::from(match self {
            Self::Usage(_) => 2,
            Self::Other(_) => 1,
            Self::Interrupted => interrupt::EXIT_CODE,
        })
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Usage(message) | Self::Other(message) => f.write_str(message),
            Self::Interrupted => f.write_str("interrupted; the same command goes on from here"),
        }
    }
}

/// The known name that `word` was probably meant to be.
pub(crate) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let distance = |name: &str| strsim::damerau_levenshtein(&word, &name.to_lowercase());
    let reach = (word.chars().count() / 3).max(2);
    let candidates = known.iter().map(|name| (distance(name), *name));
    candidates.filter(|(d, name)| *d <= reach && *d < name.len()).min_by_key(|(d, _)| *d).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_names() {
        let known = ["volpath", "path", "direct"];
        assert_eq!(nearest("volpth", &known), Some("volpath"));
        assert_eq!(nearest("PATH", &known), Some("path"));
        assert_eq!(nearest("drect", &known), Some("direct"));
        assert_eq!(nearest("lightcuts", &known), None);
        assert_eq!(nearest("x", &known), None);
    }
}
