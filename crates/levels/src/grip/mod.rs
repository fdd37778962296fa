//! Grip (VI.3): the parts gripper, end effector 1, by eight air valves, a potentiometer and two strain gages.
//!
//! Air cannot be metered: six flow valves open or close the fingers at three speeds, and trapped air holds what was
//! reached. So the servo chooses a flow by the distance that is left, coarse to fine, stops inside a dead band, lets the
//! readings settle, and only then judges. It does not hunt: a flow that was stopped starts again only if the settled
//! reading is outside a wider band than the one that stopped it.
//!
//! The command selects the table. Before any of them UP-INIT runs if position and force are not calibrated yet; the
//! command waits, still executing, and is executed after it.
//!
//! ```text
//!   a command                               the calibration (UP-INIT)
//!
//!         new number, Good                   Missing         Deferred, Failed
//!                |                              |                   |
//!                v                              | at once           | first command that
//!            .-------.    not calibrated        |                   | moves the fingers
//!            | Start |- - - - - - - - - - - -.  |                   |
//!            '-------'                       :  v                   v
//!                | calibrated                :..>.----------------.
//!                v                               |    Closing     |  readings at 0.10 in
//!   Error    .-------. <---------.               '----------------'
//!   <--------|  Move |           |                       | steady
//!   too late '-------'           |               .----------------.
//!                | in the        | outside       |    Opening     |  readings at 5.00 in
//!                | dead band     | wide band     '----------------'
//!                v               |                       | steady
//!            .--------.          |               .----------------.
//!            | Settle |----------'               |    Venting     |  readings without force
//!            '--------'                          '----------------'
//!                | inside the wide band                  | steady, plausible   | else
//!                v                                       v                     v
//!              Done                                    Valid                 Failed
//! ```
//!
//! A gripper that is there when the system is booted is calibrated at once. One that comes later belongs to a process that was
//! dormant, and a process that wakes moves nothing before it is told to
//! (docs/design/handshake.md "Wake"): E-move sends UP-INIT when the gripper is
//! clear of its holster (V.2.1 QC-ATTACH). When the gripper is taken off, a calibration under way is void and all valves go off; one that was finished is kept.
//! PAUSE leaves the valves as they are, literally (VI.3.1): sent while a flow is on, the flow stays on.

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use self::preprocess::attainable;
pub use self::state::{Calibration, Command, Phase, Readings, Scale, State, Steady, Step};

use core::marker::PhantomData;

use rcs_core::{
    interface::{
        CommonMemory, GripOutputs,
        device::{DeviceInputs, GripSensors},
        grip::{GripCommand, GripVerb},
    },
    process::{Inputs, Process},
    table::Table,
};

use self::{
    preprocess::{Arriving, Seen},
    tables::{Action, CLOSE_GRIP, Gripper, PAUSE, POSITION, UP_INIT, close_grip, pause, position, up_init},
};
use crate::old_execution::{Course, EXECUTE};

/// Decision tables, the upper one first.
const TABLES: &[&Table] = &[&EXECUTE, &POSITION, &CLOSE_GRIP, &UP_INIT, &PAUSE];

/// Where a gripper that is servoed has its sensor words, its command and its outputs.
///
/// The hand of the Active Pedestal is nearly identical to the parts gripper (III.9.2): one servo serves both.
pub trait Site {
    /// The name of the process.
    const NAME: &'static str;
    /// `endeff-id#` of the gripper; 0 for one that is not on the quick change.
    const END_EFFECTOR_ID: u8;

    /// The command buffer.
    fn command(memory: &CommonMemory) -> &GripCommand;
    /// The sensor words, and whether the gripper that they come from is there.
    fn sensors(devices: &DeviceInputs) -> (Gripper, GripSensors);
}

/// The parts gripper, end effector 1, on the quick change (III.3.6).
#[derive(Clone, Copy, Debug, Default)]
pub struct PartsGripper;

impl Site for PartsGripper {
    const NAME: &'static str = "Grip";
    const END_EFFECTOR_ID: u8 = 1;

    fn command(memory: &CommonMemory) -> &GripCommand {
        &memory.emove.grip
    }

    fn sensors(devices: &DeviceInputs) -> (Gripper, GripSensors) {
        let quick_change = &devices.quick_change;
        let locked = quick_change.locked && !quick_change.unlocked;
        let attached = locked && quick_change.end_effector_id == Self::END_EFFECTOR_ID;
        (if attached { Gripper::Attached } else { Gripper::Detached }, devices.grip)
    }
}

/// The process that servoes a gripper at some site.
#[derive(Clone, Debug, Default)]
pub struct Servo<S> {
    state: State,
    site: PhantomData<S>,
}

/// The Grip process.
pub type Grip = Servo<PartsGripper>;

impl<S> Servo<S> {
    /// Look up the state variables in the table that has the duty; its row gives the action and the next step.
    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        if seen.calibrate {
            let decision = up_init(state.phase, seen.gripper, seen.clock, seen.readings(state));
            state.phase = decision.next;
            let step = state.execution.step;
            state.execution.note(TABLES, &UP_INIT, decision.row, step);
            return decision.action;
        }
        if !matches!(seen.course, Course::Begin | Course::Continue) {
            return if seen.course == Course::Refuse { Action::Stop } else { Action::Keep };
        }
        let step = state.step();
        let (table, decision) = match state.command.verb {
            GripVerb::Position | GripVerb::OpenGrip => {
                (&POSITION, position(step, seen.gripper, seen.clock, seen.opening(state), seen.rest))
            }
            GripVerb::CloseGrip => {
                (&CLOSE_GRIP, close_grip(step, seen.gripper, seen.clock, seen.grasp(state), seen.rest))
            }
            GripVerb::Pause | GripVerb::UpInit | GripVerb::None => (&PAUSE, pause(seen.gripper)),
        };
        state.execution.note(TABLES, table, decision.row, decision.next.code());
        decision.action
    }
}

impl<S: Site, Data: ?Sized> Process<Data> for Servo<S> {
    type State = State;
    type Seen = ();
    type Action = ();
    type Outputs = GripOutputs;

    const NAME: &'static str = S::NAME;
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut GripOutputs) {
        let (gripper, sensors) = S::sensors(&inputs.external.devices);
        let arriving = Arriving {
            command: S::command(inputs.memory),
            end_effector_id: S::END_EFFECTOR_ID,
            woken: outputs.header.republished,
            gripper,
            sensors,
            tick: inputs.tick,
        };
        let seen = Seen::preprocess(&mut self.state, &arriving);
        let action = self.decide(&seen);
        *outputs = postprocess::perform(&mut self.state, &seen, action, inputs.tick);
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &GripOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut GripOutputs) {}

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}
