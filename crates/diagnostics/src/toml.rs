//! Reads TOML into structures, such as a cell description, and finds at once everything in it that does not fit.
//!
//! The structures derive serde's `Deserialize`, which gives up at the first value that does not fit. This
//! deserializer does not let it: a value of another kind is noted with its place and replaced by one that
//! fits, a *stand-in*, and an unknown key is noted and left out. That a key is missing is known only when the
//! structure says so, since it may have a default; then reading begins anew with a stand-in for that key.
//! What was read with stand-ins is never used; it only lets the numbers of all other entries be checked in
//! the same go.

use std::{cell::RefCell, collections::BTreeSet, fmt, fmt::Display, ops::Range};

use serde::{
    Deserialize,
    de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor, value::StrDeserializer},
    forward_to_deserialize_any,
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::{At, Diagnostics, Problem, Problems, Source, nearest};

/// The way to an entry: `gripper.parts.body[0]`.
pub type Path = String;

/// The way to a key of a table.
#[must_use]
pub fn join(path: &str, key: &str) -> Path {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The way to an element of an array.
#[must_use]
pub fn element(path: &str, index: usize) -> Path {
    format!("{path}[{index}]")
}

/// What messages call the whole of a kind of file, the codes of its problems, and the numbers that it may have.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// The whole, as a message says it: `the description`.
    pub whole: &'static str,
    /// Code of what is no TOML.
    pub syntax: &'static str,
    /// Code of a key that there is not.
    pub key: &'static str,
    /// Code of a key that is missing.
    pub missing: &'static str,
    /// Code of a value that does not fit.
    pub value: &'static str,
    /// Smallest and largest magnitude of a number that is not 0.
    pub magnitudes: [f64; 2],
}

/// A text with its tables.
pub struct Document<'a> {
    source: &'a Source,
    root: Spanned<DeTable<'a>>,
    kind: FileKind,
}

/// Entries whose values do not come from the text.
#[derive(Clone, Debug, Default)]
pub struct StandIns(BTreeSet<Path>);

impl StandIns {
    /// What stands at a path is what the text says: neither it, nor a part of it, nor what it is a part of has a
    /// stand-in.
    #[must_use]
    pub fn trusts(&self, path: &str) -> bool {
        let holds = |whole: &str, part: &str| {
            part.strip_prefix(whole).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        !self.0.iter().any(|stand_in| holds(stand_in, path) || holds(path, stand_in))
    }

    /// The ways to the entries.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }
}

/// What was read.
pub struct Reading<T> {
    /// The structure; `None` if not even stand-ins make one.
    pub value: Option<T>,
    /// What did not fit.
    pub problems: Problems,
    /// The entries that have stand-ins.
    pub stand_ins: StandIns,
}

impl<'a> Document<'a> {
    /// Take a text apart; also what is wrong with it as TOML.
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

    /// Read a structure from a text that is TOML, and check its values: `check` gets the structure and the entries
    /// that have stand-ins, and adds what it finds to the problems.
    ///
    /// # Errors
    /// All problems of the text.
    pub fn load<T: serde::de::DeserializeOwned>(
        source: &Source,
        kind: FileKind,
        check: impl FnOnce(&T, &StandIns, &mut Problems),
    ) -> Result<T, Diagnostics> {
        let (document, mut problems) = Document::parse(source, kind);
        // What stands behind a place that is no TOML may be anything.
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

    /// The bytes of an entry: of its value if that stands on one place, else of its key, else those of the
    /// nearest table around it.
    #[must_use]
    pub fn place(&self, path: &str) -> At {
        at(&self.source.text, self.bytes(path))
    }

    fn bytes(&self, path: &str) -> Range<usize> {
        let mut at = 0..0;
        let mut table = Some(self.root.get_ref());
        for step in path.split('.') {
            let (key, indices) = step.split_once('[').unwrap_or((step, ""));
            let Some((name, found)) = table.and_then(|table| table.get_key_value(key)) else { break };
            let mut value = Some(found);
            at = if is_in_one_place(found.get_ref()) { found.span() } else { name.span() };
            for index in indices.split('[').filter_map(|index| index.trim_end_matches(']').parse().ok()) {
                let index: usize = index;
                value = value.and_then(|value| value.get_ref().get(index));
                at = value.map_or(at, Spanned::span);
            }
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
            let (problems, stand_ins) = (problems.into_inner(), StandIns(stand_ins.into_inner()));
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

/// A value that is not spread over tables with headers of their own.
fn is_in_one_place(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Table(_) => false,
        DeValue::Array(array) => array.iter().all(|one| !one.get_ref().is_table()),
        _ => true,
    }
}

/// Why a structure could not be built.
#[derive(Debug)]
enum Stop {
    /// A key is missing; the caller adds of which table.
    Field(&'static str),
    /// A key is missing, by its whole way.
    Missing(Path),
    /// Something else.
    Other(String),
}

impl Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Field(what) => write!(f, "{what} is missing"),
            Self::Missing(what) => write!(f, "{what} is missing"),
            Self::Other(what) => f.write_str(what),
        }
    }
}

impl std::error::Error for Stop {}

impl de::Error for Stop {
    fn custom<T: Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }

