use std::path::Path;

use interfaces::{Decided, device::LinkBytes};
use levels::ladder::{PROCESS_COUNT, ProcessId};
use record::Log;

use super::{Align, End};
use crate::{
    Error,
    story::{CommandHistory, Moment, walk},
};

/// Identifies ticks that are compared with each other: command number, and ticks since the command began.
pub type Key = (u32, u64);

#[derive(Clone, Debug)]
pub struct Mark {
    pub tick: u64,
    command: u32, // number of the command that Task has taken
    pub rows: [Option<Decided>; PROCESS_COUNT],
    pub tool: [f64; 3], // commanded tool point, inches, world
    pub sent: LinkBytes,
}

#[derive(Default)]
pub struct Trace {
    pub marks: Vec<Mark>,
    pub command_history: CommandHistory,
    pub end: End,
}

impl Trace {
    pub fn note(&mut self, moment: &Moment) {
        self.command_history.note(moment);
        let mut rows = [None; PROCESS_COUNT];
        for (row, process) in rows.iter_mut().zip(ProcessId::ALL) {
            *row = moment.after.header(*process).decided;
        }
        let status = &moment.after.t3i.status;
        let tool = status.frame_feedback.tool.map(|hundredths| f64::from(hundredths) / 100.0);
        let (tick, command) = (moment.tick.0, moment.after.task.status.echo);
        self.marks.push(Mark { tick, command, rows, tool, sent: moment.after.device_outputs().link_tx });
    }

    pub fn of_log(log: &Log, path: &Path) -> Result<Self, Error> {
        let mut trace = Self::default();
        walk(log, path, |moment| {
            trace.note(moment);
            true
        })?;
        trace.ended(log);
        Ok(trace)
    }

    pub fn ended(&mut self, log: &Log) {
        self.end = End::of_log(log, self.marks.last().map_or(0, |mark| mark.tick));
    }

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

    /// The rows of a process in the order of firing, each with the first tick of its firing.
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
