//! A run, from the first tick to the result.
//!
//! What the log is told of the next tick, and its warm-up, come before that tick begins.

use std::{path::PathBuf, sync::atomic::Ordering, time::Instant};

use ::neighbours::workstation::player::{self, BegunStep};
use depc::{
    Plate,
    host::{PATIENCE_TICKS, RESTART_TICKS},
};
use executive::{
    boards::Lost,
    failure::Failure,
    generations::Generations,
    memory::{Mirror, Publisher, RunName, SET_UP_LIMIT, within_limit},
    rest::{AT_LAST, RestWatch},
    runner::Runner,
    timing::Stage,
};
use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{CommonMemory, DeviceInputs, DeviceOutputs, ExternalInputs, device::LinkBytes};
use levels::ladder::LadderState;
use plant::CellEvent;
use rcs_core::{
    digest::Digest,
    tick::{TICK_S, Tick},
};
use record::Level;
use taskdata::load::Job;

use crate::{
    boards::Controller,
    cell_view::View,
    config::{ClockKind, RobotKind, RunConfig},
    contacts::{Commands, ContactCheck},
    egm::EgmPort,
    error::StartError,
    live::Live,
    log::Log,
    neighbours::Neighbours,
    observer::{Observer, TickReport},
    operator::{A_TICK, Around, Inputs, Operator},
    own::OwnRobot,
    pace::{self, Pace},
    placement::PlacementCheck,
    result::{
        self, CommandResult, EgmResult, EmergencyResult, Events, FailureResult, FaultsResult, ItemResult,
        PortResult, RunResult, SIMULATED,
    },
    robot::Robot,
    setup::Setup,
    verdict::{Ending, outside},
    workstation::SimulatedWorkstation,
};

/// Ticks that the cell goes on after the controller has stopped: two seconds, in which the arm comes to rest
/// and whatever is held badly falls.
const SETTLING: usize = 50;

/// A run that has been set up.
pub struct Run {
    config: RunConfig,
    observer: Box<dyn Observer>,
    pub(crate) job: Job,
    /// Task data, with what the job loads on the way.
    pub(crate) generations: Generations,
    /// Generations that came by a change, not by a line of the job.
    pub(crate) changed: u32,
    /// What came from outside for the last tick.
    external: ExternalInputs,
    /// Mirrors the status; it ends before the publisher of `runner` does.
    mirror: Option<Mirror>,
    pub(crate) runner: Runner<Controller>,
    pub(crate) neighbours: Neighbours,
    pub(crate) workstation: SimulatedWorkstation,
    /// Where operators' requests come from, and what becomes of them.
    asked: Inputs,
    operator: Operator,
    inputs: DeviceInputs,
    pub(crate) robot: Robot,
    pub(crate) log: Option<Log>,
    log_path: Option<PathBuf>,
    /// Lets viewers see what the log gets.
    live: Option<Live>,
    pace: Pace,
    /// When the first tick was due.
    started: Option<Instant>,
    /// How the run has ended.
    ending: Option<Ending>,
    /// What the robot touches.
    pub(crate) check: ContactCheck,
    /// Where the parts are to be.
    pub(crate) placement: PlacementCheck,
    /// The warning that the T3 controller showed last, and when.
    pub(crate) warning: Option<(Tick, String)>,
    /// What the cell shows to programs outside.
    view: Box<View>,
    /// Events of the cell since the last tick, for the log of the next one.
    fresh: Vec<(Level, &'static str, String)>,
    /// What has happened, for the result.
    events: Events,
    /// Does the robot rest?
    rest: RestWatch,
    /// The end of the run, for which the robot is brought to rest.
    ramp: Option<Ramp>,
    /// Ticks that the host is to wait for an answer; at a port the first answer may take as long as `--wait` says.
    patience: Option<u16>,
    first_patience: Option<u16>,
    /// What the line was said to suffer last.
    trouble: Option<&'static str>,
    /// What a person has to do before the job that has failed can go on.
    remedy: Option<&'static str>,
}

/// The robot comes to rest: the velocity knob is at zero, and no command is given any more.
struct Ramp {
    ending: Ending,
    ticks: u32,
    /// Fingerprint of the ticks before.
    before: Digest,
}

/// What became of a run.
pub struct RunOutcome {
    /// How it ended.
    pub ending: Ending,
    /// All that is known of it, for scripts.
    pub result: RunResult,
    /// All steps of the job, those of the workstation included.
    pub steps: Vec<BegunStep>,
    /// What became of the log, in words.
    pub log: String,
    /// The processes that took longest, in words.
    pub slowest: String,
    /// What a person has to do before a job that has failed can go on.
    pub remedy: Option<&'static str>,
}

impl RunOutcome {
    /// The job is over, every part is where it should be, and nothing touched that may not.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        matches!(self.ending, Ending::Finished)
    }
}

