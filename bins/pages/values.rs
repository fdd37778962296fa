//! Values that name data. Completions offer the names of the default directory; the arguments accept other names, too.

use std::{
    ffi::OsStr,
    ops::Deref,
    path::{Path, PathBuf},
};

use clap::{
    Arg, Args, Command, Error,
    builder::{NonEmptyStringValueParser, PathBufValueParser, PossibleValue, TypedValueParser},
};
use diagnostics::{FAULTS, JOBS, NamedFiles, ROBOTS};

use crate::shipped;

const CELL: &str = "cell.toml";

#[must_use]
pub fn default_data() -> PathBuf {
    let name = PathBuf::from(shipped::default_data());
    shipped::data_directory(&name).unwrap_or(name)
}

/// The option `--data` with its default, flattened into the arguments of each command that needs data.
#[derive(Clone, Debug, Args)]
pub struct DataArgument {
    /// Directory with task data, cell.toml, jobs, faults and robots [default: data; if there is none: built-in,
    /// the data of the program]
    #[arg(
        long,
        value_name = "DIR",
        default_value = shipped::default_data(),
        hide_default_value = true,
        value_parser = data_directory()
    )]
    pub data: PathBuf,
}

impl Deref for DataArgument {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.data
    }
}

impl From<PathBuf> for DataArgument {
    fn from(data: PathBuf) -> Self {
        Self { data }
    }
}

/// An existing directory, or `built-in`.
#[must_use]
pub fn data_directory() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|named| {
        let built_in = shipped::BUILT_IN;
        let none = || {
            let named = named.display();
            format!("there is no task data directory {named}; {built_in} names the data of the program")
        };
        let directory = shipped::data_directory(&named).ok_or_else(none)?;
        let inside = named.join("data");
        if !named.join(CELL).is_file() && inside.join(CELL).is_file() {
            let (named, inside) = (named.display(), inside.display());
            return Err(format!("{named} has no {CELL}, {inside} has one: name {inside}"));
        }
        Ok(directory)
    })
}

/// The name or path of a file, or else the path of a built-in one.
#[must_use]
pub fn fault_file() -> impl TypedValueParser<Value = PathBuf> {
    with_names(PathBufValueParser::new().map(shipped::resolve), || names(&FAULTS))
}

#[must_use]
pub fn job() -> impl TypedValueParser<Value = String> {
    with_names(NonEmptyStringValueParser::new(), || names(&JOBS))
}

#[must_use]
pub fn robot() -> impl TypedValueParser<Value = String> {
    with_names(NonEmptyStringValueParser::new(), || names(&ROBOTS))
}

#[must_use]
pub fn names(kind: &NamedFiles) -> Vec<String> {
    kind.names(&default_data())
}

#[must_use]
pub fn with_names<P: TypedValueParser>(
    parser: P,
    names: fn() -> Vec<String>,
) -> impl TypedValueParser<Value = P::Value> {
    WithNames { parser, names }
}

#[derive(Clone)]
struct WithNames<P> {
    parser: P,
    names: fn() -> Vec<String>,
}

impl<P: TypedValueParser> TypedValueParser for WithNames<P> {
    type Value = P::Value;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<Self::Value, Error> {
        self.parser.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.names)().into_iter().map(PossibleValue::new)))
    }
}
