//! The ledger: the last accepted command about an object or a tool, until it finishes (docs/design/recovery.md
//! "Ledger").
//!
//! The ledger is an output of Task, so it survives a restart. It distinguishes a repeated command from a new one: an
//! interrupted TRANSFER continues after its RELEASE with the update and the motion to its end-at location; after a
//! finished one it starts at the beginning. Progress is not in the ledger: it follows from the statuses from below.

use interfaces::{
    data_base::Carried,
    emove::Standing,
    hws::{HwsCommand, Ledger},
    subtask::{SubtaskStatus, SubtaskVerb},
};
use rcs_core::{Plain, name::Name16};

use super::plan::{Plan, Resumed, TaskVerb};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Placed {
    /// The object is not placed, or the command is new.
    Not,
    /// The gripper released the object last at the destination, and the robot is still there.
    AtDestination,
    /// The gripper released the object last at the destination, and the robot has been moved away from there.
    Left,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskPart {
    /// The part is not in the pedestal's hand.
    Elsewhere,
    /// The part is in the pedestal's hand. The robot may hold it too.
    InPedestal,
}

/// The content of a command: all but its number.
#[must_use]
pub const fn content(command: &HwsCommand) -> HwsCommand {
    HwsCommand { number: 0, ..*command }
}

#[must_use]
pub fn resumed(command: &HwsCommand, ledger: Option<&Ledger>) -> Resumed {
    match ledger.filter(|ledger| ledger.command == content(command)).map(|ledger| ledger.last) {
        None => Resumed::Not,
        Some(SubtaskVerb::GotoEndpt) => Resumed::Leaving,
        Some(
            SubtaskVerb::InsertTool
            | SubtaskVerb::ReleaseTool
            | SubtaskVerb::AcquireTool
            | SubtaskVerb::RemoveTool,
        ) => Resumed::AtTool,
        Some(_) => Resumed::Begun,
    }
}

/// The object of a repeated command. Objects that earlier commands placed are ignored.
#[must_use]
pub fn placed(plan: &Plan, below: &SubtaskStatus, ledger: Option<&Ledger>) -> Placed {
    let placing = matches!(
        ledger.map(|ledger| ledger.last),
        Some(SubtaskVerb::PlaceObj | SubtaskVerb::Position | SubtaskVerb::GotoEndpt)
    );
    let destination = plan.destination.site();
    let at_destination = below.placed.is_some_and(|placed| {
        plan.object == Some(placed.object)
            && plan.destination.grip == placed.grip
            && destination == Some(placed.site)
    });
    let stands = |at: Standing| destination == Some(at.site) && at.grip == Some(plan.destination.grip);
    match (at_destination && placing && plan.resumed != Resumed::Not, below.at.is_some_and(stands)) {
        (false, _) => Placed::Not,
        (true, true) => Placed::AtDestination,
        (true, false) => Placed::Left,
    }
}

/// True if a held object comes from another place than the source of a new command. The ledger has the place if it is
/// about the object; otherwise the carried object has it (docs/design/recovery.md "Database").
#[must_use]
pub fn is_from_elsewhere(
    command: &HwsCommand,
    plan: &Plan,
    ledger: Option<&Ledger>,
    carried: Option<&Carried>,
) -> bool {
    let source = |command: &HwsCommand| (command.source, command.source_sector);
    match ledger
        .map(|ledger| (&ledger.command, ledger.reported))
        .filter(|(last, _)| last.object == plan.object)
    {
        Some((last, reported)) => reported || source(last) != source(command),
        None => !plan.source.site().zip(carried).is_some_and(|(site, carried)| {
            Some(carried.item) == plan.object
                && (carried.location, carried.sector) == (site.location, site.sector)
        }),
    }
}

/// True if the command in the ledger takes this object.
#[must_use]
pub fn is_taken(ledger: Option<&Ledger>, object: &Name16) -> bool {
    ledger.is_some_and(|Ledger { command, .. }| {
        command.object.as_ref() == Some(object) && TaskVerb::of(&command.command).is_some_and(TaskVerb::takes)
    })
}

/// A command without an object leaves the ledger unchanged. A command that has to take its object again has reported
/// no update yet.
#[must_use]
pub fn opened(ledger: Option<Ledger>, command: &HwsCommand, plan: &Plan) -> Option<Ledger> {
    if !plan.is_about_something() || plan.resumed != Resumed::Not {
        return ledger.map(|ledger| Ledger { reported: ledger.reported && !plan.update_due, ..ledger });
    }
    Some(Ledger { command: content(command), last: SubtaskVerb::None, reported: plan.from_elsewhere })
}
