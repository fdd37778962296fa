//! A single branch, row by row, for the analysis of the control processes.

use std::fmt::Write as _;

use closed_loop::failure;
use interfaces::Decided;
use levels::ladder::{Ladder, ProcessId};
use rcs_core::tick::Tick;

use super::{branch::Branch, trial::Observer, verdict::BranchResult};

#[derive(Clone, Debug, Default, PartialEq)]
struct StatusLine {
    command: String,
    report: &'static str,
    decided: Option<Decided>,
    step: String,
    why: &'static str,
}

/// Prints the branch: every change of command, status and step, and every fired row near the interruption.
pub struct Story {
    text: String,
    at: u64,
    around: u64,
    last: Vec<StatusLine>,
}

impl Story {
    #[must_use]
    pub fn new(at: u64, around: u64) -> Self {
        Self { text: String::new(), at, around, last: Vec::new() }
    }

    #[must_use]
    pub fn told(mut self, result: &BranchResult) -> String {
        let BranchResult { at, interruption, verdict, detail, line, until, .. } = result;
        let mut head = format!("{interruption} after tick {at}, in `{line}`\n");
        for doing in &result.doing {
            let _ = writeln!(head, "    {doing}");
        }
        let _ = writeln!(
            self.text,
            "\n{verdict:?} at tick {until}{}{detail}",
            if detail.is_empty() { "" } else { ": " }
        );
        for ended in &result.ended {
            let _ = writeln!(self.text, "    {ended}");
        }
        head + "\n" + &self.text
    }

    fn said(branch: &Branch<'_>) -> Vec<StatusLine> {
        let (hws, memory) = (&branch.closed.external().hws, branch.memory());
        let said = |process: &ProcessId| {
            let (header, said) = (memory.header(*process), memory.said(*process));
            StatusLine {
                command: failure::command(*process, hws, memory),
                report: said.report,
                decided: header.decided,
                step: header.step.unwrap_or_default().to_string(),
                why: said.fault.text(),
            }
        };
        ProcessId::ALL.iter().map(said).collect()
    }
}

impl Observer for Story {
    fn tick(&mut self, branch: &Branch<'_>) {
        let tick = branch.at().0;
        let near = tick <= self.at + self.around;
        let now = Self::said(branch);
        let first = self.last.is_empty();
        for (at, (said, process)) in now.iter().zip(Ladder::processes()).enumerate() {
            let before = self.last.get(at).cloned().unwrap_or_default();
            let row = before.decided != said.decided;
            let rest = StatusLine { decided: said.decided, ..before.clone() } != *said;
            let idle = said.command.is_empty();
            if !(rest || row && near) || first && idle {
                continue;
            }
            let number = said.decided.map_or(0, |decided| decided.row);
            let table = said.decided.and_then(|decided| process.table(decided.table));
            let text =
                table.and_then(|table| table.row(number)).map_or_else(String::new, |row| row.to_string());
            let name = table.map_or("no table", |table| table.name);
            let why = if said.why.is_empty() { String::new() } else { format!(" [{}]", said.why) };
            let _ = writeln!(
                self.text,
                "{tick:>6} {:<15} {:<44} {:<10}{why} {name} row {}{}{}: {text}",
                process.name,
                said.command,
                said.report,
                number,
                if said.step.is_empty() { "" } else { ", " },
                said.step
            );
        }
        for event in &branch.events {
            let _ = writeln!(self.text, "{tick:>6} cell: {event}");
        }
        self.last = now;
    }

    fn say(&mut self, tick: Tick, text: &str) {
        let _ = writeln!(self.text, "{:>6} -- {text}", tick.0);
    }
}
