//! The history of every process in a run: changes of its commands, rows and reports.

use interfaces::{CommonMemory, Decided, ExternalInputs, Header};
use levels::ladder::{PROCESS_COUNT, ProcessId, ProcessInfo};
use rcs_core::{
    name::Name16,
    table::{self, Condition, Row, Values},
    tick::Tick,
};

use crate::failure;

/// Names and tables of all processes, in the order of common memory.
pub type Processes = &'static [ProcessInfo; PROCESS_COUNT];

/// Number of entries that are kept of each kind, so that the history of an endless run does not grow.
const KEPT: usize = 4096;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Commanded {
    pub tick: u64, // Task reads it in the same tick, other receivers one tick later
    pub number: u32,
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fired {
    pub tick: u64,
    pub decided: Option<Decided>, // table and row; `None` if no row of a table fired
    pub values: Option<Values>,   // the values for which it first fired
    pub step: Option<Name16>,     // step of the command after the row
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported {
    pub tick: u64,
    pub report: &'static str, // the report as text: `executing`, `done`, `not-detected` ..
    pub reason: &'static str, // the reason of a failed command; empty otherwise
}

pub struct History {
    processes: Processes,
    /// Id of the end effector of Prim's commands, with the tick from which it is valid.
    grippers: Vec<(u64, Option<u8>)>,
    commands: [Vec<Commanded>; PROCESS_COUNT],
    rows: [Vec<Fired>; PROCESS_COUNT],
    reports: [Vec<Reported>; PROCESS_COUNT],
}

impl History {
    /// An empty history. `processes` are those that made the decisions: of this program, or of the log.
    #[must_use]
    pub fn new(processes: Processes) -> Self {
        Self {
            processes,
            grippers: Vec::new(),
            commands: Default::default(),
            rows: Default::default(),
            reports: Default::default(),
        }
    }

    /// Records a tick: its external inputs, and common memory after it.
    pub fn note(&mut self, tick: Tick, external: &ExternalInputs, memory: &CommonMemory) {
        let tick = tick.0;
        let gripper = memory.emove.prim.end_effector_id;
        if self.grippers.last().is_none_or(|(_, last)| *last != gripper) {
            keep(&mut self.grippers, (tick, gripper));
        }
        for process in ProcessId::ALL.iter().copied() {
            let at = process.position();
            let Header { decided, step, basis, .. } = *memory.header(process);
            let rows = &mut self.rows[at];
            if rows.last().is_none_or(|last| (last.decided, last.step) != (decided, step)) {
                keep(rows, Fired { tick, decided, values: basis.map(|basis| basis.values), step });
            }
            let said = memory.said(process);
            let (report, reason) = (said.report, said.fault.text());
            let reports = &mut self.reports[at];
            if reports.last().is_none_or(|last| (last.report, last.reason) != (report, reason)) {
                keep(reports, Reported { tick, report, reason });
            }
            let number = memory.command_number(process).unwrap_or(external.hws.number);
            let commands = &mut self.commands[at];
            if number != commands.last().map_or(0, |last| last.number) {
                let text = failure::command(process, &external.hws, memory);
                keep(commands, Commanded { tick, number, text });
            }
        }
    }

    pub fn command(&self, process: ProcessId, tick: u64) -> Option<&Commanded> {
        // Except for Task, processes read commands that were written one tick earlier.
        let written = if process == ProcessId::Task { tick } else { tick.saturating_sub(1) };
        latest(&self.commands[process.position()], written, |command| command.tick)
    }

    pub fn row(&self, process: ProcessId, tick: u64) -> Option<&Fired> {
        latest(&self.rows[process.position()], tick, |fired| fired.tick)
    }

    pub fn report(&self, process: ProcessId, tick: u64) -> Option<&Reported> {
        latest(&self.reports[process.position()], tick, |report| report.tick)
    }

    /// Id of the end effector of Prim's command that was read in a tick.
    pub(super) fn gripper(&self, tick: u64) -> Option<u8> {
        latest(&self.grippers, tick.saturating_sub(1), |(from, _)| *from)?.1
    }

    #[must_use]
    pub fn info(&self, process: ProcessId) -> &'static ProcessInfo {
        &self.processes[process.position()]
    }

    pub(super) fn row_of(&self, process: ProcessId, fired: &Fired) -> Option<table::Fired> {
        let (table, row) = self.info(process).row(fired.decided?)?;
        Some(table::Fired { table, row, values: fired.values })
    }

    /// A row as text: `table QC-DETACH row 3: Unlock, then Unlocking, because step is Lowering, lock is Locked`.
    pub(super) fn row_words(&self, process: ProcessId, fired: &Fired) -> String {
        match self.row_of(process, fired) {
            None => "by no row of a table".to_owned(),
            Some(row) => {
                let effect = effect(row.row, fired.step.unwrap_or_default().as_str());
                let because = because(&conditions(&row));
                format!("table {} row {}: {effect}, {because}", row.table.name, row.row.number)
            }
        }
    }
}

/// Adds an entry. At twice the number of entries to keep, the older half is removed.
fn keep<T>(entries: &mut Vec<T>, entry: T) {
    if entries.len() >= 2 * KEPT {
        entries.drain(..KEPT);
    }
    entries.push(entry);
}

fn latest<T>(entries: &[T], tick: u64, tick_of: impl Fn(&T) -> u64) -> Option<&T> {
    let end = entries.partition_point(|entry| tick_of(entry) <= tick);
    entries.get(end.checked_sub(1)?)
}

/// The values for which a row fired, as text: `step is Start`, `gripper is None`.
pub fn conditions(fired: &table::Fired) -> Vec<String> {
    let steps = fired.steps();
    let step = (!steps.is_empty()).then(|| format!("step is {}", steps.join(" or ")));
    step.into_iter().chain(fired.conditions().map(|asked| condition(&asked))).collect()
}

pub fn condition(asked: &Condition) -> String {
    format!("{} is {}", asked.variable, asked.values.join(" or "))
}

/// Action and next step of a row: `GraspObj, then Grasping`, or for a row of any step `Wait in step moving`.
pub fn effect(row: &Row, step: &str) -> String {
    let at = if row.steps.is_empty() && row.next.is_none() && !step.is_empty() {
        format!(" in step {step}")
    } else {
        String::new()
    };
    let next = row.next.map_or_else(String::new, |next| format!(", then {next}"));
    format!("{}{at}{next}", row.call())
}

/// The conditions as a reason: `because step is Start, gripper is None`.
pub fn because(conditions: &[String]) -> String {
    match conditions {
        [] => "in any state".to_owned(),
        conditions => format!("because {}", conditions.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use levels::execution::{Buffer, EXECUTE, Outcome};
    use rcs_core::{handshake::Arrival, table::Variables as _};

    #[test]
    fn the_latest_entry_counts() {
        let entries = [3, 7, 9];
        let at = |tick| latest(&entries, tick, |entry| *entry).copied();
        assert_eq!([at(2), at(3), at(8), at(100)], [None, Some(3), Some(7), Some(9)]);
    }

    #[test]
    fn long_history_keeps_its_end() {
        let mut entries = Vec::new();
        (0..3 * KEPT).for_each(|entry| keep(&mut entries, entry));
        assert!((KEPT..=2 * KEPT).contains(&entries.len()), "{}", entries.len());
        assert_eq!(entries.last(), Some(&(3 * KEPT - 1)));
    }

    #[test]
    fn row_is_reported_with_its_step() {
        let any = Row {
            number: 1,
            steps: &[],
            when: &[Condition { variable: "work", values: &["Busy", "Lost"] }],
            action: "Wait",
            argument: None,
            next: None,
        };
        assert_eq!(effect(&any, "letting-go"), "Wait in step letting-go");
        assert_eq!(effect(&any, ""), "Wait");
        let one = Row {
            number: 2,
            steps: &["Start"],
            when: &[],
            action: "MovToHol",
            argument: Some("Own"),
            next: Some("Stowing"),
        };
        assert_eq!(effect(&one, "stowing"), "MovToHol(Own), then Stowing");
    }

    #[test]
    fn reason_names_the_values_of_the_fired_row() {
        let of_row = |number: u8, values: Option<Values>| {
            let row = EXECUTE.row(number).unwrap();
            because(&conditions(&table::Fired { table: &EXECUTE, row, values }))
        };
        let values =
            Values { step: Outcome::Done.code(), variables: Buffer { arrival: Arrival::Same }.code() };
        assert_eq!(of_row(5, Some(values)), "because step is Done, arrival is Same");
        assert_eq!(of_row(5, None), "because step is Idle or Done or Error or Joystick, arrival is Same");
        assert_eq!(because(&[]), "in any state");
    }
}
