//! What the program says. Results go to the output stream, everything else to the error stream.

use crate::failure::Failure;
use std::fmt::Display;
use std::io::{ErrorKind, Write};

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    /// Errors only.
    Quiet,
    /// What matters.
    Normal,
    /// Also what was chosen and measured.
    Verbose,
}

/// Says things while the program works.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Console {
    /// How much.
    pub(crate) level: Level,
}

impl Console {
    /// The console of a command without choices.
    pub(crate) const NORMAL: Self = Self { level: Level::Normal };

    /// What a user should know and may have to act on.
    pub(crate) fn warning(self, message: impl Display) {
        if self.level >= Level::Normal {
            error_line(format_args!("warning: {message}"));
        }
    }

    /// What happens.
    pub(crate) fn say(self, message: impl Display) {
        if self.level >= Level::Normal {
            error_line(message);
        }
    }

    /// What only a curious user wants to know.
    pub(crate) fn detail(self, message: impl Display) {
        if self.level >= Level::Verbose {
            error_line(message);
        }
    }
}

/// A line on the error stream. There is nobody to tell when that is closed.
pub(crate) fn error_line(message: impl Display) {
    let _ = writeln!(std::io::stderr(), "{message}");
}

/// The result of a command on the output stream. A reader who has seen enough (`| head`) is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::other(format_args!("cannot write to the output: {error}")))
        }
        _ => Ok(()),
    }
}
