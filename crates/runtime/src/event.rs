//! Events of a run, as values with a code. Log, result and programs convert them to sentences.

use std::fmt;

use depc::warning::Warning;
use executive::{
    boards::Board,
    overrun::{Overrun, PUNCTUAL},
};
use neighbours::{
    mailbox::MailboxError,
    workstation::{
        self,
        player::{JobFailure, Retry, WaitReason},
    },
};
use plant::{CellEvent, t3::explained};
use record::Level;
use sessions::{data_system, network::NetEvent, pedestal, vision};

use closed_loop::{
    contacts::ContactEvent,
    field::{FieldChange, FieldEvent},
    truth::Confirmation,
};

#[derive(Debug)]
#[non_exhaustive]
pub enum Event {
    Cell(CellEvent), // an event in the cell; only prohibited contacts are events: [`Event::Contact`]
    Contact(ContactEvent), // two objects have a prohibited contact, or have separated
    LineFaults(Vec<&'static str>), // faults of these kinds have occurred on the line to the robot
    Link(&'static str), // the state of the line to the robot has changed
    RobotRefuses(Warning), // the caller's robot refuses a point, or reports a fault
    Network(NetEvent), // a neighbour has connected, disconnected or was refused
    DataBaseRefuses(String), // the Data System refuses a command, for this reason
    DataSystem(data_system::Remark), // remark from the connection to a Data System in another process
    Pedestal(pedestal::Remark), // remark from the connection to a pedestal in another process
    Vision(vision::Remark), // remark from the connection to a vision system in another process
    Retries(Retry),  // a failed command is sent again
    OperatorJobFailed(JobFailure), // the job of an operator has failed; the run continues
    CommandRefused(workstation::Refusal),
    CommandFailsCheck(String), // a command does not pass its check, for this reason; Task refuses it
    /// A line of the workstation controller for the cell is refused, for this reason.
    CellLineRefused(String),
    Untrue(Confirmation), // a confirmation that is false in the cell
    Field(FieldEvent),
    /// The status of the cell cannot be written for the workstation controller.
    CellStatusUnsent(MailboxError),
    HandedOver,        // the job has transferred the command to the workstation controller
    TakenBack,         // the workstation controller has disconnected, and the job continues
    Waits(WaitReason), // the job has begun to wait for an operator
    Resumed(String),   // the controller has started with the knowledge of an earlier run
    /// The journal cannot be written, for this reason; `None` when it is written again.
    Journal(Option<String>),
    /// Task data have been loaded during the run.
    Loaded {
        generation: u32,
        name: String,
    },
    Changed(String), // an external change of the run
    RealTime {
        verdict: String, // the settings that the system granted, and the system
        complete: bool,  // all were granted
    },
    BoardNotPunctual(Board),    // a board lacks some real-time settings
    Overrun(Overrun),           // slots of the 40 ms grid were skipped
    ViewerDisconnected(String), // the live view has disconnected a viewer, for this reason
    WentWrong(String), // at the end of a failed run: the first failure or a consequence, as a sentence
    UserStops, // the user stops the run, by a signal or by leaving the console that the run has started
    Stops,     // after skipped slots, the robot is brought to rest and the run ends
    Holds,     // after skipped slots, the robot holds
    Punctual,  // the ticks are on time again, and the robot continues
}

impl Event {
    /// Stable short name of the event's kind, such as `cell.dropped`.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Cell(event) => event.code(),
            Self::Contact(ContactEvent::Begins(_)) => "contact.begins",
            Self::Contact(ContactEvent::Ends(_)) => "contact.ends",
            Self::LineFaults(_) => "fault.line",
            Self::Link(_) => "link.trouble",
            Self::RobotRefuses(_) => "robot.refuses",
            Self::Network(event) => event.code(),
            Self::DataBaseRefuses(_) => "data-system.refuses",
            Self::DataSystem(remark) => remark.code(),
            Self::Pedestal(remark) => remark.code(),
            Self::Vision(remark) => remark.code(),
            Self::Retries(_) => "command.again",
            Self::OperatorJobFailed(_) => "operator.job-failed",
            Self::CommandRefused(_) => "command.refused",
            Self::CommandFailsCheck(_) => "command.check",
            Self::CellLineRefused(_) => "workstation.refused",
            Self::Field(event) => event.code(),
            Self::Untrue(confirmation) if confirmation.is_false() => "truth.false",
            Self::Untrue(_) => "truth.not-sensed",
            Self::CellStatusUnsent(_) => "workstation.unsent",
            Self::HandedOver => "command.handed-over",
            Self::TakenBack => "command.taken-back",
            Self::Waits(_) => "operator.awaited",
            Self::Resumed(_) => "run.resumed",
            Self::Journal(Some(_)) => "journal.trouble",
            Self::Journal(None) => "journal.back",
            Self::Loaded { .. } => "data.loaded",
            Self::Changed(_) => "run.changed",
            Self::RealTime { .. } => "time.granted",
            Self::BoardNotPunctual(_) => "time.board",
            Self::Overrun(_) => "time.overrun",
            Self::ViewerDisconnected(_) => "live.disconnected",
            Self::WentWrong(_) => "run.failed",
            Self::UserStops => "run.stopped",
            Self::Stops => "time.stops",
            Self::Holds => "time.holds",
            Self::Punctual => "time.punctual",
        }
    }

