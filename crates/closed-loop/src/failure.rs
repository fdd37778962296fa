//! Explains a failure in one sentence: process, decision table and row.
//!
//! A reason travels up the ladder unchanged, one level per tick, so its origin is the lowest process that reports the
//! reason Task received. As lower processes may have continued since, [`Watch`] stores, per process, common memory of
//! the tick in which the present report began.
//!
//! [`Account`](crate::account::Account) orders reports with collisions, lost parts and emergency stops, which often
//! precede them.

use interfaces::{CommonMemory, Detail, ExternalInputs, Fault, Header, HwsCommand, Reason};
use levels::ladder::{PROCESS_COUNT, ProcessId, ProcessInfo};
use rcs_core::{Plain, handshake::Lower, table::Fired, tick::Tick};
use serde::{Deserialize, Serialize};

use crate::account::Kind;

pub const PROCESSES: usize = PROCESS_COUNT;

/// A failure of a run. The field names are those of the JSON object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    #[serde(with = "number")]
    pub tick: Tick,
    pub kind: Kind,
    /// The manual's name of the process that reports the reason; `cell` and `T3` for events in the cell.
    pub process: String,
    pub table: Option<String>, // its decision table, if one decided
    pub row: Option<u8>,       // the row that fired, from 1
    pub text: String,
    /// True if the robot or a device is lost or was stopped, which is not a failure of the job.
    #[serde(skip)]
    pub stopped: bool,
}

impl Failure {
    #[must_use]
    pub fn outside(tick: Tick, kind: Kind, process: &str, text: String) -> Self {
        Self { tick, kind, process: process.to_owned(), table: None, row: None, text, stopped: false }
    }
}

mod number {
    use super::{Deserialize, Tick};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub fn serialize<S: serde::Serializer>(tick: &Tick, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_u64(tick.0)
    }

    pub fn deserialize<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Tick, D::Error> {
        u64::deserialize(from).map(Tick)
    }
}

#[derive(Clone, Copy)]
struct Cause {
    tick: Tick,
    fault: Fault,
    external: HwsCommand,
    before: CommonMemory,
    header: Header,
    detail: Detail,
}

/// Stores, per process, the tick in which the present report began and common memory of that tick.
#[derive(Clone)]
pub struct Watch {
    last: [Fault; PROCESSES],
    causes: [Option<Cause>; PROCESSES],
}

impl Default for Watch {
    fn default() -> Self {
        Self { last: faults(&CommonMemory::ZERO), causes: [None; PROCESSES] }
    }
}

impl Watch {
    /// Observes the external inputs and the buffers before and after a tick. Does not allocate.
    pub fn observe(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        before: &CommonMemory,
        after: &CommonMemory,
    ) {
        let now = faults(after);
        for ((process, cause), (fault, last)) in
            ProcessId::ALL.iter().zip(&mut self.causes).zip(now.into_iter().zip(self.last))
        {
            if fault.is_none() {
                *cause = None;
            } else if fault != last {
                let header = *after.header(*process);
                let detail = Detail::of(*process, fault, &external.hws, after);
                *cause = Some(Cause { tick, fault, external: external.hws, before: *before, header, detail });
            }
        }
        self.last = now;
    }

    /// The failure that Task reports, if any. `processes` are the names and tables in the order of [`CommonMemory`].
    #[must_use]
    pub fn failure(&self, processes: &[ProcessInfo; PROCESSES]) -> Option<Failure> {
        let cause_of = |process: ProcessId| self.causes[process.position()].as_ref();
        let task = cause_of(ProcessId::Task)?;
        let Fault::Reason(reason) = task.fault else { return None };
        let link = matches!(reason, Reason::LinkOff | Reason::LinkError);
        let device = matches!(reason, Reason::DeviceSilent | Reason::DeviceTripped);
        let root = ProcessId::upward().find(|process| {
            cause_of(*process).is_some_and(|cause| match cause.fault {
                Fault::Reason(other) => other == reason && cause.tick <= task.tick,
                Fault::Link(_) => link,
            })
        })?;
        let cause = cause_of(root)?;
        let why = cause.fault.text();
        let process = &processes[root.position()];
        let fired = process.fired(&cause.header);
        let text = format!(
            "{}: {why}{}, {}{}",
            process.name,
            cause.detail,
            while_doing(root, cause),
            fired.map_or_else(String::new, |fired| format!(" (table {fired})"))
        );
        let kind = match reason {
            _ if link => Kind::Link,
            Reason::OffPath => Kind::OffPath,
            _ => Kind::Process,
        };
        Some(Failure {
            tick: cause.tick,
            kind,
            process: process.name.to_owned(),
            table: fired.map(|fired| fired.table.name.to_owned()),
            row: fired.map(|fired| fired.row.number),
            text,
            stopped: link || device,
        })
    }
}

fn faults(memory: &CommonMemory) -> [Fault; PROCESSES] {
    let mut faults = [Fault::Reason(Reason::None); PROCESSES];
    for (process, fault) in ProcessId::ALL.iter().zip(&mut faults) {
        *fault = memory.said(*process).fault;
    }
    faults
}

fn while_doing(process: ProcessId, cause: &Cause) -> String {
    let command = command(process, &cause.external, &cause.before);
    if command.is_empty() { "without a command".to_owned() } else { format!("while it executed {command}") }
}

/// The command of a process as text; empty for none.
#[must_use]
pub fn command(process: ProcessId, hws: &HwsCommand, memory: &CommonMemory) -> String {
    memory.show_command(process, |command| command.to_string()).unwrap_or_else(|| hws.to_string())
}

