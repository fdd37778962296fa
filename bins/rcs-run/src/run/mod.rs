//! `rcs-run run`: a job, from the first tick to the result.
//!
//! One tick is, in this order: what has come over a serial line, the controller (timed, and its allocations
//! counted), what goes over the line, the hand-off to the log, the cell, the workstation controller. Physics
//! allocates and takes its time; it is outside of what is counted as the controller's. What the log is told of
//! the next tick, and its warm-up, come before that tick begins.

pub mod boards;
pub mod contacts;
mod log;
pub mod neighbours;
mod outside;
mod pace;
mod page;
mod placement;
mod progress;
mod result;
mod robot;
pub mod setup;
mod switched;
mod verdict;
pub mod workstation;

use std::{
    io,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use ::neighbours::workstation::player;
use depc::{
    Plate,
    host::{PATIENCE_TICKS, RESTART_TICKS},
};
use executive::{
    boards::Lost,
    failure::Failure,
    generations::Generations,
    memory::{Mirror, Publisher, RunName},
    rest::{AT_LAST, RestWatch},
    runner::Runner,
    timing::Stage,
};
use levels::ladder::LadderState;
use os_io::console;
use plant::CellEvent;
use rcs_core::{
    digest::Digest,
    interface::{CommonMemory, DeviceInputs, DeviceOutputs, ExternalInputs, device::LinkBytes},
    tick::{TICK_S, Tick},
};
use record::Level;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use taskdata::load::{Job, job::Reload};

use self::{
    boards::Controller,
    contacts::{Commands, ContactCheck},
    log::Log,
    neighbours::Neighbours,
    pace::Pace,
    page::Page,
    placement::PlacementCheck,
    progress::Progress,
    result::{
        CommandResult, EmergencyResult, Events, FailureResult, FaultsResult, ItemResult, PortResult,
        RunResult, SIMULATED,
    },
    robot::Robot,
    setup::Setup,
    verdict::{Ending, outside},
    workstation::SimulatedWorkstation,
};
use crate::{
    cli::{ClockKind, RobotKind, RunArguments, Switch},
    error::{Error, FAILED, STOPPED},
};

/// Ticks that the cell goes on after the controller has stopped: two seconds, in which the arm comes to rest and whatever is
/// held badly falls.
const SETTLING: usize = 50;

/// What moves while a run goes on.
struct Run {
    runner: Runner<Controller>,
    neighbours: Neighbours,
    workstation: SimulatedWorkstation,
    inputs: DeviceInputs,
    robot: Robot,
    log: Option<Log>,
    pace: Pace,
    progress: Progress,
    /// What the robot touches.
    check: ContactCheck,
    /// Where the parts are to be.
    placement: PlacementCheck,
    /// The warning that the T3 controller showed last, and when.
    warning: Option<(Tick, String)>,
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

/// The robot comes to rest: the velocity knob is at zero, and nobody commands any more.
struct Ramp {
    ending: Ending,
    ticks: u32,
    /// Fingerprint of the ticks before.
    before: Digest,
}

/// Run a job and print its result.
///
/// # Errors
/// [`Error`] if the run could not begin. A job that fails is no error here, but an exit status.
pub fn run(arguments: &RunArguments) -> Result<ExitCode, Error> {
    let interrupted = interruption()?;
    let mut setup = Setup::load(arguments, &interrupted)?;
    setup.neighbours.gather(arguments, &interrupted)?;
    setup.robot.gather(arguments.wait, &interrupted);
    let name = arguments.run.clone().unwrap_or_else(|| RunName::unique(&setup.job.name));
    let controller = Controller::start(arguments, &name, &setup.store, &setup.job, &interrupted)?;
    let file = setup.log.take();
    let log_path = file.as_ref().map(|file| file.path().to_owned());
    let log = file.map(|file| Log::start(file, arguments, &setup)).transpose()?;
    let publisher = publisher(arguments, &name);
    let Setup { store, job, description, cell, robot, neighbours, .. } = setup;
    let workstation = SimulatedWorkstation::new(cell);
    let workstation = if robot.port().is_some() { workstation.with_robot_elsewhere() } else { workstation };
    let workstation = if neighbours.can_switch() { workstation.with_hand_over() } else { workstation };
    let mut run = Run {
        runner: Runner::new(controller, publisher),
        neighbours,
        inputs: workstation.cell.inputs(),
        robot,
        workstation,
        log,
        progress: Progress::new(job.steps.len() + 1),
        pace: Pace::fast(arguments.overrun),
        placement: PlacementCheck::new(&description),
        warning: None,
        check: ContactCheck::new(description.contact),
        fresh: Vec::new(),
        events: Events::default(),
        rest: RestWatch::default(),
        ramp: None,
        patience: arguments.robot.patience(),
        first_patience: first_patience(arguments),
        trouble: None,
        remedy: None,
    };
    // Ends before the run does: it looks on as any reader.
    let mirror = run.runner.publisher().and_then(mirror);
    // The 40 ms grid begins with the clock: what comes before the first tick counts.
    let started = Instant::now();
    if arguments.clock == ClockKind::Real {
        run.ask_for_real_time(arguments.cpu);
    }
    let ending = run.play(Generations::new(store), &job.reloads, arguments, &interrupted);
    let wall_s = started.elapsed().as_secs_f64();
    let ending = run.checked(ending);
    run.progress.end();
    let mut result = run.result(&job, &ending, wall_s);
    let log_text = run.finish_log(&ending, &mut result, log_path);
    let page = Page {
        result: &result,
        steps: &run.neighbours.all_steps(),
        log: &log_text,
        slowest: &pace::slowest(run.runner.stage_times()),
        stopped: matches!(ending, Ending::Stopped),
    };
    print(&page, arguments.json)?;
    let to_do = run.remedy.map_or_else(String::new, |remedy| format!("; to do: {remedy}"));
    // What is shared goes before the last word: whoever reads it may start the next run at once.
    drop(mirror);
    drop(run);
    Ok(match (&ending, &result.failure) {
        (Ending::Failed(failure), Some(FailureResult { line, .. })) => {
            let line = line.as_ref().map_or_else(String::new, |line| format!(" in `{line}`"));
            os_io::stderr_line!(
                "rcs-run: {} failed at tick {}{line}: {}{to_do}",
                job.name,
                failure.tick,
                failure.text
            );
            ExitCode::from(if failure.stopped { STOPPED } else { FAILED })
        }
        _ => ExitCode::SUCCESS,
    })
}

/// A flag that an interrupt, a hang-up or a termination request sets; the second one ends the program at once.
pub fn interruption() -> Result<Arc<AtomicBool>, Error> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&flag))
            .map_err(Error::Signals)?;
        signal_hook::flag::register(signal, Arc::clone(&flag)).map_err(Error::Signals)?;
    }
    Ok(flag)
}

