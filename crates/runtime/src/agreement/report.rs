//! What is wrong with a cell description or a file of faults, told as what is wrong with task data is.

use plant::{
    description::DescriptionError,
    mistake::{Mistakes, TextSpan},
};
use taskdata::load::{Diagnostics, Source, places::Places, report::Problems, source::At};

use crate::setup::CELL;

/// The text of a cell description as a source.
#[must_use]
pub fn source(text: String) -> Source {
    Source { name: CELL.to_owned(), text: text.into() }
}

/// The mistakes in a cell description.
#[must_use]
pub fn cell_report(text: String, error: &DescriptionError) -> Diagnostics {
    match error {
        DescriptionError::Mistakes(mistakes) => toml_report(source(text), mistakes),
        DescriptionError::Unreadable { .. } => {
            let mut problems = Problems::default();
            problems.general("file", error.to_string());
            Diagnostics::new(problems, Places::in_lines(&[source(text)]), 0, Vec::new())
        }
    }
}

/// The mistakes in a file of TOML.
#[must_use]
pub fn toml_report(source: Source, mistakes: &Mistakes) -> Diagnostics {
    let mut problems = Problems::default();
    for mistake in mistakes.all() {
        let message = mistake.message.clone();
        match &mistake.place {
            Some(place) => problems.error(mistake.code, at(place), message),
            None => problems.general(mistake.code, message),
        }
        if let Some(expected) = &mistake.expected {
            problems.expected(expected);
        }
        if let Some(nearest) = &mistake.nearest {
            problems.nearest("one", nearest);
        }
    }
    Diagnostics::new(problems, Places::in_lines(&[source]), 0, Vec::new())
}

/// A piece of a file without blocks.
pub(super) fn at(place: &TextSpan) -> At {
    let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    At { source: 0, start: small(place.start), length: small(place.length) }
}
