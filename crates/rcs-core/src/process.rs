//! A control process (II.2.2): once a tick it reads common memory as the tick before left it, decides, and writes its own
//! output buffers.

use crate::{
    interface::{CommonMemory, ExternalInputs},
    record::Field,
    table::Table,
    tick::Tick,
};

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
/// `step` is the generic process of II.2.2: *preprocess* reads inputs and sets state variables, *decide* looks them up in the table
/// of the current command, *postprocess* fills the outputs. The same state and inputs give the same outputs, to the bit.
pub trait Process<Data: ?Sized> {
    /// Everything the process remembers: plain data, logged, restorable.
    type State: Field;
    /// Its output buffers.
    type Outputs: Field;

    /// The manual's name.
    const NAME: &'static str;
    /// Its decision tables; the header of its outputs names one by position from 1.
    const TABLES: &'static [&'static Table];

    /// One execution cycle. `outputs` holds what was written in the tick before and is overwritten.
    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut Self::Outputs);

    /// What the process remembers.
    fn state(&self) -> &Self::State;

    /// Go on from a remembered state.
    fn restore(&mut self, state: Self::State);
}
