//! A run that begins under stand-alone command and is switched to the workstation controller and back (IV.4.1).
//!
//! ```text
//!   job ──`** workstation`: robot at HOME, PAUSE last, Data System connected──► workstation controller
//!    ▲                                                                               │
//!    └──── PAUSE, next line ◄──── it has disconnected, and no command is executed ◄───┘
//! ```
//!
//! The numbers of the commands form one sequence. A workstation controller that connects earlier waits.

use std::{
    thread,
    time::{Duration, Instant},
};

use closed_loop::{JobPlayer, workstation::SimulatedWorkstation};
use interfaces::{CommonMemory, HwsCommand, hws::HwsReport};
use neighbours::workstation::{
    Gate,
    player::{BegunStep, Hwsc, Progress, Retry},
};
use rcs_core::tick::{TICK_MS, Tick};
use sessions::network::{ClockKind, Endpoint};

use crate::{
    event::Event,
    judge::{CommandJudge, play, read_command},
    outside::OutsideWorkstation,
};

const HOME: &str = "HOME"; // location of the robot when the workstation controller takes over (IV.4.1)
const PAUSE: &str = "PAUSE"; // last command before the workstation controller takes over

pub struct SwitchContext<'a> {
    pub tick: Tick,
    /// Common memory after the tick and the task data, and the verdict on commands.
    pub judge: CommandJudge<'a>,
    /// True if the Data System is connected, or runs in the controller's process.
    pub has_data_system: bool,
}

pub struct Switched {
    job: JobPlayer,
    outside: OutsideWorkstation,
    wait: u32,           // time limit for the connection of the workstation controller, s
    since: Tick,         // tick in which it took over
    was_connected: bool, // true if it has been connected since then
}

impl Switched {
    #[must_use]
    pub fn new(hwsc: Hwsc, endpoint: Endpoint, wait: u32) -> Self {
        Self {
            job: JobPlayer::new(hwsc),
            outside: OutsideWorkstation::new(endpoint),
            wait,
            since: Tick::BEFORE_START,
            was_connected: false,
        }
    }

    #[must_use]
    pub fn is_handed_over(&self) -> bool {
        self.job.hwsc.is_handed_over()
    }

    pub fn job_under_way(&mut self) -> Option<&mut Hwsc> {
        (!self.is_handed_over()).then_some(&mut self.job.hwsc)
    }

    /// The job, read-only, unless it has transferred the command.
    #[must_use]
    pub fn job(&self) -> Option<&Hwsc> {
        (!self.is_handed_over()).then_some(&self.job.hwsc)
    }

    pub const fn outside(&mut self) -> &mut OutsideWorkstation {
        &mut self.outside
    }

    /// Number of the job's last begun line, and the number of its lines.
    #[must_use]
    pub fn place(&self) -> (usize, usize) {
        self.job.hwsc.place()
    }

    /// Steps of the job, or the commands of the workstation controller since it took over.
    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        if self.is_handed_over() { self.outside.begun_steps() } else { self.job.hwsc.begun_steps() }
    }

    /// Steps of the job, and the later commands of the workstation controller.
    #[must_use]
    pub fn all_steps(&self) -> Vec<BegunStep> {
        let outside = if self.is_handed_over() { self.outside.begun_steps() } else { &[] };
        [self.job.hwsc.begun_steps(), outside].concat()
    }

    #[must_use]
    pub fn retried(&self) -> &[Retry] {
        self.job.hwsc.retried()
    }

    pub fn step(
        &mut self,
        around: &SwitchContext<'_>,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        events: &mut Vec<Event>,
    ) -> Progress {
        if self.is_handed_over() {
            return self.follow(around, gate, workstation, events);
        }
        self.outside.attend(around.tick, workstation, events);
        let progress = play(&mut self.job, around.tick, gate, workstation, &around.judge, events);
        if self.is_handed_over() { self.hand_over(around, gate, events) } else { progress }
    }

    fn hand_over(
        &mut self,
        around: &SwitchContext<'_>,
        gate: &mut Gate,
        events: &mut Vec<Event>,
    ) -> Progress {
        if let Some(obstacle) = obstacle(around.judge.memory, gate.command(), around.has_data_system) {
            return self.refuse(around.tick, obstacle);
        }
        events.push(Event::HandedOver);
        gate.initialize();
        (self.since, self.was_connected) = (around.tick, false);
        // In fast clock, hours of simulated time would pass before it connects.
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

    /// Follow the workstation controller's commands, or its disconnection.
    fn follow(
        &mut self,
        around: &SwitchContext<'_>,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        events: &mut Vec<Event>,
    ) -> Progress {
        let task = &around.judge.memory.task;
        let progress = self.outside.step(around.tick, gate, workstation, &around.judge, events);
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
        let progress = self.job.take_back(around.tick, gate, self.outside.take_steps());
        read_command(gate, self.job.command_box(), &around.judge, events);
        progress
    }

    fn refuse(&mut self, tick: Tick, why: String) -> Progress {
        self.job.hwsc.refuse(tick, why);
        self.job.hwsc.progress().clone()
    }
}

/// The reason why the workstation controller cannot take over (IV.4.1), if any.
pub fn obstacle(memory: &CommonMemory, last: &HwsCommand, has_data_system: bool) -> Option<String> {
    let needs = "the workstation controller is connected with";
    let place = memory.emove.estimates.place.map(|place| place.site.location);
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