    /// Severity: damage in the cell is an error.
    #[must_use]
    pub fn level(&self) -> Level {
        match self {
            Self::Cell(CellEvent::Warning(_) | CellEvent::ViseStuck) | Self::RobotRefuses(_) => Level::Error,
            Self::Cell(event) if event.is_harm() => Level::Error,
            Self::Untrue(confirmation) if confirmation.is_false() => Level::Error,
            Self::Contact(_) | Self::CellStatusUnsent(_) | Self::Stops | Self::WentWrong(_) => Level::Error,
            Self::RealTime { complete: true, .. } => Level::Info,
            Self::Field(FieldEvent { what: FieldChange::Back(_) | FieldChange::Released, .. }) => Level::Info,
            Self::Network(NetEvent::Connected(_)) => Level::Info,
            Self::HandedOver | Self::TakenBack | Self::Loaded { .. } | Self::Changed(_) | Self::Punctual => {
                Level::Info
            }
            Self::UserStops | Self::Resumed(_) | Self::Journal(None) => Level::Info,
            _ => Level::Warning,
        }
    }

    /// Source of its line in the log. Injected faults have another source than their effects.
    #[must_use]
    pub fn source(&self) -> &'static str {
        match self {
            Self::Cell(CellEvent::FaultBegins { .. } | CellEvent::FaultEnds { .. }) | Self::LineFaults(_) => {
                "fault"
            }
            Self::Cell(_) | Self::Contact(_) => "cell",
            Self::CellLineRefused(_) | Self::CellStatusUnsent(_) | Self::Untrue(_) => "cell",
            Self::Field(_) => "field",
            Self::Link(_) => "T3I",
            Self::RobotRefuses(_) => "robot",
            Self::Network(_) => "network",
            Self::ViewerDisconnected(_) => "live",
            Self::DataBaseRefuses(_) | Self::DataSystem(_) => "Data System",
            Self::Pedestal(_) => "Active Pedestal",
            Self::Vision(_) => "vision",
            Self::Retries(_)
            | Self::OperatorJobFailed(_)
            | Self::CommandRefused(_)
            | Self::CommandFailsCheck(_)
            | Self::HandedOver
            | Self::TakenBack => "HWSC",
            Self::Waits(_) => "operator",
            Self::Changed(_) => "change",
            Self::Loaded { .. }
            | Self::Resumed(_)
            | Self::Journal(_)
            | Self::RealTime { .. }
            | Self::BoardNotPunctual(_)
            | Self::Overrun(_)
            | Self::UserStops
            | Self::WentWrong(_)
            | Self::Stops
            | Self::Holds
            | Self::Punctual => "executive",
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cell(event) => event.fmt(f),
            Self::Contact(event) => event.fmt(f),
            Self::LineFaults(kinds) => write!(f, "on the line: {}", kinds.join(", ")),
            Self::Link(trouble) => f.write_str(trouble),
            Self::RobotRefuses(warning) => {
                write!(f, "the robot does not accept the commanded position: {}", explained(*warning))
            }
            Self::Network(event) => event.fmt(f),
            Self::DataBaseRefuses(why) => write!(f, "the Data System refuses: {why}"),
            Self::DataSystem(remark) => remark.fmt(f),
            Self::Pedestal(remark) => remark.fmt(f),
            Self::Vision(remark) => remark.fmt(f),
            Self::Retries(retry) => retry.fmt(f),
            Self::OperatorJobFailed(failure) => write!(f, "the job of the operator has failed: {failure}"),
            Self::CommandRefused(refusal) => write!(f, "a command is refused: {refusal}"),
            Self::CommandFailsCheck(why) => write!(f, "a command does not pass its check: {why}"),
            Self::Field(event) => event.fmt(f),
            Self::Untrue(confirmation) => confirmation.fmt(f),
            Self::CellLineRefused(why) => write!(f, "a line of the workstation is refused: {why}"),
            Self::CellStatusUnsent(error) => error.fmt(f),
            Self::HandedOver => f.write_str("the workstation controller commands from here on"),
            Self::TakenBack => f.write_str("the workstation controller has gone; the job continues"),
            Self::Loaded { generation, name } => {
                write!(f, "task data, generation {generation}: {name} is loaded")
            }
            Self::Resumed(knowledge) => write!(f, "resumed: {knowledge}"),
            Self::Journal(Some(why)) => {
                write!(
                    f,
                    "the journal is not written: {why}; after a loss of power the run cannot be resumed from here"
                )
            }
            Self::Journal(None) => f.write_str("the journal is written again"),
            Self::Waits(reason) => reason.fmt(f),
            Self::Changed(what) => f.write_str(what),
            Self::RealTime { verdict, .. } => write!(f, "real time: {verdict}"),
            Self::BoardNotPunctual(board) => {
                write!(f, "{board}: not everything that real time needs was granted")
            }
            Self::Overrun(overrun) => overrun.fmt(f),
            Self::ViewerDisconnected(why) => write!(f, "live view: {why}"),
            Self::WentWrong(sentence) => f.write_str(sentence),
            Self::UserStops => {
                f.write_str("the user stops the run: the robot ramps to rest, then the run ends")
            }
            Self::Stops => f.write_str("the robot is brought to rest, and the run ends"),
            Self::Holds => write!(f, "the robot holds until {PUNCTUAL} ticks in a row were punctual"),
            Self::Punctual => f.write_str("punctual again: the robot continues"),
        }
    }
}

