//! The text lines on `/log`, derived from the differences between two ticks.
//!
//! They report commands, the status of the job, sensor events, faults of the link, and each failure as one sentence:
//! process, reason, and row of the table.

use interfaces::{
    CommonMemory, Detail, Fault, Header, ProcessId,
    data_base::Connection,
    emove::Holding,
    hws::{HwsCommand, HwsReport},
    prim::{PrimReport, PrimVerb},
    t3i::{T3iStatus, T3iVerb},
};
use rcs_core::handshake::Lower;

use crate::{channels::HeaderPlace, proto::foxglove::Level};

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remark {
    pub level: Level,
    pub source: String, // a process, the cell, the recorder
    pub text: String,
    /// Source file of the decision table, or the code of an event such as `cell.dropped`; empty if there is neither.
    pub file: &'static str,
    pub line: u32, // of the decision table in its file, or 0
}

#[must_use]
pub fn remarks(
    headers: &[HeaderPlace],
    hws: &HwsCommand,
    before: &CommonMemory,
    after: &CommonMemory,
) -> Vec<Remark> {
    let mut said = Vec::new();
    commands(headers, hws, before, after, &mut said);
    encounters(headers, before, after, &mut said);
    link(headers, before, after, &mut said);
    failures(headers, hws, before, after, &mut said);
    said
}

fn commands(
    headers: &[HeaderPlace],
    hws: &HwsCommand,
    before: &CommonMemory,
    after: &CommonMemory,
    said: &mut Vec<Remark>,
) {
    let mut say = |level, field: &str, text: String| {
        let source = name_of(headers, field);
        said.push(Remark { level, source, text, ..Remark::default() });
    };
    let (was, is) = (&before.task.status, &after.task.status);
    if was.echo != is.echo {
        say(Level::Info, "task", format!("command {}: {}", is.echo, hws.in_words()));
    }
    if was.echo != is.echo && after.task.connection == Connection::Interrupted {
        let text = "STARTUP was interrupted: the Data System receives nothing until it is sent again";
        say(Level::Warning, "task", text.to_owned());
    }
    if was.report != is.report && is.report != HwsReport::Idle {
        let level = if is.report == HwsReport::Error { Level::Error } else { Level::Info };
        say(level, "task", format!("command {}: {}{}", is.echo, is.report, is.unconfirmed.suffix()));
    }
    down(before, after, say);
}

/// Sensor events: the condition of a guarded move, an object, a gripper, the operator at the joystick box.
fn encounters(headers: &[HeaderPlace], before: &CommonMemory, after: &CommonMemory, said: &mut Vec<Remark>) {
    let mut say = |field: &str, text: String| {
        said.push(Remark { source: name_of(headers, field), text, ..Remark::default() });
    };
    let (was, is) = (before.prim.status.report, after.prim.status.report);
    let guarded = matches!(before.emove.prim.command, PrimVerb::GoUntil | PrimVerb::GoWhile);
    if was != is && (guarded || is == PrimReport::JoystickOn) {
        let (command, sensor) = (before.emove.prim.command, before.emove.prim.sensor.unwrap_or_default());
        match is {
            PrimReport::Done | PrimReport::DetectedErr | PrimReport::NotDetected => {
                say("prim", format!("{command} {sensor}: {is}"));
            }
            PrimReport::JoystickOn => say("prim", "the joystick box is on".to_owned()),
            _ => {}
        }
    }
    let (was, is) = (&before.subtask.status, &after.subtask.status);
    if let Some(remark) = holding(&was.held, &is.held) {
        say("subtask", remark);
    }
    match (was.end_effector_id, is.end_effector_id) {
        (Some(id), None) => say("subtask", format!("gripper {id} is off")),
        (was, Some(id)) if was != Some(id) => say("subtask", format!("gripper {id} is on")),
        _ => {}
    }
}

/// True if T3I has not yet read Prim's order to restart the link, during which faults are expected.
#[must_use]
pub fn is_restart_ordered(before: &CommonMemory) -> bool {
    let command = &before.prim.t3i;
    command.command == T3iVerb::Restart && command.number != before.t3i.status.echo
}

