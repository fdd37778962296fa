//! Procedures (IV): checklists that see for themselves whether a step is done.
//!
//! A procedure is a table of steps. A step has its number in the manual, a text, a [`Watch`] that says how one
//! knows that it is done, and requests to the run that do it. A state goes on being watched: a step that is undone
//! loses its mark, until the step that ends it is done. What the console cannot see, because the robot is at a
//! port or no device shows it, is for a person to say.

mod condition;
mod controller;
mod keys;
mod neighbours;
mod progress;
mod robot;
mod screen;
mod show;
mod stops;

pub use self::{
    condition::{Begun, Condition, Sight},
    progress::{Mark, Progress, Track},
    screen::sections,
    show::Show,
};

/// A procedure of the manual.
#[derive(Debug)]
pub struct Procedure {
    /// Section of the manual.
    pub section: &'static str,
    /// What it is for.
    pub title: &'static str,
    /// The steps, in their order.
    pub steps: &'static [Step],
}

/// A step.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Its number in the section.
    pub id: &'static str,
    /// What is to be done, or to be so.
    pub text: &'static str,
    /// What else there is to know; empty for nothing.
    pub how: &'static str,
    /// How one knows that it is done.
    pub watch: Watch,
    /// The number of the step that ends what this one has brought about: when that is asked for or done, the
    /// mark of this one stays.
    pub until: &'static str,
    /// What Enter asks the run for, in this order.
    pub ask: &'static [Ask],
    /// What is said before Enter asks; empty if nothing can be harmed.
    pub warning: &'static str,
    /// What is shown of the cell at this step.
    pub show: Show,
}

/// How one knows that a step is done.
#[derive(Clone, Copy, Debug)]
pub enum Watch {
    /// All this is so, and goes on being so.
    State(&'static [Condition]),
    /// All this has been so once since the step began.
    Event(&'static [Condition]),
    /// A person says it.
    Said,
    /// A person says it at a real robot; a simulated cell has no such thing.
    Real,
}

/// A request to the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// This line.
    Line(&'static str),
    /// `release` for each emergency stop that is in.
    ReleaseEStops,
}

/// All procedures, in the order of the manual.
pub const ALL: [&Procedure; 14] = [
    &stops::E_STOP,
    &robot::POWER_UP,
    &robot::SET_UP,
    &robot::START_UP,
    &stops::WARNING,
    &stops::RESOLVERS,
    &robot::SHUT_DOWN,
    &stops::MANUAL_CONTROL,
    &neighbours::WORKSTATION,
    &neighbours::DATA_SYSTEM,
    &neighbours::PEDESTAL,
    &neighbours::VISION,
    &neighbours::PEDESTAL_START,
    &neighbours::PEDESTAL_SHUT_DOWN,
];

/// A step without requests.
const fn step(id: &'static str, text: &'static str, watch: Watch) -> Step {
    Step { id, text, how: "", watch, until: "", ask: &[], warning: "", show: Show::Nothing }
}

/// A step that brings about a state.
const fn state(id: &'static str, text: &'static str, conditions: &'static [Condition]) -> Step {
    step(id, text, Watch::State(conditions))
}

/// A step in which something happens.
const fn event(id: &'static str, text: &'static str, conditions: &'static [Condition]) -> Step {
    step(id, text, Watch::Event(conditions))
}

/// A step that a person looks at.
const fn said(id: &'static str, text: &'static str) -> Step {
    step(id, text, Watch::Said)
}

/// A step for which a simulated cell has no device.
const fn real(id: &'static str, text: &'static str) -> Step {
    step(id, text, Watch::Real)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_fits_and_names_steps_that_are_there() {
        for procedure in ALL {
            let at = |id: &str| procedure.steps.iter().position(|step| step.id == id);
            for (index, step) in procedure.steps.iter().enumerate() {
                let named = format!("{} {}: {}", procedure.section, step.id, step.text);
                assert!(procedure.title.chars().count() <= 47, "{}", procedure.title);
                assert!(step.text.chars().count() <= 62 && step.id.len() <= 4, "{named}");
                assert!(at(step.id) == Some(index), "{named}: the number stands twice");
                assert!(
                    step.until.is_empty() || at(step.until) > Some(index),
                    "{named}: until {}",
                    step.until
                );
                assert!(step.warning.is_empty() || !step.ask.is_empty(), "{named}: nothing is asked for");
            }
        }
    }
}
