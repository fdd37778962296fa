//! Reads TOML into structures, such as a cell description, and reports all its errors at once.
//!
//! The structures derive serde's `Deserialize`, which stops at the first error. This deserializer reports a wrong
//! value with its place, replaces it by one of the right type, a *stand-in*, and continues; it reports and omits an
//! unknown key. Only the structure determines whether it needs a missing key. Reading then starts again with a stand-in
//! for the key. Values read with stand-ins are never used; they allow all other entries to be checked in the same pass.

mod reader;

use std::{cell::RefCell, collections::BTreeSet, ops::Range};

use serde::{Deserialize, de::DeserializeOwned};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use self::reader::{Node, Notes, Reader, Stop};
use crate::{At, Diagnostics, Problem, Problems, Source};

/// The path of an entry: `gripper.parts.body[0]`.
pub type Path = String;

/// The path of a key of a table.
#[must_use]
pub fn join(path: &str, key: &str) -> Path {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The path of an array element.
#[must_use]
pub fn element(path: &str, index: usize) -> Path {
    format!("{path}[{index}]")
}

/// A kind of file: its name in messages, the codes of its problems, and the range of its numbers.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// Name of the whole file in messages: `the description`.
    pub whole: &'static str,
    /// Code of a syntax error.
    pub syntax: &'static str,
    /// Code of an unknown key.
    pub key: &'static str,
    /// Code of a key that is missing.
    pub missing: &'static str,
    /// Code of a wrong value.
    pub value: &'static str,
    /// Smallest and largest absolute value of a number that is not 0.
    pub magnitudes: [f64; 2],
}

/// A text and the tables parsed from it.
pub struct Document<'a> {
    source: &'a Source,
    root: Spanned<DeTable<'a>>,
    kind: FileKind,
}

/// Paths of the entries that have stand-ins.
#[derive(Clone, Debug, Default)]
pub struct Defaulted(BTreeSet<Path>);

impl Defaulted {
    /// True if neither the value at a path, nor a part of it, nor an entry around it has a stand-in.
    #[must_use]
    pub fn trusts(&self, path: &str) -> bool {
        let holds = |whole: &str, part: &str| {
            part.strip_prefix(whole).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        !self.0.iter().any(|stand_in| holds(stand_in, path) || holds(path, stand_in))
    }

    /// The paths of the entries.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }
}

/// Result of reading.
pub struct Reading<T> {
    /// The structure; `None` if it cannot be built even with stand-ins.
    pub value: Option<T>,
    /// The problems found.
    pub problems: Problems,
    /// The entries that have stand-ins.
    pub stand_ins: Defaulted,
}

impl<'a> Document<'a> {
    /// Parse a text; also returns its syntax errors.
    #[must_use]
    pub fn parse(source: &'a Source, kind: FileKind) -> (Self, Problems) {
        let (root, errors) = DeTable::parse_recoverable(&source.text);
        let mut problems = Problems::default();
        for error in errors {
            let message = format!("this is not TOML: {}", error.message().replace('\n', ", "));
            let at = at(&source.text, error.span().unwrap_or(0..0));
            problems.error(kind.syntax, at, message);
        }
        (Self { source, root, kind }, problems)
    }

    /// Reads a structure. `check` gets it with the stand-ins, and adds problems. Fails with all problems.
    pub fn load<T: DeserializeOwned>(
        source: &Source,
        kind: FileKind,
        check: impl FnOnce(&T, &Defaulted, &mut Problems),
    ) -> Result<T, Diagnostics> {
        let (document, mut problems) = Document::parse(source, kind);
        // After a syntax error the tables are not reliable.
        if !problems.is_empty() {
            return Err(document.report(problems));
        }
        let reading = document.read::<T>();
        problems = reading.problems;
        if let Some(value) = &reading.value {
            check(value, &reading.stand_ins, &mut problems);
        }
        match reading.value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => Err(document.report(problems)),
        }
    }

    /// The place of a value; of its key, if the value has several places; or of the nearest existing table.
    #[must_use]
    pub fn place(&self, path: &str) -> At {
        at(&self.source.text, self.bytes(path))
    }

