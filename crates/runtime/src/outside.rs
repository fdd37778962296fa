//! A workstation controller in another process: its mailboxes, and the commands that a run stores.
//!
//! It also commands the simulated cell, with lines of a job in a separate mailbox. In fast clock the run ends when it
//! disconnects, and has failed if this happens during a command. On the 40 ms grid the robot waits.

use closed_loop::workstation::SimulatedWorkstation;
use interfaces::{HwsCommand, TaskOutputs, Unconfirmed, hws::HwsReport};
use neighbours::{
    mailbox::{CELL_COMMAND, CELL_STATUS, HWSC_COMMAND, HWSC_STATUS},
    workstation::{
        Gate,
        cell::{self, CellLine, CellStatus, Trouble},
        player::{BegunStep, JobFailure, Outcome, Progress, Workstation as _},
    },
};
use rcs_core::{name::Name16, tick::Tick};
use sessions::network::{ClockKind, Disconnect, Endpoint, NetEvent, Presence};
use taskdata::load::{
    BlockNumber, Store,
    job::{self, Workstation as Action},
};

use crate::{
    event::Event,
    judge::{CommandJudge, read_command},
    loads,
};

/// Number of stored commands, so that a run of a year does not exhaust the memory.
const REMEMBERED: usize = 10_000;

pub struct OutsideWorkstation {
    endpoint: Endpoint,
    line_read: u16, // mailgram number of the last line for the cell
    line: u16,
    refused: Option<String>,             // the reason why that line was refused
    load: Option<(BlockNumber, String)>, // the requested block, until the run begins to load it
    loading: Option<u16>,                // number of the line whose load is unanswered
    begun_steps: Vec<BegunStep>,
    began: Tick,
    came: bool, // true if it has been connected in a tick
    here: bool,
    by_hand: bool, // true if it has used the joystick box or the rotary table's panel since it connected
    disconnect: Option<Disconnect>, // the reason why the last connection ended
}

impl OutsideWorkstation {
    #[must_use]
    pub const fn new(endpoint: Endpoint) -> Self {
        Self {
            endpoint,
            line_read: 0,
            line: 0,
            refused: None,
            load: None,
            loading: None,
            begun_steps: Vec::new(),
            began: Tick::BEFORE_START,
            came: false,
            here: false,
            by_hand: false,
            disconnect: None,
        }
    }

