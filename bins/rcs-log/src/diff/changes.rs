//! What a person asks first of two runs: which rows decided otherwise, where the robot went another way, what
//! took another time.

use std::fmt;

use interfaces::{Decided, device::LinkBytes};
use levels::ladder::{Ladder, PROCESS_COUNT, ProcessId};
use rcs_core::tick::TICK_S;
use record::remarks::row_text;
use serde::Serialize;

use crate::story::{Chronicle, CommandStory, Moment};

/// What of a tick is compared.
pub struct Tally {
    rows: [Option<Decided>; PROCESS_COUNT],
    /// Where the robot was commanded to, world, in.
    tool: [f64; 3],
    /// Bytes that went out on the link.
    sent: LinkBytes,
}

impl Tally {
    /// What of a tick is compared.
    #[must_use]
    pub fn of(moment: &Moment) -> Self {
        let mut rows = [None; PROCESS_COUNT];
        for (row, process) in rows.iter_mut().zip(ProcessId::ALL) {
            *row = moment.after.header(*process).decided;
        }
        let tool =
            moment.after.t3i.status.frame_feedback.tool.map(|hundredths| f64::from(hundredths) / 100.0);
        Self { rows, tool, sent: moment.after.device_outputs().link_tx }
    }
}

/// Rows of a process that decided otherwise.
#[derive(Debug, Serialize)]
struct Rows {
    process: String,
    /// Ticks in which another row is in the header.
    ticks: u64,
    /// The first of them, and the rows of both runs in it.
    first: [u64; 2],
    a: String,
    b: String,
}

/// The robot was commanded elsewhere.
#[derive(Debug, Serialize)]
struct Motion {
    /// Ticks in which it was.
    ticks: u64,
    /// The first of them.
    first: [u64; 2],
    /// How far apart at the most, in, and when.
    greatest_in: f64,
    at: [u64; 2],
}

/// A command that took another time, or ended otherwise.
#[derive(Debug, Serialize)]
struct Time {
    command: String,
    a: String,
    b: String,
}

/// How two runs differ, in terms of commands, rows and motions.
#[derive(Debug, Default, Serialize)]
pub struct Changes {
    rows: Vec<Rows>,
    motion: Option<Motion>,
    /// The first tick with other bytes on the link, and how many there are.
    link: Option<([u64; 2], u64)>,
    times: Vec<Time>,
}

impl Changes {
    /// Take in a tick that both runs have.
    pub fn note(&mut self, ticks: [u64; 2], a: &Tally, b: &Tally) {
        for (process, (was, is)) in ProcessId::ALL.iter().zip(a.rows.into_iter().zip(b.rows)) {
            if was != is {
                self.row(ticks, *process, was, is);
            }
        }
        let apart = a.tool.iter().zip(b.tool).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if apart > 0.0 {
            let motion = Motion { ticks: 0, first: ticks, greatest_in: 0.0, at: ticks };
            let motion = self.motion.get_or_insert(motion);
            motion.ticks += 1;
            if apart > motion.greatest_in {
                (motion.greatest_in, motion.at) = (apart, ticks);
            }
        }
        if a.sent != b.sent {
            self.link.get_or_insert((ticks, 0)).1 += 1;
        }
    }

    fn row(&mut self, ticks: [u64; 2], process: ProcessId, a: Option<Decided>, b: Option<Decided>) {
        let info = &Ladder::processes()[process.position()];
        if let Some(known) = self.rows.iter_mut().find(|rows| rows.process == info.name) {
            known.ticks += 1;
            return;
        }
        let text = |decided: Option<Decided>| {
            let row = decided.and_then(|decided| info.row(decided));
            row.map_or_else(|| "no row".to_owned(), |(table, row)| row_text(table, row))
        };
        let process = info.name.to_owned();
        self.rows.push(Rows { process, ticks: 1, first: ticks, a: text(a), b: text(b) });
    }

    /// Compare how long each command took, and how it ended.
    pub fn compare_times(&mut self, [a, b]: &[Chronicle; 2]) {
        let said = |command: Option<&CommandStory>| {
            command.map_or_else(
                || "not commanded".to_owned(),
                |command| {
                    let ticks = command.last_tick - command.first_tick;
                    format!("{} after {ticks} ticks ({:.2} s)", command.status, ticks as f64 * TICK_S)
                },
            )
        };
        for at in 0..a.commands.len().max(b.commands.len()) {
            let (of_a, of_b) = (a.commands.get(at), b.commands.get(at));
            let (a, b) = (said(of_a), said(of_b));
            if a != b {
                let command = of_a.or(of_b).map_or_else(String::new, |command| command.text.clone());
                self.times.push(Time { command, a, b });
            }
        }
    }
}

/// A tick of both runs.
fn both([a, b]: [u64; 2]) -> String {
    if a == b { format!("tick {a}") } else { format!("ticks {a} and {b}") }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Rows { process, ticks, first, a, b } in &self.rows {
            writeln!(f, "row        {process}, {ticks} ticks, first in {}:", both(*first))?;
            writeln!(f, "             {a}\n             {b}")?;
        }
        if let Some(Motion { ticks, first, greatest_in, at }) = &self.motion {
            let (first, at) = (both(*first), both(*at));
            writeln!(
                f,
                "motion     {ticks} ticks, first in {first}; {greatest_in:.2} in apart at most, in {at}"
            )?;
        }
        if let Some((first, ticks)) = &self.link {
            writeln!(f, "link       other bytes in {ticks} ticks, first in {}", both(*first))?;
        }
        for Time { command, a, b } in &self.times {
            writeln!(f, "time       {command}: {a}; {b}")?;
        }
        Ok(())
    }
}
