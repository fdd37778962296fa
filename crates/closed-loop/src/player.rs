//! Sends commands to Task through the command mailbox.
//!
//! ```text
//!   Gate: status mailbox ──► Commander::step ──► command ──► CommandBox ──► Gate::read ──► Task
//! ```
//!
//! The job of a run and an operator ([`JobPlayer`]), and the operator of a campaign use a [`CommandBox`].

use std::convert::Infallible;

use crate::course::Levels;
use interfaces::HwsCommand;
use neighbours::{
    mailbox::{HWSC_COMMAND, Mailbox},
    workstation::{
        Gate, Unchecked, command,
        player::{BegunStep, Hwsc, JobFailure, Progress},
        status::{self, Status},
    },
};
use rcs_core::tick::Tick;
use taskdata::files::TaskData;

use crate::{ClosedLoop, Given, World, workstation::SimulatedWorkstation};

pub trait Commander<W = SimulatedWorkstation> {
    /// Called once per tick: read Task's status and return the command for the mailbox, if any.
    fn step(&mut self, tick: Tick, status: &Status<'_>, workstation: &mut W) -> Option<HwsCommand>;
}

impl<W: World> Commander<W> for Hwsc {
    fn step(&mut self, tick: Tick, status: &Status<'_>, workstation: &mut W) -> Option<HwsCommand> {
        Self::step(self, tick, status, workstation);
        self.mailgram().copied()
    }
}

#[derive(Clone, Debug)]
pub struct CommandBox(Mailbox);

impl Default for CommandBox {
    fn default() -> Self {
        Self(Mailbox::initialized(HWSC_COMMAND))
    }
}

impl CommandBox {
    #[must_use]
    pub const fn mailbox(&self) -> &Mailbox {
        &self.0
    }

    /// Once per tick: the commander reads the status mailbox and writes its command; the gate must then read the
    /// mailbox. Fails if the status cannot be decoded or the command does not fit.
    pub fn write<W>(
        &mut self,
        tick: Tick,
        gate: &Gate,
        workstation: &mut W,
        commander: &mut impl Commander<W>,
    ) -> Result<(), JobFailure> {
        let status = status::decode(gate.status_box().data())
            .map_err(|error| JobFailure::Refused(error.to_string()))?;
        match commander.step(tick, &status, workstation) {
            Some(command) => self.post(&command),
            None => Ok(()),
        }
    }

    fn post(&mut self, command: &HwsCommand) -> Result<(), JobFailure> {
        let refused = |why: String| JobFailure::Refused(why);
        let bytes = command::encode(command).map_err(|error| refused(error.to_string()))?;
        self.0.write(&bytes).map_err(|error| refused(error.to_string()))
    }
}

impl<L, W: World> ClosedLoop<L, W>
where
    L: for<'a> Levels<TaskData<'a>, Error = Infallible>,
{
    /// Run one tick without external inputs, with commands of a job that was checked when it was loaded. After an error
    /// the tick is valid.
    pub fn step(
        &mut self,
        command_box: &mut CommandBox,
        commander: &mut impl Commander<W>,
    ) -> (W::Settled, Result<(), JobFailure>) {
        let Ok(()) = self.decide(&Given::default());
        let settled = self.settle(None);
        let written = self.exchange(|desk| {
            let written = command_box.write(desk.tick, desk.gate, desk.workstation, commander);
            desk.gate.read(command_box.mailbox(), &Unchecked);
            written
        });
        self.reload();
        (settled, written)
    }
}

/// The workstation controller's emulator with a job and its command mailbox. A copy continues from the same line.
#[derive(Clone, Debug)]
pub struct JobPlayer {
    pub hwsc: Hwsc,
    command_box: CommandBox,
}

impl JobPlayer {
    #[must_use]
    pub fn new(hwsc: Hwsc) -> Self {
        Self { hwsc, command_box: CommandBox::default() }
    }

    #[must_use]
    pub const fn command_box(&self) -> &Mailbox {
        self.command_box.mailbox()
    }

    /// Once per tick: the emulator reads its status mailbox and writes its command mailbox. The gate must then read it.
    pub fn write<W: World>(&mut self, tick: Tick, gate: &Gate, workstation: &mut W) -> Progress {
        let written = self.command_box.write(tick, gate, workstation, &mut self.hwsc);
        self.progress(written)
    }

    /// Return control to the job and write its next command. The mailboxes are initialized (IX.1).
    pub fn take_back(&mut self, tick: Tick, gate: &mut Gate, commands: Vec<BegunStep>) -> Progress {
        self.command_box.0.initialize();
        gate.initialize();
        self.hwsc.take_back(tick, gate.command().number, commands);
        let written = self.hwsc.mailgram().map_or(Ok(()), |command| self.command_box.post(command));
        match written {
            Ok(()) => Progress::Running,
            Err(failure) => Progress::Failed(failure),
        }
    }

    /// Run one tick of a loop that this player commands, without external inputs.
    pub fn step<L, W: World>(&mut self, closed: &mut ClosedLoop<L, W>) -> Progress
    where
        L: for<'a> Levels<TaskData<'a>, Error = Infallible>,
    {
        let (_, written) = closed.step(&mut self.command_box, &mut self.hwsc);
        self.progress(written)
    }

    fn progress(&self, written: Result<(), JobFailure>) -> Progress {
        written.map_or_else(Progress::Failed, |()| self.hwsc.progress().clone())
    }
}
