//! Decision tables of T3I: commands from Prim, reports of the robot controller, supervision of the robot, rows common
//! to all commands, and one file per command.

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

/// What a new POINT is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Point {
    /// It is the next in order, and the line can carry its frame.
    Next,
    /// A number was left out: a point is missing, and the path would have a jump.
    Gap,
    /// The frame is none, or has no words on the line.
    Unsendable,
    /// The queue is full.
    Full,
}

/// The link, as a precondition of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iLink {
    /// It runs.
    Running,
    /// No report has come yet.
    Starting,
    /// It has failed since the last RESTART.
    Failed,
}

/// The controller's DTR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Dtr {
    /// It is on, or this end of the line has stopped in the middle of a frame and does not look.
    On,
    /// The controller does not run its DEPC function, or is not there.
    Off,
}

/// The start of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LinkStart {
    /// It goes on, or is over.
    Over,
    /// The link was lost in this tick, or is to be restarted.
    Begun,
    /// A report has come in this tick.
    Reported,
}

/// The words with which a report is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Words {
    /// No position was ever sent.
    Nothing,
    /// Those of the position that was sent last and of the one before.
    Sent,
}

/// The position of the last report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Reported {
    /// No word is more than 2 counts beside the way from the words before to the last ones.
    Near,
    /// A word is.
    Far,
}

/// What was sent in the tick before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Before {
    /// Nothing that counts.
    Nothing,
    /// A point, or a part of the way to it.
    Point,
    /// A reported position that is not that of the last words, without an error to report.
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
    /// It is not.
    Far,
}

/// The time that the resolvers have to come near a reported position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grace {
    /// It is not over.
    Running,
    /// It is over.
    Over,
}

/// What there is to report as an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trouble {
    /// Nothing.
    None,
    /// The robot has left its path.
    OffPath,
    /// A command was refused.
    Refusal,
    /// The link has failed since the last RESTART.
    Fault,
}

/// What the line can take in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iLine {
    /// No position is known: nothing but a restart.
    Down,
    /// A frame is outstanding.
    Busy,
    /// A frame.
    Free,
}

/// Does Prim work?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iCommander {
    /// It has run in the last tick.
    Live,
    /// It is held, dormant or lost.
    Still,
}

/// Points that wait, before this tick's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PointQueue {
    /// None: the output is the goal.
    Empty,
    /// One: another may come.
    One,
    /// More than one: none may come.
    More,
}

/// The position to send on the way to the oldest point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum NextPosition {
    /// It has words on the line.
    Sendable,
    /// It has none, or nothing is to be sent.
    Unsendable,
}

/// What is in the command buffer, for [`receive::RECEIVE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Is it new?
    pub arrival: Arrival,
    /// The command.
    pub command: T3iVerb,
    /// The point of a POINT.
    pub point: Point,
    /// The link.
    pub link: T3iLink,
}

/// The state variables of [`report::REPORT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Answer {
    /// The controller's DTR.
    pub dtr: Dtr,
    /// The start of the link.
    pub start: LinkStart,
    /// What a report is compared with.
    pub words: Words,
    /// The report.
    pub place: Reported,
    /// What was sent in the tick before.
    pub before: Before,
}

/// The state variables of [`follow::FOLLOW`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Feedback {
    /// A RESTART of Prim.
    pub restart: Restarting,
    /// The resolvers and the path.
    pub place: Followed,
    /// The time for a reported position.
    pub grace: Grace,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// What there is to report as an error.
    pub trouble: Trouble,
    /// The line.
    pub line: T3iLine,
    /// Prim.
    pub prim: T3iCommander,
    /// The queue.
    pub queue: PointQueue,
    /// The way to the oldest point.
    pub way: NextPosition,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What is in the command buffer.
    pub request: Request,
    /// What came from the robot controller.
    pub answer: Answer,
    /// What the resolvers say.
    pub feedback: Feedback,
    /// Tool frame of the resolvers.
    pub resolvers: WireFrame,
    /// The command.
    pub command: T3iCommand,
    /// Does Prim work?
    pub prim: T3iCommander,
    /// The line.
    pub line: T3iLine,
    /// As far as the limits allow towards the oldest point, the new one included.
    pub advance: Option<Advance>,
}

/// What a row can ask for; each with the report to Prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing goes out, or what the link itself has to repeat.
    Nothing(T3iReport),
    /// A restart goes out.
    Restart(T3iReport),
    /// The last position once more, so that the loss of the link is noticed.
    Repeat(T3iReport),
    /// The next point, or as much of the way to it as the limits allow.
    Advance(T3iReport),
    /// The last position once more. The queue is emptied, and the command counts as invalid from now on.
    Refuse(T3iReport),
}

commands! {
    /// Consult the tables of a command.
    pub fn of_command(T3iVerb, enum Step, Situation) -> Action {
        others: receive::RECEIVE, report::REPORT, follow::FOLLOW, trouble::TROUBLE;
        None | Pause: goals::REST   => trouble::trouble then pause::pause;
        Restart: goals::RESTARTED   => trouble::trouble then restart::restart;
        Point: goals::SENT          => trouble::trouble then point::point;
    }
}
