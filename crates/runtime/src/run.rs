//! A run, from the first tick to the result.
//!
//! Between two ticks the run logs the cell of the next tick and warms up the caches for it.

mod end;
mod operate;
mod outcome;
mod start;
mod tell;

use std::{path::PathBuf, sync::atomic::Ordering, time::Instant};

use ::neighbours::workstation::player;
use depc::Plate;
use executive::{
    boards::Lost,
    failure::Failure,
    generations::Generations,
    memory::{Announced, Mirror, RunName},
    rest::RestWatch,
    runner::Runner,
    timing::Stage,
};
use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{CommonMemory, DeviceInputs, DeviceOutputs, ExternalInputs, device::LinkBytes};
use levels::ladder::LadderState;
use rcs_core::tick::Tick;
use taskdata::load::Job;

use self::end::Ramp;
pub use self::outcome::RunOutcome;
use crate::{
    boards::Controller,
    cell_view::View,
    config::{ClockKind, RunConfig},
    contacts::ContactCheck,
    event::Event,
    judge::NextData,
    live::Live,
    load::Loads,
    log::Log,
    neighbours::Neighbours,
    observer::{Observer, TickReport},
    operator::{Inputs, Operator},
    pace::Pace,
    result::{DataResult, Events},
    robot::Robot,
    truth::{TruthCheck, placement::PlacementCheck},
    verdict::{Ending, outside},
    workstation::SimulatedWorkstation,
};

/// Ticks for which the cell is simulated after the controller has stopped: two seconds, in which the arm comes to rest
/// and loosely held parts fall.
const SETTLING: usize = 50;

/// A run that has been set up.
pub struct Run {
    pub(crate) config: RunConfig,
    observer: Box<dyn Observer>,
    pub(crate) job: Job,
    /// Task data, with the blocks that are loaded during the run.
    pub(crate) generations: Generations,
    /// Number of generations made by a change instead of a line of the job.
    pub(crate) changed: u32,
    /// External inputs of the last tick.
    external: ExternalInputs,
    /// Mirrors the status; it must be dropped before the publisher of `runner`.
    mirror: Option<Mirror>,
    pub(crate) runner: Runner<Controller>,
    pub(crate) neighbours: Neighbours,
    pub(crate) workstation: SimulatedWorkstation,
    /// Source of operators' requests.
    pub(crate) asked: Inputs,
    operator: Operator,
    /// Loads that operators have requested.
    pub(crate) loads: Loads,
    /// Name of the run.
    pub(crate) name: RunName,
    inputs: DeviceInputs,
    pub(crate) robot: Robot,
    pub(crate) log: Option<Log>,
    log_path: Option<PathBuf>,
    /// Origin of the task data.
    data: DataResult,
    /// The live view.
    live: Option<Live>,
    pace: Pace,
    /// Time when the first tick was due.
    started: Option<Instant>,
    /// Ending of the run.
    ending: Option<Ending>,
    /// Check of the robot's contacts.
    pub(crate) check: ContactCheck,
    /// Check of the parts' places.
    pub(crate) placement: PlacementCheck,
    /// Judge of the confirmations of the control processes.
    pub(crate) truth: TruthCheck,
    /// The last warning on the screen of the T3 controller, and its tick.
    pub(crate) warning: Option<(Tick, String)>,
    /// The state of the cell for other programs.
    view: Box<View>,
    /// Events of the cell since the last tick, for the log of the next one.
    fresh: Vec<Event>,
    /// All events, for the result.
    events: Events,
    /// Detects when the robot is at rest.
    rest: RestWatch,
    /// The end of the run while the robot is brought to rest for it.
    ramp: Option<Ramp>,
    /// Ticks for which the host waits for an answer; at a port it waits for the first answer as long as `--wait`.
    patience: Option<u16>,
    first_patience: Option<u16>,
    /// The last reported state of the line.
    trouble: Option<&'static str>,
    /// What a person must do before the failed job can continue.
    remedy: Option<&'static str>,
    /// The run for programs that look for it. It must be dropped after `runner`.
    announced: Option<Announced>,
}

impl Run {
    /// Run to the end, and return the outcome.
    #[must_use]
    pub fn complete(mut self) -> RunOutcome {
        while self.step() {}
        self.finish()
    }

    /// Run one tick. Returns false if the run has ended; further calls do nothing.
    pub fn step(&mut self) -> bool {
        if self.ending.is_none() {
            if self.started.is_none() {
                self.begin();
            }
            self.ending = self.tick();
        }
        self.ending.is_none()
    }

