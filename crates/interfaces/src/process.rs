//! A control process (II.2.2): once a tick it reads common memory as the tick before left it, decides, and
//! writes its own output buffers.

use rcs_core::{Plain, table::Table, tick::Tick};

use crate::{CommonMemory, ExternalInputs};

/// What a process reads in a tick. `Data` is the task data, which rcs-core does not know.
#[derive(Debug)]
pub struct Inputs<'a, Data: ?Sized> {
    /// This tick.
    pub tick: Tick,
    /// All output buffers as written in the tick before.
    pub memory: &'a CommonMemory,
    /// What came from outside for this tick.
    pub external: &'a ExternalInputs,
    /// Task data.
    pub data: &'a Data,
}

/// A control process: a pure state machine without clock, I/O or heap.
///
/// [`Process::step`] is the generic process of II.2.2. *preprocess* reads the inputs and sets the state
/// variables, *decide* looks them up in decision tables, *postprocess* fills the outputs. The same state and
/// inputs give the same outputs, to the bit.
pub trait Process<Data: ?Sized> {
    /// Everything the process remembers: plain data, logged, restorable.
    type State: Plain;
    /// Its output buffers.
    type Outputs: Plain;
    /// The state variables of a tick, and what else preprocess has found.
    type Seen;
    /// What the tables can ask for.
    type Action;

    /// The manual's name.
    const NAME: &'static str;
    /// Its decision tables; the header of its outputs names one by position from 1.
    const TABLES: &'static [&'static Table];

    /// Read the inputs and set the state variables. `outputs` holds what was written in the tick before.
    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &Self::Outputs) -> Self::Seen;

    /// Look the state variables up in the decision tables.
    fn decide(&mut self, seen: &Self::Seen) -> Self::Action;

    /// Carry out the action of the row that fired, and fill the output buffers.
    fn postprocess(
        &mut self,
        action: Self::Action,
        seen: &Self::Seen,
        inputs: &Inputs<'_, Data>,
        outputs: &mut Self::Outputs,
    );

    /// What the process remembers.
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

    /// Go on from a remembered state.
    fn restore(&mut self, state: Self::State) {
        *self.state_mut() = state;
    }
}
