//! Preprocess: read command and statuses, and set the state variables that the tables look at.

use rcs_core::{
    handshake::Lower,
    interface::{
        CommonMemory, Reason,
        grip::{GripCommand, GripVerb},
        pedestal::{PedestalCommand, PedestalVerb, TableStatus},
    },
    process::Inputs,
    tick::Tick,
};

use super::{state::State, tables::Object};
use crate::{grip::goal::Goal, old_execution::Course, pedestal::table::within_limits};

/// State variables of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// What the upper table says.
    pub course: Course,
    /// Status of the hand.
    pub hand: Lower,
    /// Status of the table.
    pub table: Lower,
    /// What the hand holds.
    pub object: Object,
}

impl Seen {
    /// Read the inputs of a tick.
    pub fn preprocess<Data: ?Sized>(state: &mut State, inputs: &Inputs<'_, Data>) -> Self {
        let memory = inputs.memory;
        let command = &memory.subtask.pedestal;
        state.hand.start(memory.hand.status.echo);
        state.table.start(memory.table.status.echo);
        if command.number != 0 {
            state.cycle = command.cycle;
        }
        let course = state.execution.consult(command.number, || fault(command, &memory.table.status));
        if course == Course::Begin {
            state.command = *command;
        }
        Self {
            course,
            hand: hand(state, memory, inputs.tick),
            table: table(state, memory, inputs.tick),
            object: object(state, memory),
        }
    }
}

fn hand(state: &State, memory: &CommonMemory, tick: Tick) -> Lower {
    let status = &memory.hand.status;
    state.hand.read(tick, &memory.hand.header, status.echo, status.report.lower())
}

fn table(state: &State, memory: &CommonMemory, tick: Tick) -> Lower {
    let status = &memory.table.status;
    state.table.read(tick, &memory.table.header, status.echo, status.report.lower())
}

/// Fingers that stand wider than the grasp size have something between them (VIII.9.1). A hand that is not calibrated cannot
/// tell.
fn object(state: &State, memory: &CommonMemory) -> Object {
    let hand = &memory.hand.status;
    let gripping = state.command.command == PedestalVerb::Grip;
    let size = if gripping { state.command.grasp_size } else { state.held_size };
    if size == 0 {
        Object::None
    } else if !hand.initialized || hand.position > size {
        Object::Held
    } else {
        Object::Lost
    }
}

/// The command to the hand that opens or closes it as the pedestal is told; the number is missing.
pub(super) fn hand_command(command: &PedestalCommand) -> GripCommand {
    let (verb, force) = match command.command {
        PedestalVerb::PreGrip | PedestalVerb::Release => (GripVerb::OpenGrip, 0),
        PedestalVerb::Grip => (GripVerb::CloseGrip, command.grasp_force),
        PedestalVerb::None | PedestalVerb::Pause | PedestalVerb::Flip => (GripVerb::Pause, 0),
    };
    GripCommand { command: verb, force, position: command.grasp_size, ..GripCommand::default() }
}

/// The absolute angle that a command leads to, 0.1 degree.
pub(super) fn angle(command: &PedestalCommand, table: &TableStatus) -> i32 {
    match command.command {
        PedestalVerb::Flip => table.position.saturating_add(command.table_angle),
        _ => command.table_angle,
    }
}

/// Why a command cannot be executed, if so. Found before anything moves: half of a PRE-GRIP would be worse than none.
fn fault(command: &PedestalCommand, table: &TableStatus) -> Option<Reason> {
    let turns = match command.command {
        PedestalVerb::None => return Some(Reason::UnknownCommand),
        PedestalVerb::Flip if !table.calibrated => return Some(Reason::NotPrepared),
        PedestalVerb::PreGrip | PedestalVerb::Flip => true,
        PedestalVerb::Grip | PedestalVerb::Release | PedestalVerb::Pause => false,
    };
    if turns && !within_limits(angle(command, table)) {
        Some(Reason::TableLimit)
    } else if !Goal::from(&hand_command(command)).is_attainable() {
        Some(Reason::GripUnattainable)
    } else {
        None
    }
}