    fn bytes(&self, path: &str) -> Range<usize> {
        let mut at = 0..0;
        let (mut table, mut rest) = (Some(self.root.get_ref()), path);
        while let Some((name, found)) = table.and_then(|table| first_key(table, rest)) {
            rest = rest.get(name.get_ref().len()..).unwrap_or_default();
            let mut value = Some(found);
            at = if is_in_one_place(found.get_ref()) { found.span() } else { name.span() };
            while let Some((index, after)) = rest.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
                let element = index.parse().ok().and_then(|index: usize| value?.get_ref().get(index));
                at = element.map_or(at, Spanned::span);
                (value, rest) = (element, after);
            }
            rest = rest.strip_prefix('.').unwrap_or_default();
            table = value.and_then(|value| value.get_ref().as_table());
        }
        at
    }

    /// The problems with their places, in the order of the text.
    #[must_use]
    pub fn report(&self, mut problems: Problems) -> Diagnostics {
        problems.place_entries(|entry| self.place(entry));
        Diagnostics::of_file(problems, self.source)
    }

    /// Read a structure.
    #[must_use]
    pub fn read<'s, T: Deserialize<'s>>(&'s self) -> Reading<T>
    where
        'a: 's,
    {
        let mut missing = BTreeSet::new();
        loop {
            let notes = Notes {
                text: &self.source.text,
                kind: self.kind,
                missing: &missing,
                problems: RefCell::default(),
                stand_ins: RefCell::default(),
            };
            let result = T::deserialize(Reader {
                notes: &notes,
                node: Node::Table(self.root.get_ref()),
                path: String::new(),
            });
            let Notes { problems, stand_ins, .. } = notes;
            let (problems, stand_ins) = (problems.into_inner(), Defaulted(stand_ins.into_inner()));
            match result {
                Err(Stop::Missing(path)) if !missing.contains(&path) => {
                    missing.insert(path);
                }
                Err(stop) if problems.is_empty() => {
                    let problems = Problem::of_entry(self.kind.value, "", stop.to_string()).into();
                    return Reading { value: None, problems, stand_ins };
                }
                result => return Reading { value: result.ok(), problems, stand_ins },
            }
        }
    }
}

/// The first key of a path, with its value. A key in quotes can contain dots, so the longest key that fits is used.
fn first_key<'t, 'a>(
    table: &'t DeTable<'a>,
    path: &str,
) -> Option<(&'t Spanned<std::borrow::Cow<'a, str>>, &'t Spanned<DeValue<'a>>)> {
    let fits = |key: &str| {
        path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    let fitting = table.iter().filter(|(key, _)| fits(key.get_ref()));
    fitting.max_by_key(|(key, _)| key.get_ref().len())
}

/// False for tables and arrays of tables, which can be spread over the text.
fn is_in_one_place(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Table(_) => false,
        DeValue::Array(array) => array.iter().all(|one| !one.get_ref().is_table()),
        _ => true,
    }
}

impl FileKind {
    fn any_number(&self) -> String {
        let [smallest, largest] = self.magnitudes;
        if smallest == 0.0 {
            return format!("a number from -{largest} to {largest}");
        }
        format!("0, or a number from {smallest} to {largest} or from -{largest} to -{smallest}")
    }

    /// In problems with numbers out of range, state only the positive range for entries in `positive`.
    pub fn above_zero(&self, positive: &BTreeSet<Path>, problems: &mut Problems) {
        let [smallest, largest] = self.magnitudes;
        for problem in problems.iter_mut() {
            let (Some(entry), Some(found)) = (&problem.entry, &problem.found) else { continue };
            if positive.contains(entry) && problem.expected.as_ref() == Some(&self.any_number()) {
                let expected = format!("a number from {smallest} to {largest}");
                *problem = Problem::unlike(problem.code, entry, expected, found);
            }
        }
    }
}

