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

/// Farther than this, a robot has left the place of its last motion (docs/design/motion.md "Where the robot is").
pub(super) const LOST_INCHES: f64 = 0.5;
pub(super) const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0; // 2 degrees
pub(super) const ASIDE_INCHES: f64 = 0.35; // to a segment into a holster or the drum: the robot is on it
const SEARCH_PER_TICK: u32 = 64; // location points

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Localization {
    place: Option<RobotPlace>, // the end of the last motion
    away: bool,                // the robot has been moved away from `place`
    way: Option<Way>,
    /// The path from the last known place or way, on which the joystick box has moved the robot.
    track: Track,
    searched: u32, // location points searched so far
    surroundings: Surroundings,
}

impl Localization {
    pub(super) fn adopt(&mut self, estimates: &Estimates) {
        (self.place, self.way, self.track) = (estimates.place, estimates.way, estimates.track);
    }

    pub(super) fn write_to(&self, estimates: &mut Estimates) {
        (estimates.place, estimates.way, estimates.track) = (self.place, self.way, self.track);
    }

    /// A robot that is moved back, as by the joystick box, is at its place again.
    pub(super) fn place(&self) -> Option<&RobotPlace> {
        self.place.as_ref().filter(|_| !self.away)
    }

    /// The end of the last motion, even if the robot has been moved away.
    pub(super) const fn last_place(&self) -> Option<&RobotPlace> {
        self.place.as_ref()
    }

    pub(super) fn ends(&self) -> [Option<&RobotPlace>; 3] {
        let way = self.way.as_ref();
        [self.place.as_ref(), way.map(|way| &way.to), way.map(|way| &way.from)]
    }

    pub(super) fn origin(&self) -> Option<&RobotPlace> {
        self.place().or_else(|| self.way.as_ref().map(|way| &way.from))
    }

    pub(super) const fn track(&self) -> &Track {
        &self.track
    }

    pub(super) const fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

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

    /// A robot at rest is not on a path that it has left. `is_moving` is true during an order to Prim, `is_half_way` in
    /// a gripper exchange or at the tool drum.
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

    pub(super) fn sense_place(&mut self, present: &Frame) {
        let there =
            |pose: &Pose| pose.to_frame().is_ok_and(|frame| near(&frame, present, LOST_INCHES, LOST_RADIANS));
        self.away = self.place.as_ref().is_some_and(|place| !there(&place.pose));
    }

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

    pub(super) const fn arrive(&mut self, at: RobotPlace) {
        (self.place, self.way, self.away) = (Some(at), None, false);
    }

    /// Records that relative moves have ended at the command's location.
    pub(super) fn stand(&mut self, gone_to: GoneTo, command: &EmoveCommand, memory: &CommonMemory) {
        if let Some(pose) = commanded_pose(memory) {
            (self.place, self.away) = (Some(robot_at(command, gone_to, pose)), false);
        }
    }

    pub(super) const fn set_place(&mut self, at: Option<RobotPlace>) {
        self.place = at;
    }

    /// Notes that a relative move begins, so the robot is at no place and on no path.
    pub(super) const fn leave(&mut self) {
        (self.place, self.way) = (None, None);
    }

    /// Empty fingers depart as from any object.
    pub(super) const fn note_empty_fingers(&mut self) {
        if let Some(place) = &mut self.place
            && let GoneTo::Brought(object) = place.gone_to
        {
            place.gone_to = GoneTo::Object(object);
        }
    }
}
