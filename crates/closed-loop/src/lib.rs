//! A run as a value: control processes, cell, line, mailboxes and Data System, without clock, thread, file or
//! network.
//!
//! Copies of a [`ClosedLoop`] continue bit for bit alike, even in different threads. A program waits for the next
//! tick, supplies the external inputs ([`Given`]), and sends the outputs. The order within a tick:
//!
//! ```text
//!   decide(given) ──► the processes run on the inputs       bytes leave for the robot when it returns
//!   settle(moved) ──► the cell moves on, and is judged       contacts, places of parts, confirmations
//!        operators act here, between cell and mailboxes
//!   exchange(..)  ──► Data System and source of commands     they read the outputs of the tick
//!   reload()      ──► task data that the job has loaded      unless a command is executed
//! ```
//!
//! The cell is a [`World`]: the simulated one, whose contacts, places and confirmations are judged, or the ideal one
//! ([`ideal`]).
//!
//! `rcs-run run` adds clock, log, boards, robots and neighbours; `rcs-run campaign` forks the loop.

pub mod account;
pub mod chain;
pub mod contacts;
pub mod course;
pub mod devices;
pub mod failure;
pub mod field;
pub mod generations;
mod given;
pub mod ideal;
mod line;
mod player;
mod present;
pub mod rest;
mod simulated;
pub mod truth;
pub mod workstation;
mod world;

use std::sync::Arc;

use crate::course::{Course, Levels};
use depc::Plate;
use interfaces::{
    CommonMemory, DeviceInputs, DeviceOutputs, ExternalInputs, Header, HwsCommand, device::LinkBytes,
};
use levels::ladder::ProcessId;
use neighbours::{
    data_system::{ANSWER_TICKS, DataSystem, InMemory},
    workstation::{Gate, TaskState},
};
use os_io::alloc::Section;
use rcs_core::{digest::Digest, tick::Tick};
use taskdata::{
    files::TaskData,
    load::{Store, job::Reload},
};

use self::{generations::Generations, given::combined, workstation::SimulatedWorkstation};
pub use self::{
    given::{Given, RobotInputs},
    line::RobotLine,
    player::{CommandBox, Commander, JobPlayer},
    present::Present,
    simulated::Settled,
    world::{Turn, World},
};

#[derive(Clone)]
pub struct ClosedLoop<L = Present, W: World = SimulatedWorkstation> {
    course: Course<L>,
    generations: Generations,
    external: ExternalInputs,
    inputs: DeviceInputs,
    gate: Gate,
    books: Option<DataSystem<InMemory>>, // the Data System; `None` for an external one
    checks: W::Checks,
    pub workstation: W, // the cell and the other equipment of the workstation
}

pub struct StepContext<'a, W = SimulatedWorkstation> {
    pub tick: Tick,
    pub memory: &'a CommonMemory,
    pub inputs: &'a DeviceInputs,
    pub gate: &'a mut Gate, // Task's end of the mailboxes; its status box contains the status of this tick
    pub workstation: &'a mut W, // the cell and the other equipment of the workstation
    pub generations: &'a Generations,
}

impl<L, W: World> ClosedLoop<L, W> {
    /// A run before its first tick: control processes, task data with the reloads of the job, and a world.
    #[must_use]
    pub fn in_world(levels: L, store: Arc<Store>, reloads: Arc<Vec<Reload>>, world: W) -> Self {
        Self {
            course: Course::new(levels),
            generations: Generations::new(store, reloads),
            external: ExternalInputs::default(),
            inputs: world.inputs(),
            gate: Gate::default(),
            books: Some(DataSystem::in_memory(ANSWER_TICKS)),
            checks: world.checks(),
            workstation: world,
        }
    }

    #[must_use]
    pub fn with_data_system_elsewhere(self) -> Self {
        Self { books: None, ..self }
    }

    /// Continues like a controller that lost its power after `tick`, with its knowledge. The world continues.
    pub fn resume(&mut self, tick: Tick, memory: &CommonMemory, hws: &HwsCommand, generation: u32) {
        self.course.start_after(tick, memory);
        self.gate = Gate::resumed(hws);
        self.generations.resume(generation);
    }

    #[must_use]
    pub fn external_with(&self, given: &Given) -> ExternalInputs {
        let mut devices = self.inputs;
        if let Some(robot) = &given.robot {
            (devices.link_rx, devices.link_ready, devices.link_unsent) =
                (robot.rx, robot.ready, robot.unsent);
            devices.resolvers = robot.resolvers.unwrap_or(devices.resolvers);
        }
        (devices.link_patience, devices.robot_lag) = (given.silence_limit, given.lag);
        devices.joystick = combined(&given.joystick, devices.joystick);
        ExternalInputs {
            hws: *self.gate.command(),
            devices,
            data_base: self.books.as_ref().map_or(given.data_base, DataSystem::status),
            generation: self.generations.number(),
            pedestal: given.pedestal,
            operator: given.terminals,
        }
    }

