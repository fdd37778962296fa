use geometry::units::inches;
use interfaces::grip::{GripCommand, GripVerb};
use rcs_core::Plain;

use super::tables::{
    AirFlow, GripActivity,
    command::{Acceptance, Commanded, TargetOpening, command},
};
use crate::execution::Course;

pub(super) const CLOSED_END: f64 = 0.10; // in (VIII.9.1: a closed gripper has 0.10 in)
pub(super) const OPEN_END: f64 = 5.00; // in
/// Force that each finger reads when the fingers are shut on each other, lb. ASSUMED: the pads meet at the closed end.
pub(super) const SUPPLY_FORCE: f64 = 80.0;

/// A copy of the goal of the current command, since the buffer of a commander that restarts is empty.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripGoal {
    pub verb: GripVerb,
    pub opening: f64,       // in; for a grasp, the size of the object
    pub force: f64,         // lb
    pub speed: Option<f64>, // in/s
}

impl From<&GripCommand> for GripGoal {
    fn from(command: &GripCommand) -> Self {
        Self {
            verb: command.command,
            opening: inches(command.position),
            force: f64::from(command.force),
            speed: (command.velocity != 0).then(|| inches(command.velocity)),
        }
    }
}

impl GripGoal {
    #[must_use]
    pub fn is_attainable(&self) -> bool {
        let reachable =
            (CLOSED_END..=OPEN_END).contains(&self.opening) && self.speed.is_none_or(|s| s >= 0.0);
        match self.verb {
            GripVerb::Position | GripVerb::OpenGrip => reachable,
            GripVerb::CloseGrip => reachable && (0.0..=SUPPLY_FORCE).contains(&self.force),
            GripVerb::UpInit | GripVerb::Pause | GripVerb::None => true,
        }
    }

    /// The greatest flow that does not exceed the commanded speed. If all exceed it, the fine flow.
    pub(super) fn greatest_flow(&self) -> AirFlow {
        match self.speed {
            None => AirFlow::Coarse,
            Some(speed) if speed >= 4.0 => AirFlow::Coarse,
            Some(speed) if speed >= 1.0 => AirFlow::Medium,
            Some(_) => AirFlow::Fine,
        }
    }

    pub(super) fn command(&self, course: Course, accepted: bool) -> GripActivity {
        let commanded = Commanded {
            course,
            acceptance: if accepted { Acceptance::Accepted } else { Acceptance::Refused },
            verb: self.verb,
            target: if self.opening >= OPEN_END { TargetOpening::OpenEnd } else { TargetOpening::Narrower },
        };
        command((), &commanded).action
    }
}