fn link(headers: &[HeaderPlace], before: &CommonMemory, after: &CommonMemory, said: &mut Vec<Remark>) {
    let mut say = |level, text: String| {
        said.push(Remark { level, source: name_of(headers, "t3i"), text, ..Remark::default() });
    };
    let (was, is) = (&before.t3i.status, &after.t3i.status);
    let ordered = is_restart_ordered(before);
    match (was.link_running, is.link_running) {
        (_, false) if ordered => {
            say(Level::Info, "the link to the robot starts again, as Prim has ordered".to_owned())
        }
        (false, true) => say(Level::Info, "the link to the robot runs".to_owned()),
        (true, false) => say(Level::Warning, "the link to the robot is lost".to_owned()),
        _ => {}
    }
    if let Some(trouble) = is.trouble().filter(|trouble| was.trouble() != Some(*trouble)) {
        say(Level::Warning, trouble.to_owned());
    }
    let counts = |status: &T3iStatus| {
        let counters = &status.counters;
        [
            (Level::Warning, "NAK", counters.naks),
            (Level::Warning, "frame without an answer", counters.timeouts),
            (Level::Warning, "report with a wrong checksum", counters.checksum_errors),
            (Level::Info, "re-start", counters.restarts),
        ]
    };
    for ((_, _, was), (level, what, is)) in counts(was).into_iter().zip(counts(is)) {
        if is > was && !(ordered && what == "re-start") {
            say(level, format!("{what}, {is} so far"));
        }
    }
    // Only the first limited point is reported, because a fast move is limited in every tick.
    if is.counters.limited > was.counters.limited && before.t3i.header.decided != after.t3i.header.decided {
        say(Level::Info, "the velocity limits hold a point back".to_owned());
    }
}

/// The processes whose commands show the progress of the job; commands of the others are details.
const FOLLOWED: [ProcessId; 3] = [ProcessId::Subtask, ProcessId::Emove, ProcessId::Pedestal];

/// A command to a lower process: `-> E-move: GRASP-OBJ LINKBAR1 at PFIXTURE`, except the points to T3I.
fn down(before: &CommonMemory, after: &CommonMemory, mut say: impl FnMut(Level, &str, String)) {
    for process in ProcessId::ALL.iter().copied().filter(|process| *process != ProcessId::T3i) {
        let Some(commander) = process.commander() else { continue };
        if before.command_number(process) != after.command_number(process)
            && let Some(text) = after.show_command(process, |command| format!("-> {process}: {command}"))
        {
            let level = if FOLLOWED.contains(&process) { Level::Info } else { Level::Debug };
            say(level, commander.field(), text);
        }
    }
}

fn failures(
    headers: &[HeaderPlace],
    hws: &HwsCommand,
    before: &CommonMemory,
    after: &CommonMemory,
    said: &mut Vec<Remark>,
) {
    for process in ProcessId::ALL.iter().copied() {
        let (was, is) = (before.said(process).fault, after.said(process).fault);
        if is != was && !is.is_none() {
            // T3I recovers from many faults of the link itself. A fault during PAUSE is reported together with `done`.
            let failed = after.said(process).lower == Lower::Error && !matches!(is, Fault::Link(_));
            let level = if failed { Level::Error } else { Level::Warning };
            let reason = format!("{}{}", is.text(), Detail::of(process, is, hws, after));
            said.push(failure(headers, process.field(), after.header(process), level, reason));
        }
    }
}

fn failure(headers: &[HeaderPlace], field: &str, header: &Header, level: Level, reason: String) -> Remark {
    let place = headers.iter().find(|place| place.field == field);
    let source = name_of(headers, field);
    match place.and_then(|place| place.fired(header)) {
        Some(fired) => Remark {
            level,
            source,
            text: format!("{reason} ({fired})"),
            file: fired.table.file,
            line: fired.table.line,
        },
        None => Remark { level, source, text: reason, ..Remark::default() },
    }
}

