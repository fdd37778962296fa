//! The ladder (VI.6): one line per process and per neighbour, with command, status and row.

use closed_loop::failure;
use interfaces::{CommonMemory, CommonStatus, Header, ProcessId, device::VisionStatus, for_each_process};
use levels::ladder::Ladder;
use rcs_core::{handshake::Lower, table::Fired, tick::TICK_S};

use super::Tone;
use crate::rcs_console::{
    picture::{Absence, Picture},
    story::{self, Story},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    Process(ProcessId),
    /// The workstation controller: its command to Task, and Task's status.
    Workstation,
    /// The Data System: its request and its answer.
    DataSystem,
    /// The vision system: its request and its answer.
    Vision,
    /// The robot controller at the other end of the link.
    Robot,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    Level,
    /// A process or neighbour at the same level, with others after it.
    Beside,
    /// The last process or neighbour at the same level.
    Last,
    /// A process below one that is not the last at its level.
    Below,
    /// A process below one that is the last at its level.
    LastBelow,
}

const LINES: [(Branch, Item); 16] = [
    (Branch::Level, Item::Workstation),
    (Branch::Level, Item::Process(ProcessId::Task)),
    (Branch::Last, Item::DataSystem),
    (Branch::Level, Item::Process(ProcessId::Subtask)),
    (Branch::Last, Item::Process(ProcessId::Pedestal)),
    (Branch::Below, Item::Process(ProcessId::Hand)),
    (Branch::LastBelow, Item::Process(ProcessId::RotaryTable)),
    (Branch::Level, Item::Process(ProcessId::Emove)),
    (Branch::Beside, Item::Vision),
    (Branch::Beside, Item::Process(ProcessId::QuickChange)),
    (Branch::Beside, Item::Process(ProcessId::Grip)),
    (Branch::Beside, Item::Process(ProcessId::VGrip)),
    (Branch::Last, Item::Process(ProcessId::ToolGrip)),
    (Branch::Level, Item::Process(ProcessId::Prim)),
    (Branch::Level, Item::Process(ProcessId::T3i)),
    (Branch::Level, Item::Robot),
];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// The process reports a failure or an error.
    pub trouble: bool,
    /// The process detected the first failure.
    pub cause: bool,
    /// The process was not executed, or the neighbour sent no data.
    pub absent: bool,
    /// The process controls the gripper on the robot.
    pub on: bool,
    /// The line differs from the previous picture.
    pub changed: bool,
}

