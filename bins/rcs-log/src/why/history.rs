//! What every process did over a whole run, kept by change: its commands, rows and reports. And the wiring of the ladder:
//! who commands whom, and who looks at which devices.

use executive::failure::{self, PROCESSES};
use levels::ladder::{Ladder, ProcessInfo};
use rcs_core::{
    interface::{CommonMemory, ExternalInputs, Header},
    name::Name16,
    table::{Condition, Row, Table},
};

use crate::story::Moment;

/// Position of Prim among the processes.
pub const PRIM: usize = 3;
/// Position of the T3 Interface.
pub const T3I: usize = 4;

/// What surrounds a process.
pub struct Wiring {
    /// Who commands it; none for Task, which the workstation controller commands.
    pub commander: Option<usize>,
    /// Whose statuses it reads.
    pub below: &'static [usize],
    /// Inputs that it looks at: beginnings of their names in `ExternalInputs`.
    pub devices: &'static [&'static str],
}

/// The wiring of all processes, in the order of common memory (docs/design/ownership.md "Commands", III.1).
pub const WIRING: [Wiring; PROCESSES] = [
    Wiring { commander: None, below: &[1], devices: &["data_base"] },
    Wiring { commander: Some(0), below: &[2, 9], devices: &["devices.quick_change", "pedestal.answers"] },
    Wiring {
        commander: Some(1),
        below: &[3, 5, 6, 7, 8],
        devices: &["devices.vision", "devices.holsters", "devices.quick_change", "devices.grip.beams"],
    },
    Wiring {
        commander: Some(2),
        below: &[4],
        devices: &["devices.force.valid", "devices.holsters", "devices.grip.beams", "devices.joystick"],
    },
    Wiring {
        commander: Some(3),
        below: &[],
        devices: &[
            "devices.link_ready",
            "devices.link_rx.length",
            "devices.link_unsent",
            "devices.resolvers.valid",
        ],
    },
    Wiring { commander: Some(2), below: &[], devices: &["devices.quick_change", "devices.holsters"] },
    Wiring { commander: Some(2), below: &[], devices: &["devices.grip"] },
    Wiring { commander: Some(2), below: &[], devices: &["devices.grip", "devices.quick_change"] },
    Wiring { commander: Some(2), below: &[], devices: &["devices.grip", "devices.quick_change"] },
    Wiring { commander: Some(1), below: &[10, 11], devices: &["devices.pedestal"] },
    Wiring {
        commander: Some(9),
        below: &[],
        devices: &[
            "devices.pedestal.potentiometer",
            "devices.pedestal.strain_left",
            "devices.pedestal.strain_right",
        ],
    },
    Wiring {
        commander: Some(9),
        below: &[],
        devices: &[
            "devices.pedestal.table_potentiometer",
            "devices.pedestal.limit_plus",
            "devices.pedestal.limit_minus",
            "devices.pedestal.motor_moving",
            "devices.pedestal.motor_counter",
        ],
    },
];

/// A command from the tick on in which it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// The tick; the receiver sees it in the next one, Task in this one.
    pub tick: u64,
    /// Its number.
    pub number: u32,
    /// As people write it.
    pub text: String,
}

/// A row from the tick on in which it fired first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fired {
    /// The tick.
    pub tick: u64,
    /// Number of the table in its process.
    pub table: u8,
    /// The row; 0 for none.
    pub row: u8,
    /// Step of the command after it; empty for none.
    pub step: Name16,
}

/// A report from the tick on in which it was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// The tick.
    pub tick: u64,
    /// `executing`, `done`, `not-detected` ...
    pub report: &'static str,
    /// Why it failed; empty if it did not.
    pub reason: &'static str,
}

/// The history of a run.
#[derive(Default)]
pub struct History {
    commands: [Vec<Command>; PROCESSES],
    rows: [Vec<Fired>; PROCESSES],
    reports: [Vec<Report>; PROCESSES],
}

