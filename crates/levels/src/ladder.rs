//! The ladder: all control processes, stepped once per tick.
//!
//! Every process reads common memory of the previous tick and writes only its own part of the next one. So the
//! order of the processes does not change the result ([`Ladder::step_in_order`] lets a test check it).
//!
//! The processes of an Active Pedestal in a separate system are not stepped: their received outputs are copied.

use interfaces::{
    CommonMemory, Decided, ExternalInputs, Header, OutsidePedestal,
    device::{LinkBytes, single_step},
    for_each_process,
    operator::may_be_written,
    process::{Inputs, Process},
};
use rcs_core::{
    Plain,
    table::{Fired, Row, Table},
    tick::Tick,
};
use taskdata::files::TaskData;

pub use interfaces::{PROCESS_COUNT, ProcessId};

use crate::{
    goal::{Declared, Goals},
    processes::*,
};

#[derive(Debug)]
pub struct ProcessInfo {
    pub name: &'static str,
    /// Its tables; `table` of a [`Decided`] counts them from 1.
    pub tables: &'static [&'static Table],
    pub goals: &'static [Declared],
}

impl ProcessInfo {
    #[must_use]
    pub fn table(&self, number: u8) -> Option<&'static Table> {
        self.tables.get(usize::from(number.checked_sub(1)?)).copied()
    }

    #[must_use]
    pub fn row(&self, decided: Decided) -> Option<(&'static Table, &'static Row)> {
        let table = self.table(decided.table)?;
        Some((table, table.row(decided.row)?))
    }

    #[must_use]
    pub fn fired(&self, header: &Header) -> Option<Fired> {
        let (table, row) = self.row(header.decided?)?;
        Some(Fired { table, row, values: header.basis.map(|basis| basis.values) })
    }
}

const fn info<P: Process<TaskData<'static>> + Goals>() -> ProcessInfo {
    ProcessInfo { name: P::NAME, tables: P::TABLES, goals: P::GOALS }
}

type StateOf<P> = <P as Process<TaskData<'static>>>::State;

macro_rules! ladder {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        static PROCESSES: [ProcessInfo; PROCESS_COUNT] = [ $( info::<$id>(), )+ ];

        #[derive(Clone, Copy, Debug, PartialEq, Plain)]
        pub struct LadderState {
            $( #[doc = $doc] pub $field: StateOf<$id>, )+
            pub buttons: u8,
        }

        #[derive(Clone, Debug, Default)]
        pub struct Ladder {
            $( $field: $id, )+
            /// Single-step buttons of the previous tick, because a button steps a process only when it is pressed.
            buttons: u8,
        }

        impl Ladder {
            fn step_one(
                &mut self,
                process: ProcessId,
                inputs: &Inputs<'_, TaskData<'_>>,
                after: &mut CommonMemory,
            ) {
                match process { $( ProcessId::$id => self.$field.step(inputs, &mut after.$field), )+ }
            }

            /// Write the values that a person has given for a process (IV.2.6).
            fn write_into(
                &mut self,
                process: ProcessId,
                inputs: &Inputs<'_, TaskData<'_>>,
                after: &mut CommonMemory,
            ) {
                for write in inputs.external.operator.writes_to(process) {
                    match process { $( ProcessId::$id => self.$field.write(write, inputs, &mut after.$field), )+ }
                }
            }

            /// Restart a process: its state is lost, as after a crash.
            pub fn restart(&mut self, process: ProcessId) {
                match process { $( ProcessId::$id => self.$field = $id::default(), )+ }
            }

            #[must_use]
            pub fn state(&self) -> LadderState {
                fn of<P: Process<TaskData<'static>>>(process: &P) -> P::State {
                    *process.state()
                }
                LadderState { $( $field: of(&self.$field), )+ buttons: self.buttons }
            }

            pub fn restore(&mut self, state: &LadderState) {
                fn to<P: Process<TaskData<'static>>>(process: &mut P, state: P::State) {
                    process.restore(state);
                }
                $( to(&mut self.$field, state.$field); )+
                self.buttons = state.buttons;
            }
        }
    };
}
for_each_process!(ladder);

