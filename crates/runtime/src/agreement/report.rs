//! What is wrong with a cell description, told as what is wrong with task data is.

use plant::description::{DescriptionError, TextSpan};
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
    let mut problems = Problems::default();
    match error {
        DescriptionError::Faults(faults) => {
            for fault in faults.all() {
                let (message, place) = (fault.message.clone(), fault.place);
                match place {
                    Some(place) => problems.error(fault.code, at(&place), message),
                    None => problems.general(fault.code, message),
                }
                if let Some(expected) = &fault.expected {
                    problems.expected(expected);
                }
                if let Some(nearest) = &fault.nearest {
                    problems.nearest("one", nearest);
                }
            }
        }
        DescriptionError::Unreadable { .. } => problems.general("file", error.to_string()),
    }
    Diagnostics::new(problems, Places::in_lines(&[source(text)]), 0, Vec::new())
}

/// A piece of a file without blocks.
pub(super) fn at(place: &TextSpan) -> At {
    let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    At { source: 0, start: small(place.start), length: small(place.length) }
}
