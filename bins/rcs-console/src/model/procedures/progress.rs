//! Progress of the procedures: the marks of their steps, and the keys that change the marks.

use interfaces::station::EStop;
use rcs_core::tick::Tick;

use super::{
    ALL, Ask, Procedure, Step, Watch,
    condition::{Begun, Sight},
};
use crate::rcs_console::source::Cell;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Not done, as far as the console can detect.
    #[default]
    Open,
    Seen,
    /// Done in this tick; the console no longer checks it.
    Done(Tick),
    /// Confirmed by the operator in this tick.
    Said(Tick),
    /// Skipped by the operator in this tick, with a reason.
    Skipped(Tick, String),
    /// Without a device in the simulated cell.
    NotThere,
}

impl Mark {
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Open => "",
            Self::Seen => "seen",
            Self::Done(_) => "done",
            Self::Said(_) => "said",
            Self::Skipped(..) => "left",
            Self::NotThere => "n/a",
        }
    }

    /// True if the next step may begin.
    #[must_use]
    pub fn is_set(&self) -> bool {
        *self != Self::Open
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pub procedure: &'static Procedure,
    pub marks: Vec<Mark>,
    pub cursor: usize,
    pub begun: Begun,
    current: Option<usize>, // index of the step to which `begun` belongs
    /// True if the warning has been shown; the next Enter sends the requests of the step at the cursor.
    pub is_warned: bool,
}

impl PartialEq for Procedure {
    fn eq(&self, other: &Self) -> bool {
        (self.section, self.title) == (other.section, other.title)
    }
}

impl Track {
    fn new(procedure: &'static Procedure) -> Self {
        Self {
            procedure,
            marks: vec![Mark::Open; procedure.steps.len()],
            cursor: 0,
            begun: Begun::default(),
            current: None,
            is_warned: false,
        }
    }

    #[must_use]
    pub fn next(&self) -> Option<usize> {
        self.marks.iter().position(|mark| !mark.is_set())
    }

    #[must_use]
    pub fn step(&self) -> Option<&'static Step> {
        self.procedure.steps.get(self.cursor)
    }

    pub fn move_to(&mut self, cursor: usize) {
        self.cursor = cursor.min(self.procedure.steps.len().saturating_sub(1));
        self.is_warned = false;
    }

    /// Mark the step at the cursor, and move the cursor to the next open one.
    pub fn mark(&mut self, mark: Mark) {
        if let Some(marked) = self.marks.get_mut(self.cursor) {
            *marked = mark;
        }
        self.go_on();
    }

    /// Remove the operator's mark from the step at the cursor.
    pub fn take_back(&mut self) {
        if let Some(marked) = self.marks.get_mut(self.cursor) {
            *marked = Mark::Open;
        }
    }

    fn go_on(&mut self) {
        if let Some(next) = self.next() {
            self.move_to(next);
        }
    }

    /// Begins the step at the cursor and returns its requests. `last` is the number of the request sent before them.
    pub fn ask(&mut self, sight: &Sight<'_>, last: u32) -> Vec<String> {
        let Some(step) = self.step() else { return Vec::new() };
        self.begin(self.cursor, sight);
        self.begun.asked = Some(last);
        self.is_warned = false;
        step.ask.iter().flat_map(|ask| lines(*ask, sight.cell)).collect()
    }

    fn begin(&mut self, step: usize, sight: &Sight<'_>) {
        self.current = Some(step);
        self.begun = Begun { tick: sight.picture.tick, tool: sight.tool(), asked: None };
    }

    /// Update the marks from a picture: a step has a mark as long as its conditions hold.
    fn look(&mut self, sight: &Sight<'_>) {
        let was = self.next();
        if was.is_some() && self.current != was && self.begun.asked.is_none() {
            was.into_iter().for_each(|next| self.begin(next, sight));
        }
        let sight = Sight { begun: self.begun, ..*sight };
        let next = self.next().unwrap_or(self.marks.len());
        let asked = self.current.filter(|_| self.begun.asked.is_some());
        for (at, step) in self.procedure.steps.iter().enumerate() {
            let end = self.procedure.steps.iter().position(|other| other.id == step.until);
            let is_ended = end.is_some_and(|end| asked == Some(end) || end < next);
            let is_current = self.current == Some(at);
            if let Some(mark) = self.marks.get_mut(at) {
                *mark = looked(step, std::mem::take(mark), &sight, is_current, is_ended);
            }
        }
        if self.current.is_some_and(|at| self.marks.get(at).is_some_and(Mark::is_set)) {
            self.begun.asked = None;
        }
        // Move the cursor on from a step that has just been done.
        if was == Some(self.cursor) && self.next() != was {
            self.go_on();
        }
    }
}

