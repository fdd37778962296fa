//! An error or a warning with its place: in plain text, with a source frame, or field by field for programs.

use std::{fmt, ops::Range, sync::Arc};

use miette::{LabeledSpan, NamedSource, Severity as MietteSeverity, SourceCode, SourceSpan};
use os_io::{console::shown, text::plain};

use crate::{
    places::{Places, Position},
    problem::{Problem, Problems, Severity},
    source::{At, BlockNumber},
};

impl Problems {
    /// The problems tied to their sources, in the order of the text.
    #[must_use]
    pub fn into_diagnostics(mut self, places: &mut Places<'_>) -> Vec<Diagnostic> {
        self.list.retain(|p| p.severity == Severity::Error || !places.accepts(p.at, p.code));
        self.list.sort_by_key(|p| p.at.map_or((0, 0), |at| (at.source, at.start)));
        self.list.into_iter().map(|p| Diagnostic::new(p, places)).collect()
    }
}

/// An error or a warning about a piece of text in a file.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    pub(super) problem: Problem,
    file: String,
    position: Option<Position>,
    text: String,
    line_text: String,
    rest: String, // after the underlined piece
    source: Option<NamedSource<Arc<str>>>,
}

impl Diagnostic {
    fn new(mut problem: Problem, places: &mut Places<'_>) -> Self {
        let source = problem.at.and_then(|at| places.source(at));
        let position = problem.at.and_then(|at| places.position(at));
        let text = source.zip(problem.at).and_then(|(s, at)| s.text.get(range(at))).unwrap_or_default();
        let line = source.zip(position).map(|(s, position)| line_from(&s.text, position.begin));
        let end = problem.at.map_or(0, |at| at.start.saturating_add(at.length));
        let rest = source.map_or("", |s| line_from(&s.text, end));
        let elsewhere = problem.elsewhere.take().map(|(before, at)| format!("{before} {}", places.words(at)));
        problem.help = problem.help.or(elsewhere);
        Self {
            file: source.map(|s| s.name.clone()).unwrap_or_default(),
            position,
            text: text.to_owned(),
            line_text: line.unwrap_or_default().to_owned(),
            rest: rest.to_owned(),
            source: source.map(|s| NamedSource::new(&s.name, Arc::clone(&s.text))),
            problem,
        }
    }

    /// Severity.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        self.problem.severity
    }

    /// Stable short name of the kind of problem, such as `name.unknown`.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        self.problem.code
    }

    /// One sentence that states the found and the expected value.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.problem.message
    }

    /// What to do, or the nearest known name.
    #[must_use]
    pub fn help(&self) -> Option<&str> {
        self.problem.help.as_deref()
    }

    /// What was expected, if the message names one thing or one range.
    #[must_use]
    pub fn expected(&self) -> Option<&str> {
        self.problem.expected.as_deref()
    }

    /// The found value, if the message compares it with the expected one.
    #[must_use]
    pub fn found(&self) -> Option<&str> {
        self.problem.found.as_deref()
    }

    /// The path of the entry in a TOML file: `gripper.parts.body[0]`.
    #[must_use]
    pub fn entry(&self) -> Option<&str> {
        self.problem.entry.as_deref()
    }

    /// The piece of text to underline.
    #[must_use]
    pub const fn at(&self) -> Option<At> {
        self.problem.at
    }

    /// The nearest known name, if one is similar.
    #[must_use]
    pub fn nearest(&self) -> Option<&str> {
        self.problem.nearest.as_deref()
    }

    /// The file, relative to the data directory; empty if it could not be read.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The block, if the piece is in one.
    #[must_use]
    pub fn block(&self) -> Option<BlockNumber> {
        self.position.and_then(|position| position.block)
    }

    /// Line of the block from 0 (as the manual counts), or of the file from 1 outside blocks.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        self.position.map(|position| position.line)
    }

    /// Column from 1.
    #[must_use]
    pub fn column(&self) -> Option<u32> {
        self.position.map(|position| position.column)
    }

    /// Number of bytes that are underlined.
    #[must_use]
    pub fn length(&self) -> Option<u32> {
        self.problem.at.map(|at| at.length)
    }

    /// The text that is underlined.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text from the underlined piece to the end of the line.
    pub(super) const fn rest(&self) -> &str {
        self.rest.as_str()
    }

    /// File, block, line and column as text.
    #[must_use]
    pub fn place(&self) -> String {
        match self.position {
            Some(Position { block: Some(block), line, column, .. }) => {
                format!("{}: {block}, line {line}, column {column}", self.file)
            }
            Some(Position { line, column, .. }) => format!("{}: line {line}, column {column}", self.file),
            None => self.file.clone(),
        }
    }

    /// The finding without control characters, in the person's units. Byte positions remain.
    pub(super) fn shown(&self) -> Self {
        let mut finding = self.clone();
        finding.problem.message = shown(&self.problem.message).into_owned();
        finding.problem.help = self.problem.help.as_deref().map(|help| shown(help).into_owned());
        let source = self.source.as_ref();
        finding.source =
            source.map(|source| NamedSource::new(plain(source.name()), plain(source.inner()).into()));
        finding
    }

    pub(super) fn in_line(&self) -> String {
        let place = self.place();
        let colon = if place.is_empty() { "" } else { ": " };
        let help = self.help().map_or_else(String::new, |help| format!(" ({help})"));
        format!("{place}{colon}{}{help}", self.problem.message)
    }

    /// Place and message in the first line, then the line with the text underlined, then help.
    pub(super) fn plain(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place();
        let colon = if place.is_empty() { "" } else { ": " };
        writeln!(f, "{}: {place}{colon}{}", self.problem.severity.text(), self.problem.message)?;
        if let Some(position) = self.position.filter(|_| !self.line_text.is_empty()) {
            let before = usize::try_from(position.column).unwrap_or(1).saturating_sub(1);
            let rest = self.line_text.chars().count().saturating_sub(before);
            let width = self.text.lines().next().unwrap_or_default().chars().count().clamp(1, rest.max(1));
            writeln!(f, "    {}", self.line_text)?;
            writeln!(f, "    {}{}", " ".repeat(before), "^".repeat(width))?;
        }
        if let Some(help) = &self.problem.help {
            writeln!(f, "    help: {help}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem.message)
    }
}

impl std::error::Error for Diagnostic {}

impl miette::Diagnostic for Diagnostic {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.problem.code))
    }

    fn severity(&self) -> Option<MietteSeverity> {
        Some(match self.problem.severity {
            Severity::Error => MietteSeverity::Error,
            Severity::Warning => MietteSeverity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.help.as_ref().map(|h| -> Box<dyn fmt::Display + 'a> { Box::new(h) })
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|s| -> &dyn SourceCode { s })
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = self.position.and_then(|Position { block, line, column, .. }| {
            block.map(|block| format!("{block}, line {line}, column {column}"))
        });
        let range = range(self.problem.at?);
        let span = SourceSpan::new(range.start.into(), range.len());
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(label, span))))
    }
}

fn range(at: At) -> Range<usize> {
    let start = usize::try_from(at.start).unwrap_or(usize::MAX);
    start..start.saturating_add(usize::try_from(at.length).unwrap_or(0))
}

/// The line of a listing begins after its number.
fn line_from(text: &str, start: u32) -> &str {
    let start = usize::try_from(start).unwrap_or(usize::MAX);
    text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default()
}
