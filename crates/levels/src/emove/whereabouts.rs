//! Whether the place of the robot is known, and the search for its location point.

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    emove::{GoneTo, RobotPlace},
    prim::PrimVerb,
    process::Inputs,
    subtask::LocationKind,
    track::Course,
};
use rcs_core::handshake::Lower;
use taskdata::files::{LocptId, TaskData};

use super::{
    route::near,
    state::State,
    surroundings::{Surroundings, is_plain},
    tables::Whereabouts,
};
use crate::places::place_of;

/// The robot is no longer where its last move ended if it is more than this many inches …
/// (docs/design/motion.md "Where the robot is")
pub(super) const LOST_INCHES: f64 = 0.5;
/// … or radians (2 degrees) off.
pub(super) const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// The robot is on a segment of the way into a holster or the drum within this many inches.
pub(super) const ASIDE_INCHES: f64 = 0.35;
/// Location points that are looked at in a tick to find out where the robot is.
const SEARCH_PER_TICK: u32 = 64;

impl State {
    /// Look through some more location points for the one at which the robot stands.
    pub(super) fn search(&mut self, present: &Frame, data: &TaskData<'_>) {
        for _ in 0..SEARCH_PER_TICK {
            let next = LocptId::new(self.searched.saturating_add(1));
            let Some(locpt) = data.locpt(next) else { return };
            self.searched = next.number();
            let place = place_of(next);
            let plain = is_plain(&locpt.name, &place, data);
            if plain && near(&locpt.frame, present, LOST_INCHES, LOST_RADIANS) {
                self.beliefs.place = Some(RobotPlace {
                    gone_to: GoneTo::Location,
                    location: locpt.name,
                    kind: LocationKind::Point,
                    record: next.to_option(),
                    array: None,
                    sector: None,
                    pose: Pose::from_frame(present),
                });
                (self.beliefs.way, self.away) = (None, false);
                return;
            }
        }
    }

    /// Which known places are nearest, as long as it is not known where the robot is.
    pub(super) fn look_around(&mut self, place: Whereabouts, present: Option<&Frame>, data: &TaskData<'_>) {
        match (place, present) {
            (Whereabouts::Known, _) => self.surroundings = Surroundings::default(),
            (Whereabouts::Searching | Whereabouts::Unknown, Some(present)) => {
                self.surroundings.look(present, data);
            }
            (Whereabouts::Searching | Whereabouts::Unknown, None) => {}
        }
    }

    /// The place where the robot stands, unless it has been moved away from there. If it is moved back, as by
    /// the joystick box, it stands there again.
    pub(super) fn place(&self) -> Option<RobotPlace> {
        self.beliefs.place.filter(|_| !self.away)
    }

    /// What Prim makes of its command. A robot that has passed a through point flies on to it: it executes.
    pub(super) fn robot(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        match self.prim.status_of(inputs.tick, &inputs.memory.prim) {
            Lower::Done if inputs.memory.emove.prim.command == PrimVerb::GoThru => Lower::Executing,
            lower => lower,
        }
    }

    /// Is it known where the robot is? A way that it has left says nothing any more, once it is at rest.
    pub(super) fn whereabouts(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Whereabouts {
        let moving = matches!(self.robot(inputs), Lower::Pending | Lower::Executing);
        // On its return to a way the robot moves, and is not on it yet.
        let moves_on_it = moving && self.beliefs.track.course == Course::Known;
        let on_way = self.beliefs.way.is_some() && (moves_on_it || self.on_way(inputs).is_some());
        let half_way = self.beliefs.exchange.is_some() || self.beliefs.drum.is_some();
        if self.place().is_some() || half_way || on_way {
            Whereabouts::Known
        } else if inputs.data.locpt(LocptId::new(self.searched.saturating_add(1))).is_some() {
            Whereabouts::Searching
        } else {
            Whereabouts::Unknown
        }
    }
}
