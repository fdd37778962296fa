//! Says why something failed: which process, which decision table, which row, in one sentence.
//!
//! A reason travels up the ladder unchanged, a tick a level, so the process that knows most is the lowest one
//! that bears the reason which arrived at Task. By the time it arrives there the lower processes have moved
//! on: [`Watch`] therefore keeps, for each process, common memory as it was in the tick when the process
//! began to report its reason.

use levels::ladder::{PROCESS_COUNT, ProcessId, ProcessInfo};
use rcs_core::{
    Plain,
    handshake::Lower,
    interface::{
        CommonMemory, ExternalInputs, Header, HwsCommand, Reason,
        grip::{GripCommand, GripVerb},
        hws::HwsReport,
        jaws::{JawsCommand, JawsVerb},
        pedestal::{PedestalCommand, PedestalVerb, TableVerb},
        t3i::{LinkFault, T3iReport},
    },
    table::{Row, Table},
    tick::Tick,
};

/// Processes of [`CommonMemory`], in its order.
pub const PROCESSES: usize = PROCESS_COUNT;

/// Processes from the lowest upward, as positions in [`CommonMemory`]: T3I, Grip, V-Grip, Tool-Grip, Quick
/// Change, hand and table of the pedestal, the pedestal, Prim, E-move, Subtask, Task.
const UPWARD: [usize; PROCESSES] = [4, 6, 7, 8, 5, 10, 11, 9, 3, 2, 1, 0];

/// Position of Task.
const TASK: usize = 0;

/// Why a run failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Tick in which it began.
    pub tick: Tick,
    /// The process that knows why; the manual's name.
    pub process: String,
    /// Its decision table, if one was used.
    pub table: Option<String>,
    /// The row that fired, from 1.
    pub row: Option<u8>,
    /// The whole in one sentence.
    pub text: String,
    /// The link to the robot is lost, or the robot was stopped: not a matter of the job.
    pub stopped: bool,
}

/// What a process reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Report {
    Reason(Reason),
    Link(LinkFault),
}

impl Report {
    const fn is_none(self) -> bool {
        matches!(self, Self::Reason(Reason::None) | Self::Link(LinkFault::None))
    }
}

/// The beginning of a report that lasts.
#[derive(Clone, Copy)]
struct Cause {
    tick: Tick,
    report: Report,
    external: HwsCommand,
    before: CommonMemory,
    header: Header,
}

/// Looks at every tick and keeps when, and amid what, each process began to report what it reports now.
pub struct Watch {
    last: [Report; PROCESSES],
    causes: [Option<Cause>; PROCESSES],
}

impl Default for Watch {
    fn default() -> Self {
        Self { last: reports(&CommonMemory::ZERO), causes: [None; PROCESSES] }
    }
}

impl Watch {
    /// Look at a tick: what came from outside, what the processes read, and what they wrote. Does not
    /// allocate.
    pub fn observe(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        before: &CommonMemory,
        after: &CommonMemory,
    ) {
        let now = reports(after);
        let headers = headers(after);
        for (process, cause) in self.causes.iter_mut().enumerate() {
            let report = now[process];
            if report.is_none() {
                *cause = None;
            } else if report != self.last[process] {
                *cause = Some(Cause {
                    tick,
                    report,
                    external: external.hws,
                    before: *before,
                    header: headers[process],
                });
            }
        }
        self.last = now;
    }