/// The mark of a step after an update.
fn looked(step: &Step, mark: Mark, sight: &Sight<'_>, is_current: bool, is_ended: bool) -> Mark {
    let tick = sight.picture.tick;
    match (step.watch, mark) {
        (_, mark @ (Mark::Said(_) | Mark::Skipped(..) | Mark::Done(_))) => mark,
        (Watch::Real, Mark::Open) if matches!(sight.cell, Cell::Shown(_)) => Mark::NotThere,
        (Watch::State(_), Mark::Seen) if is_ended => Mark::Done(tick),
        (Watch::State(conditions), _) => match all(conditions, sight) {
            Some(true) => Mark::Seen,
            Some(false) | None => Mark::Open,
        },
        (Watch::Event(conditions), Mark::Open) if is_current && all(conditions, sight) == Some(true) => {
            Mark::Done(tick)
        }
        (_, mark) => mark,
    }
}

/// True if all conditions hold; `None` if some are unknown and none fails.
fn all(conditions: &[super::Condition], sight: &Sight<'_>) -> Option<bool> {
    let seen: Vec<_> = conditions.iter().map(|condition| sight.holds(*condition)).collect();
    match (seen.contains(&Some(false)), seen.contains(&None)) {
        (true, _) => Some(false),
        (false, true) => None,
        (false, false) => Some(true),
    }
}

impl Step {
    /// True if the console cannot detect the step here, so that the operator must confirm it.
    #[must_use]
    pub fn needs_a_word(&self, sight: &Sight<'_>) -> bool {
        match self.watch {
            Watch::State(conditions) | Watch::Event(conditions) => {
                !conditions.contains(&super::Condition::Taken) && all(conditions, sight).is_none()
            }
            Watch::Said | Watch::Real => true,
        }
    }
}

fn lines(ask: Ask, cell: &Cell) -> Vec<String> {
    match ask {
        Ask::Line(line) => vec![line.to_owned()],
        Ask::ReleaseEStops => {
            let Cell::Shown(view) = cell else { return Vec::new() };
            let pressed = EStop::ALL.iter().zip(view.controller.estops).filter(|(_, is_in)| *is_in);
            pressed.map(|(site, _)| format!("release {site}")).collect()
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    pub tracks: Vec<Track>,
    pub cursor: usize,
    /// True if the procedure at the cursor is open.
    pub is_open: bool,
}

impl Default for Progress {
    fn default() -> Self {
        Self { tracks: ALL.into_iter().map(Track::new).collect(), cursor: 0, is_open: false }
    }
}

impl Progress {
    pub fn open(&mut self) -> Option<&mut Track> {
        let is_open = self.is_open;
        self.tracks.get_mut(self.cursor).filter(|_| is_open)
    }

    /// Update the marks from a picture of the run. Only the open procedure detects events.
    pub fn look(&mut self, sight: &Sight<'_>) {
        if let Some(track) = self.open() {
            track.look(sight);
        }
    }

    pub fn restart(&mut self) {
        if let Some(track) = self.open() {
            *track = Track::new(track.procedure);
        }
    }
}
