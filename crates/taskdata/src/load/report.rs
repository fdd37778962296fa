//! What a load found: every error and warning at once, each with its place, and what was loaded.

use std::{fmt, io::IsTerminal, sync::Arc};

use miette::{
    GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, Severity as MietteSeverity, SourceCode,
    SourceSpan,
};

use super::{
    places::{Places, Position},
    source::{At, BlockNumber},
};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The data cannot be used.
    Error,
    /// The data can be used, but look at it.
    Warning,
}

impl Severity {
    /// The word in a message.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// Something found, before it is tied to the text of its source.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How bad.
    pub severity: Severity,
    /// Stable short name of the kind of problem.
    pub code: &'static str,
    /// Where; `None` for a file that could not be read.
    pub at: Option<At>,
    /// One sentence: what was found and what was expected.
    pub message: String,
    /// What to do, or the nearest known name.
    pub help: Option<String>,
    /// Another place that belongs to it, with the words before it; it becomes the help.
    pub elsewhere: Option<(String, At)>,
    /// What was expected in its place, for programs; the message says it too.
    pub expected: Option<String>,
    /// The nearest known name, for programs; the help says it too.
    pub nearest: Option<String>,
}

/// A list of problems that is filled while forms are read and checked.
#[derive(Clone, Debug, Default)]
pub struct Problems {
    list: Vec<Problem>,
}

impl Problems {
    /// Add an error.
    pub fn error(&mut self, code: &'static str, at: At, message: impl Into<String>) {
        self.push(Severity::Error, code, at, message.into(), None);
    }

    /// Add an error with help.
    pub fn error_help(
        &mut self,
        code: &'static str,
        at: At,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.push(Severity::Error, code, at, message.into(), Some(help.into()));
    }

    /// Add an error of something that is there already.
    pub fn duplicate(&mut self, at: At, message: impl Into<String>, first: At) {
        self.error("duplicate", at, message);
        self.elsewhere("the first is in", first);
    }

    /// Name another place that belongs to the last problem; it becomes the help.
    pub fn elsewhere(&mut self, before: impl Into<String>, at: At) {
        if let Some(last) = self.list.last_mut() {
            last.elsewhere = Some((before.into(), at));
        }
    }

    /// Add a warning.
    pub fn warning(&mut self, code: &'static str, at: At, message: impl Into<String>, help: Option<String>) {
        self.push(Severity::Warning, code, at, message.into(), help);
    }

    /// Add an error with help where there is some.
    pub fn push(
        &mut self,
        severity: Severity,
        code: &'static str,
        at: At,
        message: String,
        help: Option<String>,
    ) {
        self.list.push(Problem {
            severity,
            code,
            at: Some(at),
            message,
            help,
            elsewhere: None,
            expected: None,
            nearest: None,
        });
    }

    /// Move all problems of another list behind these.
    pub fn append(&mut self, others: &mut Self) {
        self.list.append(&mut others.list);
    }

    /// Give the last problem a help line.
    pub fn help(&mut self, help: String) {
        if let Some(last) = self.list.last_mut() {
            last.help = Some(help);
        }
    }

    /// Add to the help of a problem that was noted at a place.
    pub fn add_help(&mut self, code: &str, at: At, more: &str) {
        let noted = self.list.iter_mut().find(|problem| problem.code == code && problem.at == Some(at));
        if let Some(problem) = noted {
            problem.help = Some(match problem.help.take() {
                Some(help) => format!("{help}; {more}"),
                None => more.to_owned(),
            });
        }
    }

    /// Note what was expected in the place of the last problem.
    pub fn expected(&mut self, what: impl Into<String>) {
        if let Some(last) = self.list.last_mut() {
            last.expected = Some(what.into());
        }
    }

    /// Note the nearest name, of the sort `what`, to the one of the last problem; it becomes the help too.
    pub fn nearest(&mut self, what: &str, name: &str) {
        if let Some(last) = self.list.last_mut() {
            last.help = Some(format!("the nearest {what} is {name}"));
            last.nearest = Some(name.to_owned());
        }
    }

