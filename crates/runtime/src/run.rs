//! A run, from the first tick to the result. It logs and warms up between two ticks.

mod end;
mod operate;
mod outcome;
mod start;
mod tell;

use std::{path::PathBuf, sync::atomic::Ordering, time::Instant};

use ::neighbours::workstation::player::{self, WaitReason};
use closed_loop::{ClosedLoop, Given, RobotInputs};
use closed_loop::{
    account::{Alarms, Kind},
    chain::History,
    failure::Failure,
    rest::RestWatch,
};
use depc::Plate;
use executive::{
    boards::Lost,
    memory::{Announced, Mirror, RunName},
    runner::Runner,
    timing::Stage,
};
use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{CommonMemory, ExternalInputs, device::Resolvers, hws::HwsStatus};
use levels::ladder::LadderState;
use plant::Cell;
use rcs_core::tick::Tick;
use record::journal::Journal;
use taskdata::load::Job;

use self::end::Ramp;
pub use self::outcome::RunOutcome;
use crate::{
    boards::Controller,
    cell_view::View,
    config::{ClockKind, RunConfig},
    contradiction::Contradictions,
    event::Event,
    field::FieldPort,
    live::Live,
    load::Loads,
    log::Log,
    neighbours::Neighbours,
    observer::{Observer, TickReport},
    operator::{Inputs, Operator},
    pace::Pace,
    result::{DataResult, Events},
    resume::Causes,
    robot::Robot,
    verdict::Ending,
    views::Viewed,
};

/// Ticks that the cell is simulated after the controller has stopped, so that arm and loose parts come to rest: 2 s.
const SETTLING: usize = 50;

pub struct Run {
    pub(crate) config: RunConfig,
    observer: Box<dyn Observer>,
    pub(crate) job: Job,
    pub(crate) closed: ClosedLoop<Controller>,
    mirror: Option<Mirror>, // mirrors the status; it must be dropped before the publisher of `runner`
    pub(crate) runner: Runner<Controller>,
    pub(crate) neighbours: Neighbours,
    pub(crate) asked: Inputs,
    operator: Operator,
    pub(crate) loads: Loads,
    pub(crate) name: RunName,
    pub(crate) robot: Robot,
    pub(crate) field: Option<FieldPort>, // the couplers over TCP, if any
    pub(crate) log: Option<Log>,
    log_path: Option<PathBuf>,
    journal: Option<Journal>,
    journal_trouble: Option<String>,        // why the journal is not written
    contradictions: Option<Contradictions>, // of a resumed run, until its job continues
    data: DataResult,
    live: Option<Live>,
    pace: Pace,
    started: Option<Instant>,
    ending: Option<Ending>,
    pub(crate) warning: Option<Failure>, // the last warning on the screen of the robot controller
    pub(crate) alarms: Alarms,           // emergencies, fallen parts, and failed devices of the cell
    task: HwsStatus,
    history: History, // changes of the processes, for the chain of a failure
    view: Box<View>,
    /// The states of the run that were logged last, and the reason why the job waits, if it does.
    viewed: Viewed,
    waits: Option<WaitReason>,
    fresh: Vec<Event>, // events of the cell since the last tick, for the log of the next one
    events: Events,
    rest: RestWatch,
    ramp: Option<Ramp>, // the end of the run for which the robot is brought to rest
    /// Ticks for which the host waits for an answer. At a port it waits for the first answer as long as `--wait`.
    silence_limit: Option<u16>,
    first_silence_limit: Option<u16>,
    saved: Causes, // those of the last saved cell
    /// True until the robot at a port has reported its position to a resumed run. The resolvers are those of the model
    /// of the cell, which is where the robot was in the earlier run.
    is_unreported: bool,
    /// The last reported state of the line.
    trouble: Option<&'static str>,
    /// The operator's action before the failed job can continue.
    remedy: Option<&'static str>,
    /// The run's announcement to programs that search for it. It must be dropped after `runner`.
    announced: Option<Announced>,
}

impl Run {
    /// The address of the live view's page; `None` without a live view.
    #[must_use]
    pub fn live_address(&self) -> Option<String> {
        self.live.as_ref().and_then(Live::address)
    }

    #[must_use]
    pub fn complete(mut self) -> RunOutcome {
        while self.step() {}
        self.finish()
    }

