//! Where the robot is (docs/design/motion.md "Where the robot is"): its known place, or the path that it is on.
//!
//! * [`path`]: the path of a motion that was interrupted;
//! * [`track`]: the path on which the joystick box has moved the robot;
//! * [`returning`]: return to the place or the path;
//! * [`surroundings`]: the known places around a robot that is at none.

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

/// The robot is no longer where its last move ended if it is more than this many inches …
/// (docs/design/motion.md "Where the robot is")
pub(super) const LOST_INCHES: f64 = 0.5;
/// … or radians (2 degrees) off.
pub(super) const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// The robot is on a segment of the way into a holster or the drum within this many inches.
pub(super) const ASIDE_INCHES: f64 = 0.35;
/// Location points that are looked at in a tick to find out where the robot is.
const SEARCH_PER_TICK: u32 = 64;

/// Where the robot is.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Localization {
    /// Where its last motion ended.
    place: Option<RobotPlace>,
    /// It has been moved away from there.
    away: bool,
    /// The path that it is on.
    way: Option<Way>,
    /// The path from the last known place or way, on which the joystick box has moved it.
    track: Track,
    /// How many location points have been looked at to find out where it is.
    searched: u32,
    /// The known places around it, if it is at none.
    surroundings: Surroundings,
}

impl Localization {
    pub(super) fn adopt(&mut self, estimates: &Estimates) {
        (self.place, self.way, self.track) = (estimates.place, estimates.way, estimates.track);
    }

    pub(super) fn write_to(&self, estimates: &mut Estimates) {
        (estimates.place, estimates.way, estimates.track) = (self.place, self.way, self.track);
    }

    /// The place of the robot, unless it has been moved away from there. If it is moved back, as by the joystick box,
    /// it is there again.
    pub(super) fn place(&self) -> Option<&RobotPlace> {
        self.place.as_ref().filter(|_| !self.away)
    }

    /// Where its last motion ended, even if it has been moved away from there.
    pub(super) const fn last_place(&self) -> Option<&RobotPlace> {
        self.place.as_ref()
    }

    /// The places to which it belongs: that of its last motion, or the ends of its path.
    pub(super) fn ends(&self) -> [Option<&RobotPlace>; 3] {
        let way = self.way.as_ref();
        [self.place.as_ref(), way.map(|way| &way.to), way.map(|way| &way.from)]
    }

    /// Its place, or the one that it has left last.
    pub(super) fn origin(&self) -> Option<&RobotPlace> {
        self.place().or_else(|| self.way.as_ref().map(|way| &way.from))
    }

    pub(super) const fn track(&self) -> &Track {
        &self.track
    }

    pub(super) const fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// Where the robot is, seen from the command's location.
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

    /// Whether it is known where the robot is. A path that it has left says nothing any more, once it is at rest.
    /// `is_moving`: by an order to Prim; `is_half_way`: in the exchange of a gripper, or at the tool drum.
    pub(super) fn knowledge(
        &self,
        is_moving: bool,
        is_half_way: bool,
        inputs: &EmoveInputs<'_>,
    ) -> PlaceKnowledge {
        // On its return to a path the robot moves, and is not on it yet.
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

    /// Is the robot still where its last motion ended?
    pub(super) fn sense_place(&mut self, present: &Frame) {
        let there =
            |pose: &Pose| pose.to_frame().is_ok_and(|frame| near(&frame, present, LOST_INCHES, LOST_RADIANS));
        self.away = self.place.as_ref().is_some_and(|place| !there(&place.pose));
    }

    /// Which known places are nearest, as long as it is not known where the robot is.
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

    /// Forget the known places around the robot.
    pub fn forget_surroundings(&mut self) {
        self.surroundings = Surroundings::default();
    }

    /// Look through some more location points for the one at which the robot stands.
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

    /// The robot has come to rest at the goal of a motion.
    pub(super) const fn arrive(&mut self, at: RobotPlace) {
        (self.place, self.way, self.away) = (Some(at), None, false);
    }

    /// The robot stands where relative moves have led it: it is at the location of the command.
    pub(super) fn stand(&mut self, gone_to: GoneTo, command: &EmoveCommand, memory: &CommonMemory) {
        if let Some(pose) = commanded_pose(memory) {
            (self.place, self.away) = (Some(robot_at(command, gone_to, pose)), false);
        }
    }

    /// Without a motion the robot is at another place, or at none any more.
    pub(super) const fn set_place(&mut self, at: Option<RobotPlace>) {
        self.place = at;
    }

    /// A relative move is ordered: the robot is at no place, and on no path.
    pub(super) const fn leave(&mut self) {
        (self.place, self.way) = (None, None);
    }

    /// What was brought has been let go, or is lost: the empty fingers depart as from any object.
    pub(super) const fn note_empty_fingers(&mut self) {
        if let Some(place) = &mut self.place
            && let GoneTo::Brought(object) = place.gone_to
        {
            place.gone_to = GoneTo::Object(object);
        }
    }
}
