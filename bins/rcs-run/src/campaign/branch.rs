//! A run that can be forked: controller, cell, line, mailboxes and Data System, without log, clock, network and shared
//! memory.
//!
//! A tick of a [`Branch`] does what a tick of `rcs-run run` does with the fast clock and the simulated robot, in the
//! same order, so that both have the same digest. Any number of copies can continue from a state, each in its own
//! thread.

use std::{
    convert::Infallible,
    fmt::{self, Write as _},
};

use depc::fault::{Direction, FaultKind, Injector, Plan, Rule};
use executive::{
    alloc::Section,
    course::{Course, Levels},
    failure::Watch,
    generations::is_busy,
};
use interfaces::{
    CommonMemory, DeviceInputs, DeviceOutputs, ExternalInputs, HwsCommand, OperatorInputs, OutsidePedestal,
    device::LinkBytes,
};
use levels::ladder::{Ladder, LadderState, ProcessId};
use neighbours::{
    data_system::{ANSWER_TICKS, DataSystem, InMemory, Item},
    mailbox::{HWSC_COMMAND, Mailbox},
    workstation::{
        Gate, Unchecked, command,
        player::Hwsc,
        status::{self, Status},
    },
};
use plant::{Cell, CellDescription, CellEvent};
use rcs_core::{Plain as _, digest::Digest, tick::Tick};
use taskdata::{
    files::TaskData,
    load::{Job, Store},
};

use runtime::{
    StartError,
    contacts::{ContactCheck, FREE},
    neighbours::task_state,
    truth::{Confirmation, Scene, TruthCheck},
    workstation::SimulatedWorkstation,
};

use super::past;
use crate::error::Error;

/// Ticks of delay of a late answer: more than the three ticks for which the host waits.
const LATE: u16 = 5;

/// The data that all branches of a campaign share.
pub struct Facility {
    /// Task data.
    pub store: Store,
    /// The job.
    pub job: Job,
    /// The cell description.
    pub description: CellDescription,
    /// Seed of the cell's noise.
    pub seed: u64,
}

/// Commands Task in a branch, and operates the workstation beside the robot.
pub trait Commander {
    /// Called once per tick: reads Task's status and returns the command to write into the mailbox, if any.
    fn step(
        &mut self,
        tick: Tick,
        status: &Status<'_>,
        workstation: &mut SimulatedWorkstation,
    ) -> Option<HwsCommand>;
}

impl Commander for Hwsc {
    fn step(
        &mut self,
        tick: Tick,
        status: &Status<'_>,
        workstation: &mut SimulatedWorkstation,
    ) -> Option<HwsCommand> {
        Self::step(self, tick, status, workstation);
        self.mailgram().copied()
    }
}

/// The line to the robot controller.
#[derive(Clone, Copy, Debug, Default)]
struct RobotLine {
    /// Faults of a fault file.
    file: Option<Injector>,
    /// Fault of the next answer.
    armed: Option<FaultKind>,
    /// Carries out the fault of the last answer that was hit.
    answer: Option<Injector>,
}

impl RobotLine {
    fn advance(&mut self, tick: Tick, cell: &mut Cell, outputs: &DeviceOutputs) -> DeviceInputs {
        let mut inputs = match &mut self.file {
            None => cell.step(outputs),
            Some(injector) => cell.step_behind(injector, tick, outputs),
        };
        self.strike(tick, &inputs);
        if let Some(injector) = &mut self.answer {
            (inputs.link_rx, inputs.link_ready) =
                injector.carry(Direction::ToHost, tick, &inputs.link_rx, inputs.link_ready);
        }
        inputs
    }

    /// Hits an answer: if a fault is armed and bytes have come, the line has this fault in this tick.
    fn strike(&mut self, tick: Tick, inputs: &DeviceInputs) {
        let Some(kind) = self.armed.filter(|_| inputs.link_rx.length > 0) else { return };
        self.armed = None;
        let rule = Rule::new(kind).at(tick.0).only(Direction::ToHost);
        let rule = if kind == FaultKind::Delay { rule.ticks(LATE) } else { rule };
        let mut plan = Plan::new(tick.0);
        // A plan with one rule accepts every rule for a single tick.
        if plan.add(rule).is_ok() {
            self.answer = Some(Injector::new(&plan));
        }
    }
}

/// The ladder of processes. Lost processes do not run: they write nothing, so that their stamps do not change.
#[derive(Clone)]
struct Present {
    ladder: Ladder,
    processes: Vec<ProcessId>,
}

impl Levels<TaskData<'_>> for Present {
    type Error = Infallible;

    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Infallible> {
        self.ladder.step_observed(&self.processes, tick, before, external, data, after, observe);
        Ok(())
    }
}

/// The state of a branch without cell and Data System.
#[derive(Clone)]
struct Control {
    course: Course<Present>,
    external: ExternalInputs,
    gate: Gate,
    command_box: Mailbox,
    check: ContactCheck,
    truth: TruthCheck,
    inputs: DeviceInputs,
    line: RobotLine,
    /// Generation of the task data, and the requested reloads that wait for the end of a command.
    generation: u32,
    asked: Vec<u32>,
}

