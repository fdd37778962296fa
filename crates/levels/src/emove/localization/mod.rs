//! The place of the robot, or the path that it is on (docs/design/motion.md "Where the robot is").
//!
//! * [`path`]: the path of an interrupted motion;
//! * [`track`]: the path on which the joystick box has moved the robot;
//! * [`returning`]: return to the place or the path;
//! * [`surroundings`]: the nearest known places of a robot at an unknown place.

pub mod path;
pub mod returning;
pub mod surroundings;
pub mod track;

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, Estimates, GoneTo, RobotPlace, Way},
    location::Site,
    track::{Course, Track},
};
use rcs_core::Plain;
use taskdata::files::{LocptId, TaskData};

use self::surroundings::{Surroundings, is_plain};
use super::{
    EmoveInputs,
    robot_place::{commanded_pose, near, robot_at},
    tables::{At, PlaceKnowledge},
};
use crate::places::named;

/// The robot has left the place of its last motion if it is more than this many inches …
/// (docs/design/motion.md "Where the robot is")
pub(super) const LOST_INCHES: f64 = 0.5;
/// … or radians (2 degrees) off.
pub(super) const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// The robot is on a segment into a holster or the drum within this many inches.
pub(super) const ASIDE_INCHES: f64 = 0.35;
/// Location points per tick in the search for the place of the robot.
const SEARCH_PER_TICK: u32 = 64;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Localization {
    /// The place where the last motion ended.
    place: Option<RobotPlace>,
    /// The robot has been moved away from `place`.
    away: bool,
    way: Option<Way>,
    /// The path from the last known place or way, on which the joystick box has moved the robot.
    track: Track,
    /// Location points searched so far.
    searched: u32,
    surroundings: Surroundings,
}

impl Localization {
    pub(super) fn adopt(&mut self, estimates: &Estimates) {
        (self.place, self.way, self.track) = (estimates.place, estimates.way, estimates.track);
    }

    pub(super) fn write_to(&self, estimates: &mut Estimates) {
        (estimates.place, estimates.way, estimates.track) = (self.place, self.way, self.track);
    }

    /// The place of the robot, unless it has been moved away. A robot that is moved back, as by the joystick box, is
    /// there again.
    pub(super) fn place(&self) -> Option<&RobotPlace> {
        self.place.as_ref().filter(|_| !self.away)
    }

    /// The place where the last motion ended, even if the robot has been moved away.
    pub(super) const fn last_place(&self) -> Option<&RobotPlace> {
        self.place.as_ref()
    }

    /// The place of the last motion, or the ends of the path.
    pub(super) fn ends(&self) -> [Option<&RobotPlace>; 3] {
        let way = self.way.as_ref();
        [self.place.as_ref(), way.map(|way| &way.to), way.map(|way| &way.from)]
    }

    /// The place of the robot, or its last one.
    pub(super) fn origin(&self) -> Option<&RobotPlace> {
        self.place().or_else(|| self.way.as_ref().map(|way| &way.from))
    }

    pub(super) const fn track(&self) -> &Track {
        &self.track
    }

    pub(super) const fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// The robot's place, relative to the command's location.
    pub(super) fn at(&self, command: &EmoveCommand) -> At {
        match self.place() {
            Some(at) if at.site.has_location_of(&command.site) => match at.gone_to {
                GoneTo::Drum => At::InDrum,
                GoneTo::Location | GoneTo::Object(_) | GoneTo::View(_) | GoneTo::Brought(_) => At::There,
            },
            Some(at) if at.site.location.as_str() == named::TOOL_SAFE => At::Before,
            _ => At::Elsewhere,
        }
    }

    /// Knowledge of the robot's place. A path that the robot has left is ignored once it is at rest. `is_moving`:
    /// by an order to Prim; `is_half_way`: in a gripper exchange, or at the tool drum.
    pub(super) fn knowledge(
        &self,
        is_moving: bool,
        is_half_way: bool,
        inputs: &EmoveInputs<'_>,
    ) -> PlaceKnowledge {
        // A robot that returns to a path moves, and is not on it yet.
        let moves_on_it = is_moving && self.track.course == Course::Known;
        let on_way = self.way.is_some() && (moves_on_it || self.on_path(inputs).is_some());
        if self.place().is_some() || is_half_way || on_way {
            PlaceKnowledge::Known
        } else if inputs.data.locpt(LocptId::new(self.searched.saturating_add(1))).is_some() {
            PlaceKnowledge::Searching
        } else {
            PlaceKnowledge::Unknown
        }
    }

    /// Update whether the robot is still where its last motion ended.
    pub(super) fn sense_place(&mut self, present: &Frame) {
        let there =
            |pose: &Pose| pose.to_frame().is_ok_and(|frame| near(&frame, present, LOST_INCHES, LOST_RADIANS));
        self.away = self.place.as_ref().is_some_and(|place| !there(&place.pose));
    }

    /// Search for the nearest known places while the robot's place is unknown.
    pub(super) fn sense_surroundings(
        &mut self,
        place: PlaceKnowledge,
        present: Option<&Frame>,
        data: &TaskData<'_>,
    ) {
        match (place, present) {
            (PlaceKnowledge::Known, _) => self.surroundings = Surroundings::default(),
            (PlaceKnowledge::Searching | PlaceKnowledge::Unknown, Some(present)) => {
                self.surroundings.look(present, data);
            }
            (PlaceKnowledge::Searching | PlaceKnowledge::Unknown, None) => {}
        }
    }

    pub fn forget_surroundings(&mut self) {
        self.surroundings = Surroundings::default();
    }

    /// Search more location points for the one at which the robot is.
    pub(super) fn search(&mut self, present: &Frame, data: &TaskData<'_>) {
        for _ in 0..SEARCH_PER_TICK {
            let next = LocptId::new(self.searched.saturating_add(1));
            let Some(locpt) = data.locpt(next) else { return };
            self.searched = next.number();
            let site = Site::point(locpt.name, next);
            let plain = is_plain(&site, data);
            if plain && near(&locpt.frame, present, LOST_INCHES, LOST_RADIANS) {
                self.place =
                    Some(RobotPlace { gone_to: GoneTo::Location, site, pose: Pose::from_frame(present) });
                (self.way, self.away) = (None, false);
                return;
            }
        }
    }

    pub(super) const fn search_again(&mut self) {
        self.searched = 0;
    }

    /// The robot is at rest at the goal of a motion.
    pub(super) const fn arrive(&mut self, at: RobotPlace) {
        (self.place, self.way, self.away) = (Some(at), None, false);
    }

    /// Relative moves have ended at the location of the command.
    pub(super) fn stand(&mut self, gone_to: GoneTo, command: &EmoveCommand, memory: &CommonMemory) {
        if let Some(pose) = commanded_pose(memory) {
            (self.place, self.away) = (Some(robot_at(command, gone_to, pose)), false);
        }
    }

    /// The place has changed without a motion.
    pub(super) const fn set_place(&mut self, at: Option<RobotPlace>) {
        self.place = at;
    }

    /// A relative move begins: the robot is at no place, and on no path.
    pub(super) const fn leave(&mut self) {
        (self.place, self.way) = (None, None);
    }

    /// The object has been released or lost: the empty fingers depart as from any object.
    pub(super) const fn note_empty_fingers(&mut self) {
        if let Some(place) = &mut self.place
            && let GoneTo::Brought(object) = place.gone_to
        {
            place.gone_to = GoneTo::Object(object);
        }
    }
}
