//! A run in which a workstation controller in another process commands from the start, and an operator can take
//! the command and return it (IV.4.1).
//!
//! ```text
//!                        `stand-alone`: no command is executed; `now`: PAUSE replaces it
//!   workstation controller ─────────────────────────────────────────────────────────────► operator
//!            ▲                                                                                │
//!            └──── `workstation`: robot at HOME, PAUSE last, Data System connected ◄──────────┘
//! ```
//!
//! The numbers of the commands form one sequence. While an operator commands, the workstation controller reads an
//! initialized status mailbox, and its commands are not executed.

use closed_loop::{JobPlayer, workstation::SimulatedWorkstation};
use interfaces::{CommonMemory, TaskOutputs, hws::HwsReport};
use neighbours::workstation::{
    Gate,
    player::{BegunStep, Hwsc, Progress, TIME_LIMIT, pause},
};
use rcs_core::tick::Tick;
use sessions::network::Endpoint;

use crate::{
    event::Event,
    judge::{CommandJudge, play},
    outside::OutsideWorkstation,
    switched::obstacle,
};

pub struct Commanded {
    pub(crate) outside: OutsideWorkstation,
    /// Sends the operator's commands; `None` while the workstation controller commands.
    alone: Option<JobPlayer>,
    before: Vec<BegunStep>,
}

impl Commanded {
    #[must_use]
    pub const fn new(endpoint: Endpoint) -> Self {
        Self { outside: OutsideWorkstation::new(endpoint), alone: None, before: Vec::new() }
    }

    #[must_use]
    pub const fn is_stand_alone(&self) -> bool {
        self.alone.is_some()
    }

    pub fn job_under_way(&mut self) -> Option<&mut Hwsc> {
        self.alone.as_mut().map(|emulator| &mut emulator.hwsc)
    }

    #[must_use]
    pub fn job(&self) -> Option<&Hwsc> {
        self.alone.as_ref().map(|emulator| &emulator.hwsc)
    }

    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        match &self.alone {
            Some(emulator) => emulator.hwsc.begun_steps(),
            None => self.outside.begun_steps(),
        }
    }

    /// Commands of all sources, in order.
    #[must_use]
    pub fn all_steps(&self) -> Vec<BegunStep> {
        [&self.before, self.begun_steps()].concat()
    }

    pub fn step(
        &mut self,
        tick: Tick,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        judge: &CommandJudge<'_>,
        events: &mut Vec<Event>,
    ) -> Progress {
        let Some(emulator) = &mut self.alone else {
            return self.outside.step(tick, gate, workstation, judge, events);
        };
        self.outside.attend(tick, workstation, events);
        match play(emulator, tick, gate, workstation, judge, events) {
            Progress::Running => {}
            Progress::Over => emulator.hwsc.wait_without_job(),
            Progress::Failed(failure) => {
                events.push(Event::OperatorJobFailed(failure));
                emulator.hwsc.wait_without_job();
            }
        }
        Progress::Running
    }

    /// Give the command to an operator. Errors: the reason, as a sentence.
    pub fn take_command(
        &mut self,
        tick: Tick,
        task: &TaskOutputs,
        gate: &mut Gate,
        now: bool,
    ) -> Result<String, String> {
        if self.alone.is_some() {
            return Err("the run is stand-alone already; `workstation` gives the command back".to_owned());
        }
        let last = *gate.command();
        let executes = task.status.echo != last.number || task.status.report == HwsReport::Executing;
        if executes && !now {
            return Err(format!(
                "{} of the workstation controller, number {}, is executed: wait for its end, or `stand-alone now` \
                 sends PAUSE in its place",
                last.command, last.number
            ));
        }
        self.outside.interrupt(tick);
        self.before.extend(self.outside.take_steps());
        gate.initialize();
        let mut hwsc = Hwsc::stand_alone(last.number, TIME_LIMIT);
        if executes {
            let paused = hwsc.command_by_operator(tick, "PAUSE".to_owned(), pause());
            paused.map_err(|error| error.to_string())?;
        }
        self.alone = Some(JobPlayer::new(hwsc));
        Ok("the workstation controller no longer commands; `workstation` gives the command back".to_owned())
    }

    /// Give the command to the workstation controller. Errors: the reason, as a sentence.
    pub fn give_command(
        &mut self,
        tick: Tick,
        memory: &CommonMemory,
        has_data_system: bool,
        gate: &mut Gate,
    ) -> Result<String, String> {
        let Some(emulator) = &self.alone else {
            return Err("the workstation controller commands already".to_owned());
        };
        if let Some(obstacle) = obstacle(memory, gate.command(), has_data_system) {
            return Err(obstacle);
        }
        let status = &memory.task.status;
        if status.echo != gate.command().number || status.report != HwsReport::Finished {
            return Err(format!("PAUSE is not finished in tick {tick}: ask again"));
        }
        self.before.extend_from_slice(emulator.hwsc.begun_steps());
        self.alone = None;
        gate.initialize();
        self.outside.pass_over(gate);
        Ok("the workstation controller commands".to_owned())
    }
}