/// A run between two ticks. A copy continues from the same state.
#[derive(Clone)]
pub struct Branch<'f> {
    facility: &'f Facility,
    control: Control,
    data_system: DataSystem<InMemory>,
    /// The cell and the workstation's other equipment.
    pub workstation: SimulatedWorkstation,
    /// Events in the cell in the last tick.
    pub events: Vec<CellEvent>,
    /// Confirmations of the last tick that are not true.
    pub untrue: Vec<Confirmation>,
}

impl<'f> Branch<'f> {
    /// The run before its first tick.
    ///
    /// # Errors
    /// [`Error`] if the cell cannot be built.
    pub fn start(facility: &'f Facility) -> Result<Self, Error> {
        let cell = Cell::new(&facility.description, facility.seed).map_err(StartError::from)?;
        let control = Control {
            course: Course::new(Present { ladder: Ladder::default(), processes: ProcessId::ALL.to_vec() }),
            external: ExternalInputs::default(),
            gate: Gate::default(),
            command_box: Mailbox::initialized(HWSC_COMMAND),
            check: ContactCheck::new(facility.description.contact.clone()),
            truth: TruthCheck::default(),
            inputs: cell.inputs(),
            line: RobotLine::default(),
            generation: 0,
            asked: Vec::new(),
        };
        Ok(Self {
            facility,
            control,
            data_system: DataSystem::in_memory(ANSWER_TICKS),
            workstation: SimulatedWorkstation::new(cell),
            events: Vec::new(),
            untrue: Vec::new(),
        })
    }

    /// Run a tick.
    pub fn tick(&mut self, commander: &mut impl Commander) {
        let control = &mut self.control;
        control.external = ExternalInputs {
            hws: *control.gate.command(),
            devices: control.inputs,
            data_base: self.data_system.status(),
            generation: control.generation,
            pedestal: OutsidePedestal::ZERO,
            operator: OperatorInputs::ZERO,
        };
        let data = data(self.facility, control.generation);
        {
            let _section = Section::enter();
            let Ok(()) = control.course.step(&control.external, &data, &mut |_| {});
            control.course.sum_up(&control.external);
        }
        let mut outputs = control.course.memory().device_outputs();
        if !control.course.levels().processes.contains(&ProcessId::T3i) {
            // The last frame of a lost process goes out only once.
            outputs.link_tx = LinkBytes::ZERO;
        }
        control.inputs = control.line.advance(control.course.tick(), &mut self.workstation.cell, &outputs);
        self.observe();
        let course = &self.control.course;
        self.data_system.step(course.tick(), &course.memory().task.data_base);
        self.exchange(commander);
        self.control.inputs.vision = self.workstation.cell.inputs().vision;
        self.reload();
    }

    /// Record what has happened in the cell.
    fn observe(&mut self) {
        let control = &mut self.control;
        let tick = control.course.tick();
        self.events = self.workstation.events(tick);
        let commands = control.check.commands(control.course.memory());
        control.check.look(tick, self.workstation.cell.contacts(), commands);
        control.truth.note_delivered(tick, self.workstation.delivered());
        let (hws, data) = (&control.external.hws, &data(self.facility, control.generation));
        let (memory, cell) = (control.course.memory(), &self.workstation.cell);
        self.untrue = control.truth.look(&Scene { tick, hws, memory, data, cell });
        // What passes by without a touch is of no interest here.
        self.workstation.cell.watch_clearance(FREE);
    }

    /// Pass Task's status to the commander, and its command to Task.
    fn exchange(&mut self, commander: &mut impl Commander) {
        let control = &mut self.control;
        let (tick, memory) = (control.course.tick(), control.course.memory());
        control.gate.write(memory, task_state(&memory.task.header, tick));
        let command = status::decode(control.gate.status_box().data())
            .ok()
            .and_then(|status| commander.step(tick, &status, &mut self.workstation));
        // The commands come from a job, whose fields fit into the mailbox.
        if let Some(bytes) = command.and_then(|command| command::encode(&command).ok()) {
            let _ = control.command_box.write(&bytes);
        }
        // The job was checked when it was loaded.
        control.gate.read(&control.command_box, &Unchecked);
    }

    /// Make the task data that the job has loaded visible when Task executes no command.
    fn reload(&mut self) {
        let control = &mut self.control;
        control.asked.extend(self.workstation.loads());
        if !is_busy(control.course.memory()) && !control.asked.is_empty() {
            control.generation = control.asked.remove(0);
        }
    }

    /// Note that a person has changed these parts after the last tick.
    pub fn note_changed(&mut self, parts: Vec<u32>) {
        let next = self.at().next();
        self.control.truth.note_changed(next, parts);
    }

    /// Number of confirmations that were judged so far.
    #[must_use]
    pub const fn judged(&self) -> u64 {
        self.control.truth.result().judged
    }

    /// Restart a process: it loses its state.
    pub fn restart(&mut self, process: ProcessId) {
        self.control.course.levels_mut().ladder.restart(process);
    }

