//! What is compared of a run.

use std::path::Path;

use interfaces::{Decided, device::LinkBytes};
use levels::ladder::{PROCESS_COUNT, ProcessId};
use record::Log;

use super::{Align, End};
use crate::{
    Error,
    story::{Chronicle, Moment, walk},
};

/// What belongs together: command and ticks since it began.
pub type Key = (u32, u64);

/// What of a tick is compared.
#[derive(Clone, Debug)]
pub struct Mark {
    /// The tick.
    pub tick: u64,
    /// The command that Task has taken.
    command: u32,
    /// Row of each process.
    pub rows: [Option<Decided>; PROCESS_COUNT],
    /// Where the robot was commanded to, world, in.
    pub tool: [f64; 3],
    /// Bytes that went out on the link.
    pub sent: LinkBytes,
}

/// What is compared of a run.
#[derive(Default)]
pub struct Trace {
    /// Its ticks.
    pub marks: Vec<Mark>,
    /// Its commands.
    pub chronicle: Chronicle,
    /// How it ended.
    pub end: End,
}

impl Trace {
    /// Take a tick in.
    pub fn note(&mut self, moment: &Moment) {
        self.chronicle.note(moment);
        let mut rows = [None; PROCESS_COUNT];
        for (row, process) in rows.iter_mut().zip(ProcessId::ALL) {
            *row = moment.after.header(*process).decided;
        }
        let status = &moment.after.t3i.status;
        let tool = status.frame_feedback.tool.map(|hundredths| f64::from(hundredths) / 100.0);
        let (tick, command) = (moment.tick.0, moment.after.task.status.echo);
        self.marks.push(Mark { tick, command, rows, tool, sent: moment.after.device_outputs().link_tx });
    }

    /// The trace of a log.
    ///
    /// # Errors
    /// [`Error::Read`] if a tick cannot be read.
    pub fn of_log(log: &Log, path: &Path) -> Result<Self, Error> {
        let mut trace = Self::default();
        walk(log, path, |moment| {
            trace.note(moment);
            true
        })?;
        trace.ended(log);
        Ok(trace)
    }

    /// All ticks of a log have been taken in.
    pub fn ended(&mut self, log: &Log) {
        self.end = End::of_log(log, self.marks.last().map_or(0, |mark| mark.tick));
    }

    /// What each tick belongs together with.
    pub fn keys(&self, align: Align) -> impl Iterator<Item = Key> {
        let (mut command, mut since) = (0, 0);
        self.marks.iter().map(move |mark| match align {
            Align::Tick => (0, mark.tick),
            Align::Command => {
                if mark.command != command {
                    (command, since) = (mark.command, mark.tick);
                }
                (command, mark.tick - since)
            }
        })
    }

    /// The rows of a process in the order in which they fired, each with its first tick.
    pub fn decisions(&self, process: usize) -> Vec<(u64, Option<Decided>)> {
        let mut decisions: Vec<(u64, Option<Decided>)> = Vec::new();
        for mark in &self.marks {
            let row = mark.rows.get(process).copied().flatten();
            if decisions.last().is_none_or(|(_, last)| *last != row) {
                decisions.push((mark.tick, row));
            }
        }
        decisions
    }
}