/// Ticks that the first answer of a robot controller at a port may take: it may be powered up after the run has begun.
fn first_patience(config: &RunConfig) -> Option<u16> {
    if config.robot.kind == RobotKind::Sim {
        return None;
    }
    let wait = config.wait.saturating_mul(RESTART_TICKS.into());
    let patience = config.robot.patience().unwrap_or(PATIENCE_TICKS);
    Some(u16::try_from(wait).unwrap_or(u16::MAX).max(patience))
}

/// Shared memory is a convenience: a run that cannot have it says so and goes on.
fn publisher(config: &RunConfig, name: &RunName, observer: &mut dyn Observer) -> Option<Publisher> {
    if !config.shared_memory {
        return None;
    }
    let publisher = within_limit(SET_UP_LIMIT, config.on_stuck, || Publisher::create(name));
    let publisher = publisher.inspect_err(|error| {
        observer.message(&format!("the run cannot be watched, shared memory cannot be had: {error}"));
    });
    publisher.ok()
}

/// So is the mirror of the status.
fn mirror(publisher: &Publisher, observer: &mut dyn Observer) -> Option<Mirror> {
    let mirror = Mirror::start(publisher);
    mirror.inspect_err(|error| observer.message(&format!("the status is not mirrored: {error}"))).ok()
}

impl Run {
    /// Read, check and start all that the run needs, and wait for boards, neighbours and robot controller.
    ///
    /// # Errors
    /// [`StartError`] if the run cannot begin, with all errors of the data. Nothing has moved then.
    pub fn new(config: RunConfig, observer: Box<dyn Observer>) -> Result<Self, StartError> {
        Self::start(config, None, observer)
    }

