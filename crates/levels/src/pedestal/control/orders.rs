use interfaces::{
    grip::{GripCommand, GripVerb},
    pedestal::{PedestalCommand, PedestalVerb, TableStatus},
};

use super::tables::{PedestalAngle, PedestalOpening};
use crate::{grip::goal::GripGoal, pedestal::table::is_within_limits};

pub(super) fn hand_command(command: &PedestalCommand) -> GripCommand {
    let (verb, force) = match command.command {
        PedestalVerb::PreGrip | PedestalVerb::Release => (GripVerb::OpenGrip, 0),
        PedestalVerb::Grip => (GripVerb::CloseGrip, command.grasp_force),
        PedestalVerb::None | PedestalVerb::Pause | PedestalVerb::Flip => (GripVerb::Pause, 0),
    };
    GripCommand { command: verb, force, position: command.grasp_size, ..GripCommand::default() }
}

/// The absolute angle at the end of a command, 0.1 degree.
pub(super) const fn table_angle(command: &PedestalCommand, table: &TableStatus) -> i32 {
    match command.command {
        PedestalVerb::Flip => match table.position {
            Some(position) => position.saturating_add(command.table_angle),
            None => command.table_angle,
        },
        PedestalVerb::PreGrip
        | PedestalVerb::Grip
        | PedestalVerb::Release
        | PedestalVerb::Pause
        | PedestalVerb::None => command.table_angle,
    }
}

pub(super) fn angle(command: &PedestalCommand, table: &TableStatus) -> PedestalAngle {
    match command.command {
        PedestalVerb::Flip if table.position.is_none() => PedestalAngle::Unknown,
        PedestalVerb::PreGrip | PedestalVerb::Flip if !is_within_limits(table_angle(command, table)) => {
            PedestalAngle::Beyond
        }
        PedestalVerb::PreGrip
        | PedestalVerb::Flip
        | PedestalVerb::Grip
        | PedestalVerb::Release
        | PedestalVerb::Pause
        | PedestalVerb::None => PedestalAngle::Within,
    }
}

pub(super) fn opening(command: &PedestalCommand) -> PedestalOpening {
    if GripGoal::from(&hand_command(command)).is_attainable() {
        PedestalOpening::Within
    } else {
        PedestalOpening::Beyond
    }
}
