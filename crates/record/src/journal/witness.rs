//! Other files that show whether a run continued after the last entry of its journal (docs/design/resume.md
//! "Heartbeat").

use interfaces::CommonMemory;
use rcs_core::plain::from_bytes;

use super::{
    doubt::RunEnd,
    format::{Contents, Entry, FIRST},
    kept::{kept, knowledge},
    logged::image,
};
use crate::reader::Log;

/// Time between an entry and its write, ms. A later change of the file is not that write.
const WRITTEN: u64 = 10_000;

/// Files beside a journal. Each can show only that the run continued.
#[derive(Clone, Copy, Default)]
pub struct Witnesses<'a> {
    /// The entry of the saved cell.
    pub cell: Option<&'a Entry>,
    /// The log of the run, or of another one.
    pub log: Option<&'a Log>,
    /// Time of the last change of the journal, ms since 1970.
    pub changed: Option<u64>,
}

/// The contents of a journal, with the end of the run as other files show it.
#[must_use]
pub fn judged(contents: Contents, witnesses: &Witnesses<'_>) -> Contents {
    let Contents { newest, sequence, end, .. } = &contents;
    let cell = witnesses.cell.is_some_and(|cell| cell.tick > newest.tick && !cell.knows_as(newest));
    // The first entry of a resumed run is older than its file.
    let is_timed = newest.written != 0 && *sequence > FIRST;
    let changed = witnesses.changed.is_some_and(|at| is_timed && at > newest.written.saturating_add(WRITTEN));
    let continued = cell || changed || witnesses.log.is_some_and(|log| continues(log, newest));
    let end = if *end == RunEnd::Reached && continued { RunEnd::Continued } else { *end };
    Contents { end, ..contents }
}

/// True if a log of the same run has a later image with other knowledge. It is of the same run if it agrees in the tick
/// of the entry.
fn continues(log: &Log, entry: &Entry) -> bool {
    let known = |at| {
        let (found, _) = image(log, at).ok()?;
        let memory: CommonMemory = from_bytes(&found.memory).ok()?;
        Some((found.tick, knowledge(&kept(&memory))))
    };
    let before = knowledge(&entry.memory);
    let is_of_run =
        log.check_layout().is_ok() && known(Some(entry.tick)).is_some_and(|(_, known)| known == before);
    is_of_run && known(None).is_some_and(|(tick, last)| tick > entry.tick && last != before)
}

#[cfg(test)]
mod tests {
    use rcs_core::tick::Tick;

    use super::*;
    use crate::journal::Identity;

    fn contents() -> Contents {
        let newest = Entry { tick: Tick(100), written: 1_000_000, ..Entry::default() };
        Contents { identity: Identity::new(), newest, sequence: 9, end: RunEnd::Reached }
    }

    #[test]
    fn later_cell_with_other_knowledge_shows_that_the_run_continued() {
        let later = Entry { tick: Tick(130), ..contents().newest };
        let end =
            |cell: &Entry| judged(contents(), &Witnesses { cell: Some(cell), ..Witnesses::default() }).end;
        assert_eq!(end(&later), RunEnd::Reached, "nothing has changed");
        let changed = Entry { line: 4, ..later };
        assert_eq!(end(&changed), RunEnd::Continued);
        assert_eq!(end(&Entry { tick: Tick(90), ..changed }), RunEnd::Reached, "it is older than the entry");
        let mut held = later;
        held.memory.emove.estimates.empty = true;
        assert_eq!(end(&held), RunEnd::Continued);
    }

    #[test]
    fn later_change_of_the_file_shows_that_it_is_not_the_last_state() {
        let end = |contents: Contents, at| {
            judged(contents, &Witnesses { changed: Some(at), ..Witnesses::default() }).end
        };
        assert_eq!(end(contents(), 1_000_400), RunEnd::Reached);
        assert_eq!(end(contents(), 1_060_000), RunEnd::Continued, "it is a copy, or was written later");
        assert_eq!(end(Contents { sequence: FIRST, ..contents() }, 9_000_000), RunEnd::Reached);
        let fast = Entry { written: 0, ..contents().newest };
        assert_eq!(end(Contents { newest: fast, ..contents() }, 9_000_000), RunEnd::Reached);
        let torn = Contents { end: RunEnd::CutOff, ..contents() };
        assert_eq!(end(torn, 9_000_000), RunEnd::CutOff);
    }
}
