//! The start of a run, before the first tick.

use std::sync::Arc;

use closed_loop::{ClosedLoop, account::Alarms, chain::History, rest::RestWatch};
use depc::host::{RESTART_TICKS, SILENCE_LIMIT_TICKS};
use diagnostics::FAULTS;
use executive::{
    memory::{Announced, Mirror, Publisher, RunName, SET_UP_LIMIT, SharedMemoryError, within_limit},
    runner::Runner,
};
use interfaces::hws::HwsStatus;
use levels::ladder::Ladder;
use rcs_core::tick::Tick;
use sessions::network::Role;

use super::Run;
use crate::{
    boards::Controller,
    config::{Boards, ClockKind, OperatorAccess, RobotKind, RunConfig},
    contradiction::Contradictions,
    error::StartError,
    event::Event,
    load::Loads,
    loads::Loader,
    log::Log,
    observer::Observer,
    operator::{Inputs, Operator},
    own::OwnRobot,
    pace::Pace,
    result::Events,
    resume::{Causes, Resumed},
    setup::Setup,
    views::{self, Viewed},
};

/// Ticks to wait for the first answer of a robot controller at a port, which may be powered up after the run has begun.
fn first_silence_limit(config: &RunConfig) -> Option<u16> {
    if config.robot.kind == RobotKind::Sim {
        return None;
    }
    let wait = config.wait.saturating_mul(RESTART_TICKS.into());
    let silence_limit = config.robot.silence_limit().unwrap_or(SILENCE_LIMIT_TICKS);
    Some(u16::try_from(wait).unwrap_or(u16::MAX).max(silence_limit))
}

/// Announce a run that has a name, before it uses a file of its own. Errors: [`StartError::NameInUse`].
fn announced(config: &RunConfig) -> Result<Option<Announced>, StartError> {
    let Some(name) = config.name.clone().filter(|_| config.shared_memory) else { return Ok(None) };
    match Announced::named(name) {
        Ok(announced) => Ok(Some(announced)),
        Err(error @ SharedMemoryError::NameInUse { .. }) => Err(StartError::NameInUse(error)),
        // Without shared memory, names cannot conflict; the publisher reports the error.
        Err(_) => Ok(None),
    }
}

fn announced_by_job(config: &RunConfig, job: &str) -> Option<Announced> {
    let is_nameless = config.name.is_none() && config.shared_memory;
    is_nameless.then(|| Announced::of_job(job).ok()).flatten()
}

/// Open shared memory, which is optional: if it is not available the run prints a message and continues.
fn publisher(config: &RunConfig, name: &RunName, observer: &mut dyn Observer) -> Option<Publisher> {
    if !config.shared_memory {
        return None;
    }
    let publisher = within_limit(SET_UP_LIMIT, config.on_stuck, || Publisher::create(name));
    let publisher = publisher.inspect_err(|error| {
        observer.message(&format!(
            "other programs cannot watch the run, shared memory is not available: {error}"
        ));
    });
    publisher.ok()
}

fn mirror(publisher: &Publisher, observer: &mut dyn Observer) -> Option<Mirror> {
    let mirror = Mirror::start(publisher);
    mirror.inspect_err(|error| observer.message(&format!("the status is not mirrored: {error}"))).ok()
}

impl Run {
    /// Starts everything and waits for boards, neighbours and robot controller. On errors the robot has not moved.
    pub fn new(config: RunConfig, observer: Box<dyn Observer>) -> Result<Self, StartError> {
        Self::start(config, None, observer)
    }

    /// [`Run::new`] with a robot of the caller instead of the configured one.
    pub fn with_robot(
        mut config: RunConfig,
        robot: Box<dyn OwnRobot>,
        observer: Box<dyn Observer>,
    ) -> Result<Self, StartError> {
        config.robot.kind = RobotKind::Own;
        Self::start(config, Some(robot), observer)
    }