    /// First part of a tick: the control processes. Does not allocate. After an error of the levels the tick is void.
    pub fn decide<E>(&mut self, given: &Given) -> Result<(), E>
    where
        L: for<'a> Levels<TaskData<'a>, Error = E>,
    {
        self.decide_with(given, |course, external, data| {
            let _section = Section::enter();
            course.advance(external, data)
        })
    }

    /// Like [`decide`](Self::decide), with a function that advances the course by a tick and sums it up. Errors:
    /// errors of that function. The tick is then void and can be decided again.
    pub fn decide_with<E>(
        &mut self,
        given: &Given,
        run: impl FnOnce(&mut Course<L>, &ExternalInputs, &TaskData<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.external = self.external_with(given);
        run(&mut self.course, &self.external, &self.generations.current().view())
    }

    /// Call a function with the course and the task data of the next tick, for example to warm it up.
    pub fn with_data<T>(&mut self, act: impl FnOnce(&mut Course<L>, &TaskData<'_>) -> T) -> T {
        act(&mut self.course, &self.generations.current().view())
    }

    /// The last tick's outputs; all zero while no process runs. A lost T3 Interface sends its last frame only once.
    #[must_use]
    pub fn outputs(&self) -> DeviceOutputs {
        let memory = self.course.memory();
        let outputs = memory.device_outputs();
        let runs = |process| memory.header(process).stamp == self.course.tick();
        if !ProcessId::ALL.iter().copied().any(runs) {
            return DeviceOutputs::default();
        }
        if runs(ProcessId::T3i) {
            outputs
        } else {
            DeviceOutputs { link_tx: LinkBytes::default(), ..outputs }
        }
    }

    /// Second part of a tick: advance the cell and judge it. With an external robot the cell follows its position
    /// `moved`, as far as known, and confirmations are not judged: the cell is only a model of the real one.
    pub fn settle(&mut self, moved: Option<&Plate>) -> W::Settled {
        let outputs = self.outputs();
        let Self { course, external, generations, workstation, checks, .. } = self;
        let (tick, memory) = (course.tick(), course.memory());
        let (hws, data) = (&external.hws, &generations.current().view());
        let settled;
        (self.inputs, settled) =
            workstation.settle(checks, &Turn { tick, hws, memory, data, outputs: &outputs, moved });
        settled
    }

    /// Third part of a tick: Data System and command source read the outputs of the tick. The source is `command`: it
    /// reads its status from the gate and lets the gate read its command. The next tick uses the results.
    pub fn exchange<T>(&mut self, command: impl FnOnce(StepContext<'_, W>) -> T) -> T {
        let (tick, memory) = (self.course.tick(), self.course.memory());
        if let Some(books) = &mut self.books {
            books.step(tick, &memory.task.data_base);
        }
        self.gate.write(memory, task_state(&memory.task.header, tick));
        let result = command(self.desk());
        // An external vision system may have answered meanwhile.
        self.inputs.vision = self.workstation.inputs().vision;
        result
    }

    /// View of a command source, or an operator, between two ticks.
    pub const fn desk(&mut self) -> StepContext<'_, W> {
        StepContext {
            tick: self.course.tick(),
            memory: self.course.memory(),
            inputs: &self.inputs,
            gate: &mut self.gate,
            workstation: &mut self.workstation,
            generations: &self.generations,
        }
    }

    /// Puts loaded task data into effect if no command is being executed. Returns true if the generation has changed.
    pub fn reload(&mut self) -> bool {
        for number in self.workstation.loads() {
            self.generations.propose(number);
        }
        self.generations.advance(self.course.memory())
    }

    #[must_use]
    pub const fn tick(&self) -> Tick {
        self.course.tick()
    }

    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.course.memory()
    }

    #[must_use]
    pub const fn course(&self) -> &Course<L> {
        &self.course
    }

    /// For changes of the control processes between two ticks, and for a warm-up.
    pub const fn course_mut(&mut self) -> &mut Course<L> {
        &mut self.course
    }

    #[must_use]
    pub const fn digest(&self) -> Digest {
        self.course.digest()
    }

    #[must_use]
    pub const fn external(&self) -> &ExternalInputs {
        &self.external
    }

    #[must_use]
    pub const fn inputs(&self) -> &DeviceInputs {
        &self.inputs
    }

    #[must_use]
    pub const fn command(&self) -> &HwsCommand {
        self.gate.command()
    }

    #[must_use]
    pub const fn gate(&self) -> &Gate {
        &self.gate
    }

    #[must_use]
    pub const fn generations(&self) -> &Generations {
        &self.generations
    }

    pub const fn generations_mut(&mut self) -> &mut Generations {
        &mut self.generations
    }

    #[must_use]
    pub const fn books(&self) -> Option<&DataSystem<InMemory>> {
        self.books.as_ref()
    }

    pub const fn books_mut(&mut self) -> Option<&mut DataSystem<InMemory>> {
        self.books.as_mut()
    }
}

const fn task_state(header: &Header, tick: Tick) -> TaskState {
    if header.stamp.0 != tick.0 {
        TaskState::Lost
    } else if header.republished {
        TaskState::Held
    } else {
        TaskState::Runs
    }
}
