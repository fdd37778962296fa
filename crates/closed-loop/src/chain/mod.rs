//! The causes and consequences of a failure: the commands before it, the trace to its first cause, the reports up to
//! Task.
//!
//! The trace begins with the process that first reported the reason which Task received. Its row has new conditions. If
//! a process below failed or changed in the previous tick, the trace continues with it. Otherwise the cause is a
//! device, a limit, or data. From there, the commands are traced upwards.

mod history;

use interfaces::t3i::LinkFault;
use levels::ladder::{PROCESS_COUNT, ProcessId};
use rcs_core::table::{Condition, Fired, Row};
use serde::{Deserialize, Serialize};

pub use history::{Fired as FiredRow, History, Processes, because, conditions, effect};

use crate::{
    account::{Account, Kind},
    failure::Failure,
};
use history::condition;

const PARTS_GRIPPER: u8 = 1; // end effector id of the gripper whose hand is the process Grip

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Link {
    pub tick: u64,
    pub process: String,
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    pub process: ProcessId,
    pub tick: u64,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Chain {
    /// Commands that led to the first failure, from the workstation controller down; empty if none can have caused it.
    pub commands: Vec<Link>,
    pub report: Option<Report>, // the first failure that a process reports, if any
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    pub tick: u64,
    pub text: String,
    /// The commands that led to the process of the first cause, from the workstation controller down.
    pub commands: Vec<Link>,
    pub causes: Vec<Link>,       // the causes, from the report to the first cause
    pub consequences: Vec<Link>, // the reports of the failure up to Task
}

impl Chain {
    #[must_use]
    pub fn of(account: &Account, history: &History) -> Self {
        let Failure { tick, kind, .. } = account.first;
        let root = kind.mover(history.gripper(tick.0)).map(|process| Root { process, tick: tick.0 });
        Self {
            commands: root.map_or_else(Vec::new, |root| commands(history, root)),
            report: account
                .of_process()
                .and_then(|failure| Report::of(failure, history))
                .map(|(_, report)| report),
        }
    }

    #[must_use]
    pub fn last_command(&self) -> Option<&Link> {
        self.commands.last().or_else(|| self.report.as_ref()?.commands.last())
    }
}

impl Report {
    /// The report of a failure, and where its trace ends; `None` if the failure is not that of a process.
    #[must_use]
    pub fn of(failure: &Failure, history: &History) -> Option<(Root, Self)> {
        let (process, tick) = (ProcessId::from_text(&failure.process)?, failure.tick.0);
        let (root, causes) = down(history, process, tick);
        let (commands, consequences) = (commands(history, root), up(history, process, tick));
        Some((root, Self { tick, text: failure.text.clone(), commands, causes, consequences }))
    }
}

impl Kind {
    /// The lowest process whose command can have caused a failure of this kind: the gripper for a lost part, T3I
    /// for a warning of the robot controller, Prim for all other motion; `None` if no command can have caused it.
    #[must_use]
    pub const fn mover(self, gripper: Option<u8>) -> Option<ProcessId> {
        match (self, gripper) {
            (Self::EmergencyStop | Self::Power | Self::Link | Self::Device | Self::Program, _) => None,
            (Self::RobotController, _) => Some(ProcessId::T3i),
            (Self::Lost, Some(PARTS_GRIPPER)) => Some(ProcessId::Grip),
            _ => Some(ProcessId::Prim),
        }
    }
}

/// Traces a report down to the first process without a report from below; the last link is the first cause.
fn down(history: &History, process: ProcessId, tick: u64) -> (Root, Vec<Link>) {
    let (mut root, mut links) = (Root { process, tick }, Vec::new());
    // The ladder has four levels above the link, so a longer trace would be a cycle.
    for _ in 0..PROCESS_COUNT {
        links.push(report(history, root));
        match below(history, root) {
            Some(next) => root = next,
            None => break,
        }
    }
    (root, links)
}

/// The process below that made the row fire: it reports a failure, or reported a change in the previous tick.
fn below(history: &History, at: Root) -> Option<Root> {
    let seen = at.tick.checked_sub(1)?;
    let said = |process: ProcessId| Some((process, history.report(process, seen)?));
    let neighbours = || at.process.below().filter_map(said);
    let failed = neighbours().find(|(process, report)| has_failed(*process, report.reason));
    let found = failed.or_else(|| neighbours().find(|(_, report)| report.tick == seen && seen > 1));
    found.map(|(process, report)| Root { process, tick: report.tick })
}

/// True if `reason` is a failure. T3I reports `no error` for success, the other processes an empty text.
#[must_use]
pub fn has_failed(process: ProcessId, reason: &str) -> bool {
    let none = if process == ProcessId::T3i { LinkFault::None.text() } else { "" };
    reason != none
}

/// The report of a process in a tick, with the row and its new conditions.
fn report(history: &History, at: Root) -> Link {
    let mut text = match history.report(at.process, at.tick) {
        Some(report) if has_failed(at.process, report.reason) => {
            format!("reports {}: {}", report.report, report.reason)
        }
        Some(report) => format!("reports {}", report.report),
        None => "has reported nothing yet".to_owned(),
    };
    if let Some(fired) = history.row(at.process, at.tick) {
        text += &format!(" ({})", history.row_words(at.process, fired));
        if let Some(news) = news(history, at, fired) {
            text += &format!("; new in this tick: {news}");
        }
    }
    Link { tick: at.tick, process: history.info(at.process).name.to_owned(), text }
}

/// The conditions that the previous row lacks. `None` unless the row fired for the first time under the same command.
fn news(history: &History, at: Root, fired: &history::Fired) -> Option<String> {
    if fired.tick != at.tick {
        return None;
    }
    let seen = at.tick.checked_sub(1)?;
    let command = |tick| history.command(at.process, tick).map(|command| command.number);
    if command(at.tick) != command(seen) {
        return None;
    }
    let last = history.row(at.process, seen)?;
    let (now, before) = (history.row_of(at.process, fired)?, history.row_of(at.process, last)?);
    // An earlier table that decides now had passed the decision on before, by a row that no header names.
    let is_above = before.table.name != now.table.name;
    let passed = now.table.rows.iter().filter(|row| is_above && row.action == CONSULT);
    let changed = changed(passed.chain([before.row]), &now);
    (!changed.is_empty()).then(|| changed.join(", "))
}

const CONSULT: &str = "consult"; // the action of rows that pass the decision on to the next table

/// The values for which a row fired, without the step and without the conditions of earlier rows.
fn changed<'a>(before: impl Iterator<Item = &'a Row>, now: &Fired) -> Vec<String> {
    let known: Vec<&Condition> = before.flat_map(|row| row.when).collect();
    let asked = now.row.when.iter().zip(now.conditions());
    asked.filter(|(asked, _)| !known.contains(asked)).map(|(_, found)| condition(&found)).collect()
}

