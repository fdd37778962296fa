//! V-Grip (VI.4) and Tool-Grip (VI.5): grippers that open and close by air, with a potentiometer for the position
//! of their fingers.
//!
//! Both share one process, with a [`JawsKind`] each, and have no servo: a command gives air to one side, waits until
//! the potentiometer reading is steady, and reports where the fingers have stopped.
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
//! Fingers that have stopped at the wrong end, or at neither an end nor the commanded size, are reported at their
//! actual position, with a reason. Air stays on until the next command: a part is held only while the fingers
//! press.
//!
//! ```text
//!               ACCEPT               AIR: gripper, motion
//!   a command ----------> Start ------> Move ------> done, or stopped elsewhere
//!       |                  |             |
//!       | refused          | the gripper is not there, or its fingers never stop
//!       v                  v             v
//!     error <-----------------------------
//! ```
//!
//! The process is dormant while its gripper is in the holster (II.2.3). When it wakes it adopts the number of the
//! command in its buffer and executes nothing before a new one arrives (docs/design/handshake.md "Wake").

pub mod goals;
pub mod kind;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

pub use self::{
    kind::{CylindricalPartGripper, JawsKind, Parameters, ToolGripper},
    preprocess::{POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE},
};

use core::marker::PhantomData;

use interfaces::{
    JawsOutputs,
    process::{Inputs, Process},
};
use rcs_core::table::Table;

use self::{
    state::State,
    tables::{Action, StateVariables, number},
};

#[derive(Clone, Debug, Default)]
pub struct Jaws<K> {
    state: State,
    kind: PhantomData<K>,
}

pub type VGrip = Jaws<CylindricalPartGripper>;
pub type ToolGrip = Jaws<ToolGripper>;

impl<K> crate::goal::Goals for Jaws<K> {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<K: JawsKind, Data: ?Sized> Process<Data> for Jaws<K> {
    type State = State;
    type Outputs = JawsOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = K::NAME;
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &JawsOutputs) -> StateVariables {
        self.state.sense::<K, Data>(inputs, outputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> Action {
        tables::decide(&mut self.state, &mut { *seen })
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut JawsOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.request.asked, &[number::ACCEPT]) {
            state.size = seen.size;
        }
        state.act(action, seen);
        *outputs = state.report(seen, inputs.tick);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