impl History {
    /// Take a tick in.
    pub fn note(&mut self, moment: &Moment) {
        let tick = moment.tick.0;
        let (headers, reports) = (failure::headers(&moment.after), reports(&moment.after));
        let numbers = numbers(&moment.external, &moment.after);
        for process in 0..PROCESSES {
            let Header { table, row, step, .. } = headers[process];
            let rows = &mut self.rows[process];
            if rows.last().is_none_or(|last| (last.table, last.row, last.step) != (table, row, step)) {
                rows.push(Fired { tick, table, row, step });
            }
            let (report, reason) = reports[process];
            let said = &mut self.reports[process];
            if said.last().is_none_or(|last| (last.report, last.reason) != (report, reason)) {
                said.push(Report { tick, report, reason });
            }
            let (number, commands) = (numbers[process], &mut self.commands[process]);
            if number != commands.last().map_or(0, |last| last.number) {
                let text = failure::command(process, &moment.external.hws, &moment.after);
                commands.push(Command { tick, number, text });
            }
        }
    }

    /// The command that a process had in a tick.
    pub fn command(&self, process: usize, tick: u64) -> Option<&Command> {
        // Everybody but Task reads what was written a tick before.
        let written = if process == 0 { tick } else { tick.saturating_sub(1) };
        latest(&self.commands[process], written, |command| command.tick)
    }

    /// The row that fired in a process in a tick, and since when it did.
    pub fn row(&self, process: usize, tick: u64) -> Option<&Fired> {
        latest(&self.rows[process], tick, |fired| fired.tick)
    }

    /// What a process reported in a tick, and since when.
    pub fn report(&self, process: usize, tick: u64) -> Option<&Report> {
        latest(&self.reports[process], tick, |report| report.tick)
    }
}

/// The last entry that is not later than a tick.
fn latest<T>(entries: &[T], tick: u64, tick_of: impl Fn(&T) -> u64) -> Option<&T> {
    let end = entries.partition_point(|entry| tick_of(entry) <= tick);
    entries.get(end.checked_sub(1)?)
}

/// The process at a position.
pub fn process(at: usize) -> &'static ProcessInfo {
    &Ladder::processes()[at]
}

/// Table and row that fired.
pub fn row_of(at: usize, fired: &Fired) -> Option<(&'static Table, &'static Row)> {
    let table = process(at).table(fired.table)?;
    Some((table, table.row(fired.row)?))
}

/// What a row asks for, as words: `step is Start`, `gripper is None`.
pub fn conditions(row: &Row) -> Vec<String> {
    let step = (!row.steps.is_empty()).then(|| format!("step is {}", row.steps.join(" or ")));
    step.into_iter().chain(row.when.iter().map(condition)).collect()
}

/// What a row asks of a variable, as words: `held is Nothing or Other`.
pub fn condition(asked: &Condition) -> String {
    format!("{} is {}", asked.variable, asked.values.join(" or "))
}

/// What a row did, as words: `GraspObj, then Grasping`. A row that fires in any step says in which one it
/// did: `Wait in step moving`.
pub fn deed(row: &Row, step: &str) -> String {
    let at = if row.steps.is_empty() && row.next.is_none() && !step.is_empty() {
        format!(" in step {step}")
    } else {
        String::new()
    };
    let next = row.next.map_or_else(String::new, |next| format!(", then {next}"));
    format!("{}{at}{next}", row.call())
}

/// Why a row fired, as words: `because step is Start, gripper is None`.
pub fn because(conditions: &[String]) -> String {
    match conditions {
        [] => "whatever the state".to_owned(),
        conditions => format!("because {}", conditions.join(", ")),
    }
}