/// Ticks that the first answer of a robot controller at a port may take: it may be powered up after the run has begun.
fn first_patience(arguments: &RunArguments) -> Option<u16> {
    let RobotKind::Serial(_) = arguments.robot.kind else { return None };
    let wait = arguments.wait.saturating_mul(RESTART_TICKS.into());
    let patience = arguments.robot.patience().unwrap_or(PATIENCE_TICKS);
    Some(u16::try_from(wait).unwrap_or(u16::MAX).max(patience))
}

/// Shared memory is a convenience: a run that cannot have it says so and goes on.
fn publisher(arguments: &RunArguments, name: &RunName) -> Option<Publisher> {
    if arguments.shared_memory == Switch::Off {
        return None;
    }
    match Publisher::create(name) {
        Ok(publisher) => Some(publisher),
        Err(error) => {
            os_io::stderr_line!("rcs-run: nobody can look on, shared memory cannot be had: {error}");
            None
        }
    }
}

/// So is the mirror of the status.
fn mirror(publisher: &Publisher) -> Option<Mirror> {
    let mirror = Mirror::start(publisher);
    mirror.inspect_err(|error| os_io::stderr_line!("rcs-run: the status is not mirrored: {error}")).ok()
}

fn print(page: &Page<'_>, json: bool) -> Result<(), Error> {
    let text = if json {
        serde_json::to_string(page.result).map_err(io::Error::from)? + "\n"
    } else {
        page.to_string()
    };
    Ok(console::answer(&text)?)
}