    /// Like [`Run::new`], with a robot of the caller's own in the place of that of the configuration.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn with_robot(
        mut config: RunConfig,
        robot: Box<dyn OwnRobot>,
        observer: Box<dyn Observer>,
    ) -> Result<Self, StartError> {
        config.robot.kind = RobotKind::Own;
        Self::start(config, Some(robot), observer)
    }

    fn start(
        config: RunConfig,
        own: Option<Box<dyn OwnRobot>>,
        mut observer: Box<dyn Observer>,
    ) -> Result<Self, StartError> {
        let mut setup = Setup::load(&config, own, &mut *observer)?;
        setup.neighbours.gather(&config, &mut *observer)?;
        setup.robot.gather(&config, &mut *observer);
        let name = config.name.clone().unwrap_or_else(|| RunName::unique(&setup.job.name));
        let controller = Controller::start(&config, &name, &setup.store, &setup.job, &mut *observer)?;
        let file = setup.log.take();
        let log_path = file.as_ref().map(|file| file.path().to_owned());
        let log = file.map(|file| Log::start(file, &config, &setup)).transpose()?;
        let publisher = publisher(&config, &name, &mut *observer);
        let Setup { store, job, description, cell, robot, neighbours, mut live, .. } = setup;
        let workstation = SimulatedWorkstation::new(cell);
        let workstation = if robot.is_elsewhere() { workstation.with_robot_elsewhere() } else { workstation };
        let workstation = if neighbours.can_switch() { workstation.with_hand_over() } else { workstation };
        let operator = Operator::new(robot.is_elsewhere());
        let runner = Runner::new(controller, publisher);
        let asked = Inputs::of(&config, &name, &mut *observer)?;
        if let Some(live) = &mut live {
            live.start(&config, &job.name, asked.socket(), &mut *observer)?;
        }
        let mirror = runner.publisher().and_then(|publisher| mirror(publisher, &mut *observer));
        Ok(Self {
            runner,
            mirror,
            neighbours,
            inputs: workstation.cell.inputs(),
            robot,
            workstation,
            asked,
            operator,
            log,
            log_path,
            live,
            pace: Pace::fast(config.overrun),
            started: None,
            ending: None,
            placement: PlacementCheck::new(&description),
            warning: None,
            check: ContactCheck::new(description.contact),
            view: Box::default(),
            fresh: Vec::new(),
            events: Events::default(),
            rest: RestWatch::default(),
            ramp: None,
            patience: config.robot.patience(),
            first_patience: first_patience(&config),
            trouble: None,
            remedy: None,
            generations: Generations::new(store),
            changed: 0,
            external: ExternalInputs::default(),
            job,
            observer,
            config,
        })
    }

    /// Run to the end.
    #[must_use]
    pub fn complete(mut self) -> RunOutcome {
        while self.step() {}
        self.finish()
    }

    /// Run one tick. False if the run is over: then nothing more is done.
    pub fn step(&mut self) -> bool {
        if self.ending.is_none() {
            if self.started.is_none() {
                self.begin();
            }
            self.ending = self.tick();
        }
        self.ending.is_none()
    }

    /// The tick that was run last.
    #[must_use]
    pub const fn last_tick(&self) -> Tick {
        self.runner.tick()
    }

    /// All buffers as that tick has left them.
    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.runner.memory()
    }

    /// What came from outside for that tick.
    #[must_use]
    pub const fn external_inputs(&self) -> &ExternalInputs {
        &self.external
    }

    /// Fingerprint of the simulated cell as it is now, as the log has it of every tick.
    #[must_use]
    pub fn cell_digest(&self) -> u64 {
        self.workstation.cell.digest()
    }

    /// End the run and its log. A run that is not over counts as stopped.
    #[must_use]
    pub fn finish(mut self) -> RunOutcome {
        let wall_s = self.started.map_or(0.0, |started| started.elapsed().as_secs_f64());
        let ending = self.ending.take().unwrap_or(Ending::Stopped);
        let ending = self.checked(ending);
        let mut result = self.result(&ending, wall_s);
        let log = self.finish_log(&ending, &mut result);
        // What is shared goes first: a caller may start the next run of the name at once.
        drop(self.mirror.take());
        drop(self.live.take());
        RunOutcome {
            result,
            steps: self.neighbours.all_steps(),
            log,
            slowest: pace::slowest(self.runner.stage_times()),
            remedy: self.remedy,
            ending,
        }
    }

    /// Before the first tick. The 40 ms grid begins with the clock: what comes before the first tick counts.
    fn begin(&mut self) {
        self.started = Some(Instant::now());
        if self.config.clock == ClockKind::Real {
            self.ask_for_real_time(self.config.cpu);
        }
        self.show_cell();
        self.neighbours.begin(self.runner.memory(), &self.inputs);
        self.note_neighbours(self.runner.tick().next());
    }

    /// The log's thread runs already: it keeps its ordinary priority.
    fn ask_for_real_time(&mut self, core: Option<usize>) {
        let (level, text) = self.pace.ask_for_real_time(core, self.config.speed);
        self.observer.message(&text);
        if let Some(log) = &mut self.log {
            log.note(Tick::BEFORE_START.next(), level, "executive", &text);
            for board in self.runner.levels().unpunctual() {
                let text = format!("{board}: not everything that real time needs was granted");
                log.note(Tick::BEFORE_START.next(), Level::Warning, "executive", &text);
            }
        }
    }

    /// Wait until the next tick is due, having warmed it up if there is time.
    fn wait(&mut self) {
        if self.pace.wake_early() {
            let external = self.external();
            self.runner.warm_up(&external, &self.generations.current().view());
        }
        for (level, text) in self.pace.wait(self.runner.stage_times()) {
            self.observer.message(&format!("tick {}: {text}", self.runner.tick().next()));
            if let Some(log) = &mut self.log {
                log.note(self.runner.tick().next(), level, "executive", &text);
            }
        }
        self.runner.stage_times_mut().begin();
    }

    /// What comes from outside for the next tick.
    fn external(&self) -> ExternalInputs {
        let mut devices = self.pace.inputs(self.inputs);
        devices.link_patience = self.first_patience.or(self.patience);
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
        }
    }

    /// Tell the log of the next tick's cell, and of what happened in it.
    fn show_cell(&mut self) {
        let tick = self.runner.tick().next();
        let Some(log) = &mut self.log else { return self.fresh.clear() };
        for (level, source, event) in self.fresh.drain(..) {
            log.note(tick, level, source, &event);
        }
        if let Some(counts) = self.robot.faults() {
            log.faults(tick, counts);
        }
        log.cell(tick, &self.workstation.cell, self.robot.egm().map(EgmPort::frames));
    }

    /// Show programs outside the cell as a tick has left it. A robot elsewhere has none.
    fn publish_cell(&mut self, tick: Tick) {
        let publisher = self.runner.publisher().filter(|_| !self.robot.is_elsewhere());
        if let Some(publisher) = publisher {
            let job = (self.job.steps.len(), self.neighbours.begun_steps());
            let cell = &self.workstation.cell;
            publisher.show_cell(self.view.look(tick, cell, self.warning.as_ref(), job, &self.pace));
        }
    }

    /// One tick; how the run ends, if it ends with it.
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
                // With a successor the boards run the same tick again.
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
        self.runner.stage_times_mut().mark(Stage::Cell);
        let steps = self.neighbours.begun_steps();
        let (lines, hws) = (self.job.steps.len(), &external.hws);
        self.observer.tick(&TickReport { tick, lines, steps, hws, memory: &memory });
        self.operate(tick);
        let progress = self.neighbours.step(
            tick,
            &memory,
            &self.inputs,
            &mut self.workstation,
            self.generations.current(),
        );
        self.tell_operators(tick);
        self.note_neighbours(tick);
        self.publish_cell(tick);
        // Vision in another process has answered the tick that is over.
        self.inputs.vision = self.workstation.cell.inputs().vision;
        match progress {
            player::Progress::Over => return Some(self.left(Ending::Finished)),
            // Whatever the arm runs into belongs to the run.
            player::Progress::Failed(_) if self.workstation.is_settling(tick) => {}
            player::Progress::Failed(failure) => {
                self.remedy = self.remedy.or(failure.remedy());
                let ending = Ending::Failed(self.explain(&failure, &external));
                self.end_at_rest(ending);
            }
            player::Progress::Running => {}
        }
        // An arm that sinks without pressure is stopped by what it meets, and the emergency is the verdict.
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
            // Where another process commands there is no job that ends by itself.
            let failed = || Ending::Failed(outside(tick, "rcs-run", "interrupted".to_owned()));
            let ending = if self.neighbours.are_commanding() { Ending::Stopped } else { failed() };
            self.end_at_rest(ending);
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

    /// Say what the line to the robot suffers, as soon as it is something else.
    fn watch_link(&mut self, tick: Tick, memory: &CommonMemory) {
        if memory.t3i.status.link_running {
            self.first_patience = None;
        }
        let before = std::mem::replace(&mut self.trouble, memory.t3i.status.trouble());
        if let Some(trouble) = self.trouble.filter(|_| self.trouble != before) {
            self.observer.message(&format!("{tick}: {trouble}"));
            self.events.push(tick, trouble);
        }
    }

    /// End the run as soon as the robot rests. What ends it first is what it ends with.
    fn end_at_rest(&mut self, ending: Ending) {
        if self.ramp.is_none() {
            self.neighbours.stop_commanding();
            let before = self.runner.digest();
            self.ramp = Some(Ramp { ending, ticks: 0, before });
        }
    }

    /// A tick is over: the end of the run, if the robot rests for it.
    fn at_rest(&mut self, memory: &CommonMemory) -> Option<Ending> {
        self.rest.observe(memory);
        let ramp = self.ramp.as_mut()?;
        if !self.rest.is_at_rest() && ramp.ticks < AT_LAST {
            ramp.ticks += 1;
            return None;
        }
        let ending = std::mem::replace(&mut ramp.ending, Ending::Stopped);
        Some(if matches!(ending, Ending::Stopped) { self.left(ending) } else { ending })
    }

    /// What operators have asked for since the last tick. The next tick is the first to see it.
    fn operate(&mut self, tick: Tick) {
        let first = tick.next();
        for _ in 0..A_TICK {
            let Some(input) = self.asked.next(first) else { break };
            let mut around = Around {
                tick,
                store: self.generations.current(),
                neighbours: &mut self.neighbours,
                workstation: &mut self.workstation,
            };
            let verdict = self.operator.carry_out(&input, &mut around);
            let line = input.line(first, &verdict);
            if let Some(difference) = input.answer(first, &verdict) {
                self.observer.message(&format!("tick {first}: {difference}"));
            }
            if let (Some(log), Some(line)) = (&mut self.log, line) {
                log.operator(line);
            }
        }
        self.operator.work_the_box();
    }

    /// The job has begun to wait: who looks at the program or its log is told, too.
    fn tell_operators(&mut self, tick: Tick) {
        let Some(news) = self.neighbours.operator_news() else { return };
        self.observer.message(&format!("tick {tick}: {news}"));
        if let Some(log) = &mut self.log {
            log.note(tick.next(), Level::Warning, "operator", &news);
        }
        self.events.push(tick, &news);
    }

    /// The rest of a tick: the cell moves.
    fn advance(&mut self, tick: Tick, outputs: &DeviceOutputs) {
        let controller = self.runner.levels();
        self.inputs = self
            .robot
            .advance(tick, &mut self.workstation.cell, outputs, || acknowledged(&controller.state()));
    }

    /// A board is lost. The robot hears nothing any more and the valves stay as they are, while time goes on
    /// in the cell.
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

    /// What has happened in the cell in a tick, for the log, for the page and for the verdict.
    fn observe(&mut self, tick: Tick, commands: Commands) {
        // The check decides which contacts are worth a line.
        let events = self.workstation.events(tick).into_iter();
        let events = events.filter(|event| !matches!(event, CellEvent::Contact(_)));
        let events: Vec<_> = events.collect();
        let shown = |event: &CellEvent| matches!(event, CellEvent::Warning(_)).then(|| event.to_string());
        if let Some(warning) = events.iter().find_map(shown) {
            self.warning = Some((tick, warning));
        }
        self.fresh = events.iter().map(|event| (gravity(event), source(event), event.to_string())).collect();
        let lines = self.check.look(tick, self.workstation.cell.contacts(), commands);
        self.fresh.extend(lines.into_iter().map(|line| (Level::Error, "cell", line)));
        self.workstation.cell.watch_clearance(self.check.margin());
        for (_, _, event) in &self.fresh {
            self.events.push(tick, event);
        }
    }

    /// What neighbours say beside their mailboxes is an event of the run; Task learns no more than their statuses tell.
    fn note_neighbours(&mut self, tick: Tick) {
        for (level, source, text) in self.neighbours.notes() {
            if let Some(log) = &mut self.log {
                log.note(tick, level, source, &text);
            }
            self.events.push(tick, &text);
        }
    }

    /// Take up the reloads that the job has asked for, and let the next tick see them if no command is in
    /// progress.
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
        // Reloads are proposed in their order, so that a generation has the number of its reload.
        let (tick, number) = (self.runner.tick().next(), self.generations.number());
        if let (Some(log), Some(reload)) = (&mut self.log, reload(number)) {
            log.reload(tick, number, &reload.source);
        }
    }

    fn result(&mut self, ending: &Ending, wall_s: f64) -> RunResult {
        let ticks = self.runner.tick().0;
        let simulated_s = ticks as f64 * TICK_S;
        let ramp_ticks = self.ramp.as_ref().map_or(0, |ramp| ramp.ticks);
        let steps = self.neighbours.all_steps();
        let commands = steps.iter().filter(|step| step.is_command).map(|step| CommandResult {
            text: result::bare(&step.text),
            status: step.outcome.text(),
            ticks: step.ticks,
        });
        RunResult {
            job: self.job.name.clone(),
            commands: commands.collect(),
            retries: self.neighbours.retried().iter().map(Into::into).collect(),
            ticks: ticks - u64::from(ramp_ticks),
            ramp_ticks,
            simulated_s,
            wall_s,
            realtime_factor: simulated_s / wall_s,
            overruns: self.pace.skipped(),
            overruns_by: self.pace.overruns(),
            allocations_after_start: self.runner.allocations(),
            tick_us: self.runner.times().summary().into(),
            part_us: pace::times(self.runner.stage_times()),
            late_us: self.pace.late(),
            realtime: self.pace.verdict(),
            boards: self.runner.levels().results(),
            link: (&self.runner.memory().t3i.status.counters).into(),
            operator: self.operator.requests(),
            faults: self.robot.faults().map(FaultsResult::from),
            cell_faults: self.workstation.cell.faults().into_iter().map(Into::into).collect(),
            port: self.robot.port().map(PortResult::from),
            egm: self.robot.egm().map(EgmResult::from),
            emergency_stop: self.workstation.last_emergency().map(EmergencyResult::from),
            digest: self.runner.digest().to_string(),
            simulated: self.robot.is_elsewhere().then_some(SIMULATED),
            digest_before_ramp: self
                .ramp
                .as_ref()
                .map_or_else(|| self.runner.digest(), |ramp| ramp.before)
                .to_string(),
            parts: self.workstation.cell.parts().into_iter().map(Into::into).collect(),
            data_base: self.items(),
            contacts: self.check.collisions().to_vec(),
            clearance: self.check.nearest().cloned(),
            events: std::mem::take(&mut self.events),
            log: None,
            failure: match ending {
                Ending::Failed(failure) => {
                    Some(FailureResult::new(failure, self.neighbours.line_at(failure.tick), self.remedy))
                }
                Ending::Finished | Ending::Stopped => None,
            },
        }
    }

    /// What the data base holds at the end.
    fn items(&mut self) -> Vec<ItemResult> {
        let items = self.neighbours.items().inspect_err(|why| {
            self.observer.message(&format!("the items cannot be listed: {why}"));
        });
        items.unwrap_or_default().into_iter().map(Into::into).collect()
    }

    /// End the log and say what became of it. A log that broke does not make a finished job a failed one.
    fn finish_log(&mut self, ending: &Ending, result: &mut RunResult) -> String {
        let Some(log) = self.log.take() else { return "none".to_owned() };
        let outcome = ending.text().to_owned();
        result.log = self.log_path.take();
        match log.finish(self.runner.digest(), outcome, result.facts()) {
            Ok(summary) => {
                let (file, size) = (summary.path.display(), summary.bytes as f64 / 1e6);
                let lost = match summary.lost.ticks {
                    0 => String::new(),
                    lost => format!("; {lost} ticks found no room and are missing"),
                };
                format!("{file} ({size:.1} MB{lost}): rerun {file}, or open it in Foxglove or Lichtblick")
            }
            Err(error) => {
                self.observer.message(&format!("the log ended before the run did: {error}"));
                format!("incomplete: {error}")
            }
        }
    }
}

/// The position that the robot has acknowledged or reported last, while the link runs.
fn acknowledged(state: &LadderState) -> Option<Plate> {
    let host = state.t3i.host;
    host.is_running().then(|| host.position())
}

/// The tool frame that Prim has commanded in this tick, as T3I gets it and as Prim means it.
fn commanded(state: &LadderState, memory: &CommonMemory) -> Option<(WireFrame, Frame)> {
    state.prim.motion.map(|motion| (memory.prim.t3i.frame, motion.frame()))
}

/// How much a line of the log about an event matters: what went wrong in the world is an error.
const fn gravity(event: &CellEvent) -> Level {
    match event {
        CellEvent::Warning(_) | CellEvent::ViseStuck => Level::Error,
        event if event.is_harm() => Level::Error,
        _ => Level::Warning,
    }
}

/// Who a line of the log about an event comes from: what was planned is told apart from what came of it.
const fn source(event: &CellEvent) -> &'static str {
    match event {
        CellEvent::FaultBegins { .. } | CellEvent::FaultEnds { .. } => "fault",
        _ => "cell",
    }
}