    fn start(
        mut config: RunConfig,
        own: Option<Box<dyn OwnRobot>>,
        mut observer: Box<dyn Observer>,
    ) -> Result<Self, StartError> {
        config.faults = config.faults.map(|name| FAULTS.find(&name, &config.data)).transpose()?;
        let announced = announced(&config)?;
        let mut setup = Setup::load(&config, own, &mut *observer)?;
        let announced = announced.or_else(|| announced_by_job(&config, &setup.job.name));
        let say = |phase: &str| announced.iter().for_each(|announced| announced.say(phase));
        setup.neighbours.gather(&config, say, &mut *observer)?;
        if setup.field.is_some() && config.has_real_devices() {
            say("waits for its couplers");
        }
        let field = setup.field.take();
        let field = field.map(|field| field.gather(&config, &setup.job.name, &mut *observer)).transpose()?;
        let (field, field_port) = field.map_or((None, None), |(field, port)| (Some(field), port));
        if setup.robot.is_elsewhere() {
            say("waits for its robot");
        }
        setup.robot.gather(&config, &mut *observer);
        let given = || config.name.clone().unwrap_or_else(|| RunName::unique(&setup.job.name));
        let name = announced.as_ref().map_or_else(given, |announced| announced.name().clone());
        if config.boards != Boards::One {
            say("waits for its boards");
        }
        let buffers = setup.resumed.as_ref().map(Resumed::buffers);
        let controller =
            Controller::start(&config, &name, (&setup.store, &setup.job), buffers.as_ref(), &mut *observer)?;
        say("starts");
        let file = setup.log.take();
        let log_path = file.as_ref().map(|file| file.path().to_owned());
        let mut log = file.map(|file| Log::start(file, &config, &setup)).transpose()?;
        if let Some(log) = &mut log {
            log.view(Tick::BEFORE_START.next(), views::places(&setup.description));
        }
        let publisher = publisher(&config, &name, &mut *observer);
        let Setup {
            store,
            data,
            mut job,
            cell,
            line_faults,
            robot,
            mut neighbours,
            mut live,
            journal,
            resumed,
            ..
        } = setup;
        let reloads = std::mem::take(&mut job.reloads);
        let mut closed = ClosedLoop::new(controller, Arc::new(store), Arc::new(reloads), cell);
        if let Some(field) = field {
            closed = closed.with_field(field);
        }
        let robot_is_at_port = robot.port().is_some();
        if robot.is_elsewhere() {
            closed.workstation.note_robot_elsewhere();
        }
        if neighbours.can_switch() {
            closed.workstation.note_hand_over();
        }
        if let Some(plan) = &line_faults {
            closed.line_mut().apply_faults(plan);
        }
        let keeps_books = neighbours.data_system().is_none();
        let closed = if keeps_books { closed } else { closed.with_data_system_elsewhere() };
        let mut closed = closed;
        if let Some(resumed) = &resumed {
            resumed.start(&mut closed, &job, &mut *observer)?;
        }
        let contradictions = resumed.as_ref().map(|_| Contradictions::of(closed.memory()));
        let fresh = resumed.as_ref().map(|resumed| Event::Resumed(resumed.to_string()));
        if let Some(event) = &fresh {
            observer.message(&event.to_string());
        }
        let operator = Operator::new(robot.is_elsewhere());
        let runner = Runner::new(publisher);
        let asked = Inputs::of(&config, &name, &mut *observer)?;
        let network = neighbours.network.as_ref();
        if let Some((network, entrance)) = network.zip(asked.entrance()) {
            network.let_operators_in(move |stream, unread| entrance.enter(stream, &unread));
        }
        let beginning = log.as_mut().and_then(Log::take_beginning);
        if let Some((live, beginning)) = live.as_mut().zip(beginning) {
            let operators = asked.socket().filter(|_| config.operator == OperatorAccess::Network);
            live.start(&config, &job.name, &beginning, operators, &mut *observer)?;
        }
        // The thread starts before this process requests real-time priority.
        let asks = config.outside.contains(&Role::Workstation) || asked.socket().is_some();
        let beside = asks && config.clock == ClockKind::Real && config.inputs.is_none();
        let loader = beside.then(Loader::start).transpose().map_err(StartError::Thread)?;
        say(if runner.publisher().is_some() {
            "runs"
        } else {
            "runs, but its buffers are not in shared memory"
        });
        let mirror = runner.publisher().and_then(|publisher| mirror(publisher, &mut *observer));
        Ok(Self {
            closed,
            runner,
            mirror,
            neighbours,
            robot,
            field: field_port,
            asked,
            operator,
            loads: Loads::with(loader),
            name,
            log,
            log_path,
            data,
            live,
            pace: Pace::fast(config.overrun),
            started: None,
            ending: None,
            warning: None,
            alarms: Alarms::default(),
            task: HwsStatus::default(),
            history: History::new(Ladder::processes()),
            view: Box::default(),
            viewed: Viewed::default(),
            waits: None,
            fresh: fresh.into_iter().collect(),
            journal,
            journal_trouble: None,
            contradictions,
            events: Events::default(),
            rest: RestWatch::default(),
            ramp: None,
            silence_limit: config.robot.silence_limit(),
            first_silence_limit: first_silence_limit(&config),
            saved: Causes::default(),
            is_unreported: resumed.is_some() && robot_is_at_port,
            trouble: None,
            remedy: None,
            job,
            observer,
            config,
            announced,
        })
    }
}
