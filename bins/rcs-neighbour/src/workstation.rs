//! The workstation controller: the emulator that also runs in the controller's process, here behind mailboxes.

use std::{collections::VecDeque, path::Path};

use diagnostics::JOBS;
use neighbours::{
    fields::successor,
    layout::LayoutError,
    mailbox::{CELL_COMMAND, CELL_STATUS, HWSC_COMMAND, HWSC_STATUS, Mailbox},
    workstation::{
        cell::{self, CellStatus, Trouble},
        command,
        player::{Hwsc, JobFailure, Progress, TIME_LIMIT, Workstation},
        status,
    },
};
use os_io::text::amount;
use rcs_core::tick::Tick;
use sessions::network::{ClockKind, Peer, Received, Role};
use taskdata::load::{Job, Store, job::Workstation as Action};

use crate::{Error, cli::WorkstationArguments, connect};

/// Ticks within which a command must be echoed over a network: 2 s.
const NETWORK_TICKS: u64 = 50;

pub fn play(arguments: &WorkstationArguments) -> Result<(), Error> {
    let job = job(arguments)?;
    let mut peer = connect(&arguments.controller, Role::Workstation)?;
    let hwsc = Hwsc::new(job.steps, TIME_LIMIT).with_retries(arguments.retry);
    let mut hwsc = if peer.clock() == ClockKind::Fast { hwsc } else { hwsc.with_answer_ticks(NETWORK_TICKS) };
    let mut command_box = Mailbox::initialized(HWSC_COMMAND);
    let (mut cell, mut told, mut retried) = (Cell::default(), 0, 0);
    loop {
        let Received::Pulse(tick) = peer.receive()? else { continue };
        if peer.mailbox(HWSC_STATUS).mailgram() != 0 && peer.mailbox(CELL_STATUS).mailgram() != 0 {
            cell.read(peer.mailbox(CELL_STATUS)).map_err(unreadable)?;
            let status = status::decode(peer.mailbox(HWSC_STATUS).data()).map_err(unreadable)?;
            let progress = hwsc.step(Tick(tick), &status, &mut cell).clone();
            for retry in hwsc.retried().iter().skip(retried) {
                os_io::stdout_line!("tick {tick}: {retry}");
                retried += 1;
            }
            tell(&hwsc, &mut told, progress != Progress::Running);
            match progress {
                Progress::Running => {}
                Progress::Over => return Ok(()),
                Progress::Failed(failure) => {
                    let last = hwsc.begun_steps().last().map_or("", |step| step.text.as_str());
                    let line = if let JobFailure::Unfinished { line, .. } = &failure { line } else { last };
                    let remedy =
                        failure.remedy().map_or_else(String::new, |remedy| format!("; to do: {remedy}"));
                    return Err(Error::Job(format!("`{line}` failed: {failure}{remedy}")));
                }
            }
            if let Some(command) = hwsc.mailgram() {
                let bytes = command::encode(command).map_err(|error| Error::Job(error.to_string()))?;
                command_box.write(&bytes).map_err(|error| Error::Job(error.to_string()))?;
                peer.send(&command_box)?;
            }
            cell.send(&mut peer)?;
        }
        peer.pulse(tick)?;
    }
}

fn unreadable(error: LayoutError) -> Error {
    Error::Job(format!("a status of the controller cannot be read: {error}"))
}

fn job(arguments: &WorkstationArguments) -> Result<Job, Error> {
    let unusable = |what: String| move |report| Error::Data { what, report };
    let data = &arguments.data;
    // The controller refuses a command whose data have errors.
    let (store, _) = Store::load_with_faults(data);
    let path = JOBS.find(Path::new(&arguments.job), data)?;
    let (job, _) = Job::load(&path, &store).map_err(unusable(format!("the job {}", path.display())))?;
    Ok(job)
}

/// Prints one line for every finished step.
fn tell(hwsc: &Hwsc, told: &mut usize, over: bool) {
    let finished = if over { hwsc.begun_steps().len() } else { hwsc.begun_steps().len().saturating_sub(1) };
    for step in hwsc.begun_steps().get(*told..finished).unwrap_or_default() {
        os_io::stdout_line!("{}: {} after {}", step.text, step.ending(), amount(step.ticks, "tick"));
    }
    *told = finished.max(*told);
}

/// The simulated cell as seen through its mailboxes.
struct Cell {
    command_box: Mailbox,
    /// Number of the line sent last.
    number: u16,
    /// Lines not yet sent: the mailbox holds only one.
    lines: VecDeque<String>,
    echo: u16,
    busy: bool,
    trouble: Trouble,
    text: String,
}

impl Default for Cell {
    fn default() -> Self {
        Self {
            command_box: Mailbox::initialized(CELL_COMMAND),
            number: 0,
            lines: VecDeque::new(),
            echo: 0,
            busy: false,
            trouble: Trouble::None,
            text: String::new(),
        }
    }
}

impl Cell {
    fn read(&mut self, mailbox: &Mailbox) -> Result<(), LayoutError> {
        let CellStatus { echo, busy, trouble, text } = CellStatus::decode(mailbox.data())?;
        (self.echo, self.busy, self.trouble) = (echo, busy, trouble);
        self.text.clear();
        self.text.push_str(text);
        Ok(())
    }

    /// Sends the next line if the cell has echoed the previous one.
    fn send(&mut self, peer: &mut Peer) -> Result<(), Error> {
        if self.echo != self.number {
            return Ok(());
        }
        let Some(line) = self.lines.pop_front() else { return Ok(()) };
        self.number = successor(self.number);
        let bytes = cell::encode_line(self.number, &line);
        self.command_box.write(&bytes).map_err(|error| Error::Job(error.to_string()))?;
        Ok(peer.send(&self.command_box)?)
    }

    fn trouble(&self, wanted: &[Trouble]) -> Option<String> {
        wanted.contains(&self.trouble).then(|| self.text.clone())
    }
}

impl Workstation for Cell {
    fn begin(&mut self, action: &Action, line: &str) -> Result<(), String> {
        if matches!(action, Action::Load { .. }) {
            return Err("blocks are loaded by the controller's own jobs only".to_owned());
        }
        self.lines.push_back(line.to_owned());
        Ok(())
    }

    fn busy(&self) -> bool {
        !self.lines.is_empty() || self.echo != self.number || self.busy
    }

    fn fault(&self) -> Option<String> {
        self.trouble(&[Trouble::Refused, Trouble::Fault])
    }

    fn emergency(&self) -> Option<String> {
        self.trouble(&[Trouble::Emergency])
    }
}
