//! A problem before its place in the text is resolved.

use std::fmt::Display;

use crate::{names::nearest, source::At};

/// Severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The data cannot be used.
    Error,
    /// The data can be used, but should be checked.
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

/// A problem before its place in the text is resolved.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Severity.
    pub severity: Severity,
    /// Stable short name of the kind of problem.
    pub code: &'static str,
    /// The piece of text; `None` for a file that could not be read.
    pub at: Option<At>,
    /// The path of the entry in a TOML file: `gripper.parts.body[0]`; lists count from 0.
    pub entry: Option<String>,
    /// One sentence that states the found and the expected value.
    pub message: String,
    /// What to do, or the nearest known name.
    pub help: Option<String>,
    /// Another place related to the problem, with the words before it. Both become the help.
    pub elsewhere: Option<(String, At)>,
    /// What was expected, for programs; the message contains it, too.
    pub expected: Option<String>,
    /// The found value, for programs, if the message compares it with the expected one.
    pub found: Option<String>,
    /// The nearest known name, for programs; the help contains it, too.
    pub nearest: Option<String>,
    /// Key that equal problems in several lines share. With `None`, the message is the key.
    pub same: Option<String>,
    /// Names of data, one of which is probably wrong. Empty if the underlined text is wrong.
    pub data: Vec<String>,
}

impl Problem {
    const fn new(severity: Severity, code: &'static str, at: Option<At>, message: String) -> Self {
        Self {
            severity,
            code,
            at,
            entry: None,
            message,
            help: None,
            elsewhere: None,
            expected: None,
            found: None,
            nearest: None,
            same: None,
            data: Vec::new(),
        }
    }

    /// An error of a TOML entry, with its complete message.
    #[must_use]
    pub fn of_entry(code: &'static str, entry: &str, message: String) -> Self {
        Self { entry: Some(entry.to_owned()), ..Self::new(Severity::Error, code, None, message) }
    }

    /// An error of a TOML entry, from the expected and the found value.
    #[must_use]
    pub fn unlike(code: &'static str, entry: &str, expected: impl Display, found: impl Display) -> Self {
        let (expected, found) = (expected.to_string(), found.to_string());
        let message = format!("{entry}: expected {expected}, found {found}");
        Self { expected: Some(expected), found: Some(found), ..Self::of_entry(code, entry, message) }
    }

    /// Adds the nearest of the known names, if one is similar.
    #[must_use]
    pub fn near(mut self, wanted: &str, known: &[&str]) -> Self {
        if let Some(name) = nearest(wanted, known.iter().copied()) {
            self.set_nearest("one", name);
        }
        self
    }

    fn set_nearest(&mut self, what: &str, name: &str) {
        self.help = Some(format!("the nearest {what} is {name}"));
        self.nearest = Some(name.to_owned());
    }
}

/// A list of problems, filled while forms are read and checked.
#[derive(Clone, Debug, Default)]
pub struct Problems {
    pub(super) list: Vec<Problem>,
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self { list: vec![problem] }
    }
}

impl Extend<Problem> for Problems {
    fn extend<I: IntoIterator<Item = Problem>>(&mut self, problems: I) {
        self.list.extend(problems);
    }
}

impl Problems {
    /// Adds a problem.
    pub fn add(&mut self, problem: Problem) {
        self.list.push(problem);
    }

    /// All problems.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Problem> {
        self.list.iter_mut()
    }

    pub(crate) fn place_entries(&mut self, place: impl Fn(&str) -> At) {
        for problem in self.list.iter_mut().filter(|problem| problem.at.is_none()) {
            problem.at = problem.entry.as_deref().map(&place);
        }
    }

    /// True if there are no problems.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds an error.
    pub fn error(&mut self, code: &'static str, at: At, message: impl Into<String>) {
        self.push(Severity::Error, code, at, message.into(), None);
    }

    /// Adds an error with help.
    pub fn error_help(
        &mut self,
        code: &'static str,
        at: At,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.push(Severity::Error, code, at, message.into(), Some(help.into()));
    }

    /// Adds an error for something that is already defined at `first`.
    pub fn duplicate(&mut self, at: At, message: impl Into<String>, first: At) {
        self.error("duplicate", at, message);
        self.elsewhere("the first is in", first);
    }

    /// Adds another place related to the last problem; it becomes the help.
    pub fn elsewhere(&mut self, before: impl Into<String>, at: At) {
        if let Some(last) = self.list.last_mut() {
            last.elsewhere = Some((before.into(), at));
        }
    }

    /// Adds a warning.
    pub fn warning(&mut self, code: &'static str, at: At, message: impl Into<String>, help: Option<String>) {
        self.push(Severity::Warning, code, at, message.into(), help);
    }

    /// Adds a problem, with optional help.
    pub fn push(
        &mut self,
        severity: Severity,
        code: &'static str,
        at: At,
        message: String,
        help: Option<String>,
    ) {
        self.list.push(Problem { help, ..Problem::new(severity, code, Some(at), message) });
    }

    /// Moves all problems of another list to the end of this one.
    pub fn append(&mut self, others: &mut Self) {
        self.list.append(&mut others.list);
    }

    /// Sets the help of the last problem.
    pub fn help(&mut self, help: String) {
        if let Some(last) = self.list.last_mut() {
            last.help = Some(help);
        }
    }

    /// Adds text to the help of a problem with this code and place.
    pub fn add_help(&mut self, code: &str, at: At, more: &str) {
        let noted = self.list.iter_mut().find(|problem| problem.code == code && problem.at == Some(at));
        if let Some(problem) = noted {
            problem.help = Some(match problem.help.take() {
                Some(help) => format!("{help}; {more}"),
                None => more.to_owned(),
            });
        }
    }

    /// Sets the key that the last problem shares with equal ones.
    pub fn same_as(&mut self, key: String) {
        if let Some(last) = self.list.last_mut() {
            last.same = Some(key);
        }
    }

    /// Sets the names of the data, one of which is probably the cause of the last problem.
    pub fn about(&mut self, data: Vec<String>) {
        if let Some(last) = self.list.last_mut() {
            last.data = data;
        }
    }

    /// Sets the expected value of the last problem.
    pub fn expected(&mut self, what: impl Into<String>) {
        if let Some(last) = self.list.last_mut() {
            last.expected = Some(what.into());
        }
    }

    /// Sets the name nearest to that of the last problem; `what` is its kind. It becomes the help, too.
    pub fn nearest(&mut self, what: &str, name: &str) {
        if let Some(last) = self.list.last_mut() {
            last.set_nearest(what, name);
        }
    }

    /// Adds an error without a place in a text.
    pub fn general(&mut self, code: &'static str, message: String) {
        self.list.push(Problem::new(Severity::Error, code, None, message));
    }

    /// Adds an error of the operating system about a file.
    pub fn unreadable(&mut self, path: &str, error: &std::io::Error) {
        self.general("file", format!("{path} cannot be read: {error}"));
    }

    /// True if the list contains an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|p| p.severity == Severity::Error)
    }
}
