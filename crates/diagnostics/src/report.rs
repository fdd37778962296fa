//! The report of a load: every error and warning with its place, and the numbers of loaded files and records.

use std::{fmt, io::IsTerminal};

use miette::{GraphicalReportHandler, GraphicalTheme};
use os_io::{console::shown, text::amount};

use crate::{Diagnostic, Places, Problems, Severity, Source};

/// Number of records in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// The manual's name of the file.
    pub file: &'static str,
    /// Number of records.
    pub records: usize,
}

/// The outcome of a load.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Number of files that were read.
    pub files: usize,
    /// Number of blocks that were loaded.
    pub blocks: usize,
    /// Number of records in each file; empty if there were errors.
    pub loaded: Vec<Loaded>,
    pub(crate) told: usize, // an earlier report has them
}

impl Diagnostic {
    /// The finding with source frame and colour if `graphical`, otherwise as plain text. [`os_io::console::drawn`]
    /// prints the graphical form, which needs no [`os_io::console::shown`].
    #[must_use]
    pub fn render(&self, graphical: bool) -> String {
        if !graphical {
            return Plain(self).to_string();
        }
        let shown = self.shown();
        let colourless = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let theme = if colourless { GraphicalTheme::unicode_nocolor() } else { GraphicalTheme::unicode() };
        let handler = GraphicalReportHandler::new_themed(theme);
        let mut out = String::new();
        // A finding that cannot be drawn is given as plain text.
        if handler.render_report(&mut out, &shown).is_err() {
            out.push_str(shown.message());
        }
        out + "\n"
    }
}

struct Plain<'a>(&'a Diagnostic);

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.plain(f)
    }
}

impl Diagnostics {
    /// A report of the problems in the sources.
    #[must_use]
    pub fn new(problems: Problems, mut places: Places<'_>, blocks: usize, loaded: Vec<Loaded>) -> Self {
        let files = places.sources().len();
        Self { diagnostics: problems.into_diagnostics(&mut places), files, blocks, loaded, told: 0 }
    }

    /// A report of the problems in one file, whose places are lines and columns.
    #[must_use]
    pub fn of_file(problems: Problems, source: &Source) -> Self {
        Self::new(problems, Places::in_lines(std::slice::from_ref(source)), 0, Vec::new())
    }

    /// A report for a file that cannot be read, or for values that do not come from a file.
    #[must_use]
    pub fn without_text(problems: Problems) -> Self {
        Self::new(problems, Places::in_lines(&[]), 0, Vec::new())
    }

    /// Adds the findings of another check of one of the report's sources.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.diagnostics.extend(other.diagnostics);
        self
    }

    /// All findings, in the order of the text.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The errors.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|d| d.severity() == Severity::Error)
    }

    /// The warnings.
    pub fn warnings(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|d| d.severity() == Severity::Warning)
    }

    /// True if there is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }

    /// The report as text: with source frames and colour if `graphical`, else the plain text of [`fmt::Display`].
    #[must_use]
    pub fn render(&self, graphical: bool) -> String {
        if !graphical {
            return self.to_string();
        }
        let all: String = self.diagnostics.iter().map(|diagnostic| diagnostic.render(true)).collect();
        all + &self.summary()
    }

    /// All findings in one line: each with its place, message and help.
    #[must_use]
    pub fn in_line(&self) -> String {
        let all: Vec<String> = self.diagnostics.iter().map(Diagnostic::in_line).collect();
        all.join("; ")
    }

    /// The report for standard error, graphical on a terminal; [`os_io::console::stderr_drawn`] writes it.
    #[must_use]
    pub fn render_for_stderr(&self) -> String {
        match std::io::stderr().is_terminal() {
            true => self.render(true),
            false => shown(&self.to_string()).into_owned(),
        }
    }

    /// Numbers of errors, warnings, blocks, files and records, in one or two lines.
    #[must_use]
    pub fn summary(&self) -> String {
        let told = if self.told > 0 { format!(" and {} reported above", self.told) } else { String::new() };
        let mut out = format!(
            "{}, {}{told}; {} in {}\n",
            amount(self.errors().count(), "error"),
            amount(self.warnings().count(), "warning"),
            amount(self.blocks, "block"),
            amount(self.files, "file"),
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
