//! What Subtask tells the pedestal process in a tick.

use interfaces::pedestal::{PedestalCommand, PedestalReport, PedestalStatus, PedestalVerb};

/// What Subtask does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    Nothing,
    Command(PedestalVerb),
}

/// Nothing, or one of `verbs`: any when the last command has ended, and another one than it before.
pub fn choices(verbs: &[PedestalVerb], last: &PedestalCommand, status: &PedestalStatus) -> Vec<Told> {
    let ended = status.echo == last.number && status.report != PedestalReport::Executing;
    let may = |verb: &&PedestalVerb| ended || **verb != last.command;
    let told = verbs.iter().filter(may).map(|verb| Told::Command(*verb));
    core::iter::once(Told::Nothing).chain(told).collect()
}