    /// Why Task reports an error; `None` while it reports none. `processes` are the names and tables in the
    /// order of [`CommonMemory`].
    #[must_use]
    pub fn failure(&self, processes: &[ProcessInfo; PROCESSES]) -> Option<Failure> {
        let task = self.causes[TASK].as_ref()?;
        let Report::Reason(reason) = task.report else { return None };
        let link = matches!(reason, Reason::LinkOff | Reason::LinkError);
        let root = UPWARD.into_iter().find(|&process| {
            self.causes[process].as_ref().is_some_and(|cause| match cause.report {
                Report::Reason(other) => other == reason && cause.tick <= task.tick,
                Report::Link(_) => link,
            })
        })?;
        let cause = self.causes[root].as_ref()?;
        let why = match cause.report {
            Report::Reason(reason) => reason.text(),
            Report::Link(fault) => fault.text(),
        };
        let process = &processes[root];
        let row = row_of(process, &cause.header);
        let text = format!(
            "{}: {why}, {}{}",
            process.name,
            while_doing(root, cause),
            row.map_or_else(String::new, |(table, row)| format!(
                " (table {}, row {}: {row})",
                table.name, row.number
            ))
        );
        Some(Failure {
            tick: cause.tick,
            process: process.name.to_owned(),
            table: row.map(|(table, _)| table.name.to_owned()),
            row: row.map(|(_, row)| row.number),
            text,
            stopped: link,
        })
    }
}

/// The table and the row that a header names.
fn row_of(process: &ProcessInfo, header: &Header) -> Option<(&'static Table, &'static Row)> {
    let table = process.table(header.table)?;
    Some((table, table.row(header.row)?))
}

fn reports(memory: &CommonMemory) -> [Report; PROCESSES] {
    [
        Report::Reason(memory.task.status.reason),
        Report::Reason(memory.subtask.status.reason),
        Report::Reason(memory.emove.status.reason),
        Report::Reason(memory.prim.status.reason),
        Report::Link(memory.t3i.status.fault),
        Report::Reason(memory.quick_change.status.reason),
        Report::Reason(memory.grip.status.reason),
        Report::Reason(memory.v_grip.status.reason),
        Report::Reason(memory.tool_grip.status.reason),
        Report::Reason(memory.pedestal.status.reason),
        Report::Reason(memory.hand.status.reason),
        Report::Reason(memory.table.status.reason),
    ]
}

/// Headers of all processes in the order of common memory.
#[must_use]
pub const fn headers(memory: &CommonMemory) -> [Header; PROCESSES] {
    [
        memory.task.header,
        memory.subtask.header,
        memory.emove.header,
        memory.prim.header,
        memory.t3i.header,
        memory.quick_change.header,
        memory.grip.header,
        memory.v_grip.header,
        memory.tool_grip.header,
        memory.pedestal.header,
        memory.hand.header,
        memory.table.header,
    ]
}

fn while_doing(process: usize, cause: &Cause) -> String {
    let command = command(process, &cause.external, &cause.before);
    if command.is_empty() { "without a command".to_owned() } else { format!("while it executed {command}") }
}

/// The command that a process has, as a person says it; empty for none.
#[must_use]
pub fn command(process: usize, hws: &HwsCommand, memory: &CommonMemory) -> String {
    let words = |words: &[&dyn std::fmt::Display]| {
        let words: Vec<String> =
            words.iter().map(ToString::to_string).filter(|word| !word.is_empty()).collect();
        words.join(" ")
    };
    match process {
        0 => words(&[
            &hws.command,
            &hws.object,
            &at(&hws.source, hws.source_sector),
            &to(&hws.destination, hws.destination_sector),
        ]),
        1 => {
            let command = &memory.task.subtask;
            words(&[&command.command, &command.object, &at(&command.location, 0)])
        }
        2 => {
            let command = &memory.subtask.emove;
            words(&[&command.command, &command.object, &at(&command.location, 0)])
        }
        3 => {
            let command = &memory.emove.prim;
            words(&[&command.command, &command.sensor])
        }
        4 => words(&[&memory.prim.t3i.command]),
        5 => words(&[&memory.emove.quick_change.command]),
        6 => grip(&memory.emove.grip),
        7 => jaws("VG", &memory.emove.v_grip),
        8 => jaws("TG", &memory.emove.tool_grip),
        9 => pedestal(&memory.subtask.pedestal),
        10 => grip(&memory.pedestal.hand),
        11 => {
            let command = &memory.pedestal.table;
            match command.command {
                TableVerb::Turn => format!("{} to {}", command.command, degrees(command.angle)),
                _ => command.command.to_string(),
            }
        }
        _ => String::new(),
    }
}

