//! The deserializer that continues after an error: it records a wrong value and returns a stand-in.

use std::{
    cell::RefCell,
    collections::BTreeSet,
    fmt::{self, Display},
};

use serde::{
    de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor, value::StrDeserializer},
    forward_to_deserialize_any,
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{FileKind, Path, at, element, join};
use crate::{Problem, Problems, nearest};

#[derive(Debug)]
pub(super) enum Stop {
    Field(&'static str), // missing; the caller adds the path of its table
    Missing(Path),       // missing: the whole path
    Other(String),       // as text
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

pub(super) struct Notes<'n> {
    pub(super) text: &'n str,
    pub(super) kind: FileKind,
    pub(super) missing: &'n BTreeSet<Path>,
    pub(super) problems: RefCell<Problems>,
    pub(super) stand_ins: RefCell<BTreeSet<Path>>,
}

impl Notes<'_> {
    /// The entry has an error and is not used.
    fn unusable(&self, path: &str, problem: Problem) {
        self.stand_ins.borrow_mut().insert(path.to_owned());
        self.problems.borrow_mut().add(problem);
    }
}

#[derive(Clone, Copy)]
pub(super) enum Node<'a> {
    Table(&'a DeTable<'a>),
    Value(&'a DeValue<'a>),
    StandIn, // no entry: any value of the right type
}

pub(super) struct Reader<'n, 'a> {
    pub(super) notes: &'n Notes<'n>,
    pub(super) node: Node<'a>,
    pub(super) path: Path,
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

    /// Unless the entry is a stand-in.
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

    fn whose(&self) -> &str {
        if self.path.is_empty() { self.notes.kind.whole } else { &self.path }
    }

    /// The whole number, or 1 if the entry is not one in range.
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
            PLACEHOLDER
        })
    }

    fn at(&self, key: &str, node: Node<'a>) -> Self {
        Self { notes: self.notes, node, path: join(&self.path, key) }
    }

    fn elements(self, array: &'a [Spanned<DeValue<'a>>], length: usize) -> Elements<'n, 'a> {
        Elements { reader: self, array, next: 0, length }
    }

    /// Reports keys that the structure does not have.
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

    /// The existing keys, and stand-ins for missing keys that the structure needs.
    fn entries(&self, fields: &'static [&'static str]) -> Vec<(&'a str, Node<'a>)> {
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
            // A misspelt key is not also reported as missing.
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

const PLACEHOLDER: &str = "?";

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

    /// The keys of a map are names, so every key is accepted.
    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        let entries: Vec<_> = match self.table() {
            Some(table) => {
                table.iter().map(|(key, value)| (&**key.get_ref(), Node::Value(value.get_ref()))).collect()
            }
            None => {
                self.unfit("a table", &[]);
                Vec::new()
            }
        };
        visitor.visit_map(Entries { reader: self, entries: entries.into_iter(), value: None })
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
        visitor.visit_enum(StrDeserializer::new(word.copied().unwrap_or(PLACEHOLDER)))
    }

    /// A whole number or a text.
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
        i128 u128 f32 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

struct Entries<'n, 'a> {
    reader: Reader<'n, 'a>,
    entries: std::vec::IntoIter<(&'a str, Node<'a>)>,
    value: Option<(&'a str, Node<'a>)>,
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

/// The elements of an array, with stand-ins up to a length.
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
