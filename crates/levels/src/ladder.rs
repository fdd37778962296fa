//! The ladder: all control processes, stepped once a tick.
//!
//! Every process reads common memory as the tick before left it and writes only its own part of the next one, so the order in
//! which they are stepped cannot change a bit of the result ([`Ladder::step_in_order`] lets a test try).
//!
//! The processes of an Active Pedestal that is a system of its own are not stepped: what they sent is adopted in their place.

use rcs_core::{
    Plain,
    interface::{
        CommonMemory, ExternalInputs, Header, OutsidePedestal,
        device::{JoystickBox, single_step},
    },
    process::{Inputs, Process},
    table::Table,
    tick::Tick,
};
use taskdata::files::TaskData;

use crate::{
    emove::Emove,
    grip::Grip,
    jaws::{ToolGrip, VGrip},
    pedestal::{Hand, Pedestal, Table as RotaryTable},
    prim::Prim,
    quick_change::QuickChange,
    subtask::Subtask,
    t3i::T3i,
    task::Task,
};

/// The control processes in the order of [`CommonMemory`], which is the order of the digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ProcessId {
    /// Task (V.4).
    #[text = "Task"]
    Task,
    /// Subtask (V.3).
    #[text = "Subtask"]
    Subtask,
    /// E-move (V.2).
    #[text = "E-move"]
    Emove,
    /// Prim (V.1).
    #[text = "Prim"]
    Prim,
    /// T3 Interface (VI.1).
    #[text = "T3 Interface"]
    T3i,
    /// Quick Change (VI.2).
    #[text = "Quick Change"]
    QuickChange,
    /// Grip (VI.3).
    #[text = "Grip"]
    Grip,
    /// V-Grip (VI.4).
    #[text = "V-Grip"]
    VGrip,
    /// Tool-Grip (VI.5).
    #[text = "Tool-Grip"]
    ToolGrip,
    /// Active Pedestal (VI.7).
    #[text = "Active Pedestal"]
    Pedestal,
    /// Hand of the pedestal.
    #[text = "Pedestal Hand"]
    Hand,
    /// Rotary table of the pedestal.
    #[text = "Rotary Table"]
    RotaryTable,
}

/// A process by name, with its decision tables.
#[derive(Debug)]
pub struct ProcessInfo {
    /// The manual's name.
    pub name: &'static str,
    /// Its tables; `table` of a [`rcs_core::interface::Header`] counts them from 1.
    pub tables: &'static [&'static Table],
}

impl ProcessInfo {
    /// A table by the number in a header.
    #[must_use]
    pub fn table(&self, number: u8) -> Option<&'static Table> {
        self.tables.get(usize::from(number.checked_sub(1)?)).copied()
    }
}

const fn info<P: Process<TaskData<'static>>>() -> ProcessInfo {
    ProcessInfo { name: P::NAME, tables: P::TABLES }
}

/// How many processes there are.
pub const PROCESS_COUNT: usize = ProcessId::ALL.len();

static PROCESSES: [ProcessInfo; PROCESS_COUNT] = [
    info::<Task>(),
    info::<Subtask>(),
    info::<Emove>(),
    info::<Prim>(),
    info::<T3i>(),
    info::<QuickChange>(),
    info::<Grip>(),
    info::<VGrip>(),
    info::<ToolGrip>(),
    info::<Pedestal>(),
    info::<Hand>(),
    info::<RotaryTable>(),
];

type StateOf<P> = <P as Process<TaskData<'static>>>::State;

/// What all processes remember.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LadderState {
    /// Task.
    pub task: StateOf<Task>,
    /// Subtask.
    pub subtask: StateOf<Subtask>,
    /// E-move.
    pub emove: StateOf<Emove>,
    /// Prim.
    pub prim: StateOf<Prim>,
    /// T3 Interface.
    pub t3i: StateOf<T3i>,
    /// Quick Change.
    pub quick_change: StateOf<QuickChange>,
    /// Grip.
    pub grip: StateOf<Grip>,
    /// V-Grip.
    pub v_grip: StateOf<VGrip>,
    /// Tool-Grip.
    pub tool_grip: StateOf<ToolGrip>,
    /// Active Pedestal.
    pub pedestal: StateOf<Pedestal>,
    /// Hand of the pedestal.
    pub hand: StateOf<Hand>,
    /// Rotary table of the pedestal.
    pub table: StateOf<RotaryTable>,
    /// Single-step buttons of the tick before.
    pub buttons: u8,
}

