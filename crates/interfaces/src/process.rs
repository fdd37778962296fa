//! A control process (II.2.2): reads common memory of the previous tick, decides, writes its own output buffers.

use rcs_core::{Plain, table::Table, tick::Tick};

use crate::{CommonMemory, ExternalInputs, operator::Write};

/// Inputs of a process in a tick. `Data` is the task data; this crate does not depend on its type.
#[derive(Debug)]
pub struct Inputs<'a, Data: ?Sized> {
    /// The present tick.
    pub tick: Tick,
    /// All output buffers of the previous tick.
    pub memory: &'a CommonMemory,
    /// External inputs of this tick.
    pub external: &'a ExternalInputs,
    /// Task data.
    pub data: &'a Data,
}

/// A control process: a pure state machine without clock, I/O or heap.
///
/// [`Process::step`] is the generic process of II.2.2. *preprocess* reads the inputs and sets the state variables,
/// *decide* evaluates the decision tables, *postprocess* fills the outputs. Equal state and inputs give bit-identical
/// outputs.
pub trait Process<Data: ?Sized> {
    /// The complete state of the process: plain data that is logged and can be restored.
    type State: Plain;
    /// Output buffers.
    type Outputs: Plain;
    /// The state variables of a tick and other results of preprocess.
    type StateVariables;
    /// Actions of the tables.
    type Action;

    /// The manual's name.
    const NAME: &'static str;
    /// Its decision tables; the header of its outputs identifies one by position from 1.
    const TABLES: &'static [&'static Table];

    /// Read the inputs and set the state variables. `outputs` contains the previous outputs.
    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &Self::Outputs) -> Self::StateVariables;

    /// Evaluate the decision tables for the state variables.
    fn decide(&mut self, seen: &Self::StateVariables) -> Self::Action;

    /// Carry out the action of the row that fired, and fill the output buffers.
    fn postprocess(
        &mut self,
        action: Self::Action,
        seen: &Self::StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut Self::Outputs,
    );

    /// Accept a value that an operator writes while the process is not stepped (IV.2.6), over the previous `outputs`.
    fn write(&mut self, _: &Write, _: &Inputs<'_, Data>, _: &mut Self::Outputs) {}

    /// State of the process.
    fn state(&self) -> &Self::State;

    /// Mutable state, to continue from another one.
    fn state_mut(&mut self) -> &mut Self::State;

    /// One execution cycle. It overwrites `outputs`, which contains the previous outputs.
    #[inline]
    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut Self::Outputs) {
        let seen = self.preprocess(inputs, outputs);
        let action = self.decide(&seen);
        self.postprocess(action, &seen, inputs, outputs);
    }

    /// Continue from a saved state.
    fn restore(&mut self, state: Self::State) {
        *self.state_mut() = state;
    }
}