impl Mark {
    #[must_use]
    pub const fn tone(&self) -> Tone {
        match self {
            Self { trouble: true, .. } => Tone::Trouble,
            Self { absent: true, .. } => Tone::Faint,
            Self { changed: true, .. } => Tone::Marked,
            _ => Tone::Plain,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    pub item: Item,
    pub branch: Branch,
    pub mark: Mark,
    pub name: &'static str,
    pub command: String,     // in the manual's spelling; empty for none
    pub number: Option<u32>, // of the command, if any
    pub status: String,
    pub echo: Option<u32>, // of the command to which the status belongs
    pub row: String,
    pub text: String,     // of the row, in the manual's spelling
    pub age: Option<f64>, // since the row fired; `None` for a row of this tick
}

/// The ladder of a picture. `last` is the previous picture on the screen.
#[must_use]
pub fn lines(picture: &Picture, last: Option<&Picture>, story: &Story) -> Vec<Line> {
    let (cause, cause_before) = (cause(picture, story), last.and_then(|last| cause(last, story)));
    let line = |(branch, item)| {
        let mut line = line(branch, item, picture, cause);
        line.mark.changed = last.is_some_and(|last| {
            let was = self::line(branch, item, last, cause_before);
            let key = |line: &Line| (line.number, line.status.clone(), line.row.clone());
            match item {
                // T3 Interface gets a new command in every tick.
                Item::Process(ProcessId::T3i) => {
                    (was.status, was.row) != (line.status.clone(), line.row.clone())
                }
                Item::Robot => was.row != line.row,
                _ => key(&was) != key(&line),
            }
        });
        line
    };
    LINES.into_iter().map(line).collect()
}

/// The process that detected the first failure, if any did.
fn cause(picture: &Picture, story: &Story) -> Option<ProcessId> {
    match (story.failure(picture.tick.0), story.present_trouble(picture)) {
        (Some(failure), _) => story::process_named(&failure.process),
        (None, Some(trouble)) => story::process_named(&trouble.failure.process),
        (None, None) => None,
    }
}

fn line(branch: Branch, item: Item, picture: &Picture, cause: Option<ProcessId>) -> Line {
    match item {
        Item::Process(process) => process_line(branch, process, picture, cause),
        Item::Workstation => workstation(branch, picture),
        Item::DataSystem => data_system(branch, picture),
        Item::Vision => vision(branch, picture),
        Item::Robot => robot(branch, picture),
    }
}

fn process_line(branch: Branch, process: ProcessId, picture: &Picture, cause: Option<ProcessId>) -> Line {
    let info = &Ladder::processes()[process.position()];
    let (header, said) = (picture.memory.header(process), picture.memory.said(process));
    let absence = picture.absence(process);
    let fired = info.fired(header);
    let command = picture.command(process);
    let status = match absence {
        None => format!("{}{}", said.report, said.unconfirmed.suffix()),
        Some(absence @ Absence::Elsewhere) => format!("{} {}", said.report, absence.text()),
        Some(absence) => absence.text().to_owned(),
    };
    Line {
        item: Item::Process(process),
        branch,
        mark: Mark {
            trouble: said.lower == Lower::Error || !said.fault.is_none(),
            cause: cause == Some(process),
            absent: absence.is_some(),
            on: gripper_on(picture) == Some(process),
            changed: false,
        },
        name: info.name,
        number: (!command.is_empty()).then(|| picture.command_number(process)),
        command,
        status,
        echo: Some(echo(&picture.memory, process)),
        row: fired.map_or_else(String::new, |fired| format!("{} {}", fired.table.name, fired.row.number)),
        text: row_text(&said, fired),
        age: age(header),
    }
}

/// The row that fired. The unconfirmed goals of a finished command precede it.
fn row_text(said: &CommonStatus, fired: Option<Fired>) -> String {
    let row = fired.map_or_else(String::new, |fired| fired.text().to_string());
    if said.unconfirmed.is_none() { row } else { format!("unconfirmed: {}; {row}", said.unconfirmed) }
}

/// Seconds since the row fired; `None` if it fired in this tick, or at an unknown time.
fn age(header: &Header) -> Option<f64> {
    let ticks = header.age().filter(|ticks| *ticks > 0)?;
    Some(ticks as f64 * TICK_S)
}

fn gripper_on(picture: &Picture) -> Option<ProcessId> {
    match picture.memory.quick_change.status.end_effector_id? {
        1 => Some(ProcessId::Grip),
        2 => Some(ProcessId::VGrip),
        3 => Some(ProcessId::ToolGrip),
        _ => None,
    }
}

/// The line of a neighbour, without row and age.
fn neighbour_line(branch: Branch, item: Item, name: &'static str) -> Line {
    Line {
        item,
        branch,
        mark: Mark::default(),
        name,
        command: String::new(),
        number: None,
        status: String::new(),
        echo: None,
        row: String::new(),
        text: String::new(),
        age: None,
    }
}

fn workstation(branch: Branch, picture: &Picture) -> Line {
    let (hws, status) = (&picture.external.hws, &picture.memory.task.status);
    Line {
        mark: Mark { trouble: status.report.lower() == Lower::Error, ..Mark::default() },
        command: hws.to_string(),
        number: Some(hws.number),
        status: format!("{}{}", status.report, status.unconfirmed.suffix()),
        echo: Some(status.echo),
        ..neighbour_line(branch, Item::Workstation, "Workstation")
    }
}

fn data_system(branch: Branch, picture: &Picture) -> Line {
    let (asked, answer) = (&picture.memory.task.data_base, &picture.external.data_base);
    let line = neighbour_line(branch, Item::DataSystem, "Data System");
    if asked.number == 0 {
        return Line { status: "not asked".to_owned(), ..line };
    }
    Line {
        mark: Mark { trouble: answer.report.lower() == Lower::Error, ..Mark::default() },
        command: format!("{} {}", asked.command, asked.item).trim_end().to_owned(),
        number: Some(asked.number),
        status: answer.report.text().to_owned(),
        echo: Some(answer.echo),
        ..line
    }
}

fn vision(branch: Branch, picture: &Picture) -> Line {
    let (asked, answer) = (&picture.memory.emove.vision, &picture.external.devices.vision);
    let line = neighbour_line(branch, Item::Vision, "Vision");
    if asked.number == 0 {
        return Line { status: "not asked".to_owned(), ..line };
    }
    let failed = matches!(answer.status, VisionStatus::NothingSeen | VisionStatus::NotRecognised);
    Line {
        mark: Mark { trouble: failed, ..Mark::default() },
        command: format!("{}, object {}", asked.picture, asked.object_id),
        number: Some(asked.number),
        status: answer.status.text().to_owned(),
        echo: Some(answer.echo),
        ..line
    }
}

fn robot(branch: Branch, picture: &Picture) -> Line {
    let status = &picture.memory.t3i.status;
    let link = match (status.link_running, status.controller_ready) {
        (true, _) => "link runs",
        (false, true) => "link down",
        (false, false) => "DTR off",
    };
    Line {
        mark: Mark { trouble: status.trouble().is_some(), ..Mark::default() },
        command: format!("{} sent, {} answered", status.counters.frames, status.counters.acknowledged),
        status: link.to_owned(),
        row: link.to_owned(),
        text: status.trouble().unwrap_or_default().to_owned(),
        ..neighbour_line(branch, Item::Robot, "Robot")
    }
}

/// The process that is `by` lines below or above another one.
#[must_use]
pub fn neighbour(process: ProcessId, by: usize, down: bool) -> ProcessId {
    let processes = || {
        LINES.iter().filter_map(|(_, item)| match item {
            Item::Process(process) => Some(*process),
            _ => None,
        })
    };
    let at = processes().position(|other| other == process).unwrap_or_default();
    let wanted = if down { at + by } else { at.saturating_sub(by) };
    processes().take(wanted + 1).last().unwrap_or(process)
}

/// The action of the process at the cursor and its reason, one sentence each.
#[must_use]
pub fn explanation(process: ProcessId, picture: &Picture, story: &Story) -> [String; 2] {
    let line = process_line(Branch::Level, process, picture, None);
    let row = match (line.row.as_str(), line.text.as_str()) {
        ("", _) => "no row has decided yet".to_owned(),
        (row, text) => format!("{row}: {text}"),
    };
    let first = format!("{}: {row}", line.name);
    let present = || story.present_trouble(picture).map(|trouble| trouble.failure.clone());
    let second = match (story.failure(picture.tick.0).or_else(present), picture.fault(process)) {
        (Some(failure), _) => format!("TROUBLE since tick {}: {}", failure.tick, failure.text),
        (None, Some(fault)) => format!("TROUBLE: {}", fault.text()),
        (None, None) => match line.command.as_str() {
            "" => "no command".to_owned(),
            command => format!("command {}: {command}", picture.command_number(process)),
        },
    };
    [first, second]
}

/// Possible causes of a failure that no process reports: the commands in progress.
#[must_use]
pub fn present_commands(picture: &Picture) -> String {
    failure::present_commands(Ladder::processes(), &picture.external.hws, &picture.memory)
}

macro_rules! echoes {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        #[must_use]
        pub const fn echo(memory: &CommonMemory, process: ProcessId) -> u32 {
            match process { $( ProcessId::$id => memory.$field.status.echo, )+ }
        }
    };
}
for_each_process!(echoes);

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{ExternalInputs, Reason};
    use rcs_core::tick::Tick;