    /// The last tick.
    #[must_use]
    pub const fn last_tick(&self) -> Tick {
        self.runner.tick()
    }

    /// All buffers after the last tick.
    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.runner.memory()
    }

    /// The external inputs of the last tick.
    #[must_use]
    pub const fn external_inputs(&self) -> &ExternalInputs {
        &self.external
    }

    /// Digest of the present state of the simulated cell; the log has it for every tick.
    #[must_use]
    pub fn cell_digest(&self) -> u64 {
        self.workstation.cell.digest()
    }

    /// Start the clock and prepare the first tick. The 40 ms grid begins with the clock, so the preparation counts.
    fn begin(&mut self) {
        self.started = Some(Instant::now());
        if self.config.clock == ClockKind::Real {
            self.ask_for_real_time(self.config.cpu);
        }
        self.show_cell();
        self.neighbours.begin(self.runner.memory(), &self.inputs);
        self.note_neighbours(self.runner.tick().next());
    }

    /// Request real-time settings. The thread of the log runs already, so it keeps its ordinary priority.
    fn ask_for_real_time(&mut self, core: Option<usize>) {
        let granted = self.pace.ask_for_real_time(core, self.config.speed);
        self.observer.message(&granted.to_string());
        let boards = self.runner.levels().unpunctual().into_iter().map(Event::BoardNotPunctual);
        for event in std::iter::once(granted).chain(boards) {
            self.log_event(Tick::BEFORE_START.next(), &event);
        }
    }

    /// Warm up the next tick, if there is time, and wait until it is due.
    fn wait(&mut self) {
        if self.pace.wake_early() {
            let external = self.external();
            self.runner.warm_up(&external, &self.generations.current().view());
        }
        let tick = self.runner.tick().next();
        for event in self.pace.wait(self.runner.stage_times()) {
            self.observer.message(&format!("tick {tick}: {event}"));
            self.log_event(tick, &event);
        }
        self.runner.stage_times_mut().begin();
    }

    /// The external inputs of the next tick.
    fn external(&self) -> ExternalInputs {
        let mut devices = self.pace.inputs(self.inputs);
        devices.link_patience = self.first_patience.or(self.patience);
        devices.robot_lag = self.config.robot.lag.or_else(|| self.robot.lag_ms());
        devices.joystick = self.operator.at_the_box(devices.joystick);
        if self.ramp.is_some() {
            devices.joystick.velocity = 0;
        }
        ExternalInputs {
            hws: *self.neighbours.hws(),
            devices,
            data_base: self.neighbours.data_base(),
            generation: self.generations.number(),
            pedestal: *self.neighbours.pedestal(),
            operator: *self.operator.at_the_terminals(),
        }
    }

    /// Run one tick. Returns the ending if the run ends with it.
    fn tick(&mut self) -> Option<Ending> {
        self.wait();
        self.robot.receive(&mut self.inputs);
        let external = self.external();
        self.external = external;
        if let Some(live) = &self.live {
            live.knob(external.devices.joystick.velocity);
        }
        let tick = self.runner.tick().next();
        let data = self.generations.current().view();
        let memory = loop {
            match self.runner.step(&external, &data, self.pace.skipped()).copied() {
                Ok(memory) => break memory,
                // If a board replaces the lost one, the boards run the same tick again.
                Err(lost) if self.runner.levels_mut().replace(&lost, &self.config, &mut *self.observer) => {}
                Err(lost) => return Some(Ending::Failed(self.lost(&lost, &external))),
            }
        };
        let outputs = memory.device_outputs();
        let runner = &self.runner;
        self.robot.send(&outputs, || commanded(&runner.levels().state(), runner.memory()));
        self.runner.stage_times_mut().mark(Stage::Line);
        if let Some(log) = &mut self.log {
            if self.pace.is_real() {
                log.timing(self.runner.last_ns(), self.pace.skipped());
            }
            log.tick(tick, &external, &memory, || self.runner.levels().state());
        }
        self.runner.stage_times_mut().mark(Stage::Log);
        self.advance(tick, &outputs);
        let commands = self.check.commands(&memory);
        self.observe(tick, commands);
        let cell = &self.workstation.cell;
        let task = &memory.task.status;
        self.placement.look(tick, &external.hws, task, cell.description(), &cell.parts());
        self.judge(tick, &memory);
        self.runner.stage_times_mut().mark(Stage::Cell);
        let steps = self.neighbours.begun_steps();
        let ((line, lines), hws) = (self.neighbours.place(), &external.hws);
        self.observer.tick(&TickReport { tick, line, lines, steps, hws, memory: &memory });
        self.operate(tick);
        let data = NextData { generations: &self.generations, job: &self.job, changed: self.changed };
        let progress = self.neighbours.step(tick, &memory, &self.inputs, &mut self.workstation, data);
        self.load_for_workstation(tick);
        self.tell_operators(tick);
        self.note_neighbours(tick);
        self.note_viewers(tick);
        self.publish_cell(tick);
        // Vision in another process has answered the last tick.
        self.inputs.vision = self.workstation.cell.inputs().vision;
        match progress {
            player::Progress::Over => return Some(self.left(Ending::Finished)),
            // Contacts of the sinking arm belong to the run.
            player::Progress::Failed(_) if self.workstation.is_settling(tick) => {}
            player::Progress::Failed(failure) => {
                self.remedy = self.remedy.or(failure.remedy());
                let ending = Ending::Failed(self.explain(&failure, &external));
                self.end_at_rest(ending);
            }
            player::Progress::Running => {}
        }
        // An obstacle stops an arm that sinks without pressure; the verdict is the emergency.
        let stuck = self.check.is_stuck() && !self.workstation.is_settling(tick);
        if let Some(failure) = self.check.verdict().filter(|_| stuck) {
            return Some(Ending::Failed(failure));
        }
        if let Some(overrun) = self.pace.ends(&memory) {
            let text = format!("{overrun}; --overrun {} ends the run then", self.pace.policy());
            return Some(Ending::Failed(Failure { stopped: true, ..outside(tick, "executive", text) }));
        }
        self.runner.stage_times_mut().mark(Stage::Workstation);
        if self.config.stop.load(Ordering::Relaxed) {
            self.stop_as_asked(tick);
        }
        if self.config.ticks.is_some_and(|ticks| tick.0 >= ticks) {
            if self.config.clock == ClockKind::Fast && !self.robot.is_elsewhere() {
                return Some(self.left(Ending::Stopped));
            }
            self.end_at_rest(Ending::Stopped);
        }
        self.watch_link(tick, &memory);
        if let Some(ending) = self.at_rest(&memory) {
            return Some(ending);
        }
        self.reload();
        self.show_cell();
        let stage_times = self.runner.stage_times_mut();
        stage_times.mark(Stage::Inputs);
        stage_times.finish();
        None
    }

    /// The rest of a tick: advance the cell.
    fn advance(&mut self, tick: Tick, outputs: &DeviceOutputs) {
        let controller = self.runner.levels();
        self.inputs = self
            .robot
            .advance(tick, &mut self.workstation.cell, outputs, || acknowledged(&controller.state()));
    }

    /// Handle the loss of a board: the robot gets no more frames and the valves keep their state, while the simulation
    /// of the cell continues.
    fn lost(&mut self, lost: &Lost, external: &ExternalInputs) -> Failure {
        let memory = *self.runner.memory();
        let silent = DeviceOutputs { link_tx: LinkBytes::default(), ..memory.device_outputs() };
        for tick in (lost.tick.0..).take(SETTLING).map(Tick) {
            self.advance(tick, &silent);
            let commands = self.check.commands(&memory);
            self.observe(tick, commands);
        }
        Failure {
            stopped: true,
            ..outside(lost.tick, &lost.board.to_string(), lost.explain(&external.hws, &memory))
        }
    }

    /// Accept the reloads that the job has requested; they take effect in the next tick if no command is in progress.
    fn reload(&mut self) {
        let reloads = &self.job.reloads;
        let reload =
            |number: u32| usize::try_from(number).ok()?.checked_sub(1).and_then(|at| reloads.get(at));
        let coming = self.workstation.loads().into_iter().map(|number| number + self.changed);
        for reload in coming.filter_map(reload) {
            self.generations.propose(reload.store.clone());
        }
        if !self.generations.advance(self.runner.memory()) {
            return;
        }
        // Reloads are proposed in order, so that the number of a generation is that of its reload.
        let (tick, number) = (self.runner.tick().next(), self.generations.number());
        if let (Some(log), Some(reload)) = (&mut self.log, reload(number)) {
            log.reload(tick, number, &reload.source);
        }
    }
}

/// The position that the robot has last acknowledged or reported, while the link runs.
fn acknowledged(state: &LadderState) -> Option<Plate> {
    let host = state.t3i.host;
    host.is_running().then(|| host.position())
}

/// The tool frame that Prim has commanded in this tick, as T3I gets it and exactly.
fn commanded(state: &LadderState, memory: &CommonMemory) -> Option<(WireFrame, Frame)> {
    state.prim.motion.map(|motion| (memory.prim.t3i.frame, motion.frame()))
}