/// All control processes.
#[derive(Clone, Debug, Default)]
pub struct Ladder {
    task: Task,
    subtask: Subtask,
    emove: Emove,
    prim: Prim,
    t3i: T3i,
    quick_change: QuickChange,
    grip: Grip,
    v_grip: VGrip,
    tool_grip: ToolGrip,
    pedestal: Pedestal,
    hand: Hand,
    table: RotaryTable,
    /// Single-step buttons as they were in the tick before: pressing counts, not holding down.
    buttons: u8,
}

/// A process that is not stepped in this tick: dormant (II.2.3), held by its switch on the joystick box, or suspended while a
/// recorded pose is looked at (III.3.3).
const fn is_suspended(
    process: ProcessId,
    before: &CommonMemory,
    joystick: &JoystickBox,
    pressed: u8,
) -> bool {
    let recording = before.prim.status.recording && !joystick.resume;
    let switch = match process {
        ProcessId::Task => single_step::TASK,
        ProcessId::Subtask => single_step::SUBTASK,
        ProcessId::Emove => single_step::EMOVE,
        ProcessId::Prim => single_step::PRIM,
        ProcessId::T3i
        | ProcessId::QuickChange
        | ProcessId::Grip
        | ProcessId::VGrip
        | ProcessId::ToolGrip
        | ProcessId::Pedestal
        | ProcessId::Hand
        | ProcessId::RotaryTable => 0,
    };
    let held = joystick.hold & switch != 0 && pressed & switch == 0;
    let dormant = match process {
        ProcessId::Grip => before.emove.dormant.grip,
        ProcessId::VGrip => before.emove.dormant.v_grip,
        ProcessId::ToolGrip => before.emove.dormant.tool_grip,
        ProcessId::Emove | ProcessId::Prim => recording,
        ProcessId::Task
        | ProcessId::Subtask
        | ProcessId::T3i
        | ProcessId::QuickChange
        | ProcessId::Pedestal
        | ProcessId::Hand
        | ProcessId::RotaryTable => false,
    };
    held || dormant
}

/// The header of a process's outputs.
const fn header_of(process: ProcessId, memory: &mut CommonMemory) -> &mut Header {
    match process {
        ProcessId::Task => &mut memory.task.header,
        ProcessId::Subtask => &mut memory.subtask.header,
        ProcessId::Emove => &mut memory.emove.header,
        ProcessId::Prim => &mut memory.prim.header,
        ProcessId::T3i => &mut memory.t3i.header,
        ProcessId::QuickChange => &mut memory.quick_change.header,
        ProcessId::Grip => &mut memory.grip.header,
        ProcessId::VGrip => &mut memory.v_grip.header,
        ProcessId::ToolGrip => &mut memory.tool_grip.header,
        ProcessId::Pedestal => &mut memory.pedestal.header,
        ProcessId::Hand => &mut memory.hand.header,
        ProcessId::RotaryTable => &mut memory.table.header,
    }
}

/// Publish the last outputs of a process that is not stepped again, so that its readers do not take it for lost
/// (docs/design/handshake.md "Stamp").
const fn republish(header: &mut Header, tick: Tick) {
    header.stamp = tick;
    header.republished = true;
}

/// A process of the pedestal that runs in another system: take over what it has sent, as if it had run here in this tick. Of one
/// that does not answer everything stays, the old stamp too, so that its readers know it for lost
/// (docs/design/handshake.md "Outside").
const fn adopt(process: ProcessId, sent: &OutsidePedestal, tick: Tick, memory: &mut CommonMemory) {
    if !sent.answers {
        return;
    }
    match process {
        ProcessId::Hand => memory.hand = sent.hand,
        ProcessId::RotaryTable => memory.table = sent.table,
        _ => memory.pedestal = sent.pedestal,
    }
    header_of(process, memory).stamp = tick;
}