/// A row as one says it: `table QC-DETACH row 7: Unlock, then Unlocking, because step is Start`.
pub fn row_words(at: usize, fired: &Fired) -> String {
    match row_of(at, fired) {
        None => "by no row of a table".to_owned(),
        Some((table, row)) => {
            let (deed, because) = (deed(row, fired.step.as_str()), because(&conditions(row)));
            format!("table {} row {}: {deed}, {because}", table.name, row.number)
        }
    }
}

/// Numbers of the standing commands, by receiver.
const fn numbers(external: &ExternalInputs, memory: &CommonMemory) -> [u32; PROCESSES] {
    [
        external.hws.number,
        memory.task.subtask.number,
        memory.subtask.emove.number,
        memory.emove.prim.number,
        memory.prim.t3i.number,
        memory.emove.quick_change.number,
        memory.emove.grip.number,
        memory.emove.v_grip.number,
        memory.emove.tool_grip.number,
        memory.subtask.pedestal.number,
        memory.pedestal.hand.number,
        memory.pedestal.table.number,
    ]
}

/// Report and reason of each process.
const fn reports(memory: &CommonMemory) -> [(&'static str, &'static str); PROCESSES] {
    let m = memory;
    [
        (m.task.status.report.text(), m.task.status.reason.text()),
        (m.subtask.status.report.text(), m.subtask.status.reason.text()),
        (m.emove.status.report.text(), m.emove.status.reason.text()),
        (m.prim.status.report.text(), m.prim.status.reason.text()),
        (m.t3i.status.report.text(), m.t3i.status.fault.text()),
        (m.quick_change.status.report.text(), m.quick_change.status.reason.text()),
        (m.grip.status.report.text(), m.grip.status.reason.text()),
        (m.v_grip.status.report.text(), m.v_grip.status.reason.text()),
        (m.tool_grip.status.report.text(), m.tool_grip.status.reason.text()),
        (m.pedestal.status.report.text(), m.pedestal.status.reason.text()),
        (m.hand.status.report.text(), m.hand.status.reason.text()),
        (m.table.status.report.text(), m.table.status.reason.text()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wiring_is_a_tree_below_task() {
        for (at, wiring) in WIRING.iter().enumerate() {
            assert_eq!(wiring.commander.is_none(), at == 0);
            assert!(wiring.commander.is_none_or(|commander| WIRING[commander].below.contains(&at)), "{at}");
            assert!(wiring.below.iter().all(|below| WIRING[*below].commander == Some(at)), "{at}");
        }
    }

    #[test]
    fn devices_of_the_wiring_are_inputs() {
        let leaves = record::layout::leaves(ExternalInputs::RECORD);
        for device in WIRING.iter().flat_map(|wiring| wiring.devices) {
            assert!(leaves.iter().any(|leaf| leaf.path.starts_with(device)), "{device}");
        }
    }

    #[test]
    fn the_latest_entry_counts() {
        let entries = [3, 7, 9];
        let at = |tick| latest(&entries, tick, |entry| *entry).copied();
        assert_eq!([at(2), at(3), at(8), at(100)], [None, Some(3), Some(7), Some(9)]);
    }

    #[test]
    fn a_row_is_told_with_the_step_in_which_it_fired() {
        let any = Row {
            number: 1,
            steps: &[],
            when: &[Condition { variable: "work", values: &["Busy", "Lost"] }],
            action: "Wait",
            argument: None,
            next: None,
        };
        assert_eq!(deed(&any, "letting-go"), "Wait in step letting-go");
        assert_eq!(deed(&any, ""), "Wait");
        assert_eq!(because(&conditions(&any)), "because work is Busy or Lost");
        let one = Row {
            number: 2,
            steps: &["Start"],
            when: &[],
            action: "MovToHol",
            argument: Some("Own"),
            next: Some("Stowing"),
        };
        assert_eq!(deed(&one, "stowing"), "MovToHol(Own), then Stowing");
        assert_eq!(because(&conditions(&one)), "because step is Start");
        assert_eq!(because(&conditions(&Row { steps: &[], ..one })), "whatever the state");
    }
}
