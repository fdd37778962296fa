//! A run that begins under stand-alone command and is switched to the workstation controller and back (IV.4.1).
//!
//! ```text
//!   job ──`** workstation`: robot at HOME, PAUSE last, Data System connected──► workstation controller
//!    ▲                                                                               │
//!    └──── PAUSE, next line ◄──── it has disconnected, and no command is executed ◄───┘
//! ```
//!
//! The numbers of the commands are one sequence. A workstation controller that connects before the line
//! waits: it reads no status.

use std::{
    thread,
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, HwsCommand, hws::HwsReport};
use neighbours::{
    network::{ClockKind, Endpoint},
    workstation::{
        Gate,
        player::{BegunStep, Hwsc, Progress, Retry},
    },
};
use rcs_core::tick::{TICK_MS, Tick};
use taskdata::load::Store;

use crate::{
    event::Event, neighbours::Emulator, outside::OutsideWorkstation, workstation::SimulatedWorkstation,
};

/// Where the robot must be when the workstation controller takes over (IV.4.1).
const HOME: &str = "HOME";
/// The command that must be the last one then.
const PAUSE: &str = "PAUSE";

/// What a tick has written, and what is known around it.
pub struct Around<'a> {
    /// The tick.
    pub tick: Tick,
    /// What it has written.
    pub memory: &'a CommonMemory,
    /// Task data, with which lines for the cell are read.
    pub store: &'a Store,
    /// The Data System is connected, or in the controller's own process.
    pub has_data_system: bool,
}

/// A job, and a workstation controller in another process that it hands over to.
pub struct Switched {
    job: Emulator,
    outside: OutsideWorkstation,
    /// Seconds that the workstation controller is waited for.
    wait: u32,
    /// When it took over.
    since: Tick,
    /// It has been connected since.
    was_connected: bool,
}

impl Switched {
    /// The job begins.
    #[must_use]
    pub fn new(hwsc: Hwsc, endpoint: Endpoint, wait: u32) -> Self {
        Self {
            job: Emulator::new(hwsc),
            outside: OutsideWorkstation::new(endpoint),
            wait,
            since: Tick::BEFORE_START,
            was_connected: false,
        }
    }

    /// The workstation controller commands.
    #[must_use]
    pub fn is_handed_over(&self) -> bool {
        self.job.hwsc.is_handed_over()
    }

    /// The job, unless it has handed over.
    pub fn job_under_way(&mut self) -> Option<&mut Hwsc> {
        (!self.is_handed_over()).then_some(&mut self.job.hwsc)
    }

    /// The workstation controller.
    pub const fn outside(&mut self) -> &mut OutsideWorkstation {
        &mut self.outside
    }

    /// Steps of the job, or the commands of the workstation controller since it took over.
    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        if self.is_handed_over() { self.outside.begun_steps() } else { self.job.hwsc.begun_steps() }
    }

    /// Steps of the job, and the commands that were sent since it has handed over.
    #[must_use]
    pub fn all_steps(&self) -> Vec<BegunStep> {
        let outside = if self.is_handed_over() { self.outside.begun_steps() } else { &[] };
        [self.job.hwsc.begun_steps(), outside].concat()
    }

    /// The commands of the job that were sent again after they had failed.
    #[must_use]
    pub fn retried(&self) -> &[Retry] {
        self.job.hwsc.retried()
    }

    /// Once a tick, after controller and cell.
    pub fn step(
        &mut self,
        around: &Around<'_>,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        events: &mut Vec<Event>,
    ) -> Progress {
        if self.is_handed_over() {
            return self.follow(around, gate, workstation, events);
        }
        self.outside.attend(around.tick, events);
        let progress = self.job.step(around.tick, gate, workstation, events);
        if self.is_handed_over() { self.hand_over(around, gate, events) } else { progress }
    }

    /// The line `** workstation` has come.
    fn hand_over(&mut self, around: &Around<'_>, gate: &mut Gate, events: &mut Vec<Event>) -> Progress {
        if let Some(obstacle) = obstacle(around.memory, gate.command(), around.has_data_system) {
            return self.refuse(around.tick, obstacle);
        }
        events.push(Event::HandedOver);
        gate.initialize();
        (self.since, self.was_connected) = (around.tick, false);
        // In fast clock hours would go by until it comes.
        if self.outside.endpoint().clock() == ClockKind::Fast {
            self.wait_here();
        }
        Progress::Running
    }

    /// Wait for the workstation controller between two ticks.
    fn wait_here(&self) {
        let (endpoint, limit) = (self.outside.endpoint(), Duration::from_secs(self.wait.into()));
        let (handle, started) = (endpoint.handle(), Instant::now());
        while !handle.is_connected() && !endpoint.is_interrupted() && started.elapsed() < limit {
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// The workstation controller commands, or has disconnected.
    fn follow(
        &mut self,
        around: &Around<'_>,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        events: &mut Vec<Event>,
    ) -> Progress {
        let task = &around.memory.task;
        let progress = self.outside.step(around.tick, gate, task, workstation, around.store, events);
        self.was_connected |= self.outside.is_here();
        if !self.was_connected {
            let waited = match self.outside.endpoint().clock() {
                ClockKind::Fast => u64::from(self.wait),
                ClockKind::Real => around.tick.since(self.since) * TICK_MS / 1000,
            };
            return if waited < u64::from(self.wait) || self.outside.endpoint().is_interrupted() {
                Progress::Running
            } else {
                let wait = self.wait;
                let why = format!(
                    "no workstation controller has connected within {wait} s; --wait N sets a longer time"
                );
                self.refuse(around.tick, why)
            };
        }
        if self.outside.is_here() {
            return Progress::Running;
        }
        let executes =
            task.status.echo != gate.command().number || task.status.report == HwsReport::Executing;
        if executes {
            return progress;
        }
        events.push(Event::TakenBack);
        self.job.take_back(around.tick, gate, self.outside.take_steps())
    }

    fn refuse(&mut self, tick: Tick, why: String) -> Progress {
        self.job.hwsc.refuse(tick, why);
        self.job.hwsc.progress().clone()
    }
}

/// What keeps the workstation controller from taking over (IV.4.1).
pub fn obstacle(memory: &CommonMemory, last: &HwsCommand, has_data_system: bool) -> Option<String> {
    let needs = "the workstation controller is connected with";
    let place = memory.emove.beliefs.place.map(|place| place.location);
    if place.is_none_or(|location| location.as_str() != HOME) {
        let found = place.map_or("no known location".to_owned(), |location| location.to_string());
        return Some(format!("{needs} the robot at {HOME}, it is at {found}: move it there before the line"));
    }
    if last.command.as_str() != PAUSE {
        return Some(format!(
            "{needs} {PAUSE} as the last command, it was {}: send it before the line",
            last.command
        ));
    }
    (!has_data_system).then(|| {
        "the Data System is connected before the workstation controller: start it, then the job again"
            .to_owned()
    })
}