impl Ladder {
    /// The processes and their tables, in the order of [`ProcessId`].
    #[must_use]
    pub const fn processes() -> &'static [ProcessInfo; PROCESS_COUNT] {
        &PROCESSES
    }

    /// One tick: read `before` and `external`, write `after`.
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

    /// One tick with the processes in another order, or of some of them: those of a board. What `after` holds of a process that
    /// is not named is what `before` held.
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

    /// The same, with somebody who is told of every stage as soon as it is over: `None` once the buffers are carried over from
    /// the tick before, then each process. He can measure times, which the levels cannot.
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
            if is_suspended(process, before, &external.devices.joystick, pressed) {
                republish(header_of(process, after), tick);
                continue;
            }
            match process {
                ProcessId::Task => self.task.step(&inputs, &mut after.task),
                ProcessId::Subtask => self.subtask.step(&inputs, &mut after.subtask),
                ProcessId::Emove => self.emove.step(&inputs, &mut after.emove),
                ProcessId::Prim => self.prim.step(&inputs, &mut after.prim),
                ProcessId::T3i => self.t3i.step(&inputs, &mut after.t3i),
                ProcessId::QuickChange => self.quick_change.step(&inputs, &mut after.quick_change),
                ProcessId::Grip => self.grip.step(&inputs, &mut after.grip),
                ProcessId::VGrip => self.v_grip.step(&inputs, &mut after.v_grip),
                ProcessId::ToolGrip => self.tool_grip.step(&inputs, &mut after.tool_grip),
                ProcessId::Pedestal | ProcessId::Hand | ProcessId::RotaryTable
                    if external.pedestal.elsewhere =>
                {
                    adopt(process, &external.pedestal, tick, after);
                }
                ProcessId::Pedestal => self.pedestal.step(&inputs, &mut after.pedestal),
                ProcessId::Hand => self.hand.step(&inputs, &mut after.hand),
                ProcessId::RotaryTable => self.table.step(&inputs, &mut after.table),
            }
            observe(Some(process));
        }
    }

    /// Restart a process: it forgets everything, as after a crash.
    pub fn restart(&mut self, process: ProcessId) {
        match process {
            ProcessId::Task => self.task = Task::default(),
            ProcessId::Subtask => self.subtask = Subtask::default(),
            ProcessId::Emove => self.emove = Emove::default(),
            ProcessId::Prim => self.prim = Prim::default(),
            ProcessId::T3i => self.t3i = T3i::default(),
            ProcessId::QuickChange => self.quick_change = QuickChange::default(),
            ProcessId::Grip => self.grip = Grip::default(),
            ProcessId::VGrip => self.v_grip = VGrip::default(),
            ProcessId::ToolGrip => self.tool_grip = ToolGrip::default(),
            ProcessId::Pedestal => self.pedestal = Pedestal::default(),
            ProcessId::Hand => self.hand = Hand::default(),
            ProcessId::RotaryTable => self.table = RotaryTable::default(),
        }
    }

    /// What all processes remember.
    #[must_use]
    pub fn state(&self) -> LadderState {
        fn of<P: Process<TaskData<'static>>>(process: &P) -> P::State {
            *process.state()
        }
        LadderState {
            task: of(&self.task),
            subtask: of(&self.subtask),
            emove: of(&self.emove),
            prim: of(&self.prim),
            t3i: of(&self.t3i),
            quick_change: of(&self.quick_change),
            grip: of(&self.grip),
            v_grip: of(&self.v_grip),
            tool_grip: of(&self.tool_grip),
            pedestal: of(&self.pedestal),
            hand: of(&self.hand),
            table: of(&self.table),
            buttons: self.buttons,
        }
    }

    /// Go on from a remembered state.
    pub fn restore(&mut self, state: &LadderState) {
        fn to<P: Process<TaskData<'static>>>(process: &mut P, state: P::State) {
            process.restore(state);
        }
        to(&mut self.task, state.task);
        to(&mut self.subtask, state.subtask);
        to(&mut self.emove, state.emove);
        to(&mut self.prim, state.prim);
        to(&mut self.t3i, state.t3i);
        to(&mut self.quick_change, state.quick_change);
        to(&mut self.grip, state.grip);
        to(&mut self.v_grip, state.v_grip);
        to(&mut self.tool_grip, state.tool_grip);
        to(&mut self.pedestal, state.pedestal);
        to(&mut self.hand, state.hand);
        to(&mut self.table, state.table);
        self.buttons = state.buttons;
    }
}