/// The commands that led to a process, from the workstation controller down, each with its tick and row.
fn commands(history: &History, at: Root) -> Vec<Link> {
    let (mut links, mut next) = (Vec::new(), Some((at.process, at.tick)));
    while let Some((receiver, tick)) = next {
        let Some(command) = history.command(receiver, tick) else { break };
        let commander = receiver.commander();
        let by =
            commander.and_then(|commander| history.row(commander, command.tick).map(|row| (commander, row)));
        let name = commander.map_or("HWSC", |commander| history.info(commander).name);
        let reason = by.map_or_else(String::new, |(commander, fired)| {
            format!(" ({})", history.row_words(commander, fired))
        });
        let text = format!(
            "commands {}: {}, number {}{reason}",
            history.info(receiver).name,
            command.text,
            command.number
        );
        links.push(Link { tick: command.tick, process: name.to_owned(), text });
        next = commander.map(|commander| (commander, command.tick));
    }
    links.reverse();
    links
}

/// The path of the failure upwards from a process to Task: process and tick of each report.
fn up(history: &History, from: ProcessId, tick: u64) -> Vec<Link> {
    let (mut links, mut at, mut tick) = (Vec::new(), from, tick);
    while let Some(commander) = at.commander() {
        let Some(report) = (tick + 1..=tick + 3)
            .filter_map(|later| history.report(commander, later))
            .find(|report| report.tick > tick && !report.reason.is_empty())
        else {
            break;
        };
        links.push(self::report(history, Root { process: commander, tick: report.tick }));
        (at, tick) = (commander, report.tick);
    }
    links
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, Decided, ExternalInputs, Header, Reason, StatusReport, prim::PrimReport};
    use levels::ladder::Ladder;
    use rcs_core::tick::Tick;

    fn history(changes: &[fn(&mut ExternalInputs, &mut CommonMemory)]) -> History {
        let (mut history, mut external, mut memory) =
            (History::new(Ladder::processes()), ExternalInputs::default(), CommonMemory::default());
        for (tick, change) in (1..).zip(changes) {
            change(&mut external, &mut memory);
            history.note(Tick(tick), &external, &memory);
        }
        history
    }

    fn missed() -> History {
        history(&[
            |external, _| external.hws.number = 1,
            |_, memory| memory.task.subtask.number = 1,
            |_, memory| memory.subtask.emove.number = 1,
            |_, memory| memory.emove.prim.number = 7,
            |_, memory| {
                memory.prim.status.report = PrimReport::NotDetected;
                memory.prim.status.reason = Reason::NotDetected;
                memory.prim.header = Header {
                    stamp: Tick(5),
                    decided: Some(Decided { table: 1, row: 1 }),
                    ..Header::default()
                };
            },
            |_, memory| {
                memory.emove.status.report = StatusReport::Error;
                memory.emove.status.reason = Reason::NotDetached;
            },
            |_, memory| memory.subtask.status.reason = Reason::NotDetached,
            |_, memory| memory.task.status.reason = Reason::NotDetached,
        ])
    }

    #[test]
    fn trace_ends_at_the_lowest_reporting_process() {
        let (root, links) = down(&missed(), ProcessId::Emove, 6);
        assert_eq!(root, Root { process: ProcessId::Prim, tick: 5 });
        let said: Vec<_> = links.iter().map(|link| (link.tick, link.process.as_str())).collect();
        assert_eq!(said, [(6, "E-move"), (5, "Prim")]);
        assert!(
            links[1].text.starts_with("reports not-detected: the sensor condition did not come"),
            "{links:?}"
        );
    }

    #[test]
    fn commands_are_listed_from_the_top() {
        let links = commands(&missed(), Root { process: ProcessId::Prim, tick: 5 });
        let said: Vec<_> = links.iter().map(|link| (link.tick, link.process.as_str())).collect();
        assert_eq!(said, [(1, "HWSC"), (2, "Task"), (3, "Subtask"), (4, "E-move")]);
        assert!(links[3].text.starts_with("commands Prim: , number 7"), "{links:?}");
    }

    #[test]
    fn failure_rises_one_level_per_tick() {
        let said: Vec<_> =
            up(&missed(), ProcessId::Emove, 6).into_iter().map(|link| (link.tick, link.process)).collect();
        assert_eq!(said, [(7, "Subtask".to_owned()), (8, "Task".to_owned())]);
    }

    #[test]
    fn chain_of_a_collision_has_the_commands_of_prim_and_the_later_report() {
        let collision =
            Failure::outside(Tick(5), Kind::Collision, "cell", "the robot ran into the tray".into());
        let process = Failure {
            table: Some("MOTION".into()),
            ..Failure::outside(Tick(6), Kind::Process, "E-move", "not detached".into())
        };
        let account = Account::of([process, collision]).unwrap();
        let chain = Chain::of(&account, &missed());
        let named = |links: &[Link]| links.iter().map(|link| link.process.clone()).collect::<Vec<_>>();
        assert_eq!(named(&chain.commands), ["HWSC", "Task", "Subtask", "E-move"]);
        let report = chain.report.as_ref().unwrap();
        assert_eq!((report.tick, report.text.as_str()), (6, "not detached"));
        assert_eq!(named(&report.causes), ["E-move", "Prim"]);
        assert_eq!(named(&report.consequences), ["Subtask", "Task"]);
        assert_eq!(chain.last_command(), chain.commands.last());
        let stop =
            Account::of([Failure::outside(Tick(5), Kind::EmergencyStop, "T3", "pressed".into())]).unwrap();
        assert_eq!(Chain::of(&stop, &missed()), Chain::default(), "no command presses a button");
    }

    fn subtask(table: &str, row: u8) -> Decided {
        let tables = levels::subtask::tables::TABLES;
        let at = tables.iter().position(|known| known.name == table).unwrap();
        Decided { table: u8::try_from(at + 1).unwrap(), row }
    }

    /// ORDERED passed on the decision while E-move was busy, so the condition that E-move has the order is not new.
    #[test]
    fn passed_on_conditions_are_not_new() {
        let history = history(&[
            |_, memory| memory.subtask.header.decided = Some(subtask("GET-OBJECT", 1)),
            |_, memory| memory.subtask.header.decided = Some(subtask("ORDERED", 4)),
        ]);
        let fired = history.row(ProcessId::Subtask, 2).unwrap();
        let found = news(&history, Root { process: ProcessId::Subtask, tick: 2 }, fired);
        assert_eq!(found.as_deref(), Some("emove is Error or Joystick or Lost"));
    }

    #[test]
    fn new_conditions_are_absent_from_the_previous_row() {
        const fn row(number: u8, when: &'static [Condition]) -> Row {
            Row { number, steps: &["Wait"], when, action: "Go", argument: None, next: None }
        }
        const fn asked(variable: &'static str, values: &'static [&'static str]) -> Condition {
            Condition { variable, values }
        }
        const BEFORE: Row = row(1, &[asked("hand", &["Empty"]), asked("held", &["No"])]);
        const NOW: Row = row(2, &[asked("hand", &["Empty"]), asked("held", &["Yes", "Maybe"])]);
        let now = Fired { table: &levels::execution::EXECUTE, row: &NOW, values: None };
        assert_eq!(changed([&BEFORE].into_iter(), &now), ["held is Yes or Maybe"]);
        assert!(changed([&BEFORE, &NOW].into_iter(), &now).is_empty());
    }
}
