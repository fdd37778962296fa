//! Errors of task data that are used nevertheless, and the commands that each error concerns.
//!
//! The error of a record concerns the commands that use the record. Any other error may have removed entries of its
//! block. If the block names objects, the error concerns the commands for these objects. Otherwise it concerns the
//! commands that use names or records of the block. If no name of the block is known, it concerns all commands that
//! use task data.

use diagnostics::{At, Diagnostic, Source};
use interfaces::HwsCommand;
use rcs_core::name::Name16;

use super::{Store, source::blocks, verdict::is_bare};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    pub place: String,
    pub message: String, // finding and expectation, in one sentence
    scope: Scope,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Scope {
    Record(At),           // that use the record entered here
    Objects(Vec<String>), // for one of these objects
    Names(Vec<String>),   // that use one of these names
    Any,
}

impl Fault {
    #[must_use]
    pub const fn of_record(at: At, place: String, message: String) -> Self {
        Self { place, message, scope: Scope::Record(at) }
    }

    #[must_use]
    pub fn found(diagnostic: &Diagnostic, store: &Store) -> Self {
        let scope = diagnostic.at().map_or(Scope::Any, |at| {
            if store.origins.contain(at) {
                return Scope::Record(at);
            }
            let names = nearby_names(at, &store.sources);
            let is_object = |name: &String| {
                Name16::new(name).is_ok_and(|name| store.view().object_named(&name).is_some())
            };
            let objects: Vec<String> = names.iter().filter(|name| is_object(name)).cloned().collect();
            match (objects.is_empty(), names.is_empty()) {
                (false, _) => Scope::Objects(objects),
                (true, false) => Scope::Names(names),
                (true, true) => Scope::Any,
            }
        });
        Self { place: diagnostic.place(), message: diagnostic.message().to_owned(), scope }
    }

    pub(super) fn is_same(&self, other: &Self) -> bool {
        (&self.place, &self.message) == (&other.place, &other.message)
    }

    #[must_use]
    pub fn in_line(&self) -> String {
        let colon = if self.place.is_empty() { "" } else { ": " };
        format!("{}{colon}{}", self.place, self.message)
    }
}

impl Store {
    /// The errors that concern a command; `used` has the places of its records.
    #[must_use]
    pub fn faults_of(&self, command: &HwsCommand, used: &[At]) -> Vec<&Fault> {
        if self.faults().next().is_none() || is_bare(command) {
            return Vec::new();
        }
        let named = [command.object, command.source, command.destination, command.end_at];
        let mut names: Vec<String> = named.into_iter().flatten().map(|name| name.to_string()).collect();
        for at in used {
            names.extend(line_at(*at, &self.sources).into_iter().flat_map(names_in));
        }
        let concerns = |fault: &&Fault| match &fault.scope {
            Scope::Record(at) => used.contains(at),
            Scope::Objects(objects) => {
                command.object.is_some_and(|object| objects.iter().any(|name| name == object.as_str()))
            }
            Scope::Names(others) => others.iter().any(|other| names.contains(other)),
            Scope::Any => true,
        };
        self.faults().filter(concerns).collect()
    }

    pub fn faults(&self) -> impl Iterator<Item = &Fault> {
        self.faults.iter().chain(&self.found)
    }

    pub fn add_faults(&mut self, faults: impl IntoIterator<Item = Fault>) {
        self.found.extend(faults);
    }
}

fn line_at(at: At, sources: &[Source]) -> Option<&str> {
    let source = sources.get(usize::try_from(at.source).ok()?)?;
    let start = usize::try_from(at.start).ok()?;
    let begin = source.text.get(..start)?.rfind('\n').map_or(0, |before| before + 1);
    source.text.get(begin..)?.lines().next()
}

fn nearby_names(at: At, sources: &[Source]) -> Vec<String> {
    let index = usize::try_from(at.source).unwrap_or(usize::MAX);
    let Some(source) = sources.get(index) else { return Vec::new() };
    let (found, _) = blocks(index, source);
    let Some(block) = found.iter().rfind(|block| block.header.start <= at.start) else { return Vec::new() };
    block.lines.iter().flat_map(|line| names_in(line.text)).collect()
}

fn names_in(line: &str) -> impl Iterator<Item = String> + use<'_> {
    let is_name = |word: &&str| word.bytes().any(|byte| byte.is_ascii_uppercase());
    line.split_whitespace().filter(is_name).map(str::to_owned)
}