impl Run {
    /// The log's thread runs already: it keeps its ordinary priority.
    fn ask_for_real_time(&mut self, core: Option<usize>) {
        let (level, text) = self.pace.ask_for_real_time(core);
        self.progress.say(&text);
        if let Some(log) = &mut self.log {
            log.note(Tick::BEFORE_START.next(), level, "executive", &text);
            for board in self.runner.levels().unpunctual() {
                let text = format!("{board}: not everything that real time needs was granted");
                log.note(Tick::BEFORE_START.next(), Level::Warning, "executive", &text);
            }
        }
    }

    /// Wait until the next tick is due, having warmed it up if there is time.
    fn wait(&mut self, generations: &Generations) {
        if self.pace.wake_early() {
            let external = self.external(generations);
            self.runner.warm_up(&external, &generations.current().view());
        }
        for (level, text) in self.pace.wait(self.runner.stage_times()) {
            self.progress.say(&format!("tick {}: {text}", self.runner.tick().next()));
            if let Some(log) = &mut self.log {
                log.note(self.runner.tick().next(), level, "executive", &text);
            }
        }
        self.runner.stage_times_mut().begin();
    }

    /// What comes from outside for the next tick.
    fn external(&self, generations: &Generations) -> ExternalInputs {
        let mut devices = self.pace.inputs(self.inputs);
        devices.link_patience = self.first_patience.or(self.patience);
        if self.ramp.is_some() {
            devices.joystick.velocity = 0;
        }
        ExternalInputs {
            hws: *self.neighbours.hws(),
            devices,
            data_base: self.neighbours.data_base(),
            generation: generations.number(),
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
        log.cell(tick, &self.workstation.cell);
    }

    fn play(
        &mut self,
        mut generations: Generations,
        reloads: &[Reload],
        arguments: &RunArguments,
        interrupted: &AtomicBool,
    ) -> Ending {
        self.show_cell();
        self.neighbours.begin(self.runner.memory(), &self.inputs);
        self.note_neighbours(self.runner.tick().next());
        loop {
            self.wait(&generations);
            self.robot.receive(&mut self.inputs);
            let external = self.external(&generations);
            let tick = self.runner.tick().next();
            let data = generations.current().view();
            let memory = loop {
                match self.runner.step(&external, &data, self.pace.skipped()).copied() {
                    Ok(memory) => break memory,
                    // With a successor the boards run the same tick again.
                    Err(lost) if self.runner.levels_mut().replace(&lost, arguments, interrupted) => {}
                    Err(lost) => return Ending::Failed(self.lost(&lost, &external)),
                }
            };
            let outputs = memory.device_outputs();
            self.robot.send(&outputs);
            self.runner.stage_times_mut().mark(Stage::Line);
            if let Some(log) = &mut self.log {
                if self.pace.is_real() {
                    log.timing(self.runner.last_ns(), self.pace.skipped());
                }
                log.tick(tick, &external, &memory, || self.runner.levels().state());
            }
            self.runner.stage_times_mut().mark(Stage::Log);
            self.advance(tick, &outputs);
            self.observe(tick, Commands::from(&memory));
            let cell = &self.workstation.cell;
            let task = &memory.task.status;
            self.placement.look(tick, &external.hws, task, cell.description(), &cell.parts());
            self.runner.stage_times_mut().mark(Stage::Cell);
            self.progress.show(self.neighbours.begun_steps(), &external.hws, &memory);
            let progress = self.neighbours.step(
                tick,
                &memory,
                &self.inputs,
                &mut self.workstation,
                generations.current(),
            );
            self.note_neighbours(tick);
            // Vision in another process has answered the tick that is over.
            self.inputs.vision = self.workstation.cell.inputs().vision;
            match progress {
                player::Progress::Over => return self.left(Ending::Finished),
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
                return Ending::Failed(failure);
            }
            if let Some(overrun) = self.pace.ends(&memory) {
                let text = format!("{overrun}; --overrun {} ends the run then", self.pace.policy());
                return Ending::Failed(Failure { stopped: true, ..outside(tick, "executive", text) });
            }
            self.runner.stage_times_mut().mark(Stage::Workstation);
            if interrupted.load(Ordering::Relaxed) {
                // Where another process commands there is no job that ends by itself.
                let failed = || Ending::Failed(outside(tick, "rcs-run", "interrupted".to_owned()));
                let ending = if self.neighbours.are_commanding() { Ending::Stopped } else { failed() };
                self.end_at_rest(ending);
            }
            if arguments.ticks.is_some_and(|ticks| tick.0 >= ticks) {
                if arguments.clock == ClockKind::Fast && self.robot.port().is_none() {
                    return self.left(Ending::Stopped);
                }
                self.end_at_rest(Ending::Stopped);
            }
            self.watch_link(tick, &memory);
            if let Some(ending) = self.at_rest(&memory) {
                return ending;
            }
            self.reload(&mut generations, reloads);
            self.show_cell();
            let stage_times = self.runner.stage_times_mut();
            stage_times.mark(Stage::Inputs);
            stage_times.finish();
        }
    }

    /// Say what the line to the robot suffers, as soon as it is something else.
    fn watch_link(&mut self, tick: Tick, memory: &CommonMemory) {
        if memory.t3i.status.link_running {
            self.first_patience = None;
        }
        let before = std::mem::replace(&mut self.trouble, memory.t3i.status.trouble());
        if let Some(trouble) = self.trouble.filter(|_| self.trouble != before) {
            self.progress.say(&format!("{tick}: {trouble}"));
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

    /// The rest of a tick: the cell moves.
    fn advance(&mut self, tick: Tick, outputs: &DeviceOutputs) {
        let controller = self.runner.levels();
        self.inputs = self
            .robot
            .advance(tick, &mut self.workstation.cell, outputs, || acknowledged(&controller.state()));
    }

    /// A board is lost. The robot hears nothing any more and the valves stay as they are, while time goes on in the cell.
    fn lost(&mut self, lost: &Lost, external: &ExternalInputs) -> Failure {
        let memory = *self.runner.memory();
        let silent = DeviceOutputs { link_tx: LinkBytes::default(), ..memory.device_outputs() };
        for tick in (lost.tick.0..).take(SETTLING).map(Tick) {
            self.advance(tick, &silent);
            self.observe(tick, Commands::from(&memory));
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

    /// Take up the reloads that the job has asked for, and let the next tick see them if no command is in progress.
    fn reload(&mut self, generations: &mut Generations, reloads: &[Reload]) {
        let reload =
            |number: u32| usize::try_from(number).ok()?.checked_sub(1).and_then(|at| reloads.get(at));
        for reload in self.workstation.loads().into_iter().filter_map(reload) {
            generations.propose(reload.store.clone());
        }
        if !generations.advance(self.runner.memory()) {
            return;
        }
        // Reloads are proposed in their order, so that a generation has the number of its reload.
        let (tick, number) = (self.runner.tick().next(), generations.number());
        if let (Some(log), Some(reload)) = (&mut self.log, reload(number)) {
            log.reload(tick, number, &reload.source);
        }
    }

    fn result(&mut self, job: &Job, ending: &Ending, wall_s: f64) -> RunResult {
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
            job: job.name.clone(),
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
            faults: self.robot.faults().map(FaultsResult::from),
            cell_faults: self.workstation.cell.faults().into_iter().map(Into::into).collect(),
            port: self.robot.port().map(PortResult::from),
            emergency_stop: self.workstation.last_emergency().map(EmergencyResult::from),
            digest: self.runner.digest().to_string(),
            simulated: self.robot.port().map(|_| SIMULATED),
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
        self.neighbours.items().map_or_else(
            |why| {
                os_io::stderr_line!("rcs-run: the items cannot be listed: {why}");
                Vec::new()
            },
            |items| items.into_iter().map(Into::into).collect(),
        )
    }

    /// End the log and say what became of it. A log that broke does not make a finished job a failed one.
    fn finish_log(
        &mut self,
        ending: &Ending,
        result: &mut RunResult,
        path: Option<std::path::PathBuf>,
    ) -> String {
        let Some(log) = self.log.take() else { return "none".to_owned() };
        let outcome = match ending {
            Ending::Finished => "finished".to_owned(),
            Ending::Stopped => "stopped as asked for".to_owned(),
            Ending::Failed(failure) => failure.text.clone(),
        };
        result.log = path;
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
                os_io::stderr_line!("rcs-run: the log ended before the run did: {error}");
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
