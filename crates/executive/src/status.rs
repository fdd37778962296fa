//! Summary of a run, printed by monitors and mirrored ([`crate::memory::Mirror`]).

use std::fmt;

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{Ladder, ProcessId};
use os_io::text::amount;
use rcs_core::tick::TICK_S;
use serde::Serialize;

use crate::memory::layout::Pulse;
use closed_loop::failure::command;

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ProcessStatus {
    /// The manual's name.
    pub process: &'static str,
    pub command: String, // empty for none
    pub status: &'static str,
    /// What no sensor confirms about its finished command; empty if the sensors confirm the goal.
    pub unconfirmed: &'static str,
    pub table: Option<&'static str>,
    /// The row that fired; `None` if none has fired yet.
    pub row: Option<u8>,
    pub step: String,    // of its command after that row; may be empty
    pub suspended: bool, // not stepped: dormant or held
    pub elsewhere: bool, // runs in another system
    pub lost: bool,      // has not written in this tick
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    pub run: String,
    /// The announced state of the run, as a phrase after its name; `None` if it runs, or if its state is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    pub tick: u64, // the last one
    pub simulated_s: f64,
    pub skipped: u64,       // slots of the 40 ms grid
    pub allocations: u64,   // of the controller since the start
    pub controller_us: f64, // time that the controller took for the tick, microseconds
    pub over: bool,         // the run is over
    /// Fault of the line to the robot, if any.
    pub link: Option<&'static str>,
    pub processes: Vec<ProcessStatus>,
}

impl Status {
    #[must_use]
    pub fn of(run: &str, external: &ExternalInputs, memory: &CommonMemory, pulse: &Pulse) -> Self {
        let processes = ProcessId::ALL.iter().zip(Ladder::processes()).map(|(&id, info)| {
            let header = memory.header(id);
            ProcessStatus {
                process: info.name,
                command: command(id, &external.hws, memory),
                status: memory.said(id).report,
                unconfirmed: memory.said(id).unconfirmed.text(),
                table: header.decided.and_then(|decided| info.table(decided.table)).map(|table| table.name),
                row: header.decided.map(|decided| decided.row),
                step: header.step.unwrap_or_default().to_string(),
                suspended: header.republished,
                elsewhere: of_pedestal(id) && external.pedestal.elsewhere,
                lost: header.stamp != pulse.tick,
            }
        });
        Self {
            run: run.to_owned(),
            phase: None,
            tick: pulse.tick.0,
            simulated_s: pulse.tick.0 as f64 * TICK_S,
            skipped: pulse.skipped,
            allocations: pulse.allocations,
            controller_us: pulse.controller_ns as f64 / 1000.0,
            over: pulse.over,
            link: memory.t3i.status.trouble(),
            processes: processes.collect(),
        }
    }
}

const fn of_pedestal(process: ProcessId) -> bool {
    matches!(process, ProcessId::Pedestal | ProcessId::Hand | ProcessId::RotaryTable)
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: tick {} ({:.1} s){}, {} skipped, {}, controller {:.1} us",
            self.run,
            self.tick,
            self.simulated_s,
            if self.over { ", over" } else { "" },
            amount(self.skipped, "slot"),
            amount(self.allocations, "allocation"),
            self.controller_us
        )?;
        if let Some(phase) = &self.phase {
            writeln!(f, "  {} {phase}", self.run)?;
        }
        if let Some(link) = self.link {
            writeln!(f, "  {link}")?;
        }
        for process in &self.processes {
            let mut row = match (process.table, process.row) {
                (Some(table), Some(row)) => format!("{table} row {row}"),
                _ => String::new(),
            };
            if !process.step.is_empty() {
                row += &format!(", {}", process.step);
            }
            if !process.unconfirmed.is_empty() {
                row += &format!(", unconfirmed: {}", process.unconfirmed);
            }
            let suspended = if process.suspended { " (suspended)" } else { "" };
            let elsewhere = match (process.elsewhere, process.lost) {
                (true, true) => " (another system, which does not answer)",
                (true, false) => " (another system)",
                (false, true) => " (lost)",
                (false, false) => "",
            };
            writeln!(
                f,
                "  {:<15} {:<14} {:<36} {}{suspended}{elsewhere}",
                process.process, process.status, row, process.command
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Decided, emove::EmoveVerb, grip::GripReport};
    use rcs_core::{name::Name16, tick::Tick};

    #[test]
    fn status_describes_every_process() {
        let (mut external, mut memory) = (ExternalInputs::default(), CommonMemory::default());
        external.hws.command = Name16::clipped("PAUSE");
        memory.subtask.emove.command = EmoveVerb::Pause;
        memory.grip.status.report = GripReport::ALL[1];
        (memory.grip.header.stamp, memory.grip.header.republished) = (Tick(50), true);
        external.pedestal.elsewhere = true;
        memory.hand.header.stamp = Tick(50);
        memory.task.header.decided = Some(Decided { table: 1, row: 2 });
        memory.task.header.step = Some(Name16::clipped("moving"));
        let pulse = Pulse { tick: Tick(50), skipped: 3, controller_ns: 2500, ..Pulse::default() };
        let status = Status::of("linkbar-1", &external, &memory, &pulse);
        assert_eq!((status.tick, status.skipped, status.processes.len()), (50, 3, ProcessId::ALL.len()));
        let [task, _, emove, ..] = &status.processes[..] else { panic!("{status}") };
        assert_eq!((task.command.as_str(), emove.command.as_str()), ("PAUSE", "E-PAUSE"));
        assert_eq!(
            (task.table, task.row),
            (Ladder::processes()[0].table(1).map(|table| table.name), Some(2))
        );
        assert_eq!(task.step, "moving");
        let grip = &status.processes[6];
        assert_eq!((grip.status, grip.suspended, grip.table), (GripReport::ALL[1].text(), true, None));
        let text = status.to_string();
        assert!(text.starts_with("linkbar-1: tick 50 (2.0 s), 3 slots skipped, 0 allocations"), "{text}");
        let ends = |process: &str, end: &str| {
            text.lines().any(|l| l.contains(process) && l.trim_end().ends_with(end))
        };
        assert!(text.contains(" row 2, moving "), "{text}");
        assert!(ends("Grip", "(suspended)"), "{text}");
        assert!(ends("Pedestal Hand", "(another system)"), "{text}");
        assert!(ends("Rotary Table", "(another system, which does not answer)"), "{text}");
        assert!(ends("V-Grip", "(lost)"), "{text}");
    }
}