    /// Run one tick. Returns false if the run has ended; further calls have no effect.
    pub fn step(&mut self) -> bool {
        if self.ending.is_none() {
            if self.started.is_none() {
                self.begin();
            }
            self.ending = self.tick();
        }
        self.ending.is_none()
    }

    #[must_use]
    pub const fn last_tick(&self) -> Tick {
        self.closed.tick()
    }

    pub const fn cell_mut(&mut self) -> &mut Cell {
        &mut self.closed.workstation.cell
    }

    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.closed.memory()
    }

    #[must_use]
    pub const fn external_inputs(&self) -> &ExternalInputs {
        self.closed.external()
    }

    /// Digest of the present state of the simulated cell; the log has it for every tick.
    #[must_use]
    pub fn cell_digest(&self) -> u64 {
        self.closed.workstation.cell.digest()
    }

    /// Start the clock and prepare the first tick. The 40 ms grid begins with the clock, including the preparation.
    fn begin(&mut self) {
        self.started = Some(Instant::now());
        if self.config.clock == ClockKind::Real {
            self.ask_for_real_time(self.config.cpu);
        }
        if let Some((field, start)) = self.field.as_ref().zip(self.pace.start()) {
            field.align(start);
        }
        self.show_cell();
        self.neighbours.begin(self.closed.memory(), self.closed.inputs());
        self.note_neighbours(self.closed.tick().next());
    }

    /// Request real-time settings. The thread of the log already runs, so it keeps its ordinary priority.
    fn ask_for_real_time(&mut self, core: Option<usize>) {
        let granted = self.pace.ask_for_real_time(core, self.config.speed);
        self.observer.message(&granted.to_string());
        let boards = self.closed.course().levels().unpunctual().into_iter().map(Event::BoardNotPunctual);
        for event in std::iter::once(granted).chain(boards) {
            self.log_event(Tick::BEFORE_START.next(), &event);
        }
    }

    /// Warm up the next tick, if there is time, and wait until it is due.
    fn wait(&mut self) {
        if self.pace.wake_early() {
            let external = self.closed.external_with(&self.given(None));
            let Self { closed, runner, .. } = self;
            closed.with_data(|course, data| runner.warm_up(course, &external, data));
            if let Some(field) = &mut self.field {
                field.warm_up(&mut self.closed);
            }
        }
        let tick = self.closed.tick().next();
        for event in self.pace.wait(self.runner.stage_times()) {
            self.observer.message(&format!("tick {tick}: {event}"));
            self.log_event(tick, &event);
        }
        self.runner.stage_times_mut().begin();
    }

    fn given(&self, robot: Option<RobotInputs>) -> Given {
        let unreported = Resolvers { valid: false, ..Resolvers::default() };
        let robot = robot.map(|inputs| match self.is_unreported {
            true => RobotInputs { resolvers: Some(unreported), ..inputs },
            false => inputs,
        });
        let mut joystick = self.operator.at_the_box();
        joystick.velocity = self.pace.knob(joystick.velocity);
        if self.ramp.is_some() {
            joystick.velocity = 0;
        }
        Given {
            robot,
            silence_limit: self.first_silence_limit.or(self.silence_limit),
            lag: self.config.robot.lag.or_else(|| self.robot.lag_ms()),
            joystick,
            terminals: *self.operator.at_the_terminals(),
            data_base: self.neighbours.data_base(),
            pedestal: *self.neighbours.pedestal(),
        }
    }

    fn tick(&mut self) -> Option<Ending> {
        self.wait();
        let robot = self.robot.receive();
        if let Some(field) = &mut self.field {
            field.receive(&mut self.closed);
        }
        let given = self.given(robot);
        if let Some(ending) = self.decide(&given) {
            return Some(ending);
        }
        let tick = self.closed.tick();
        let (memory, external) = (*self.closed.memory(), *self.closed.external());
        if let Some(live) = &self.live {
            live.knob(external.devices.joystick.velocity);
        }
        let levels = self.closed.course().levels();
        self.robot.send(&memory.device_outputs(), || commanded(&levels.state(), &memory));
        if let Some(field) = &mut self.field {
            field.send(&mut self.closed);
        }
        self.runner.stage_times_mut().mark(Stage::Line);
        if let Some(log) = &mut self.log {
            if self.pace.is_real() {
                log.timing(self.runner.last_ns(), self.pace.skipped());
            }
            log.tick(tick, &external, &memory, || self.closed.course().levels().state());
        }
        self.history.note(tick, &external, &memory);
        self.runner.stage_times_mut().mark(Stage::Log);
        let moved = self.moved();
        let settled = self.closed.settle(moved.as_ref());
        self.observe(tick, settled);
        self.runner.stage_times_mut().mark(Stage::Cell);
        let steps = self.neighbours.begun_steps();
        let ((line, lines), hws) = (self.neighbours.place(), &external.hws);
        self.observer.tick(&TickReport { tick, line, lines, steps, hws, memory: &memory });
        self.operate(tick);
        let (closed, neighbours) = (&mut self.closed, &mut self.neighbours);
        let progress = closed.exchange(|desk| neighbours.step(desk));
        self.write_journal(tick);
        self.tell_contradictions(tick);
        self.load_for_workstation(tick);
        self.publish_news(tick);
        self.note_neighbours(tick);
        self.note_viewers(tick);
        self.publish_cell(tick);
        self.publish_field(tick);
        match progress {
            player::Progress::Over => return Some(self.left(Ending::Finished)),
            // Contacts of the sinking arm belong to the run.
            player::Progress::Failed(_) if self.closed.workstation.is_settling(tick) => {}
            player::Progress::Failed(failure) => {
                self.remedy = self.remedy.or(failure.remedy());
                self.end_at_rest(self.explain(&failure, &external));
            }
            player::Progress::Running => self.end_without_inputs(tick),
        }
        // An obstacle stops an arm that sinks without pressure. The verdict is the emergency.
        let workstation = &self.closed.workstation;
        let is_judged = !workstation.has_real_devices() && !workstation.is_settling(tick);
        let stuck = self.closed.contacts().is_stuck() && is_judged;
        if let Some(failure) = self.closed.contacts().verdict().filter(|_| stuck) {
            return Some(failure.into());
        }
        if let Some(overrun) = self.pace.ends(&memory) {
            let text = format!("{overrun}; --overrun {} ends the run then", self.pace.policy());
            let failure = Failure::outside(tick, Kind::Program, "executive", text);
            return Some(Failure { stopped: true, ..failure }.into());
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
        self.note_work(tick, &memory);
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

    /// Run the processes. If a lost board is replaced, the boards run the same tick again; otherwise the run ends.
    fn decide(&mut self, given: &Given) -> Option<Ending> {
        loop {
            let (runner, skipped) = (&mut self.runner, self.pace.skipped());
            let decided = self
                .closed
                .decide_with(given, |course, external, data| runner.step(course, external, data, skipped));
            let Err(lost) = decided else { return None };
            let levels = self.closed.course_mut().levels_mut();
            if !levels.replace(&lost, &self.config, &mut *self.observer) {
                return Some(self.lost(&lost).into());
            }
        }
    }

    fn moved(&mut self) -> Option<Plate> {
        let levels = self.closed.course().levels();
        self.robot.moved(|| acknowledged(&levels.state()))
    }

    /// The robot gets no more frames and the valves keep their state, while the cell continues.
    fn lost(&mut self, lost: &Lost) -> Failure {
        for tick in (lost.tick.0..).take(SETTLING).map(Tick) {
            let moved = self.moved();
            let settled = self.closed.coast(tick, moved.as_ref());
            self.observe(tick, settled);
        }
        let text = lost.explain(&self.closed.external().hws, self.closed.memory());
        let failure = Failure::outside(lost.tick, Kind::Program, &lost.board.to_string(), text);
        Failure { stopped: true, ..failure }
    }

    fn reload(&mut self) {
        if self.closed.reload() {
            self.log_reload();
        }
    }

    pub(crate) fn log_reload(&mut self) {
        let (tick, generations) = (self.closed.tick().next(), self.closed.generations());
        let number = generations.number();
        if let (Some(log), Some(reload)) = (&mut self.log, generations.reload(number)) {
            log.reload(tick, number, &reload.source);
        }
    }
}

/// The position that the robot has last acknowledged or reported, while the link runs.
fn acknowledged(state: &LadderState) -> Option<Plate> {
    let host = state.t3i.host;
    host.is_running().then(|| host.position())
}

/// Prim's commanded tool frame in this tick, rounded as for T3I and unrounded.
fn commanded(state: &LadderState, memory: &CommonMemory) -> Option<(WireFrame, Frame)> {
    state.prim.motion.map(|motion| (memory.prim.t3i.frame, motion.frame()))
}