/// A range over several lines is cut at the end of its first line.
fn at(text: &str, bytes: Range<usize>) -> At {
    let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    let start = (0..=bytes.start.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    At { source: 0, start: small(start), length: small(bytes.end.clamp(start, line_end) - start) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Finding;

    const KIND: FileKind = FileKind {
        whole: "the file",
        syntax: "test.syntax",
        key: "test.key",
        missing: "test.missing",
        value: "test.value",
        magnitudes: [1e-6, 1e5],
    };

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Motor {
        name: String,
        speed: f64,
        #[serde(default)]
        poles: u8,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        motor: Vec<Motor>,
    }

    fn load(text: &str) -> Result<File, Diagnostics> {
        let source = Source { name: "motors.toml".to_owned(), text: text.into() };
        Document::load(&source, KIND, |file: &File, stand_ins, problems| {
            for (index, motor) in file.motor.iter().enumerate() {
                let path = join(&element("motor", index), "speed");
                if motor.speed < 0.0 && stand_ins.trusts(&path) {
                    problems.add(Problem::unlike(KIND.value, &path, "0 or more", motor.speed));
                }
            }
        })
    }

    #[test]
    fn all_that_does_not_fit_is_found_in_one_reading_with_its_place() {
        let file = load("[[motor]]\nname = \"a\"\nspeed = 2\n").unwrap();
        assert_eq!((&file.motor[0].name[..], file.motor[0].speed, file.motor[0].poles), ("a", 2.0, 0));
        let text = "[[motor]]\nname = 3\nsped = 1e9\n[[motor]]\nname = \"\u{e9}\"\nspeed = -1\npoles = 256\n";
        let report = load(text).unwrap_err();
        let said: Vec<_> =
            report.diagnostics().iter().map(|one| (one.place(), one.text(), one.message())).collect();
        let place = |line, column| format!("motors.toml: line {line}, column {column}");
        assert_eq!(
            said,
            [
                (place(2, 8), "3", "motor[0].name: expected a text in quotes, found 3"),
                (place(3, 1), "sped", "motor[0] has no key sped; expected one of name, speed, poles"),
                (place(6, 9), "-1", "motor[1].speed: expected 0 or more, found -1"),
                (place(7, 9), "256", "motor[1].poles: expected a whole number from 0 to 255, found 256"),
            ]
        );
        let finding = Finding::from(&report.diagnostics()[1]);
        assert_eq!(finding.nearest.as_deref(), Some("speed"));
        assert_eq!(
            (finding.found.as_deref(), finding.entry.as_deref()),
            (Some("sped"), Some("motor[0].sped"))
        );
    }

    #[test]
    fn invalid_toml_is_reported_at_its_line_and_a_missing_key_at_its_table() {
        let at = |text: &str| load(text).unwrap_err().in_line();
        assert!(
            at("motor = \n").starts_with("motors.toml: line 1, column 9: this is not TOML: "),
            "{}",
            at("motor = \n")
        );
        assert_eq!(
            at("\n[[motor]]\nspeed = 1\n"),
            "motors.toml: line 2, column 1: motor[0] has no key name, which it needs"
        );
        assert_eq!(at(""), "motors.toml: line 1, column 1: the file has no key motor, which it needs");
    }

    #[derive(Debug, Deserialize)]
    struct Named {
        valve: std::collections::BTreeMap<String, Motor>,
    }

    #[test]
    fn table_of_names_is_read_and_a_key_with_dots_has_its_line() {
        let text = "[valve]\n\"a.b\" = { name = \"x\", speed = 1 }\n\"a.c\" = { name = 7, sped = 2 }\na = { name = \"y\", speed = 0 }\n";
        let source = Source { name: "valves.toml".to_owned(), text: text.into() };
        let report = Document::load(&source, KIND, |_: &Named, _, _| {}).unwrap_err();
        let said: Vec<_> =
            report.diagnostics().iter().map(|one| format!("{}: {}", one.place(), one.message())).collect();
        assert_eq!(
            said,
            [
                "valves.toml: line 3, column 18: valve.a.c.name: expected a text in quotes, found 7",
                "valves.toml: line 3, column 21: valve.a.c has no key sped; expected one of name, speed, poles",
            ]
        );
        let source =
            Source { name: "valves.toml".to_owned(), text: text.replace("7, sped", "\"z\", speed").into() };
        let file = Document::load(&source, KIND, |_: &Named, _, _| {}).unwrap();
        assert_eq!(file.valve.keys().collect::<Vec<_>>(), ["a", "a.b", "a.c"]);
    }

    #[test]
    fn a_piece_ends_with_its_line_and_begins_with_a_character() {
        let text = "b = \"\u{e9}\" # x\nc = 3\n";
        let begin = text.find('#').unwrap();
        assert_eq!(at(text, begin..text.len()).length, 3);
        assert_eq!(at(text, 6..8).start, 5);
        assert_eq!(at(text, 400..500).length, 0);
    }
}
