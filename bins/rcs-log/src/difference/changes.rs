//! Rows that decided differently, motions to other points, and commands with other durations.

use std::{collections::HashMap, fmt};

use interfaces::Decided;
use levels::ladder::{Ladder, PROCESS_COUNT, ProcessId};
use os_io::text::amount;
use rcs_core::{table::Fired, tick::TICK_S};
use serde::Serialize;

use super::{
    Align,
    trace::{Key, Mark, Trace},
};
use crate::story::{CommandHistory, CommandStory};

/// A process in which other rows fired, or the same rows at other times.
#[derive(Debug, Serialize)]
struct Rows {
    process: String,
    ticks: u64,       // number of compared ticks whose headers name different rows
    same_order: bool, // true if the same rows fired in the same order, at other times
    /// Tick in each run where the order of the rows first differs, or else their times. `a` and `b` are the rows.
    first: [u64; 2],
    a: String,
    b: String,
}

#[derive(Debug, Serialize)]
struct Motion {
    ticks: u64,       // number of ticks in which they differ
    first: [u64; 2],  // first of these ticks, in both runs
    greatest_in: f64, // greatest distance between the points, in; `at` is its tick in both runs
    at: [u64; 2],
}

#[derive(Debug, Serialize)]
struct Time {
    command: String,
    a: String,
    b: String,
}

#[derive(Debug, Default, Serialize)]
pub struct Changes {
    rows: Vec<Rows>,
    motion: Option<Motion>,
    /// First tick, in both runs, with different bytes on the link, and the number of such ticks.
    link: Option<([u64; 2], u64)>,
    times: Vec<Time>,
}

/// Ticks in which the headers of a process name different rows: their number, the first tick, and its rows.
type Others = Option<(u64, [u64; 2], [Option<Decided>; 2])>;

impl Changes {
    #[must_use]
    pub fn between(a: &Trace, b: &Trace, align: Align) -> Self {
        let of_b: HashMap<Key, &Mark> = b.keys(align).zip(&b.marks).collect();
        let mut changes = Self::default();
        let mut others: [Others; PROCESS_COUNT] = [None; PROCESS_COUNT];
        for (key, was) in a.keys(align).zip(&a.marks) {
            let Some(is) = of_b.get(&key) else { continue };
            let ticks = [was.tick, is.tick];
            for (other, (row, another)) in others.iter_mut().zip(was.rows.iter().zip(&is.rows)) {
                if row != another {
                    other.get_or_insert((0, ticks, [*row, *another])).0 += 1;
                }
            }
            changes.motion(ticks, was, is);
            if was.sent != is.sent {
                changes.link.get_or_insert((ticks, 0)).1 += 1;
            }
        }
        for (process, other) in others.into_iter().enumerate() {
            changes.rows.extend(rows(process, other, a, b));
        }
        changes.rows.sort_by_key(|rows| (rows.first[0].min(rows.first[1]), rows.same_order));
        changes.times(&a.command_history, &b.command_history);
        changes
    }

    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.motion.is_none() && self.link.is_none() && self.times.is_empty()
    }

    #[must_use]
    pub fn deciding(&self) -> (usize, usize) {
        let late = self.rows.iter().filter(|rows| rows.same_order).count();
        (self.rows.len() - late, late)
    }

    /// Greatest distance between the commanded points, in.
    #[must_use]
    pub fn apart(&self) -> f64 {
        self.motion.as_ref().map_or(0.0, |motion| motion.greatest_in)
    }

    fn motion(&mut self, ticks: [u64; 2], a: &Mark, b: &Mark) {
        let apart = a.tool.iter().zip(b.tool).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if apart > 0.0 {
            let motion = Motion { ticks: 0, first: ticks, greatest_in: 0.0, at: ticks };
            let motion = self.motion.get_or_insert(motion);
            motion.ticks += 1;
            if apart > motion.greatest_in {
                (motion.greatest_in, motion.at) = (apart, ticks);
            }
        }
    }

    fn times(&mut self, a: &CommandHistory, b: &CommandHistory) {
        let said = |command: Option<&CommandStory>| {
            command.map_or_else(
                || "not commanded".to_owned(),
                |command| {
                    let ticks = command.last_tick - command.first_tick;
                    let (status, remark) = (&command.status, command.remark());
                    format!(
                        "{status} after {} ({:.2} s){remark}",
                        amount(ticks, "tick"),
                        ticks as f64 * TICK_S
                    )
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

/// Differences in the rows of the process at a position; `others` are the ticks with another row.
fn rows(process: usize, others: Others, a: &Trace, b: &Trace) -> Option<Rows> {
    let (was, is) = (a.decisions(process), b.decisions(process));
    let parted = was.iter().zip(&is).position(|((_, was), (_, is))| was != is);
    // A longer run has additional decisions.
    let parted = parted.or((was.len() != is.len()).then_some(was.len().min(is.len())));
    let (first, decided) = match (parted, others) {
        (None, None) => return None,
        (None, Some((_, first, decided))) => (first, decided),
        (Some(at), _) => {
            let of = |decisions: &[(u64, Option<Decided>)]| {
                decisions.get(at).or(decisions.last()).copied().unwrap_or_default()
            };
            let ((tick_a, row_a), (tick_b, row_b)) = (of(&was), of(&is));
            ([tick_a, tick_b], [row_a, row_b])
        }
    };
    let info = &Ladder::processes()[ProcessId::ALL[process].position()];
    let [a, b] = decided.map(|decided| {
        let row = decided.and_then(|decided| info.row(decided));
        let text = |(table, row)| Fired { table, row, values: None }.to_string();
        row.map_or_else(|| "no row".to_owned(), text)
    });
    let ticks = others.map_or(0, |(ticks, ..)| ticks);
    Some(Rows { process: info.name.to_owned(), ticks, same_order: parted.is_none(), first, a, b })
}

fn both([a, b]: [u64; 2]) -> String {
    if a == b { format!("tick {a}") } else { format!("ticks {a} and {b}") }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Rows { process, ticks, same_order, first, a, b } in &self.rows {
            if *same_order {
                let (first, ticks) = (both(*first), amount(*ticks, "tick"));
                writeln!(f, "row        {process}: the same rows, {ticks} at other times, first in {first}")?;
            } else {
                writeln!(f, "row        {process} decides otherwise, first in {}:", both(*first))?;
                writeln!(f, "             {a}\n             {b}")?;
            }
        }
        if let Some(Motion { ticks, first, greatest_in, at }) = &self.motion {
            let (first, at, ticks) = (both(*first), both(*at), amount(*ticks, "tick"));
            writeln!(f, "motion     {ticks}, first in {first}; {greatest_in:.2} in apart at most, in {at}")?;
        }
        if let Some((first, ticks)) = &self.link {
            let (first, ticks) = (both(*first), amount(*ticks, "tick"));
            writeln!(f, "link       other bytes in {ticks}, first in {first}")?;
        }
        for Time { command, a, b } in &self.times {
            writeln!(f, "time       {command}: {a}; {b}")?;
        }
        Ok(())
    }
}