fn holding(was: &Holding, is: &Holding) -> Option<String> {
    match (was, is) {
        _ if was == is => None,
        (_, Holding::Object(held)) => Some(format!("holds {}", held.object)),
        (Holding::Object(held), Holding::Nothing) => Some(format!("no longer holds {}", held.object)),
        (_, Holding::Nothing) => Some("holds nothing".to_owned()),
        (_, Holding::Something) => Some("holds something unknown".to_owned()),
        (_, Holding::NotKnown) => Some("cannot tell whether anything is held".to_owned()),
    }
}

fn name_of(headers: &[HeaderPlace], field: &str) -> String {
    headers.iter().find(|place| place.field == field).map_or(field, |place| place.process.name).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::headers;
    use interfaces::{
        Decided, Reason, StatusReport,
        emove::ObjectGrip,
        grip::GripReport,
        jaws::{JawsReport, JawsVerb},
        pedestal::{PedestalReport, PedestalVerb, TableVerb},
    };
    use rcs_core::name::Name10;
    use rcs_core::name::Name16;

    #[test]
    fn command_is_reported_once() {
        let mut hws = HwsCommand { number: 1, source_sector: Some(1), ..HwsCommand::default() };
        hws.command = Name16::new("TRANSFER").unwrap();
        hws.object = Name16::new("LINKBAR1").ok();
        hws.source = Name16::new("UNIT_2").ok();
        hws.destination = Name16::new("PFIXTURE").ok();
        let before = CommonMemory::default();
        let mut after = before;
        after.task.status.echo = 1;
        let said = remarks(&headers(), &hws, &before, &after);
        assert_eq!(said.len(), 1, "{said:?}");
        assert_eq!(said[0].text, "command 1: TRANSFER LINKBAR1 from UNIT_2:1 to PFIXTURE");
        assert!(remarks(&headers(), &hws, &after, &after).is_empty());
    }

    #[test]
    fn commands_of_each_level_are_reported() {
        let before = CommonMemory::default();
        let mut after = before;
        after.emove.v_grip.number = 7;
        after.emove.v_grip.command = JawsVerb::Grasp;
        after.subtask.pedestal.number = 3;
        after.subtask.pedestal.command = PedestalVerb::Flip;
        after.pedestal.table.number = 5;
        after.pedestal.table.command = TableVerb::Turn;
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let told: Vec<_> = said.iter().map(|remark| (remark.source.as_str(), remark.text.as_str())).collect();
        assert_eq!(
            told,
            [
                ("E-move", "-> V-Grip: VG-GRASP"),
                ("Subtask", "-> Active Pedestal: FLIP by 0.0 degrees"),
                ("Active Pedestal", "-> Rotary Table: TURN to 0.0 degrees")
            ]
        );
    }

    #[test]
    fn command_after_an_interrupted_startup_reports_missing_updates() {
        let mut before = CommonMemory::default();
        before.task.connection = Connection::Interrupted;
        let mut after = before;
        after.task.status.echo = 2;
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let told: Vec<_> = said.iter().map(|remark| (remark.level, remark.text.as_str())).collect();
        let text = "STARTUP was interrupted: the Data System receives nothing until it is sent again";
        assert!(told.contains(&(Level::Warning, text)), "{told:?}");
        after.task.connection = Connection::Open;
        assert_eq!(remarks(&headers(), &HwsCommand::default(), &before, &after).len(), 1);
    }

    #[test]
    fn reason_with_done_is_a_warning() {
        let before = CommonMemory::default();
        let mut after = before;
        after.task.status.report = HwsReport::Finished;
        after.task.status.reason = Reason::LinkOff;
        let said = remarks(&headers(), &HwsCommand::default(), &after, &after);
        assert!(said.is_empty(), "{said:?}");
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let told: Vec<_> = said.iter().map(|remark| (remark.level, remark.text.as_str())).collect();
        assert!(told.contains(&(Level::Warning, Reason::LinkOff.text())), "{told:?}");
    }

    #[test]
    fn every_process_with_a_reason_is_reported() {
        let before = CommonMemory::default();
        let mut after = before;
        after.v_grip.status.reason = Reason::JawsStuck;
        after.tool_grip.status.reason = Reason::WrongGripper;
        after.pedestal.status.reason = Reason::TableStuck;
        after.hand.status.reason = Reason::GripTimeout;
        after.table.status.reason = Reason::TableStuck;
        after.v_grip.status.report = JawsReport::Stuck;
        after.tool_grip.status.report = JawsReport::Stuck;
        after.pedestal.status.report = PedestalReport::Error;
        after.hand.status.report = GripReport::Serror;
        after.table.status.report = PedestalReport::Error;
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let sources: Vec<_> = said.iter().map(|remark| remark.source.as_str()).collect();
        assert_eq!(sources, ["V-Grip", "Tool-Grip", "Active Pedestal", "Pedestal Hand", "Rotary Table"]);
        assert!(said.iter().all(|remark| remark.level == Level::Error));
    }

    #[test]
    fn sensor_events_of_the_robot_are_reported() {
        let mut before = CommonMemory::default();
        before.emove.prim.command = PrimVerb::GoUntil;
        before.emove.prim.sensor = Name10::new("TOUCH").ok();
        before.prim.status.report = PrimReport::Executing;
        let mut after = before;
        after.prim.status.report = PrimReport::Done;
        let held = ObjectGrip { object: Name16::new("LINKBAR1").unwrap(), grip: 1 };
        (after.subtask.status.held, after.subtask.status.end_effector_id) = (Holding::Object(held), Some(1));
        let texts = |before, after| {
            let said = remarks(&headers(), &HwsCommand::default(), before, after);
            said.into_iter().map(|remark| remark.text).collect::<Vec<_>>()
        };
        assert_eq!(texts(&before, &after), ["GO-UNTIL TOUCH: done", "holds LINKBAR1", "gripper 1 is on"]);
        let mut later = after;
        (later.subtask.status.held, later.subtask.status.end_effector_id) = (Holding::Nothing, None);
        later.prim.status.report = PrimReport::JoystickOn;
        assert_eq!(
            texts(&after, &later),
            ["the joystick box is on", "no longer holds LINKBAR1", "gripper 1 is off"]
        );
    }

    #[test]
    fn link_faults_are_reported() {
        let mut before = CommonMemory::default();
        before.t3i.status.link_running = true;
        before.t3i.status.counters.naks = 2;
        let mut after = before;
        after.t3i.status.link_running = false;
        after.t3i.status.counters.naks = 3;
        after.t3i.status.counters.restarts = 1;
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let told: Vec<_> = said.iter().map(|remark| (remark.level, remark.text.as_str())).collect();
        assert_eq!(
            told,
            [
                (Level::Warning, "the link to the robot is lost"),
                (Level::Warning, "NAK, 3 so far"),
                (Level::Info, "re-start, 1 so far")
            ]
        );
    }

    #[test]
    fn restart_ordered_by_prim_is_not_a_fault() {
        let mut before = CommonMemory::default();
        before.t3i.status.link_running = true;
        before.prim.t3i.command = T3iVerb::Restart;
        before.prim.t3i.number = 1;
        let mut after = before;
        (after.t3i.status.link_running, after.t3i.status.counters.restarts) = (false, 1);
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        let told: Vec<_> = said.iter().map(|remark| (remark.level, remark.text.as_str())).collect();
        assert_eq!(told, [(Level::Info, "the link to the robot starts again, as Prim has ordered")]);
        before.t3i.status.echo = 1;
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        assert_eq!(said[0].level, Level::Warning, "it was read before");
    }

    #[test]
    fn a_failure_names_its_row() {
        let before = CommonMemory::default();
        let mut after = before;
        after.subtask.status.reason = Reason::UnknownLocation;
        after.subtask.status.report = StatusReport::Error;
        after.subtask.header.decided = Some(Decided { table: 2, row: 5 });
        let said = remarks(&headers(), &HwsCommand::default(), &before, &after);
        assert_eq!(said.len(), 1, "{said:?}");
        assert_eq!(said[0].level, Level::Error);
        let row = "ACCEPT row 5: missing Location => Fail(UnknownLocation)";
        assert_eq!(said[0].text, format!("the location is not in the task data ({row})"));
        assert!(said[0].line > 0);
    }
}
