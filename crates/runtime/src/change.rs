//! Changes of a run between two ticks, for experiments with a recorded run ([`crate::repeat`]). A change takes effect
//! in the next tick and is logged. Changed task data are a new generation, and do not wait for the end of a command.

use plant::fault::{FaultSubject, text::FaultFile};
use taskdata::load::{
    Diagnostics, Source,
    job::{JobLine, Reload},
};

use crate::{Run, event::Event, loads::insert};

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeError {
    #[error("with this change the task data have errors:\n{0}")]
    Data(String),
    #[error("a reload of the job waits for the end of a command: change the task data in another tick")]
    Reload,
    #[error("another process commands this run: there is no job whose lines can be changed")]
    NoJob,
    #[error("the job sends no command after tick {0}: name an earlier tick")]
    NoCommand(u64),
    #[error("the line to the robot has faults already: leave those of the line out of the file")]
    Line,
    #[error(
        "fault {0} displaces the pedestal, which is possible before the first tick only: run the job with this file instead"
    )]
    Displaced(usize),
}

impl From<Box<Diagnostics>> for ChangeError {
    fn from(report: Box<Diagnostics>) -> Self {
        Self::Data(report.render(false))
    }
}

impl Run {
    /// Add these blocks to the task data from the next tick on, also in the middle of a command. An entry replaces one
    /// of the same name. On error, the run is unchanged.
    pub fn change_data(&mut self, source: Source) -> Result<(), ChangeError> {
        let generations = self.closed.generations();
        let reloads = insert(generations.current(), generations.reloads(), generations.done(), &source)?;
        if self.use_reloads(reloads) { Ok(()) } else { Err(ChangeError::Reload) }
    }

    /// Add reloads from the next tick on. Returns false, without a change, if a reload waits for the end of a command.
    pub(crate) fn use_reloads(&mut self, reloads: Vec<Reload>) -> bool {
        let inserted = self.closed.generations_mut().insert(reloads);
        if inserted {
            self.log_reload();
        }
        inserted
    }

    /// Enable the faults of a file from the next tick on. On error, the run is unchanged.
    pub fn add_faults(&mut self, faults: &FaultFile, seed: u64) -> Result<(), ChangeError> {
        let moves =
            faults.cell.faults.iter().find(|fault| matches!(fault.what, FaultSubject::PedestalMoved { .. }));
        if let Some(fault) = moves {
            return Err(ChangeError::Displaced(fault.number));
        }
        if let Some(plan) = &faults.line
            && (self.robot.is_elsewhere() || !self.closed.line_mut().apply_faults(plan))
        {
            return Err(ChangeError::Line);
        }
        self.closed.workstation.cell.add_faults(&faults.cell, seed);
        self.note_change("faults of another file can begin");
        Ok(())
    }

    /// Use another seed for sensor noise and for the positions of delivered parts from the next tick on.
    pub fn change_seed(&mut self, seed: u64) {
        self.closed.workstation.cell.reseed(seed);
        self.note_change(&format!("the seed is {seed}"));
    }

    /// Insert a line before the next one of the job.
    pub fn insert_line(&mut self, line: JobLine) -> Result<(), ChangeError> {
        let text = format!("one more line of the job: {}", line.text);
        self.neighbours.job_player().ok_or(ChangeError::NoJob)?.insert(line);
        self.note_change(&text);
        Ok(())
    }

    pub fn replace_command(&mut self, line: JobLine) -> Result<(), ChangeError> {
        let text = format!("the next command of the job is replaced: {}", line.text);
        if !self.neighbours.job_player().ok_or(ChangeError::NoJob)?.replace_command(line) {
            return Err(ChangeError::NoCommand(self.last_tick().0));
        }
        self.note_change(&text);
        Ok(())
    }

    fn note_change(&mut self, text: &str) {
        self.log_event(self.last_tick().next(), &Event::Changed(text.to_owned()));
    }
}
