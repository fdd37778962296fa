//! Decision tables of T3I: commands from Prim, reports of the robot controller, supervision of the robot, rows
//! common to all commands, and one file per command.

pub mod follow;
pub mod pause;
pub mod point;
pub mod receive;
pub mod report;
pub mod restart;
pub mod trouble;

use super::goals;
use depc::step::Step as Advance;
use geometry::pose::WireFrame;
use interfaces::t3i::{T3iCommand, T3iReport, T3iVerb};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

/// The check of a new POINT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Point {
    /// The point is the next in order, and the line can carry its frame.
    Next,
    /// A number is missing: the path would have a jump.
    Gap,
    /// The frame is not valid, or cannot be expressed in words on the line.
    Unsendable,
    /// The queue is full.
    Full,
}

/// The link, as a precondition of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iLink {
    /// The link runs.
    Running,
    /// The controller has not reported its position yet.
    Starting,
    /// The link has failed since the last RESTART.
    Failed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Dtr {
    /// DTR is on, or is not checked because this end of the line has stopped in the middle of a frame.
    On,
    /// The controller does not run its DEPC function, or is not connected.
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LinkStart {
    /// The start is in progress or over.
    Over,
    /// The link was lost in this tick, or is to be restarted.
    Begun,
    /// A report was received in this tick.
    Reported,
}

/// The words with which a report is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Words {
    /// No position was ever sent.
    Nothing,
    /// The words of the last position sent and of the one before.
    Sent,
}

/// The position of the last report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Reported {
    /// Every word is within 2 counts of the way from the previous words to the last ones.
    Near,
    /// A word is farther away.
    Far,
}

/// The output of the previous tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Before {
    /// Nothing relevant.
    Nothing,
    /// A point, or a step towards it.
    Point,
    /// A repeated reported position other than the last words, without an error to report.
    Repeated,
}

/// A RESTART, for [`follow::FOLLOW`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Restarting {
    /// Prim has sent none in this tick.
    Before,
    /// Prim has sent one in this tick.
    Asked,
}

/// The resolvers and the path of the expected lag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Followed {
    /// The link does not run, or the resolvers are not valid.
    Unknown,
    /// The robot is within the limit of the path.
    Near,
    /// The robot is beyond the limit.
    Far,
}

/// The time in which the resolvers must come near a reported position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grace {
    /// The time is running.
    Running,
    /// The time is over.
    Over,
}

/// The error to report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trouble {
    /// No error to report.
    None,
    /// The robot has left its path.
    OffPath,
    /// A command was refused.
    Refusal,
    /// The link has failed since the last RESTART.
    Fault,
}

/// The state of the line in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iLine {
    /// No position is known, so only a restart can be sent.
    Down,
    /// A frame is outstanding.
    Busy,
    /// A frame can be sent.
    Free,
}

/// Whether Prim is active.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iCommander {
    /// Prim ran in the previous tick.
    Live,
    /// Prim is held, dormant or lost.
    Still,
}

/// Waiting points, before this tick's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PointQueue {
    /// No point: the output is the goal.
    Empty,
    /// One point: another may be sent.
    One,
    /// More than one point: no other may be sent.
    More,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum NextPosition {
    /// The position can be expressed in words on the line.
    Sendable,
    /// The position cannot be expressed in words, or none is to be sent.
    Unsendable,
}

/// The command buffer, for [`receive::RECEIVE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub arrival: Arrival,
    /// The command.
    pub command: T3iVerb,
    /// The point of a POINT.
    pub point: Point,
    /// The link.
    pub link: T3iLink,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Answer {
    /// The controller's DTR.
    pub dtr: Dtr,
    /// The start of the link.
    pub start: LinkStart,
    /// The words with which a report is compared.
    pub words: Words,
    /// The report.
    pub place: Reported,
    /// The output of the previous tick.
    pub before: Before,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Feedback {
    /// A RESTART of Prim.
    pub restart: Restarting,
    /// The resolvers, compared with the path.
    pub place: Followed,
    /// The time limit for a reported position.
    pub grace: Grace,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The error to report.
    pub trouble: Trouble,
    /// The line.
    pub line: T3iLine,
    /// Prim.
    pub prim: T3iCommander,
    /// The queue.
    pub queue: PointQueue,
    /// The next position on the way to the oldest point.
    pub way: NextPosition,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub request: Request,
    /// The answer of the robot controller.
    pub answer: Answer,
    /// The resolvers, compared with the path.
    pub feedback: Feedback,
    /// Tool frame of the resolvers.
    pub resolvers: WireFrame,
    pub command: T3iCommand,
    /// Whether Prim is active.
    pub prim: T3iCommander,
    pub line: T3iLine,
    /// The next step within the limits towards the oldest point, the new one included.
    pub advance: Option<Advance>,
}

/// The actions of T3I; each with the report to Prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Send nothing, or only what the link itself has to repeat.
    Nothing(T3iReport),
    /// Send a restart.
    Restart(T3iReport),
    /// Send the last position again, so that a loss of the link is detected.
    Repeat(T3iReport),
    /// Send the next point, or a step towards it within the limits.
    Advance(T3iReport),
    /// Send the last position again. The queue is emptied, and the command is invalid from now on.
    Refuse(T3iReport),
}

commands! {
    pub fn of_command(T3iVerb, enum Step, Situation) -> Action {
        others: receive::RECEIVE, report::REPORT, follow::FOLLOW, trouble::TROUBLE;
        None | Pause: goals::REST   => trouble::trouble then pause::pause;
        Restart: goals::RESTARTED   => trouble::trouble then restart::restart;
        Point: goals::SENT          => trouble::trouble then point::point;
    }
}
