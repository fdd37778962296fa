//! How far each procedure has come: marks, and what the keys do to them.

use rcs_core::tick::Tick;

use super::{
    ALL, Ask, Procedure, Step, Watch,
    condition::{Begun, Sight},
};
use crate::source::Cell;

/// How a step stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// It is not done, as far as one knows.
    #[default]
    Open,
    /// The console sees it.
    Seen,
    /// It was so: since this tick the console need not see it any more.
    Done(Tick),
    /// A person has said it in this tick.
    Said(Tick),
    /// A person has left it out, for a reason.
    Skipped(Tick, String),
    /// A simulated cell has no such thing.
    NotThere,
}

impl Mark {
    /// The word on the screen.
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

    /// The next step may come.
    #[must_use]
    pub fn is_set(&self) -> bool {
        *self != Self::Open
    }
}

/// How far a procedure has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// What is to be done.
    pub procedure: &'static Procedure,
    /// A mark a step.
    pub marks: Vec<Mark>,
    /// The step under the cursor.
    pub cursor: usize,
    /// How things were when the first step that is open began, or was asked for.
    pub begun: Begun,
    /// The step for which `begun` was taken.
    current: Option<usize>,
    /// The next Enter asks for the step under the cursor: its warning has been shown.
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

    /// The first step without a mark.
    #[must_use]
    pub fn next(&self) -> Option<usize> {
        self.marks.iter().position(|mark| !mark.is_set())
    }

    /// The step under the cursor.
    #[must_use]
    pub fn step(&self) -> Option<&'static Step> {
        self.procedure.steps.get(self.cursor)
    }

    /// Put the cursor on another step.
    pub fn move_to(&mut self, cursor: usize) {
        self.cursor = cursor.min(self.procedure.steps.len().saturating_sub(1));
        self.is_warned = false;
    }

    /// Mark the step under the cursor; the cursor goes to the next one that is open.
    pub fn mark(&mut self, mark: Mark) {
        if let Some(marked) = self.marks.get_mut(self.cursor) {
            *marked = mark;
        }
        self.go_on();
    }

    /// Take back what a person has said of the step under the cursor.
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

    /// What Enter asks for at the step under the cursor; `last` is the number of the last request before.
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

    /// Look at a picture: what is so gets its mark, what is so no more loses it.
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
        // The cursor goes along with what is done while it stands on the step that was to be done.
        if was == Some(self.cursor) && self.next() != was {
            self.go_on();
        }
    }
}

/// The mark of a step after a look.
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

/// All hold; none if one of them cannot be seen here and no other fails.
fn all(conditions: &[super::Condition], sight: &Sight<'_>) -> Option<bool> {
    let seen: Vec<_> = conditions.iter().map(|condition| sight.holds(*condition)).collect();
    match (seen.contains(&Some(false)), seen.contains(&None)) {
        (true, _) => Some(false),
        (false, true) => None,
        (false, false) => Some(true),
    }
}

impl Step {
    /// Nothing shows here whether it is done: a person has to say it.
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

/// The lines of a request.
fn lines(ask: Ask, cell: &Cell) -> Vec<String> {
    match ask {
        Ask::Line(line) => vec![line.to_owned()],
        Ask::ReleaseEStops => {
            let Cell::Shown(view) = cell else { return Vec::new() };
            let pressed = ESTOPS.into_iter().zip(view.controller.estops).filter(|(_, is_in)| *is_in);
            pressed.map(|(site, _)| format!("release {site}")).collect()
        }
    }
}

/// The emergency stops in the words of a request, in the order of the cell.
const ESTOPS: [&str; 5] = ["control-panel", "teach-pendant", "terminals", "joystick-box", "pedestal"];

/// How far all procedures have come.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// One a procedure.
    pub tracks: Vec<Track>,
    /// The procedure under the cursor of the list.
    pub cursor: usize,
    /// The procedure under the cursor is open.
    pub is_open: bool,
}

impl Default for Progress {
    fn default() -> Self {
        Self { tracks: ALL.into_iter().map(Track::new).collect(), cursor: 0, is_open: false }
    }
}

impl Progress {
    /// The procedure that is open.
    pub fn open(&mut self) -> Option<&mut Track> {
        let is_open = self.is_open;
        self.tracks.get_mut(self.cursor).filter(|_| is_open)
    }

    /// Look at a picture of the run. Only in the procedure that is open things happen.
    pub fn look(&mut self, sight: &Sight<'_>) {
        if let Some(track) = self.open() {
            track.look(sight);
        }
    }

    /// Begin the procedure that is open once more.
    pub fn restart(&mut self) {
        if let Some(track) = self.open() {
            *track = Track::new(track.procedure);
        }
    }
}