/// The present commands of all levels from Task down, for a failure without a report: a command that takes too long.
#[must_use]
pub fn present_commands(
    processes: &[ProcessInfo; PROCESSES],
    hws: &HwsCommand,
    memory: &CommonMemory,
) -> String {
    let lines = ProcessId::ALL.iter().zip(processes).filter_map(|(id, process)| {
        let command = command(*id, hws, memory);
        let Fired { table, row, .. } = process.fired(memory.header(*id))?;
        let text =
            || format!("{} executes {command} (table {} row {})", process.name, table.name, row.number);
        (!command.is_empty()).then(text)
    });
    lines.collect::<Vec<_>>().join("; ")
}

/// The unfinished commands of the processes as text: `Grip executed CLOSE-GRIP (...)`; empty for none.
#[must_use]
pub fn unfinished_commands(
    of: impl Iterator<Item = ProcessId>,
    hws: &HwsCommand,
    memory: &CommonMemory,
) -> String {
    let executing = |process: &ProcessId| memory.said(*process).lower == Lower::Executing;
    let lines = of.filter(executing).filter_map(|process| {
        let command = command(process, hws, memory);
        (!command.is_empty()).then(|| format!("{process} executed {command}"))
    });
    lines.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{
        Decided,
        emove::{EmoveVerb, RobotPlace},
        grip::GripVerb,
        jaws::{JawsCommand, JawsVerb, TOOL_GRIPPER},
        location::Site,
        pedestal::{PedestalVerb, TableCommand, TableVerb},
        subtask::SubtaskVerb,
        t3i::LinkFault,
    };
    use rcs_core::{Actions, Plain, Variables, decision_table, name::Name10};

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
                1: fingers: Apart  => Close              -> Wait;
            }
            /// The command has not started.
            Start {
                2: fingers: Shut   => Close              -> Wait;
            }
            /// The fingers close.
            Wait {
                3: fingers: Shut   => Fail(GraspMissed)  -> Start;
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
        names.map(|name| ProcessInfo { name, tables: if name == "Grip" { TABLES } else { &[] }, goals: &[] })
    }

    /// Plays ticks: each closure changes common memory before the watch observes it.
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
                let decided = Some(Decided { table: 1, row });
                memory.grip.header = Header { stamp: Tick(3), decided, ..Header::ZERO };
                memory.grip.status.reason = Reason::GraspMissed;
            },
            |memory| {
                memory.emove.status.reason = Reason::GraspMissed;
                memory.grip.header.decided = Some(Decided { table: 1, row: 1 });
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
             (table CLOSE-GRIP row 3: Wait, fingers Shut => Fail(GraspMissed) -> Start)"
        );
    }

    #[test]
    fn past_failure_of_a_lower_process_is_not_the_cause() {
        let watch = watched(&[
            |memory| memory.grip.status.reason = Reason::GraspMissed,
            |memory| memory.grip.status.reason = Reason::None,
            |memory| {
                memory.task.subtask.command = SubtaskVerb::GetObject;
                memory.task.subtask.site.location = Name10::new("UNIT_1").unwrap();
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
    fn a_reason_carries_its_names() {
        let watch = watched(&[
            |memory| {
                memory.subtask.emove.command = EmoveVerb::MovToLoc;
                memory.subtask.emove.site.location = Name10::new("VISE").unwrap();
                let site = Site { location: Name10::new("BENCH").unwrap(), ..Site::default() };
                let from = RobotPlace { site, ..RobotPlace::default() };
                memory.emove.estimates.place = Some(from);
            },
            |memory| memory.emove.status.reason = Reason::NoTrajectory,
            |memory| memory.subtask.status.reason = Reason::NoTrajectory,
            |memory| memory.task.status.reason = Reason::NoTrajectory,
        ]);
        let failure = watch.failure(&processes()).expect("Task reports a reason");
        let text = "E-move: no trajectory from the present location to the destination: none leads from BENCH to VISE (";
        assert!(failure.text.starts_with(text), "{}", failure.text);
        assert!(failure.text.ends_with(", while it executed MOV-TO-LOC at VISE"), "{}", failure.text);
    }

    #[test]
    fn every_process_reports_its_command() {
        let mut memory = CommonMemory::default();
        memory.emove.v_grip = JawsCommand { command: JawsVerb::Grasp, size: 200, ..JawsCommand::default() };
        memory.emove.tool_grip = JawsCommand {
            command: JawsVerb::Pose,
            end_effector_id: Some(TOOL_GRIPPER),
            ..JawsCommand::default()
        };
        memory.subtask.pedestal.command = PedestalVerb::Flip;
        memory.subtask.pedestal.table_angle = 1835;
        memory.pedestal.hand.command = GripVerb::CloseGrip;
        memory.pedestal.table = TableCommand { number: 1, command: TableVerb::Turn, angle: -300 };
        let told = |process| command(process, &HwsCommand::default(), &memory);
        let from_v_grip = ProcessId::ALL.iter().skip_while(|process| **process != ProcessId::VGrip);
        let commands: Vec<String> = from_v_grip.copied().map(told).collect();
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
        let silent = |process: &ProcessId| {
            command(*process, &HwsCommand::default(), &CommonMemory::default()).is_empty()
        };
        assert!(ProcessId::ALL.iter().all(silent));
    }

    #[test]
    fn stuck_table_explains_the_error_of_the_pedestal() {
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
