//! Procedures (IV): checklists that detect when a step is done.
//!
//! A step has its number in the manual, a text, a [`Watch`] with the conditions that complete it, and requests that
//! execute it. A step whose state is lost loses its mark. The operator confirms states that the console cannot observe.

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

#[derive(Debug)]
pub struct Procedure {
    pub section: &'static str, // of the manual
    pub title: &'static str,
    pub steps: &'static [Step],
}

#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub id: &'static str,
    pub text: &'static str, // the required action or state
    pub how: &'static str,  // additional information; empty for none
    /// How the console detects that the step is done.
    pub watch: Watch,
    /// Number of the step that ends this step's state. Once that step has sent its requests or is done, this step keeps
    /// its mark.
    pub until: &'static str,
    /// Requests that Enter sends, in order.
    pub ask: &'static [Ask],
    /// Warning before Enter sends; empty if no harm is possible.
    pub warning: &'static str,
    /// State of the cell that is shown with the step.
    pub show: Show,
}

#[derive(Clone, Copy, Debug)]
pub enum Watch {
    /// All conditions hold, and must continue to hold.
    State(&'static [Condition]),
    /// All conditions have held once since the step began.
    Event(&'static [Condition]),
    Said,
    /// With a real robot, the operator confirms the step. A simulated cell has no such device.
    Real,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    Line(&'static str),
    /// `release` for each emergency stop that is pressed.
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

const fn step(id: &'static str, text: &'static str, watch: Watch) -> Step {
    Step { id, text, how: "", watch, until: "", ask: &[], warning: "", show: Show::Nothing }
}

const fn state(id: &'static str, text: &'static str, conditions: &'static [Condition]) -> Step {
    step(id, text, Watch::State(conditions))
}

const fn event(id: &'static str, text: &'static str, conditions: &'static [Condition]) -> Step {
    step(id, text, Watch::Event(conditions))
}

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
    fn every_step_fits_and_names_existing_steps() {
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
                assert!(
                    step.warning.is_empty() || !step.ask.is_empty(),
                    "{named}: a warning without a request"
                );
            }
        }
    }
}