    fn missing_field(field: &'static str) -> Self {
        Self::Field(field)
    }
}

/// What is noted on one way through the text.
struct Notes<'n> {
    text: &'n str,
    kind: FileKind,
    missing: &'n BTreeSet<Path>,
    problems: RefCell<Problems>,
    stand_ins: RefCell<BTreeSet<Path>>,
}

impl Notes<'_> {
    /// An entry that is not used, since something is wrong with it.
    fn unusable(&self, path: &str, problem: Problem) {
        self.stand_ins.borrow_mut().insert(path.to_owned());
        self.problems.borrow_mut().add(problem);
    }
}

/// A place in the text.
#[derive(Clone, Copy)]
enum Node<'a> {
    /// The whole text.
    Table(&'a DeTable<'a>),
    /// A value.
    Value(&'a DeValue<'a>),
    /// Nothing is there; something that fits is given.
    StandIn,
}

/// Reads one entry.
struct Reader<'n, 'a> {
    notes: &'n Notes<'n>,
    node: Node<'a>,
    path: Path,
}

impl<'n, 'a> Reader<'n, 'a> {
    fn value(&self) -> Option<&'a DeValue<'a>> {
        match self.node {
            Node::Value(value) => Some(value),
            Node::Table(_) | Node::StandIn => None,
        }
    }

    fn table(&self) -> Option<&'a DeTable<'a>> {
        match self.node {
            Node::Table(table) => Some(table),
            Node::Value(value) => value.as_table(),
            Node::StandIn => None,
        }
    }

