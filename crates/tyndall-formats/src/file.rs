//! What all readers and writers share: errors with a place, whole-file reading, words of a text, numbers of a binary,
//! and writing that never leaves half a file behind.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// A file that cannot be read or written.
///
/// Shown as `PATH:LINE:COLUMN: ...` for texts, `PATH: byte OFFSET: ...` for binaries and `PATH: ...` where the file as a
/// whole is meant.
#[derive(Debug, thiserror::Error)]
#[error("{}{place} {message}", .path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What was found and what was expected.
    pub message: String,
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// Of a text; both count from 1, columns in bytes.
    Text {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
    },
    /// Offset in a binary.
    Byte(u64),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole => write!(f, ":"),
            Self::Text { line, column } => write!(f, ":{line}:{column}:"),
            Self::Byte(offset) => write!(f, ": byte {offset}:"),
        }
    }
}

impl FileError {
    /// An error at a place.
    pub fn new(path: impl AsRef<Path>, place: Place, message: impl Into<String>) -> Self {
        Self { path: path.as_ref().to_owned(), place, message: message.into() }
    }

    /// An error of the file as a whole.
    pub fn whole(path: impl AsRef<Path>, message: impl Into<String>) -> Self {
        Self::new(path, Place::Whole, message)
    }

    /// An error at a byte of a binary.
    pub fn byte(path: impl AsRef<Path>, offset: usize, message: impl Into<String>) -> Self {
        Self::new(path, Place::Byte(offset as u64), message)
    }
}

/// Opens a regular file and gives its length; anything else (a folder, a pipe, a device) has no length to check against.
pub(crate) fn open(path: &Path) -> Result<(File, u64), FileError> {
    let fail = |e: std::io::Error| FileError::whole(path, format!("cannot be read: {e}"));
    // Looked at before it is opened: opening a pipe would wait for its other end.
    let kind = std::fs::metadata(path).map_err(fail)?;
    if !kind.is_file() {
        return Err(FileError::whole(path, "is not a regular file"));
    }
    let file = File::open(path).map_err(fail)?;
    Ok((file, kind.len()))
}

/// All bytes of a regular file.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let (file, length) = open(path)?;
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // One byte more than announced: a file that grows meanwhile is not followed for ever.
    file.take(length.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|e| FileError::whole(path, format!("cannot be read: {e}")))?;
    Ok(bytes)
}

/// Writes beside `path`, flushes to the disk and renames: other programs see the old file or the new one, never a half.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let fail = |e: std::io::Error| FileError::whole(path, format!("cannot be written: {e}"));
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tyndall-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: the umask takes away from this. Temporary files are private otherwise.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(fail)?;
    file.write_all(bytes).map_err(fail)?;
    file.as_file().sync_all().map_err(fail)?;
    file.persist(path).map_err(|e| fail(e.error))?;
    #[cfg(unix)]
    File::open(folder).and_then(|f| f.sync_all()).map_err(fail)?;
    Ok(())
}

/// Runs a decoder of another library, whose panics (overflows in debug builds, say) are errors of the file here.
pub(crate) fn decode<T, E: std::fmt::Display>(
    name: &str,
    decoder: impl FnOnce() -> Result<T, E> + std::panic::UnwindSafe,
) -> Result<T, FileError> {
    match std::panic::catch_unwind(decoder) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(e)) => Err(FileError::whole(name, format!("cannot be decoded: {e}"))),
        Err(_) => Err(FileError::whole(name, "cannot be decoded: the decoder gave up")),
    }
}

/// A word of a text and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) place: Place,
}

impl Word<'_> {
    /// The word for a message, shortened.
    pub(crate) fn shown(&self) -> String {
        let text = String::from_utf8_lossy(self.bytes);
        match text.char_indices().nth(40) {
            Some((end, _)) => format!("'{}...'", text[..end].escape_debug()),
            None => format!("'{}'", text.escape_debug()),
        }
    }

    /// The whole word.
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(self.bytes).into_owned()
    }

    /// The word as a number of any kind.
    pub(crate) fn parse<T: std::str::FromStr>(&self) -> Option<T> {
        std::str::from_utf8(self.bytes).ok()?.parse().ok()
    }
}