impl From<data_system::Remark> for Event {
    fn from(remark: data_system::Remark) -> Self {
        match remark {
            data_system::Remark::Network(event) => Self::Network(event),
            own => Self::DataSystem(own),
        }
    }
}

impl From<pedestal::Remark> for Event {
    fn from(remark: pedestal::Remark) -> Self {
        match remark {
            pedestal::Remark::Network(event) => Self::Network(event),
            own => Self::Pedestal(own),
        }
    }
}

impl From<vision::Remark> for Event {
    fn from(remark: vision::Remark) -> Self {
        match remark {
            vision::Remark::Network(event) => Self::Network(event),
            own => Self::Vision(own),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sessions::network::Role;

    #[test]
    fn event_has_code_severity_source_and_sentence() {
        let fell = Event::Cell(CellEvent::Fell { part: "SHAFT".to_owned() });
        assert_eq!((fell.code(), fell.level(), fell.source()), ("cell.fell", Level::Error, "cell"));
        assert_eq!(fell.to_string(), "SHAFT lies on the floor");
        let planned = Event::Cell(CellEvent::FaultBegins { number: 1, text: "the air is lost".to_owned() });
        assert_eq!(
            (planned.code(), planned.level(), planned.source()),
            ("fault.begins", Level::Warning, "fault")
        );
        let come = Event::from(pedestal::Remark::Network(NetEvent::Connected(Role::Pedestal)));
        assert_eq!((come.code(), come.level(), come.source()), ("network.connected", Level::Info, "network"));
        let silent = Event::from(pedestal::Remark::Silent(3));
        assert_eq!((silent.code(), silent.level()), ("pedestal.silent", Level::Warning));
        assert_eq!(silent.source(), "Active Pedestal");
        assert_eq!(Event::Stops.level(), Level::Error);
    }
}
