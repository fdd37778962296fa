//! Decision tables of T3I: one for what comes from Prim, and one for each command.

use rcs_core::{
    Plain,
    handshake::Arrival,
    interface::t3i::{T3iReport, T3iVerb},
    old_table,
    table::Table,
};

/// What a new POINT is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Order {
    /// The next in order, with a frame that the line can carry.
    Next,
    /// A number was left out: a point is missing, and the path would have a jump.
    Gap,
    /// The frame is none, or has no words on the line, or the queue is full.
    Unusable,
}

/// The link, as a precondition of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Link {
    /// It runs.
    Running,
    /// No report has come yet.
    Starting,
    /// It has failed since the last RESTART.
    Failed,
}

/// Whether a command was refused and no RESTART or PAUSE has come since.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Refusal {
    /// No.
    None,
    /// Yes: `status-arg-out` 5.
    Refused,
}

/// What to do with the command in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Intake {
    /// Go on with the current command.
    Keep,
    /// Empty the queue, forget all faults, and begin the link again.
    Restart,
    /// Empty the queue.
    Pause,
    /// Append the point to the queue.
    Append,
    /// Leave the point out; the reason is already reported.
    Ignore,
    /// Empty the queue and report an invalid command.
    Refuse,
}

old_table! {
    /// What comes from Prim (VI.1.1). A refusal lasts until RESTART or PAUSE, because the next point is already on its way
    /// when Prim reads of it; a failed link until RESTART.
    pub RECEIVE: fn receive(arrival: Arrival, command: T3iVerb, order: Order, link: Link, refusal: Refusal)
        -> (Intake, Refusal)
    {
        //    arrival     command   order            link                refusal    intake    refusal
        1: ( Nothing   , _       , _              , _                 , _       ) => Keep    , None    ;
        2: ( Restarted , _       , _              , _                 , _       ) => Keep    , Refused ;
        3: ( New       , Restart , _              , _                 , _       ) => Restart , None    ;
        4: ( New       , Pause   , _              , _                 , _       ) => Pause   , None    ;
        5: ( New       , Point   , _              , _                 , Refused ) => Ignore  , Refused ;
        6: ( New       , Point   , _              , Failed            , None    ) => Ignore  , None    ;
        7: ( New       , Point   , _              , Starting          , None    ) => Refuse  , Refused ;
        8: ( New       , Point   , Gap | Unusable , Running           , None    ) => Refuse  , Refused ;
        9: ( New       , Point   , Next           , Running           , None    ) => Append  , None    ;
       10: ( New       , None    , _              , _                 , _       ) => Refuse  , Refused ;
       11: ( Same      , _       , _              , _                 , None    ) => Keep    , None    ;
       12: ( Same      , _       , _              , _                 , Refused ) => Keep    , Refused ;
    }
}

/// Whether there is something to report as an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trouble {
    /// No.
    None,
    /// A refused command or a failed link.
    Some,
}

/// What the line can take in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Line {
    /// No position is known: nothing but a restart.
    Down,
    /// A frame is outstanding.
    Busy,
    /// A frame.
    Free,
}

/// Whether Prim works.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Above {
    /// It has run in the last tick.
    Live,
    /// It is held, dormant or lost.
    Still,
}

/// Points that wait, before this tick's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Queue {
    /// None: the output is the goal.
    Empty,
    /// One: another may come.
    One,
    /// More than one: none may come.
    More,
}

/// Whether the command came in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Phase {
    /// In an earlier one.
    Going,
    /// In this one.
    Begun,
}

/// What goes out on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Output {
    /// Nothing, or what the link itself has to repeat.
    Nothing,
    /// A restart.
    Restart,
    /// The last position once more, so that the loss of the link is noticed.
    Repeat,
    /// The next point, or as much of the way to it as the limits allow.
    Advance,
}

old_table! {
    /// RESTART (VI.1.1): begin the link again and wait for the report.
    pub RESTART: fn restart(phase: Phase, trouble: Trouble, line: Line) -> (Output, T3iReport) {
        //   phase   trouble  line      output    report
        1: ( Begun , _      , _    ) => Restart , Executing ;
        2: ( Going , None   , Down ) => Nothing , Executing ;
        3: ( Going , None   , Busy ) => Nothing , Finished  ;
        4: ( Going , None   , Free ) => Repeat  , Finished  ;
        5: ( Going , Some   , Down ) => Nothing , Error     ;
        6: ( Going , Some   , Busy ) => Nothing , Error     ;
        7: ( Going , Some   , Free ) => Repeat  , Error     ;
    }
}

old_table! {
    /// POINT (VI.1.1): one point a tick. "Ready" is said one point ahead: Prim's answer to it arrives two ticks later.
    /// While Prim stands still the robot is held at once; what is said then is for a Prim that is stepped singly, whose next
    /// point lets one out of the queue.
    pub POINT: fn point(trouble: Trouble, above: Above, line: Line, queue: Queue) -> (Output, T3iReport) {
        //    trouble  above   line   queue      output    report
        1: ( None   , Live  , Free , Empty ) => Repeat  , Finished  ;
        2: ( None   , Live  , Free , One   ) => Advance , Ready     ;
        3: ( None   , Live  , Free , More  ) => Advance , Executing ;
        4: ( None   , Live  , Busy , Empty ) => Nothing , Ready     ;
        5: ( None   , Live  , Busy , One   ) => Nothing , Ready     ;
        6: ( None   , Live  , Busy , More  ) => Nothing , Executing ;
        7: ( None   , Still , Free , Empty ) => Repeat  , Finished  ;
        8: ( None   , Still , Free , One   ) => Repeat  , Ready     ;
        9: ( None   , Still , Free , More  ) => Repeat  , Executing ;
       10: ( None   , Still , Busy , _     ) => Nothing , Executing ;
       11: ( Some   , _     , Free , _     ) => Repeat  , Error     ;
       12: ( Some   , _     , Busy , _     ) => Nothing , Error     ;
       13: ( _      , _     , Down , _     ) => Nothing , Error     ;
    }
}

old_table! {
    /// PAUSE (VI.1.1): the last position is repeated. Also before the first command.
    pub PAUSE: fn pause(trouble: Trouble, line: Line) -> (Output, T3iReport) {
        //   trouble  line      output    report
        1: ( None   , Down ) => Nothing , Executing ;
        2: ( None   , Busy ) => Nothing , Executing ;
        3: ( None   , Free ) => Repeat  , Finished  ;
        4: ( Some   , Down ) => Nothing , Error     ;
        5: ( Some   , Busy ) => Nothing , Error     ;
        6: ( Some   , Free ) => Repeat  , Error     ;
    }
}

/// All tables; the header of the outputs names one by its position from 1.
pub const TABLES: &[&Table] = &[&RECEIVE, &RESTART, &POINT, &PAUSE];