    /// Lose a process: it writes nothing from now on.
    pub fn lose(&mut self, process: ProcessId) {
        self.control.course.levels_mut().processes.retain(|present| *present != process);
    }

    /// Give the next answer of the robot controller a fault.
    pub const fn spoil_answer(&mut self, kind: FaultKind) {
        self.control.line.armed = Some(kind);
    }

    /// Give the line the faults of a plan from now on.
    pub fn spoil_line(&mut self, plan: &Plan) {
        self.control.line.file = Some(Injector::new(plan));
    }

    /// Cut the cable to the robot controller: from now on no byte arrives, and DTR of the other end is off.
    pub fn cut(&mut self) {
        let from = self.at().0 + 1;
        let mut plan = Plan::new(0);
        for kind in [FaultKind::Drop, FaultKind::CtsLow] {
            // Two rules of different kinds never conflict.
            let _ = plan.add(Rule::new(kind).window(from, u64::MAX));
        }
        self.spoil_line(&plan);
    }

    /// The last tick.
    #[must_use]
    pub const fn at(&self) -> Tick {
        self.control.course.tick()
    }

    /// The processes that are not lost.
    #[must_use]
    pub fn processes(&self) -> &[ProcessId] {
        &self.control.course.levels().processes
    }

    /// What the Data System knows of the items.
    ///
    /// # Errors
    /// A text that says why it cannot list them.
    pub fn items(&mut self) -> Result<Vec<Item>, String> {
        self.data_system.items()
    }

    /// Common memory after the last tick.
    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.control.course.memory()
    }

    /// The state of the control processes after the last tick.
    #[must_use]
    pub fn ladder(&self) -> LadderState {
        self.control.course.levels().ladder.state()
    }

    /// The inputs from outside for the last tick.
    #[must_use]
    pub const fn external(&self) -> &ExternalInputs {
        &self.control.external
    }

    /// Fingerprint of all ticks so far.
    #[must_use]
    pub const fn digest(&self) -> Digest {
        self.control.course.digest()
    }

    /// Forget the faults of cell and line that are over. Call it only if no others follow.
    pub fn forget_past_faults(&mut self) {
        self.workstation.cell.forget_past_faults();
        let (tick, line) = (self.at(), &mut self.control.line);
        line.file.take_if(|injector| injector.is_over(tick));
        line.answer.take_if(|injector| injector.is_over(tick));
    }

    /// Digest of everything on which the next ticks depend, but for numbers and times that make no difference
    /// ([`past`]), and of `beside`.
    ///
    /// # Errors
    /// [`Error::Fork`] if the cell cannot be saved.
    pub fn state(&self, beside: &impl fmt::Debug) -> Result<Digest, Error> {
        let cell = self.workstation.cell.save().map_err(|error| Error::Fork(error.to_string()))?;
        let Control { course, gate, command_box, check, inputs, line, generation, asked, .. } = &self.control;
        let (mut memory, mut ladder) = (*course.memory(), self.ladder());
        let command = gate.command();
        past::forget(&mut memory, &mut ladder, self.at());
        for echo in [&mut memory.task.status.echo, &mut ladder.task.execution.receiver.echo] {
            *echo = echo.wrapping_sub(command.number);
        }
        let mut digest = Digest::new();
        digest.add(&cell);
        let mut scratch = vec![0; CommonMemory::SIZE.max(LadderState::SIZE)];
        digest.add_record(&memory, &mut scratch);
        digest.add_record(&ladder, &mut scratch);
        digest.add_record(inputs, &mut scratch);
        let command = HwsCommand { number: 0, ..*command };
        let mailboxes = (command, gate.refused(), gate.unread(command_box), line, &course.levels().processes);
        let data = (generation, asked, self.data_system.state(self.at()));
        let all = (mailboxes, data, check.state(), self.workstation.state(), beside);
        // Writing into a digest cannot fail.
        let _ = write!(Text(&mut digest), "{all:?}");
        Ok(digest)
    }

    /// The contacts of the robot.
    #[must_use]
    pub const fn check(&self) -> &ContactCheck {
        &self.control.check
    }

    /// The process that failed first, and its reason.
    #[must_use]
    pub const fn watch(&self) -> &Watch {
        self.control.course.watch()
    }

    /// Number of Task's present command.
    #[must_use]
    pub const fn command(&self) -> &HwsCommand {
        self.control.gate.command()
    }

    /// The data that all branches share.
    #[must_use]
    pub const fn facility(&self) -> &'f Facility {
        self.facility
    }
}

/// Text that is added to a digest.
struct Text<'d>(&'d mut Digest);

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.add(text.as_bytes());
        Ok(())
    }
}

/// The task data of a generation: 0 as loaded, then one per reload of the job.
fn data(facility: &Facility, generation: u32) -> TaskData<'_> {
    let reload = usize::try_from(generation).ok().and_then(|number| number.checked_sub(1));
    reload.and_then(|at| facility.job.reloads.get(at)).map_or(&facility.store, |reload| &reload.store).view()
}