    /// Add an error that belongs to no piece of text.
    pub fn general(&mut self, code: &'static str, message: String) {
        self.list.push(Problem {
            severity: Severity::Error,
            code,
            at: None,
            message,
            help: None,
            elsewhere: None,
            expected: None,
            nearest: None,
        });
    }

    /// Add what the operating system said about a file.
    pub fn unreadable(&mut self, path: &str, error: &std::io::Error) {
        self.general("file", format!("{path} cannot be read: {error}"));
    }

    /// True if an error is among them.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|p| p.severity == Severity::Error)
    }

    /// The problems tied to their sources, in the order of the text.
    #[must_use]
    pub fn into_diagnostics(mut self, places: &mut Places<'_>) -> Vec<Diagnostic> {
        self.list.retain(|p| p.severity == Severity::Error || !places.accepts(p.at, p.code));
        self.list.sort_by_key(|p| p.at.map_or((0, 0), |at| (at.source, at.start)));
        self.list.into_iter().map(|p| Diagnostic::new(p, places)).collect()
    }
}

/// An error or a warning about a form or a job line.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    severity: Severity,
    code: &'static str,
    message: String,
    help: Option<String>,
    expected: Option<String>,
    nearest: Option<String>,
    file: String,
    at: Option<At>,
    position: Option<Position>,
    text: String,
    line_text: String,
    source: Option<NamedSource<Arc<str>>>,
}

impl Diagnostic {
    fn new(problem: Problem, places: &mut Places<'_>) -> Self {
        let source = problem.at.and_then(|at| places.source(at));
        let position = problem.at.and_then(|at| places.position(at));
        let text =
            source.zip(problem.at).and_then(|(s, at)| s.text.get(range(at))).unwrap_or_default().to_owned();
        let line_text =
            source.zip(position).map(|(s, position)| line_from(&s.text, position.begin).to_owned());
        let elsewhere = problem.elsewhere.map(|(before, at)| format!("{before} {}", places.words(at)));
        Self {
            severity: problem.severity,
            code: problem.code,
            message: problem.message,
            help: problem.help.or(elsewhere),
            expected: problem.expected,
            nearest: problem.nearest,
            file: source.map(|s| s.name.clone()).unwrap_or_default(),
            at: problem.at,
            position,
            text,
            line_text: line_text.unwrap_or_default(),
            source: source.map(|s| NamedSource::new(&s.name, Arc::clone(&s.text))),
        }
    }

    /// How bad it is.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        self.severity
    }

    /// Stable short name of the kind of problem, such as `name.unknown`.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        self.code
    }

    /// One sentence: what was found and what was expected.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What to do, or the nearest known name.
    #[must_use]
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// What was expected, where one thing or one range was.
    #[must_use]
    pub fn expected(&self) -> Option<&str> {
        self.expected.as_deref()
    }

    /// The nearest known name, if one is near.
    #[must_use]
    pub fn nearest(&self) -> Option<&str> {
        self.nearest.as_deref()
    }

    /// The file, relative to the data directory; empty if it could not be read.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The block, if it stands in one.
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
        self.at.map(|at| at.length)
    }

    /// The text that is underlined.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// File, block, line and column in words.
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

    /// Plain text: place and message in the first line, then the line with the text underlined, then help.
    fn plain(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place();
        let colon = if place.is_empty() { "" } else { ": " };
        writeln!(f, "{}: {place}{colon}{}", self.severity.text(), self.message)?;
        if let Some(position) = self.position.filter(|_| !self.line_text.is_empty()) {
            let before = usize::try_from(position.column).unwrap_or(1).saturating_sub(1);
            let rest = self.line_text.chars().count().saturating_sub(before);
            let width = self.text.lines().next().unwrap_or_default().chars().count().clamp(1, rest.max(1));
            writeln!(f, "    {}", self.line_text)?;
            writeln!(f, "    {}{}", " ".repeat(before), "^".repeat(width))?;
        }
        if let Some(help) = &self.help {
            writeln!(f, "    help: {help}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Diagnostic {}

impl miette::Diagnostic for Diagnostic {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn severity(&self) -> Option<MietteSeverity> {
        Some(match self.severity {
            Severity::Error => MietteSeverity::Error,
            Severity::Warning => MietteSeverity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|h| -> Box<dyn fmt::Display + 'a> { Box::new(h) })
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|s| -> &dyn SourceCode { s })
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = self.position.and_then(|Position { block, line, column, .. }| {
            block.map(|block| format!("{block}, line {line}, column {column}"))
        });
        let range = range(self.at?);
        let span = SourceSpan::new(range.start.into(), range.len());
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(label, span))))
    }
}

fn range(at: At) -> std::ops::Range<usize> {
    let start = usize::try_from(at.start).unwrap_or(usize::MAX);
    start..start.saturating_add(usize::try_from(at.length).unwrap_or(0))
}

/// The line that begins at a byte; that of a listing begins after its number.
fn line_from(text: &str, start: u32) -> &str {
    let start = usize::try_from(start).unwrap_or(usize::MAX);
    text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default()
}

/// How many records a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// The manual's name of the file.
    pub file: &'static str,
    /// Records in it.
    pub records: usize,
}