    fn array(&self) -> Option<&'a [Spanned<DeValue<'a>>]> {
        self.value()?.as_array().map(|array| &array[..])
    }

    /// Note that something else was expected, unless nothing is there anyway.
    fn unfit(&self, expected: impl Display, known: &[&str]) {
        let found = match self.node {
            Node::Value(value) => said(value),
            Node::Table(_) => "a table".to_owned(),
            Node::StandIn => return,
        };
        let wanted = self.value().and_then(DeValue::as_str).unwrap_or_default();
        let problem = Problem::unlike(self.notes.kind.value, &self.path, expected, found);
        self.notes.unusable(&self.path, problem.near(wanted, known));
    }

    /// The table, as a message calls it.
    fn whose(&self) -> &str {
        if self.path.is_empty() { self.notes.kind.whole } else { &self.path }
    }

    /// A whole number of a type, or 1 in its place.
    fn whole<T: TryFrom<i64> + Default>(&self, low: impl Display, high: impl Display) -> T {
        let number = match self.value() {
            Some(DeValue::Integer(number)) => i64::from_str_radix(number.as_str(), number.radix()).ok(),
            _ => None,
        };
        number.and_then(|number| T::try_from(number).ok()).unwrap_or_else(|| {
            self.unfit(format_args!("a whole number from {low} to {high}"), &[]);
            T::try_from(1).unwrap_or_default()
        })
    }

    fn number(&self) -> f64 {
        let number = match self.value() {
            Some(DeValue::Integer(number)) if number.radix() == 10 => number.as_str().parse().ok(),
            Some(DeValue::Float(number)) => number.as_str().parse().ok(),
            _ => None,
        };
        let Some(number) = number.filter(|number: &f64| number.is_finite()) else {
            self.unfit("a number", &[]);
            return 1.0;
        };
        let [smallest, largest] = self.notes.kind.magnitudes;
        if number == 0.0 || (smallest..=largest).contains(&number.abs()) {
            return number;
        }
        self.unfit(self.notes.kind.any_number(), &[]);
        1.0
    }

    fn text(&self) -> &'a str {
        let text = self.value().and_then(DeValue::as_str);
        text.unwrap_or_else(|| {
            self.unfit("a text in quotes", &[]);
            STAND_IN
        })
    }

    fn at(&self, key: &str, node: Node<'a>) -> Self {
        Self { notes: self.notes, node, path: join(&self.path, key) }
    }

    fn elements(self, array: &'a [Spanned<DeValue<'a>>], length: usize) -> Elements<'n, 'a> {
        Elements { reader: self, array, next: 0, length }
    }

    /// Note the keys of a table that its structure does not have.
    fn unknown(&self, table: &DeTable<'_>, fields: &[&str]) {
        for (key, _) in table.iter().filter(|(key, _)| !fields.contains(&key.get_ref().as_ref())) {
            let name = key.get_ref();
            let expected = format!("one of {}", fields.join(", "));
            let message = format!("{} has no key {name}; expected {expected}", self.whose());
            let problem =
                Problem::of_entry(self.notes.kind.key, &join(&self.path, name), message).near(name, fields);
            self.notes.problems.borrow_mut().add(Problem {
                at: Some(at(self.notes.text, key.span())),
                expected: Some(expected),
                found: Some(name.to_string()),
                ..problem
            });
        }
    }

    /// The entries of a structure: its keys that are there, and stand-ins for those that must be and are not.
    fn entries(&self, fields: &'static [&'static str]) -> Vec<(&'static str, Node<'a>)> {
        let Some(table) = self.table() else {
            self.unfit("a table", &[]);
            return fields.iter().map(|field| (*field, Node::StandIn)).collect();
        };
        self.unknown(table, fields);
        let there =
            |field: &&'static str| table.get(*field).map(|value| (*field, Node::Value(value.get_ref())));
        let mut entries: Vec<_> = fields.iter().filter_map(there).collect();
        for field in fields {
            let path = join(&self.path, field);
            if !self.notes.missing.contains(&path) {
                continue;
            }
            entries.push((field, Node::StandIn));
            // A key that is misspelt is not missing too.
            let misspelt = table.keys().any(|key| {
                let name = key.get_ref();
                !fields.contains(&name.as_ref()) && nearest(name, fields.iter().copied()) == Some(*field)
            });
            if misspelt {
                self.notes.stand_ins.borrow_mut().insert(path);
            } else {
                let message = format!("{} has no key {field}, which it needs", self.whose());
                self.notes.unusable(&path, Problem::of_entry(self.notes.kind.missing, &path, message));
            }
        }
        entries
    }
}

impl FileKind {
    /// What is expected of a number of either sign.
    fn any_number(&self) -> String {
        let [smallest, largest] = self.magnitudes;
        if smallest == 0.0 {
            return format!("a number from -{largest} to {largest}");
        }
        format!("0, or a number from {smallest} to {largest} or from -{largest} to -{smallest}")
    }

