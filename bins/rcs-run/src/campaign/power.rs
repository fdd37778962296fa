//! A loss of power: only the bytes of the controller's journal remain.

use record::journal::{self, Entry, FormatError, Identity};

use super::branch::Branch;

pub fn journal(branch: &Branch<'_>) -> Vec<u8> {
    let entry = Entry {
        tick: branch.at(),
        generation: branch.closed.generations().number(),
        hws: *branch.closed.command(),
        memory: journal::kept(branch.memory()),
        ..Entry::default()
    };
    journal::begun(&Identity::default(), Some(&entry)).0
}

/// Switch the controller on after the last tick, with a journal. After a [`FormatError`] the controller stays off.
pub fn resume(branch: &mut Branch<'_>, bytes: &[u8]) -> Result<(), FormatError> {
    let read = journal::read(bytes)?;
    let now = branch.at();
    let (memory, entry) = (read.memory(now), &read.newest);
    branch.closed.resume(now, &memory, &entry.hws, entry.generation);
    branch.closed.course_mut().levels_mut().switch_on();
    Ok(())
}
