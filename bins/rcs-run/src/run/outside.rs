//! A workstation controller in another process: its mailboxes, and what of its commands a run remembers.
//!
//! Besides Task it commands the simulated cell: what a workstation does itself are lines of a job, in a mailbox of their own. A
//! run in fast clock is over when its workstation controller has gone; on the 40 ms grid the robot waits for it to come back.

use neighbours::{
    mailbox::{CELL_COMMAND, CELL_STATUS, HWSC_COMMAND, HWSC_STATUS},
    network::{Desk, hello::ClockKind},
    workstation::{
        Gate,
        cell::{self, CellStatus, Trouble},
        player::{Outcome, Progress, Record, Workstation as _},
    },
};
use rcs_core::{
    interface::{HwsCommand, TaskOutputs, hws::HwsReport},
    name::Name16,
    tick::Tick,
};
use record::Level;
use taskdata::load::{Job, Source, Step, Store, job::Workstation as Action};

use super::{
    neighbours::{Note, network_note},
    workstation::SimulatedWorkstation,
};

/// Commands that a run remembers; a run of a year must not fill the memory.
const REMEMBERED: usize = 10_000;

/// A workstation controller in another process.
pub struct OutsideWorkstation {
    desk: Desk,
    /// Mailgram number of the last line for the cell.
    line_read: u16,
    /// Number of that line.
    line: u16,
    /// Why it was refused.
    refused: Option<String>,
    records: Vec<Record>,
    began: Tick,
    /// It has been there.
    came: bool,
}

impl OutsideWorkstation {
    /// Its mailboxes.
    #[must_use]
    pub const fn new(desk: Desk) -> Self {
        Self {
            desk,
            line_read: 0,
            line: 0,
            refused: None,
            records: Vec::new(),
            began: Tick::BEFORE_START,
            came: false,
        }
    }

    /// The commands that were taken, as far as they are remembered.
    #[must_use]
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// Once a tick, after controller and cell.
    pub fn step(
        &mut self,
        tick: Tick,
        gate: &mut Gate,
        task: &TaskOutputs,
        workstation: &mut SimulatedWorkstation,
        store: &Store,
        notes: &mut Vec<Note>,
    ) -> Progress {
        self.follow(tick, gate.command(), task);
        self.desk.outgoing(HWSC_STATUS).clone_from(gate.status_box());
        self.write_cell(workstation, notes);
        let presence = self.desk.exchange(tick.0);
        while let Some(news) = self.desk.news() {
            notes.push(network_note(&news));
        }
        if presence.new {
            gate.initialize();
            (self.line_read, self.line, self.refused) = (0, 0, None);
        }
        self.came |= presence.here;
        let before = gate.command().number;
        if let Some(refusal) = gate.read(self.desk.incoming(HWSC_COMMAND)) {
            notes.push((Level::Warning, "HWSC", format!("a command is refused: {refusal}")));
        }
        if gate.command().number != before {
            self.begin(tick, gate.command());
        }
        self.read_cell(workstation, store, notes);
        if self.came && !presence.here && self.desk.clock() == ClockKind::Fast {
            Progress::Over
        } else {
            Progress::Running
        }
    }

    fn begin(&mut self, tick: Tick, command: &HwsCommand) {
        self.began = tick;
        if self.records.len() < REMEMBERED {
            let record =
                Record { text: spelled(command), is_command: true, outcome: Outcome::Executing, ticks: 0 };
            self.records.push(record);
        }
    }

    /// What has become of the last command.
    fn follow(&mut self, tick: Tick, command: &HwsCommand, task: &TaskOutputs) {
        let Some(record) = self.records.last_mut() else { return };
        if record.outcome != Outcome::Executing || task.status.echo != command.number {
            return;
        }
        record.ticks = tick.since(self.began);
        record.outcome = match task.status.report {
            HwsReport::Finished => Outcome::Finished,
            HwsReport::Error | HwsReport::JoystickOn => Outcome::Failed,
            HwsReport::Idle | HwsReport::Executing => Outcome::Executing,
        };
    }

    fn write_cell(&mut self, workstation: &SimulatedWorkstation, notes: &mut Vec<Note>) {
        let (emergency, fault) = (workstation.emergency(), workstation.fault());
        let (trouble, text) = match (&emergency, &fault, &self.refused) {
            (Some(text), _, _) => (Trouble::Emergency, text.as_str()),
            (None, Some(text), _) => (Trouble::Fault, text.as_str()),
            (None, None, Some(text)) => (Trouble::Refused, text.as_str()),
            (None, None, None) => (Trouble::None, ""),
        };
        let status = CellStatus { echo: self.line, busy: workstation.busy(), trouble, text }.encode();
        let mailbox = self.desk.outgoing(CELL_STATUS);
        if mailbox.data() != status
            && let Err(error) = mailbox.write(&status)
        {
            notes.push((Level::Error, "cell", error.to_string()));
        }
    }

    /// Begin what the workstation controller wants of the cell.
    fn read_cell(&mut self, workstation: &mut SimulatedWorkstation, store: &Store, notes: &mut Vec<Note>) {
        let mailbox = self.desk.incoming(CELL_COMMAND);
        if mailbox.mailgram() == self.line_read {
            return;
        }
        self.line_read = mailbox.mailgram();
        let begun = match cell::decode_line(mailbox.data()) {
            Ok((number, _)) if number == self.line => return,
            Ok((number, line)) => {
                self.line = number;
                action(line, store).and_then(|action| workstation.begin(&action, line))
            }
            Err(error) => Err(error.to_string()),
        };
        self.refused = begun.err();
        if let Some(why) = &self.refused {
            notes.push((Level::Warning, "cell", format!("a line of the workstation is refused: {why}")));
        }
    }
}

/// What a line wants of the cell.
fn action(line: &str, store: &Store) -> Result<Action, String> {
    let source = Source { name: "workstation".into(), text: format!("** {line}").into() };
    let (job, _) = Job::from_source(source, store).map_err(|report| {
        let errors: Vec<_> = report.errors().map(ToString::to_string).collect();
        errors.join("; ")
    })?;
    match job.steps.first().map(|line| line.step) {
        Some(Step::Workstation(Action::Load { .. } | Action::Wait { .. })) => {
            Err("the workstation waits by itself, and only a job of the controller's own loads blocks"
                .to_owned())
        }
        Some(Step::Workstation(action)) => Ok(action),
        _ => Err("a line for the cell was expected, such as vise close PFIXTURE".to_owned()),
    }
}

/// A command as a job has it.
fn spelled(command: &HwsCommand) -> String {
    let name = |name: &Name16| if name.is_empty() { "--".to_owned() } else { name.to_string() };
    let mut text = format!(
        "== {} {} {:+} {} {} {:+} {} {} {} {}",
        command.command,
        name(&command.object),
        command.source_grip,
        name(&command.source),
        command.source_sector,
        command.destination_grip,
        name(&command.destination),
        command.destination_sector,
        name(&command.end_at),
        command.end_at_sector,
    );
    if !command.serial.is_empty() {
        text += &format!(" #{}", command.serial);
    }
    text
}