/// Walks through the words of a text.
#[derive(Clone, Debug)]
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    line_start: usize,
    name: &'a str,
}

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8], name: &'a str) -> Self {
        Self { bytes, at: 0, line: 1, line_start: 0, name }
    }

    /// The words from the start of a later line on.
    pub(crate) fn from_line(bytes: &'a [u8], name: &'a str, at: usize, line: usize) -> Self {
        Self { bytes, at, line, line_start: at, name }
    }

    /// The number of this line, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// The next word of this line.
    pub(crate) fn in_line(&mut self) -> Option<Word<'a>> {
        loop {
            match self.bytes.get(self.at)? {
                b'\n' => return None,
                // A backslash before the line's end continues it.
                b'\\' if self.bytes[self.at + 1..].starts_with(b"\n") => self.new_line(self.at + 1),
                b'\\' if self.bytes[self.at + 1..].starts_with(b"\r\n") => self.new_line(self.at + 2),
                b if b.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
        let (start, place) = (self.at, self.place());
        while self.bytes.get(self.at).is_some_and(|b| !b.is_ascii_whitespace()) {
            self.at += 1;
        }
        Some(Word { bytes: &self.bytes[start..self.at], place })
    }

    /// The next word, in this line or a later one.
    pub(crate) fn anywhere(&mut self) -> Option<Word<'a>> {
        loop {
            if let Some(word) = self.in_line() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// Goes to the start of the next line; false at the end of the text.
    pub(crate) fn next_line(&mut self) -> bool {
        match self.bytes[self.at..].iter().position(|&b| b == b'\n') {
            Some(n) => {
                self.new_line(self.at + n);
                true
            }
            None => {
                self.at = self.bytes.len();
                false
            }
        }
    }

    fn new_line(&mut self, newline: usize) {
        self.at = newline + 1;
        self.line += 1;
        self.line_start = self.at;
    }

    /// Where the next byte stands.
    pub(crate) fn place(&self) -> Place {
        Place::Text { line: self.line, column: self.at - self.line_start + 1 }
    }

    /// Bytes read so far.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// An error at the next byte.
    pub(crate) fn error(&self, message: impl Into<String>) -> FileError {
        FileError::new(self.name, self.place(), message)
    }

    /// An error at a word.
    pub(crate) fn error_at(&self, word: Word, message: impl Into<String>) -> FileError {
        FileError::new(self.name, word.place, message)
    }

    /// A word as a finite number.
    pub(crate) fn finite(&self, word: Word) -> Result<f32, FileError> {
        match word.parse::<f32>() {
            Some(x) if x.is_finite() => Ok(x),
            _ => Err(self.error_at(word, format!("found {}, expected a finite number", word.shown()))),
        }
    }
}

/// Walks through a little-endian binary.
#[derive(Clone, Debug)]
pub(crate) struct Bytes<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
    pub(crate) name: &'a str,
}

impl<'a> Bytes<'a> {
    pub(crate) fn new(bytes: &'a [u8], name: &'a str) -> Self {
        Self { bytes, at: 0, name }
    }

    /// Bytes not yet read.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next `n` bytes; `what` they are is for the message.
    pub(crate) fn take(&mut self, n: usize, what: &str) -> Result<&'a [u8], FileError> {
        if n > self.left() {
            let left = self.left();
            return Err(self.error(format!("found {left} bytes before the end, expected {n} for {what}")));
        }
        let taken = &self.bytes[self.at..self.at + n];
        self.at += n;
        Ok(taken)
    }

    /// The next `N` bytes.
    pub(crate) fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    /// An error at the next byte.
    pub(crate) fn error(&self, message: impl Into<String>) -> FileError {
        FileError::byte(self.name, self.at, message)
    }
}
