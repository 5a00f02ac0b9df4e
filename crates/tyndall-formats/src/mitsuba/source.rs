//! Places in scene files, and the errors and warnings that point at them.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::sync::Arc;

/// The text of one file.
#[derive(Debug)]
pub(crate) struct Source {
    /// The file's name, for messages.
    pub(crate) name: String,
    /// The whole text.
    pub(crate) text: Arc<str>,
}

/// A range of bytes in a file.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    source: Arc<Source>,
    start: usize,
    end: usize,
}

impl Place {
    /// A range of `source`, brought within its text and to whole characters.
    pub(crate) fn new(source: &Arc<Source>, range: std::ops::Range<usize>) -> Self {
        let start = source.text.floor_char_boundary(range.start);
        let end = source.text.ceil_char_boundary(range.end.max(start));
        Self { source: source.clone(), start, end }
    }

    /// Line and column, both from 1; the column counts characters.
    pub(crate) fn position(&self) -> (usize, usize) {
        let before = &self.source.text.as_bytes()[..self.start];
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        (line, String::from_utf8_lossy(&before[line_start..]).chars().count() + 1)
    }

    pub(crate) fn error(&self, message: impl Into<String>) -> SceneError {
        self.error_with_help(message, None)
    }

    pub(crate) fn error_with_help(&self, message: impl Into<String>, help: Option<String>) -> SceneError {
        let (line, column) = self.position();
        SceneError(Box::new(Details {
            message: message.into(),
            help,
            line,
            column,
            span: self.start..self.end,
            source: NamedSource::new(&self.source.name, self.source.text.clone()).with_language("XML"),
        }))
    }

    pub(crate) fn warning(&self, message: impl Into<String>) -> Warning {
        let (line, column) = self.position();
        Warning { file: self.source.name.clone(), line, column, message: message.into() }
    }

    /// `FILE:LINE`, for names of things without an id.
    pub(crate) fn label(&self) -> String {
        let file = self.source.name.rsplit(['/', '\\']).next().unwrap_or_default();
        format!("{file}:{}", self.position().0)
    }
}

/// Something in a scene that was read, but perhaps not as its author hoped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The file's name.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What was found and what was made of it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)
    }
}

/// Why a scene could not be read: `FILE:LINE:COLUMN: what was found, what was expected`.
#[derive(Clone)]
pub struct SceneError(Box<Details>);

#[derive(Clone)]
struct Details {
    message: String,
    help: Option<String>,
    line: usize,
    column: usize,
    span: std::ops::Range<usize>,
    source: NamedSource<Arc<str>>,
}

impl SceneError {
    /// An error about a file that could not even be opened.
    pub(crate) fn unreadable(name: &str, message: impl Into<String>) -> Self {
        let source = Arc::new(Source { name: name.into(), text: "".into() });
        Place::new(&source, 0..0).error(message)
    }

    /// The message without its position.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// The file's name.
    pub fn file(&self) -> &str {
        self.0.source.name()
    }

    /// Line and column (in characters), both from 1.
    pub fn position(&self) -> (usize, usize) {
        (self.0.line, self.0.column)
    }

    /// Advice, such as the nearest known name.
    pub fn advice(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// The message, the line it is about with the place marked underneath, and the advice.
    pub fn report(&self) -> String {
        const WIDEST: usize = 160;
        let Details { line, column, span, help, .. } = &*self.0;
        let mut report = format!("{self}\n");
        let text = self.0.source.inner();
        if let Some(excerpt) = text.lines().nth(line - 1).filter(|_| !text.is_empty()) {
            // A minified file is one line: show the part around the place.
            let skip = if *column > WIDEST { column - WIDEST / 2 } else { 0 };
            let shown: String =
                excerpt.chars().skip(skip).take(WIDEST).map(|c| if c == '\t' { ' ' } else { c }).collect();
            let before = column - 1 - skip;
            let room = shown.chars().count().saturating_sub(before).max(1);
            let marks = text[span.clone()].lines().next().map_or(1, |s| s.chars().count()).clamp(1, room);
            let number = line.to_string();
            let gutter = " ".repeat(number.len());
            report +=
                &format!("{gutter} |\n{number} | {shown}\n{gutter} | {}{}\n", " ".repeat(before), "^".repeat(marks));
        }
        if let Some(help) = help {
            report += &format!("help: {help}\n");
        }
        report
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Details { line, column, message, source, .. } = &*self.0;
        write!(f, "{}:{line}:{column}: {message}", source.name())
    }
}

impl fmt::Debug for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.report())
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.help.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.0.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some("here".into()), self.0.span.clone()))))
    }
}

/// The known name that `word` was probably meant to be.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let reach = (word.chars().count() / 3).max(2);
    known
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&lower, &name.to_lowercase()), name))
        .filter(|(distance, name)| *distance <= reach && *distance < name.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// `did you mean "NEAREST"? known LIST: ...`.
pub(crate) fn advise(word: &str, list: &str, known: &[&str]) -> Option<String> {
    let guess =
        nearest(word, known.iter().copied()).map(|name| format!("did you mean \"{name}\"? ")).unwrap_or_default();
    (!known.is_empty()).then(|| format!("{guess}known {list}: {}", known.join(", ")))
}