fn grip(command: &GripCommand) -> String {
    match command.command {
        GripVerb::None => String::new(),
        verb => format!("{verb} (opening {}, force {} lb)", inches(command.position), command.force),
    }
}

/// V-Grip's VG-GRASP, VG-RELEASE, VGRIP-POSE, VG-PAUSE, and Tool-Grip's with TG (VI.4.1, VI.5).
fn jaws(prefix: &str, command: &JawsCommand) -> String {
    match command.command {
        JawsVerb::None => String::new(),
        JawsVerb::Pose => format!("{prefix}RIP-{}", command.command),
        JawsVerb::Pause => format!("{prefix}-{}", command.command),
        verb => format!("{prefix}-{verb} (size {})", inches(command.size)),
    }
}

fn pedestal(command: &PedestalCommand) -> String {
    let (size, angle) = (inches(command.grasp_size), degrees(command.table_angle));
    match command.command {
        PedestalVerb::None | PedestalVerb::Pause => command.command.to_string(),
        PedestalVerb::PreGrip => format!("{} (opening {size}, table at {angle})", command.command),
        PedestalVerb::Grip => format!("{} (size {size}, force {} lb)", command.command, command.grasp_force),
        PedestalVerb::Flip => format!("{} by {angle}", command.command),
        PedestalVerb::Release => format!("{} (opening {size})", command.command),
    }
}

/// Hundredths of an inch.
fn inches(hundredths: i32) -> String {
    format!("{:.2} in", f64::from(hundredths) / 100.0)
}

/// Tenths of a degree.
fn degrees(tenths: i32) -> String {
    format!("{:.1} degrees", f64::from(tenths) / 10.0)
}

fn at(location: &dyn std::fmt::Display, sector: i32) -> String {
    place("at", location, sector)
}

fn to(location: &dyn std::fmt::Display, sector: i32) -> String {
    place("to", location, sector)
}

fn place(word: &str, location: &dyn std::fmt::Display, sector: i32) -> String {
    match (location.to_string(), sector) {
        (name, _) if name.is_empty() => String::new(),
        (name, 0) => format!("{word} {name}"),
        (name, sector) => format!("{word} {name} sector {sector}"),
    }
}

/// What each level is doing, from Task down, for a failure that no process reports: a command that takes too
/// long.
#[must_use]
pub fn present_commands(
    processes: &[ProcessInfo; PROCESSES],
    hws: &HwsCommand,
    memory: &CommonMemory,
) -> String {
    let headers = headers(memory);
    let lines = processes.iter().enumerate().filter_map(|(index, process)| {
        let command = command(index, hws, memory);
        let (table, row) = row_of(process, &headers[index])?;
        let text =
            || format!("{} executes {command} (table {}, row {})", process.name, table.name, row.number);
        (!command.is_empty()).then(text)
    });
    lines.collect::<Vec<_>>().join("; ")
}

/// The commands that processes have not finished, as people say them: `Grip executed CLOSE-GRIP (...)`; empty for none.
#[must_use]
pub fn unfinished_commands(
    of: impl Iterator<Item = ProcessId>,
    hws: &HwsCommand,
    memory: &CommonMemory,
) -> String {
    let lines = of.filter(|process| is_executing(*process, memory)).filter_map(|process| {
        let command = command(process.position(), hws, memory);
        (!command.is_empty()).then(|| format!("{process} executed {command}"))
    });
    lines.collect::<Vec<_>>().join(", ")
}

