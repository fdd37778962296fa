//! V-Grip (VI.4) and Tool-Grip (VI.5): grippers that open and close by air, and tell where their fingers are.
//!
//! TG-LEVEL is VG-LEVEL with other parameters, so there is one process here and a [`Kind`] each. Nothing is servoed: a command
//! gives air to one side, waits until the potentiometer stands still, and reports where the fingers have stopped.
//!
//! ```text
//!    GRASP    closed ........................... size ........................... opened
//!             closed        jaws-stuck          closed         jaws-stuck         opened
//!    RELEASE  closed ........................... size ........................... opened
//!    POSE     closed        jaws-stuck          opened         jaws-stuck         opened
//!    PAUSE    closed ........................... size ........................... opened
//!             closed        jaws-stuck       at-position       jaws-stuck         opened
//! ```
//!
//! Fingers that have stopped on the wrong side, or where nothing wanted them, are reported as what they are, with a reason
//! beside it. Air stays on until the next command: what is held is pressed, not only enclosed.
//!
//! The process sleeps while its gripper is in the holster (II.2.3). When it wakes it adopts the command that stands in its
//! buffer and executes none before a new one comes (docs/design/handshake.md "Wake").

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
mod tests;

pub use self::{
    preprocess::{POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE},
    state::State,
};

use core::marker::PhantomData;

use rcs_core::{
    interface::{
        CommonMemory, JawsOutputs,
        jaws::{JawsCommand, JawsVerb},
    },
    process::{Inputs, Process},
    table::Table,
};

use self::{
    preprocess::Seen,
    tables::{Action, GRASP, PAUSE, RELEASE, Step, grasp, pause, release},
};
use crate::old_execution::{Course, EXECUTE};

/// Decision tables, the upper one first.
const TABLES: &[&Table] = &[&EXECUTE, &GRASP, &RELEASE, &PAUSE];

/// What makes one gripper differ from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// `endeff-id#`.
    pub end_effector_id: u8,
    /// Opening at the closed end of the fingers' way, in.
    pub closed: f64,
    /// Opening at the open end of the fingers' way, in.
    pub opened: f64,
}

/// A gripper that opens and closes.
pub trait Kind {
    /// The manual's name of its process.
    const NAME: &'static str;
    /// Its parameters.
    const PARAMETERS: Parameters;

    /// Its command buffer.
    fn command(memory: &CommonMemory) -> &JawsCommand;
}

/// The gripper for cylindrical parts, end effector 2 (III.3.7).
#[derive(Clone, Copy, Debug, Default)]
pub struct CylindricalPartGripper;

impl Kind for CylindricalPartGripper {
    const NAME: &'static str = "V-Grip";
    /// The way of the fingers is ASSUMED.
    const PARAMETERS: Parameters = Parameters { end_effector_id: 2, closed: 0.50, opened: 3.50 };

    fn command(memory: &CommonMemory) -> &JawsCommand {
        &memory.emove.v_grip
    }
}

/// The gripper for tools, end effector 3 (III.3.8).
#[derive(Clone, Copy, Debug, Default)]
pub struct ToolGripper;

impl Kind for ToolGripper {
    const NAME: &'static str = "Tool-Grip";
    /// The way of the fingers is ASSUMED.
    const PARAMETERS: Parameters = Parameters { end_effector_id: 3, closed: 1.00, opened: 4.00 };

    fn command(memory: &CommonMemory) -> &JawsCommand {
        &memory.emove.tool_grip
    }
}

/// The process of a gripper that opens and closes.
#[derive(Clone, Debug, Default)]
pub struct Jaws<K> {
    state: State,
    kind: PhantomData<K>,
}

/// The V-Grip process.
pub type VGrip = Jaws<CylindricalPartGripper>;
/// The Tool-Grip process.
pub type ToolGrip = Jaws<ToolGripper>;

impl<K> Jaws<K> {
    /// Look up the state variables in the table of the command.
    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        match seen.course {
            Course::Rest => return Action::Keep,
            Course::Refuse => return Action::Refuse,
            Course::Begin | Course::Continue => {}
        }
        let step = Step::from_code(state.execution.step).unwrap_or_default();
        let Seen { gripper, motion, stop, size, .. } = *seen;
        let (table, decision) = match state.verb {
            JawsVerb::Grasp => (&GRASP, grasp(step, gripper, motion, stop, size)),
            JawsVerb::Release | JawsVerb::Pose => (&RELEASE, release(step, gripper, motion, stop, size)),
            JawsVerb::Pause | JawsVerb::None => (&PAUSE, pause(gripper, motion, stop, size)),
        };
        state.execution.note(TABLES, table, decision.row, decision.next.code());
        decision.action
    }
}

impl<K: Kind, Data: ?Sized> Process<Data> for Jaws<K> {
    type State = State;
    type Seen = ();
    type Action = ();
    type Outputs = JawsOutputs;

    const NAME: &'static str = K::NAME;
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut JawsOutputs) {
        let command = K::command(inputs.memory);
        let woken = outputs.header.republished;
        let devices = &inputs.external.devices;
        let seen = Seen::preprocess(&mut self.state, &K::PARAMETERS, command, devices, woken, inputs.tick);
        let action = self.decide(&seen);
        *outputs = postprocess::perform(&mut self.state, &seen, action, inputs.tick);
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &JawsOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut JawsOutputs) {}

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