/// True if a process is not stepped in this tick: it is dormant (II.2.3), held by its switch on the joystick box,
/// on a stopped board (IV.2.6), or suspended after a pose was recorded (III.3.3).
fn is_suspended(process: ProcessId, before: &CommonMemory, external: &ExternalInputs, pressed: u8) -> bool {
    let (joystick, operator) = (&external.devices.joystick, &external.operator);
    let recording = before.prim.status.recording && !joystick.resume;
    let switch = match process {
        ProcessId::Task => single_step::TASK,
        ProcessId::Subtask => single_step::SUBTASK,
        ProcessId::Emove => single_step::EMOVE,
        ProcessId::Prim => single_step::PRIM,
        _ => 0,
    };
    let held = joystick.hold & switch != 0 && pressed & switch == 0;
    let dormant = match process {
        ProcessId::Grip => before.emove.dormant.grip,
        ProcessId::VGrip => before.emove.dormant.v_grip,
        ProcessId::ToolGrip => before.emove.dormant.tool_grip,
        ProcessId::Emove | ProcessId::Prim => recording,
        _ => false,
    };
    let stopped = operator.is_stopped(process.board());
    dormant || (held || stopped) && !operator.executes(process)
}

/// Publish the last outputs of a suspended process again, so that its readers do not take it for lost
/// (docs/design/handshake.md "Stamp"). The frame of a tick is sent once.
const fn republish(process: ProcessId, tick: Tick, memory: &mut CommonMemory) {
    if matches!(process, ProcessId::T3i) {
        memory.t3i.link_tx = LinkBytes::ZERO;
    }
    let header = memory.header_mut(process);
    header.stamp = tick;
    header.republished = true;
}

/// Copy the outputs of a pedestal process in another system, as if it had run here in this tick. If it does not
/// answer, its outputs and their old stamp stay, so that its readers detect the loss (docs/design/handshake.md
/// "Outside").
const fn adopt(process: ProcessId, sent: &OutsidePedestal, tick: Tick, memory: &mut CommonMemory) {
    if !sent.answers {
        return;
    }
    match process {
        ProcessId::Hand => memory.hand = sent.hand,
        ProcessId::RotaryTable => memory.table = sent.table,
        _ => memory.pedestal = sent.pedestal,
    }
    memory.header_mut(process).stamp = tick;
}

impl Ladder {
    /// The processes and their tables, in the order of [`ProcessId`].
    #[must_use]
    pub const fn processes() -> &'static [ProcessInfo; PROCESS_COUNT] {
        &PROCESSES
    }

    pub fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
    ) {
        self.step_in_order(ProcessId::ALL, tick, before, external, data, after);
    }

    /// Steps the processes of one tick in another order, or only those of a board. The outputs of other processes in
    /// `after` are those of `before`.
    pub fn step_in_order(
        &mut self,
        order: &[ProcessId],
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
    ) {
        self.step_observed(order, tick, before, external, data, after, &mut |_| {});
    }

    /// Does the same and calls `observe`: with `None` once the buffers are copied from the previous tick, then with
    /// each process. `observe` can measure times, which the levels cannot.
    #[expect(clippy::too_many_arguments, reason = "a tick's inputs and outputs, and the observer")]
    pub fn step_observed(
        &mut self,
        order: &[ProcessId],
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) {
        *after = *before;
        observe(None);
        let inputs = Inputs { tick, memory: before, external, data };
        let buttons = external.devices.joystick.single_step;
        let pressed = buttons & !self.buttons;
        self.buttons = buttons;
        for &process in order {
            if may_be_written(process, before) {
                self.write_into(process, &inputs, after);
            }
            let is_pedestal =
                matches!(process, ProcessId::Pedestal | ProcessId::Hand | ProcessId::RotaryTable);
            if is_pedestal && external.pedestal.elsewhere {
                adopt(process, &external.pedestal, tick, after);
            } else if is_suspended(process, before, external, pressed) {
                republish(process, tick, after);
                continue;
            } else {
                self.step_one(process, &inputs, after);
            }
            observe(Some(process));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Larger tables, by process and name (docs/design/tables.md "Large tables").
    const LARGE: &[(&str, &str)] = &[];

    #[test]
    fn tables_have_at_most_20_rows_and_12_variables() {
        let tables = Ladder::processes()
            .iter()
            .flat_map(|process| process.tables.iter().map(move |table| (process.name, *table)));
        let large: Vec<_> = tables
            .filter(|(_, table)| table.rows.len() > 20 || table.asked().count() > 12)
            .map(|(process, table)| (process, table.name))
            .collect();
        assert_eq!(large, LARGE);
    }
}