    fn picture() -> Picture {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        Picture { tick: Tick(0), external, memory, timing: None }
    }

    #[test]
    fn every_process_has_one_line() {
        for process in ProcessId::ALL {
            let lines = LINES.iter().filter(|(_, item)| *item == Item::Process(*process));
            assert_eq!(lines.count(), 1, "{process}");
        }
    }

    #[test]
    fn cursor_stops_at_both_ends() {
        assert_eq!(neighbour(ProcessId::Task, 1, false), ProcessId::Task);
        assert_eq!(neighbour(ProcessId::Task, 1, true), ProcessId::Subtask);
        assert_eq!(neighbour(ProcessId::T3i, 3, true), ProcessId::T3i);
    }

    #[test]
    fn cause_is_marked_and_processes_above_are_in_trouble() {
        let mut story = Story::new(usize::MAX);
        let mut now = picture();
        let changes: [fn(&mut CommonMemory); 3] = [
            |memory| memory.emove.status.reason = Reason::NothingSeen,
            |memory| memory.subtask.status.reason = Reason::NothingSeen,
            |memory| memory.task.status.reason = Reason::NothingSeen,
        ];
        for change in changes {
            let before = now.clone();
            now.tick = before.tick.next();
            change(&mut now.memory);
            story.note(&before, &now);
        }
        let lines = lines(&now, None, &story);
        let marks =
            |wanted| lines.iter().find(|line| line.item == Item::Process(wanted)).map(|line| line.mark);
        let cause = marks(ProcessId::Emove).expect("E-move has a line");
        assert!(cause.trouble && cause.cause);
        let above = marks(ProcessId::Subtask).expect("Subtask has a line");
        assert!(above.trouble && !above.cause);
        assert!(!marks(ProcessId::Grip).expect("Grip has a line").trouble);
        assert!(
            explanation(ProcessId::Prim, &now, &story)[1]
                .contains("since tick 1: E-move: vision sees no object")
        );
    }

    #[test]
    fn changes_since_the_last_picture_are_marked() {
        let (was, mut is) = (picture(), picture());
        is.memory.task.subtask.number = 4;
        is.memory.t3i.status.counters.frames = 9;
        is.memory.prim.t3i.number = 9;
        let lines = lines(&is, Some(&was), &Story::new(usize::MAX));
        let changed: Vec<_> = lines.iter().filter(|line| line.mark.changed).map(|line| line.name).collect();
        assert_eq!(changed, Vec::<&str>::new(), "a number without a command is not shown");
        is.memory.task.subtask.command = interfaces::subtask::SubtaskVerb::GetObject;
        let lines = self::lines(&is, Some(&was), &Story::new(usize::MAX));
        let changed: Vec<_> = lines.iter().filter(|line| line.mark.changed).map(|line| line.name).collect();
        assert_eq!(changed, ["Subtask"]);
    }
}
