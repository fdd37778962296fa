//! Preprocess: read the command and the sensors, and decide which readings count.

use rcs_core::{
    interface::{Reason, device::QuickChangeSensors, quick_change::QuickChangeVerb},
    process::Inputs,
};

use super::{
    state::{Ring, State},
    tables::{Clock, Id, Step},
};
use crate::old_execution::Course;

/// Ticks after which a ring that neither sensor sees is stuck (0.5 s): longer than it is on its way.
pub(super) const STUCK_TICKS: u8 = 12;
/// Ticks after which sensors that contradict each other, or an id that no gripper has, are a malfunction.
pub(super) const MALFUNCTION_TICKS: u8 = 3;
/// Ticks in which a commanded ring must arrive (1 s).
pub(super) const TURN_TICKS: u64 = 25;
/// The greatest id of a gripper: 1 parts, 2 v, 3 tool (III.3.6 to III.3.8); 0 is none.
const GREATEST_ID: u8 = 3;

/// State variables of a tick, besides the ring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// What the upper table says.
    pub course: Course,
    /// What the id is worth.
    pub id: Id,
    /// Time of the command.
    pub clock: Clock,
}

impl Seen {
    /// Read the inputs of a tick.
    pub fn preprocess<Data: ?Sized>(state: &mut State, inputs: &Inputs<'_, Data>) -> Self {
        let command = &inputs.memory.emove.quick_change;
        let course = state.execution.consult(command.number, || match command.command {
            QuickChangeVerb::None => Some(Reason::UnknownCommand),
            QuickChangeVerb::Pause | QuickChangeVerb::Lock | QuickChangeVerb::Unlock => None,
        });
        match course {
            Course::Begin => (state.command, state.since) = (command.command, inputs.tick),
            // What the command before left behind is no answer to this one.
            Course::Refuse => state.execution.step = Step::Watch.code(),
            Course::Continue | Course::Rest => {}
        }
        let sensors = &inputs.external.devices.quick_change;
        read_ring(state, sensors);
        let late = inputs.tick.since(state.since) > TURN_TICKS;
        Self {
            course,
            id: read_id(state, sensors.end_effector_id),
            clock: if late { Clock::Expired } else { Clock::Running },
        }
    }
}

fn read_ring(state: &mut State, sensors: &QuickChangeSensors) {
    let (reading, needed) = match (sensors.locked, sensors.unlocked) {
        (true, false) => (Ring::Locked, 1),
        (false, true) => (Ring::Unlocked, 1),
        (false, false) => (Ring::Between, STUCK_TICKS),
        (true, true) => (Ring::Both, MALFUNCTION_TICKS),
    };
    state.reading_ticks = if reading == state.reading { state.reading_ticks.saturating_add(1) } else { 1 };
    state.reading = reading;
    if state.reading_ticks >= needed {
        state.ring = reading;
    }
}

fn read_id(state: &mut State, id: u8) -> Id {
    if id <= GREATEST_ID {
        state.end_effector_id = id;
        state.illegal_ticks = 0;
    } else {
        state.illegal_ticks = state.illegal_ticks.saturating_add(1);
    }
    if state.illegal_ticks >= MALFUNCTION_TICKS { Id::Illegal } else { Id::Legal }
}