/// The outcome of a load.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    diagnostics: Vec<Diagnostic>,
    /// Files that were read.
    pub files: usize,
    /// Blocks that were loaded.
    pub blocks: usize,
    /// Records in each file; empty if there were errors.
    pub loaded: Vec<Loaded>,
}

impl Diagnostics {
    /// A report of what was found in the sources.
    #[must_use]
    pub fn new(problems: Problems, mut places: Places<'_>, blocks: usize, loaded: Vec<Loaded>) -> Self {
        let files = places.sources().len();
        Self { diagnostics: problems.into_diagnostics(&mut places), files, blocks, loaded }
    }

    /// The same with what another look at one of the sources found.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.diagnostics.extend(other.diagnostics);
        self
    }

    /// Everything found, in the order of the text.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The errors.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|d| d.severity == Severity::Error)
    }

    /// The warnings.
    pub fn warnings(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|d| d.severity == Severity::Warning)
    }

    /// True if there is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }

    /// The report for a person: with source frames and colour if `graphical`, else the plain text of [`fmt::Display`].
    #[must_use]
    pub fn render(&self, graphical: bool) -> String {
        if !graphical {
            return self.to_string();
        }
        let colourless = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let theme = if colourless { GraphicalTheme::unicode_nocolor() } else { GraphicalTheme::unicode() };
        let handler = GraphicalReportHandler::new_themed(theme);
        let mut out = String::new();
        for diagnostic in &self.diagnostics {
            // Writing to a String cannot fail; a diagnostic that cannot be drawn is given as plain text.
            if handler.render_report(&mut out, diagnostic).is_err() {
                out.push_str(diagnostic.message());
            }
            out.push('\n');
        }
        out + &self.summary()
    }

    /// The report for standard error: graphical on a terminal.
    #[must_use]
    pub fn render_for_stderr(&self) -> String {
        self.render(std::io::stderr().is_terminal())
    }

    /// What was loaded, in one or two lines.
    #[must_use]
    pub fn summary(&self) -> String {
        let count = |n: usize, one: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") };
        let mut out = format!(
            "{}, {}; {} in {}\n",
            count(self.errors().count(), "error"),
            count(self.warnings().count(), "warning"),
            count(self.blocks, "block"),
            count(self.files, "file"),
        );
        let records: Vec<String> = self.loaded.iter().map(|l| format!("{} {}", l.file, l.records)).collect();
        if !records.is_empty() {
            out.push_str("records: ");
            out.push_str(&records.join(", "));
            out.push('\n');
        }
        out
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for diagnostic in &self.diagnostics {
            diagnostic.plain(f)?;
        }
        f.write_str(&self.summary())
    }
}

impl std::error::Error for Diagnostics {}
