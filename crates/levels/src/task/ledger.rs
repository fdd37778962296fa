//! The ledger: the last command about an object or a tool that was accepted and has not been finished
//! (docs/design/recovery.md "Ledger").
//!
//! It is an output of Task and is read from there, so that a restarted Task has it too. It distinguishes a repeated
//! command from a new one: a TRANSFER that was interrupted after its RELEASE continues with the update and the motion
//! to its end-at location, while the same TRANSFER after a finished one begins from the start. The progress of the
//! command is not in the ledger; it follows from the statuses from below.

use interfaces::{
    data_base::Carried,
    emove::Standing,
    hws::{HwsCommand, Ledger},
    subtask::{SubtaskStatus, SubtaskVerb},
};
use rcs_core::{Plain, name::Name16};

use super::plan::{Plan, Resumed, TaskVerb};

/// Has the command placed its object already?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Placed {
    /// No, or it was not sent before.
    Not,
    /// It is what the gripper has let go last, at the destination, where the robot stands.
    AtDestination,
    /// The same, and the robot has been sent away from there.
    Left,
}

/// Is the part in the pedestal's hand?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskPart {
    Elsewhere,
    /// Yes, alone or together with the robot.
    InPedestal,
}

/// The content of a command: all but its number.
#[must_use]
pub const fn content(command: &HwsCommand) -> HwsCommand {
    HwsCommand { number: 0, ..*command }
}

/// Was a command sent before and not finished?
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

/// Has the command of a plan placed its object already? It cannot have before its order to place it, even if the same
/// object was placed there by an earlier command.
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

/// Is the object of a new command held already, and was it taken at another place than the source? The ledger
/// says where, if it is about the object, else what the robot carries (docs/design/recovery.md "Data base").
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

/// Does the command in the ledger take an object?
#[must_use]
pub fn is_taken(ledger: Option<&Ledger>, object: &Name16) -> bool {
    ledger.is_some_and(|Ledger { command, .. }| {
        command.object.as_ref() == Some(object) && TaskVerb::of(&command.command).is_some_and(TaskVerb::takes)
    })
}

/// The ledger when a command has been accepted. A command that is about no object says nothing of one that
/// is. One that has to take its object again has reported nothing yet.
#[must_use]
pub fn opened(ledger: Option<Ledger>, command: &HwsCommand, plan: &Plan) -> Option<Ledger> {
    if !plan.is_about_something() || plan.resumed != Resumed::Not {
        return ledger.map(|ledger| Ledger { reported: ledger.reported && !plan.update_due, ..ledger });
    }
    Some(Ledger { command: content(command), last: SubtaskVerb::None, reported: plan.from_elsewhere })
}