    /// Say of numbers of a wrong magnitude that they must be more than 0, where that holds of their entries.
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

/// Some bytes of a text. What goes over several lines is underlined in the first.
fn at(text: &str, bytes: Range<usize>) -> At {
    let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    let start = (0..=bytes.start.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    At { source: 0, start: small(start), length: small(bytes.end.clamp(start, line_end) - start) }
}

/// The text of a stand-in.
const STAND_IN: &str = "?";

/// A value as a message says it.
fn said(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(value) => value.to_string(),
        DeValue::Array(array) => format!("an array of {}", array.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

macro_rules! whole_numbers {
    ($($method:ident, $visit:ident, $number:ty;)+) => { $(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
            visitor.$visit(self.whole::<$number>(<$number>::MIN, <$number>::MAX))
        }
    )+ };
}

impl<'de> de::Deserializer<'de> for Reader<'_, 'de> {
    type Error = Stop;

    whole_numbers! {
        deserialize_u8, visit_u8, u8;
        deserialize_u16, visit_u16, u16;
        deserialize_u32, visit_u32, u32;
        deserialize_u64, visit_u64, u64;
        deserialize_i8, visit_i8, i8;
        deserialize_i16, visit_i16, i16;
        deserialize_i32, visit_i32, i32;
        deserialize_i64, visit_i64, i64;
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_f64(self.number())
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        let value = self.value().and_then(DeValue::as_bool);
        if value.is_none() {
            self.unfit("true or false", &[]);
        }
        visitor.visit_bool(value.unwrap_or_default())
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_str(self.text())
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_str(self.text())
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        match self.node {
            Node::StandIn => visitor.visit_none(),
            Node::Value(_) | Node::Table(_) => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        let array = self.array().unwrap_or_else(|| {
            self.unfit("an array", &[]);
            &[]
        });
        visitor.visit_seq(self.elements(array, array.len()))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Stop> {
        let array = self.array().unwrap_or_default();
        if array.len() != length {
            self.unfit(format_args!("an array of {length}"), &[]);
        }
        visitor.visit_seq(self.elements(array, length))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let entries = self.entries(fields).into_iter();
        let path = self.path.clone();
        visitor.visit_map(Entries { reader: self, entries, value: None }).map_err(|stop| match stop {
            Stop::Field(field) => Stop::Missing(join(&path, field)),
            stop => stop,
        })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let found = self.value().and_then(DeValue::as_str);
        let word = variants.iter().find(|word| found == Some(**word)).or_else(|| {
            self.unfit(format_args!("one of {}", variants.join(", ")), variants);
            variants.first()
        });
        visitor.visit_enum(StrDeserializer::new(word.copied().unwrap_or(STAND_IN)))
    }

    /// An entry that is a whole number or a word.
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        match self.value() {
            Some(DeValue::String(text)) => visitor.visit_str(text),
            Some(DeValue::Integer(_)) => visitor.visit_i64(self.whole(i64::MIN, i64::MAX)),
            _ => {
                self.unfit("a whole number, or a text in quotes", &[]);
                visitor.visit_i64(1)
            }
        }
    }

    forward_to_deserialize_any! {
        i128 u128 f32 char bytes byte_buf unit unit_struct tuple_struct map identifier ignored_any
    }
}

/// The entries of a table.
struct Entries<'n, 'a> {
    reader: Reader<'n, 'a>,
    entries: std::vec::IntoIter<(&'static str, Node<'a>)>,
    value: Option<(&'static str, Node<'a>)>,
}

impl<'a> MapAccess<'a> for Entries<'_, 'a> {
    type Error = Stop;

    fn next_key_seed<K: DeserializeSeed<'a>>(&mut self, seed: K) -> Result<Option<K::Value>, Stop> {
        self.value = self.entries.next();
        let key = self.value.map(|(key, _)| seed.deserialize(StrDeserializer::new(key)));
        key.transpose()
    }

    fn next_value_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<S::Value, Stop> {
        let (key, node) = self.value.take().unwrap_or(("", Node::StandIn));
        seed.deserialize(self.reader.at(key, node))
    }
}

/// The elements of an array, filled up with stand-ins to a length.
struct Elements<'n, 'a> {
    reader: Reader<'n, 'a>,
    array: &'a [Spanned<DeValue<'a>>],
    next: usize,
    length: usize,
}

impl<'a> SeqAccess<'a> for Elements<'_, 'a> {
    type Error = Stop;

    fn next_element_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<Option<S::Value>, Stop> {
        let index = self.next;
        if index >= self.length {
            return Ok(None);
        }
        self.next += 1;
        let node = self.array.get(index).map_or(Node::StandIn, |value| Node::Value(value.get_ref()));
        let path = element(&self.reader.path, index);
        seed.deserialize(Reader { notes: self.reader.notes, node, path }).map(Some)
    }
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
    fn what_is_no_toml_is_told_at_its_line_and_a_missing_key_at_its_table() {
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

    #[test]
    fn a_piece_ends_with_its_line_and_begins_with_a_character() {
        let text = "b = \"\u{e9}\" # x\nc = 3\n";
        let begin = text.find('#').unwrap();
        assert_eq!(at(text, begin..text.len()).length, 3);
        assert_eq!(at(text, 6..8).start, 5);
        assert_eq!(at(text, 400..500).length, 0);
    }
}
