//! A control process (II.2.2): once a tick it reads common memory of the tick before, decides, and writes its own
//! output buffers.

use rcs_core::{Plain, table::Table, tick::Tick};

use crate::{CommonMemory, ExternalInputs, operator::Write};

/// Inputs of a process in a tick. `Data` is the task data, on which this crate does not depend.
#[derive(Debug)]
pub struct Inputs<'a, Data: ?Sized> {
    /// This tick.
    pub tick: Tick,
    /// All output buffers as written in the tick before.
    pub memory: &'a CommonMemory,
    /// External inputs of this tick.
    pub external: &'a ExternalInputs,
    /// Task data.
    pub data: &'a Data,
}

/// A control process: a pure state machine without clock, I/O or heap.
///
/// [`Process::step`] is the generic process of II.2.2. *preprocess* reads the inputs and sets the state variables,
/// *decide* looks them up in decision tables, *postprocess* fills the outputs. The same state and inputs give the same
/// outputs, bit for bit.
pub trait Process<Data: ?Sized> {
    /// The whole state of the process: plain data, logged, restorable.
    type State: Plain;
    /// Output buffers.
    type Outputs: Plain;
    /// The state variables of a tick, and other results of preprocess.
    type StateVariables;
    /// Actions of the tables.
    type Action;

    /// The manual's name.
    const NAME: &'static str;
    /// Its decision tables; the header of its outputs names one by position from 1.
    const TABLES: &'static [&'static Table];

    /// Read the inputs and set the state variables. `outputs` holds what was written in the tick before.
    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &Self::Outputs) -> Self::StateVariables;

    /// Look the state variables up in the decision tables.
    fn decide(&mut self, seen: &Self::StateVariables) -> Self::Action;

    /// Carry out the action of the row that fired, and fill the output buffers.
    fn postprocess(
        &mut self,
        action: Self::Action,
        seen: &Self::StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut Self::Outputs,
    );

    /// Take over a value that a person writes while the process is not stepped (IV.2.6). `outputs` holds what was
    /// written in the tick before.
    fn write(&mut self, _: &Write, _: &Inputs<'_, Data>, _: &mut Self::Outputs) {}

    /// State of the process.
    fn state(&self) -> &Self::State;

    /// The same, to go on from another state.
    fn state_mut(&mut self) -> &mut Self::State;

    /// One execution cycle. `outputs` holds what was written in the tick before and is overwritten.
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