    /// The accepted commands that are stored.
    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        &self.begun_steps
    }

    #[must_use]
    pub const fn is_here(&self) -> bool {
        self.here
    }

    #[must_use]
    pub const fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Replace the command in progress: an operator has taken the command.
    pub fn interrupt(&mut self, tick: Tick) {
        if let Some(step) = self.begun_steps.last_mut().filter(|step| step.outcome == Outcome::Executing) {
            (step.outcome, step.ticks) = (Outcome::Interrupted, tick.since(step.began));
        }
    }

    /// Skip the commands that arrived while another source commanded.
    pub fn pass_over(&mut self, gate: &mut Gate) {
        gate.pass_over(self.endpoint.incoming(HWSC_COMMAND));
        self.line_read = self.endpoint.incoming(CELL_COMMAND).mailgram();
        self.refused = None;
    }

    pub fn take_steps(&mut self) -> Vec<BegunStep> {
        std::mem::take(&mut self.begun_steps)
    }

    /// The block that a line of this tick requests, and the line.
    pub const fn load_asked(&mut self) -> Option<(BlockNumber, String)> {
        self.load.take()
    }

    /// Answer a load with the reason of a refusal, or `None`. Only the line that requested it receives the answer.
    pub fn load_answered(&mut self, refused: Option<String>) {
        if self.loading.take() == Some(self.line) {
            self.refused = refused;
        }
    }

    /// Once per tick while an operator or the job commands. It may connect, but its commands are not read.
    pub fn attend(&mut self, tick: Tick, workstation: &mut SimulatedWorkstation, events: &mut Vec<Event>) {
        for place in [HWSC_STATUS, CELL_STATUS] {
            self.endpoint.outgoing(place).initialize();
        }
        self.exchange(tick, workstation, events);
    }

    /// Exchange the mailboxes of a tick. Motion by hand ends with the connection that commands it.
    fn exchange(
        &mut self,
        tick: Tick,
        workstation: &mut SimulatedWorkstation,
        events: &mut Vec<Event>,
    ) -> Presence {
        let presence = self.endpoint.exchange(tick.0);
        while let Some(event) = self.endpoint.event() {
            if let NetEvent::Disconnected(_, reason) = &event {
                self.disconnect = Some(reason.clone());
            }
            events.push(Event::Network(event));
        }
        if presence.new {
            (self.line_read, self.line, self.refused, self.loading) = (0, 0, None, None);
        }
        self.here = presence.connected;
        if (!presence.connected || presence.new) && std::mem::take(&mut self.by_hand) {
            workstation.cell.release_joystick();
            workstation.cell.release_table_keys();
        }
        presence
    }

    pub fn step(
        &mut self,
        tick: Tick,
        gate: &mut Gate,
        workstation: &mut SimulatedWorkstation,
        judge: &CommandJudge<'_>,
        events: &mut Vec<Event>,
    ) -> Progress {
        let task = &judge.memory.task;
        self.follow(tick, gate.command(), task);
        self.endpoint.outgoing(HWSC_STATUS).clone_from(gate.status_box());
        self.write_cell(workstation, events);
        let presence = self.exchange(tick, workstation, events);
        let gone = self.has_gone(presence);
        if presence.new {
            gate.initialize();
        }
        let before = gate.command().number;
        if let Some(refusal) = read_command(gate, self.endpoint.incoming(HWSC_COMMAND), judge, events) {
            events.push(Event::CommandRefused(refusal));
        }
        if gate.command().number != before {
            self.begin(tick, gate.command());
        }
        self.read_cell(workstation, judge.store(), events);
        if gone { self.end(gate.command(), task, workstation) } else { Progress::Running }
    }

    /// True if the workstation controller has disconnected, which ends the run. A new connection is too late.
    fn has_gone(&mut self, presence: Presence) -> bool {
        let gone = presence.was_connected && (!presence.connected || presence.new && self.came);
        self.came |= presence.connected;
        gone && self.endpoint.clock() == ClockKind::Fast
    }

    fn end(&self, command: &HwsCommand, task: &TaskOutputs, workstation: &SimulatedWorkstation) -> Progress {
        if let Some(emergency) = workstation.emergency() {
            return Progress::Failed(JobFailure::Emergency(emergency));
        }
        let status = &task.status;
        let executes = status.echo != command.number || status.report == HwsReport::Executing;
        let amid =
            if executes { format!(" while {} was not finished", command.command) } else { String::new() };
        let what = match &self.disconnect {
            Some(why) if why.is_by_controller() => {
                format!("the workstation controller was disconnected{amid}: {why}")
            }
            Some(why) if executes => {
                format!("the workstation controller has gone{amid}: {why}")
            }
            None if executes => format!("the workstation controller has gone{amid}"),
            Some(_) | None => return Progress::Over,
        };
        Progress::Failed(JobFailure::Commander(what))
    }

    fn begin(&mut self, tick: Tick, command: &HwsCommand) {
        self.began = tick;
        if self.begun_steps.len() < REMEMBERED {
            self.begun_steps.push(BegunStep {
                text: spelled(command),
                is_command: true,
                began: tick,
                outcome: Outcome::Executing,
                unconfirmed: Unconfirmed::None,
                ticks: 0,
            });
        }
    }

    fn follow(&mut self, tick: Tick, command: &HwsCommand, task: &TaskOutputs) {
        let Some(step) = self.begun_steps.last_mut() else { return };
        if step.outcome != Outcome::Executing || task.status.echo != command.number {
            return;
        }
        step.ticks = tick.since(self.began);
        step.unconfirmed = task.status.unconfirmed;
        step.outcome = match task.status.report {
            HwsReport::Finished => Outcome::Finished,
            HwsReport::Error | HwsReport::JoystickOn => Outcome::Failed,
            HwsReport::Idle | HwsReport::Executing => Outcome::Executing,
        };
    }

    fn write_cell(&mut self, workstation: &SimulatedWorkstation, events: &mut Vec<Event>) {
        let (emergency, fault) = (workstation.emergency(), workstation.fault());
        let (trouble, text) = match (&emergency, &fault, &self.refused) {
            (Some(text), _, _) => (Trouble::Emergency, text.as_str()),
            (None, Some(text), _) => (Trouble::Fault, text.as_str()),
            (None, None, Some(text)) => (Trouble::Refused, text.as_str()),
            (None, None, None) => (Trouble::None, ""),
        };
        let busy = workstation.busy() || self.loading.is_some();
        let status = CellStatus { echo: self.line, busy, trouble, text }.encode();
        let mailbox = self.endpoint.outgoing(CELL_STATUS);
        if mailbox.data() != status
            && let Err(error) = mailbox.write(&status)
        {
            events.push(Event::CellStatusUnsent(error));
        }
    }

    /// Begin the line for the cell that the workstation controller has sent.
    fn read_cell(&mut self, workstation: &mut SimulatedWorkstation, store: &Store, events: &mut Vec<Event>) {
        let mailbox = self.endpoint.incoming(CELL_COMMAND);
        if mailbox.mailgram() == self.line_read {
            return;
        }
        self.line_read = mailbox.mailgram();
        let begun = match cell::decode_line(mailbox.data()) {
            Err(error) => Err(error.to_string()),
            Ok(CellLine { number: 0, .. }) => Err("a number of at least 1 was expected, found 0".to_owned()),
            Ok(CellLine { number, text: Ok(_) }) if number == self.line => return,
            Ok(CellLine { number, text }) => {
                let line = text.map(str::to_owned).map_err(|error| error.to_string());
                self.line = number;
                line.and_then(|line| self.begin_line(&line, workstation, store))
            }
        };
        self.refused = begun.err();
        if let Some(why) = &self.refused {
            events.push(Event::CellLineRefused(why.clone()));
        }
    }

    /// Begin a line for the cell, or store a load, which the run begins after this tick.
    fn begin_line(
        &mut self,
        line: &str,
        workstation: &mut SimulatedWorkstation,
        store: &Store,
    ) -> Result<(), String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        if let Some(block) = loads::asked(&words) {
            self.load = Some((block?, line.to_owned()));
            self.loading = Some(self.line);
            return Ok(());
        }
        let action = job::own_line(line, store).map_err(|error| error.to_string())?;
        workstation.begin(&action, line)?;
        self.by_hand |= matches!(action, Action::Joystick(_) | Action::Table(_));
        Ok(())
    }
}

/// A command in the form of a job.
fn spelled(command: &HwsCommand) -> String {
    let name = |name: Option<Name16>| name.map_or("--".to_owned(), |name| name.to_string());
    let mut text = format!(
        "== {} {} {:+} {} {} {:+} {} {} {} {}",
        command.command,
        name(command.object),
        command.source_grip,
        name(command.source),
        command.source_sector.unwrap_or(0),
        command.destination_grip,
        name(command.destination),
        command.destination_sector.unwrap_or(0),
        name(command.end_at),
        command.end_at_sector.unwrap_or(0),
    );
    if !command.serial.is_empty() {
        text += &format!(" #{}", command.serial);
    }
    text
}