fn is_executing(process: ProcessId, memory: &CommonMemory) -> bool {
    let lower = match process {
        ProcessId::Task => return memory.task.status.report == HwsReport::Executing,
        ProcessId::T3i => return memory.t3i.status.report == T3iReport::Executing,
        ProcessId::Subtask => memory.subtask.status.report.lower(),
        ProcessId::Emove => memory.emove.status.report.lower(),
        ProcessId::Prim => memory.prim.status.report.lower(),
        ProcessId::QuickChange => memory.quick_change.status.report.lower(),
        ProcessId::Grip => memory.grip.status.report.lower(),
        ProcessId::VGrip => memory.v_grip.status.report.lower(),
        ProcessId::ToolGrip => memory.tool_grip.status.report.lower(),
        ProcessId::Pedestal => memory.pedestal.status.report.lower(),
        ProcessId::Hand => memory.hand.status.report.lower(),
        ProcessId::RotaryTable => memory.table.status.report.lower(),
    };
    lower == Lower::Executing
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::{
        Actions, Plain, Variables, decision_table,
        interface::{pedestal::TableCommand, subtask::SubtaskVerb},
        name::Name10,
    };

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    enum Fingers {
        Apart,
        Shut,
    }

    #[derive(Clone, Copy, Debug, Variables)]
    struct Situation {
        /// Where the fingers are.
        fingers: Fingers,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
    enum Action {
        Close,
        Fail(Reason),
    }

    decision_table! {
        /// CLOSE-GRIP for the test.
        CLOSE_GRIP: fn close_grip(enum CloseGripStep, Situation) -> Action {
            any {
                1: fingers: Apart   => Close                -> Wait;
            }
            /// Nothing done yet.
            Start {
                2: fingers: Shut    => Close                -> Wait;
            }
            /// The fingers close.
            Wait {
                3: fingers: Shut    => Fail(GraspMissed)    -> Start;
            }
        }
    }

    const TABLES: &[&rcs_core::table::Table] = &[&CLOSE_GRIP];

    fn processes() -> [ProcessInfo; PROCESSES] {
        let names = [
            "Task",
            "Subtask",
            "E-move",
            "Prim",
            "T3I",
            "Quick Change",
            "Grip",
            "V-Grip",
            "Tool-Grip",
            "Pedestal",
            "Hand",
            "Table",
        ];
        names.map(|name| ProcessInfo { name, tables: if name == "Grip" { TABLES } else { &[] } })
    }

    /// Plays ticks: each closure changes common memory, the watch looks on.
    fn watched(changes: &[fn(&mut CommonMemory)]) -> Watch {
        let (mut watch, mut memory) = (Watch::default(), CommonMemory::default());
        for (tick, change) in (1..).zip(changes) {
            let before = memory;
            change(&mut memory);
            watch.observe(Tick(tick), &ExternalInputs::default(), &before, &memory);
        }
        watch
    }

    #[test]
    fn no_failure_without_a_reason_at_task() {
        assert_eq!(Watch::default().failure(&processes()), None);
        let watch = watched(&[|memory| memory.grip.status.reason = Reason::GraspMissed]);
        assert_eq!(watch.failure(&processes()), None);
    }

    #[test]
    fn the_lowest_process_explains_with_the_row_of_its_own_tick() {
        let watch = watched(&[
            |memory| memory.emove.grip.command = GripVerb::CloseGrip,
            |memory| memory.emove.grip.force = 25,
            |memory| {
                let row = close_grip(CloseGripStep::Wait, &Situation { fingers: Fingers::Shut }).row;
                memory.grip.header = Header { stamp: Tick(3), table: 1, row, ..Header::ZERO };
                memory.grip.status.reason = Reason::GraspMissed;
            },
            |memory| {
                memory.emove.status.reason = Reason::GraspMissed;
                memory.grip.header.row = 1;
            },
            |memory| {
                memory.subtask.status.reason = Reason::GraspMissed;
                memory.emove.grip.command = GripVerb::Pause;
            },
            |memory| memory.task.status.reason = Reason::GraspMissed,
        ]);
        let failure = watch.failure(&processes()).expect("Task reports a reason");
        assert_eq!((failure.tick, failure.row, failure.stopped), (Tick(3), Some(3), false));
        assert_eq!((failure.process.as_str(), failure.table.as_deref()), ("Grip", Some("CLOSE-GRIP")));
        assert_eq!(
            failure.text,
            "Grip: the fingers closed on nothing, while it executed CLOSE-GRIP (opening 0.00 in, force 25 lb) \
             (table CLOSE-GRIP, row 3: Wait, fingers Shut => Fail(GraspMissed) -> Start)"
        );
    }

    #[test]
    fn an_older_failure_of_a_lower_process_that_has_passed_is_not_blamed() {
        let watch = watched(&[
            |memory| memory.grip.status.reason = Reason::GraspMissed,
            |memory| memory.grip.status.reason = Reason::None,
            |memory| {
                memory.task.subtask.command = SubtaskVerb::GetObject;
                memory.task.subtask.location = Name10::new("UNIT_1").unwrap();
            },
            |memory| memory.subtask.status.reason = Reason::UnknownGrip,
            |memory| memory.task.status.reason = Reason::UnknownGrip,
        ]);
        let failure = watch.failure(&processes()).expect("Task reports a reason");
        assert_eq!((failure.tick, failure.process.as_str(), failure.row), (Tick(4), "Subtask", None));
        assert_eq!(
            failure.text,
            "Subtask: the object has no such grip, while it executed GET-OBJECT at UNIT_1"
        );
    }

    #[test]
    fn every_process_tells_its_command() {
        let mut memory = CommonMemory::default();
        memory.emove.v_grip = JawsCommand { command: JawsVerb::Grasp, size: 200, ..JawsCommand::default() };
        memory.emove.tool_grip.command = JawsVerb::Pose;
        memory.subtask.pedestal.command = PedestalVerb::Flip;
        memory.subtask.pedestal.table_angle = 1835;
        memory.pedestal.hand.command = GripVerb::CloseGrip;
        memory.pedestal.table = TableCommand { number: 1, command: TableVerb::Turn, angle: -300 };
        let told = |process| command(process, &HwsCommand::default(), &memory);
        let commands: Vec<String> = (7..PROCESSES).map(told).collect();
        assert_eq!(
            commands,
            [
                "VG-GRASP (size 2.00 in)",
                "TGRIP-POSE",
                "FLIP by 183.5 degrees",
                "CLOSE-GRIP (opening 0.00 in, force 0 lb)",
                "TURN to -30.0 degrees",
            ]
        );
        assert!(
            (0..PROCESSES).all(|p| command(p, &HwsCommand::default(), &CommonMemory::default()).is_empty())
        );
    }

    #[test]
    fn a_table_that_is_stuck_explains_the_error_of_the_pedestal() {
        let watch = watched(&[
            |memory| {
                memory.pedestal.table = TableCommand { number: 1, command: TableVerb::Turn, angle: -300 }
            },
            |memory| memory.table.status.reason = Reason::TableStuck,
            |memory| memory.pedestal.status.reason = Reason::TableStuck,
            |memory| memory.subtask.status.reason = Reason::TableStuck,
            |memory| memory.task.status.reason = Reason::TableStuck,
        ]);
        let failure = watch.failure(&processes()).expect("Task reports a reason");
        assert_eq!((failure.tick, failure.process.as_str()), (Tick(2), "Table"));
        assert_eq!(
            failure.text,
            "Table: the rotary table of the pedestal does not reach its angle, while it executed TURN to -30.0 degrees"
        );
    }

    #[test]
    fn a_lost_link_is_explained_by_the_interface() {
        let watch = watched(&[
            |memory| memory.t3i.status.fault = LinkFault::NotResponding,
            |memory| memory.prim.status.reason = Reason::LinkOff,
            |memory| memory.task.status.reason = Reason::LinkOff,
        ]);
        let failure = watch.failure(&processes()).expect("Task reports a reason");
        assert_eq!((failure.tick, failure.process.as_str(), failure.stopped), (Tick(1), "T3I", true));
        assert_eq!(failure.text, "T3I: not responding, without a command");
    }
}
