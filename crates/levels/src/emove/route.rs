//! The way from where the robot is to the goal of a command (V.2.1 MOV-TO-LOC): depart points, intermediate
//! trajectory, approach points, stop.
//!
//! ```text
//!   departure --depart--> . --trajectory--> . --approach--> . --stop--> goal
//!   data of the object         by the pair       data of the new
//!   that was gone to           of locations      object and grip
//! ```

use rcs_core::{
    Plain,
    frame::Frame,
    interface::{
        ChangingPose,
        emove::{EmoveCommand, EmoveVerb},
    },
    pose::Pose,
};
use taskdata::files::{EndEffId, MovtabId, PathId, PathPoint, Place, Target, TaskData, TrajParaId, VisionId};

use super::robot_place::{GoneTo, ObjectGrip, RobotPlace, place_named};

/// Opening, 0.01 in, when pictures are taken: the camera looks between the open fingers (V.2.1 MOV-TO-VU).
/// The parts gripper opens as wide; the others open to their stop.
pub const FULL_OPENING: i32 = 500;
/// The robot is at a goal if it is within this many inches …
pub const THERE_INCHES: f64 = 0.02;
/// … and this many radians (0.1 degree) of it.
pub const THERE_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0;

/// What planning the way of a motion command came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Planning {
    /// There is a way, or the command needs none.
    Planned,
    /// No record holds the pose of the command.
    NoPose,
    /// The pose of the command is no frame.
    BadPose,
    /// Object and grip have no record of END-EFF-PARA.
    NoSizes,
    /// Object, grip and location have no grip movetable.
    NoGrip,
    /// The object has no record of VISION-PARA.
    NoView,
    /// Nothing is written on the approach of object and grip at the location.
    NoApproach,
    /// It is not known where the robot is.
    NoStart,
    /// The fingers are around a tool in the drum.
    InDrum,
    /// No trajectory leads from where the robot is to the location of the goal.
    NoTrajectory,
    /// Nothing says how fast the goal is approached.
    NoSpeed,
}

/// What lies ahead on the route.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ahead {
    /// Nothing: the robot is at the goal, or has been sent there.
    Nothing,
    /// A point to go through.
    Through,
    /// The goal, to stop at.
    Stop,
    /// A point whose record is missing.
    Missing,
}

/// A planned way and how far it has been commanded.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Route {
    /// Depart points, relative to the pose departed from.
    pub depart: PathId,
    /// Intermediate trajectory.
    pub between: PathId,
    /// Approach points, relative to the goal, and the stop.
    pub approach: PathId,
    /// Parameters of the final motion.
    pub stop: TrajParaId,
    /// Points commanded so far.
    pub commanded: u16,
    /// The goal has been commanded, or need not be.
    pub complete: bool,
    /// Opening of the fingers at the goal, 0.01 in; `None` if it does not matter.
    pub opening: Option<i32>,
    /// The opening has been commanded.
    pub opening_sent: bool,
    /// The pose departed from; without a number until it is published.
    pub departure: ChangingPose,
    /// The goal; without a number until it is published.
    pub goal: ChangingPose,
}

/// A point of a route that Prim is to be sent to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Where it is.
    pub at: LegGoal,
    /// Parameters.
    pub parameters: TrajParaId,
}

/// Where a leg ends, as Prim is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegGoal {
    /// A record with a movetable applied.
    Record {
        /// Record of POSE, or changing record.
        pose: u32,
        /// Record of MOVTAB, if there is one.
        movetable: Option<u32>,
    },
    /// A frame that no record holds: a movetable on the trajectory point before it.
    Computed(Frame),
}

/// The goal of a command, looked up.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Where the tool is to be.
    pub frame: Frame,
    /// How it is approached; null if nothing is written.
    pub approach: PathId,
    /// Opening of the fingers, 0.01 in; `None` if it does not matter.
    pub opening: Option<i32>,
    /// What is gone to.
    pub gone_to: GoneTo,
}

impl Goal {
    /// The goal of a motion command. `base` is the pose of the command, or where vision found the object.
    ///
    /// # Errors
    /// What is missing.
    pub fn new(command: &EmoveCommand, base: &Frame, data: &TaskData<'_>) -> Result<Self, Planning> {
        let (place, gone_to) = (place_named(command), GoneTo::of(command));
        let grip_frame = || {
            let movetable = data.grip_movetable(&command.object, command.grip, &place);
            Ok(data.moved(base, movetable.ok_or(Planning::NoGrip)?))
        };
        let approach = || data.approach(&command.object, command.grip, &place).ok_or(Planning::NoApproach);
        match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovToHol => {
                let sizes = data
                    .end_eff(EndEffId::from_option(command.object_parameters))
                    .ok_or(Planning::NoSizes)?;
                let opening = Some(sizes.appr_size);
                Ok(Self { frame: grip_frame()?, approach: approach()?, opening, gone_to })
            }
            EmoveVerb::MovObjTo => {
                Ok(Self { frame: grip_frame()?, approach: approach()?, opening: None, gone_to })
            }
            EmoveVerb::MovToVu => {
                let view =
                    data.vision_para(VisionId::from_option(command.object_vision)).ok_or(Planning::NoView)?;
                let approach = data.view_approach(&command.object, command.grip, &place);
                Ok(Self {
                    frame: data.moved(base, view.movetable),
                    approach: approach.ok_or(Planning::NoApproach)?,
                    opening: Some(FULL_OPENING),
                    gone_to,
                })
            }
            _ => Ok(Self {
                frame: *base,
                approach: data.approach_location(&place).unwrap_or(PathId::NULL),
                opening: None,
                gone_to,
            }),
        }
    }
}

/// True if two places are the same location: no intermediate trajectory leads from one to the other.
#[must_use]
pub fn same_location(a: &Place, b: &Place) -> bool {
    a.locpt == b.locpt && (!a.locpt.is_null() || a.array == b.array)
}

/// True if two frames are the same for a robot that is at rest.
#[must_use]
pub fn near(a: &Frame, b: &Frame, inches: f64, radians: f64) -> bool {
    let distance = a.distance(b);
    distance.inches <= inches && distance.radians <= radians
}

impl Route {
    /// Plan the way to `goal` from where the robot is, if that is known.
    ///
    /// # Errors
    /// Why there is no way.
    pub fn plan(
        command: &EmoveCommand,
        goal: &Goal,
        from: Option<&RobotPlace>,
        data: &TaskData<'_>,
    ) -> Result<Self, Planning> {
        let from = from.ok_or(Planning::NoStart)?;
        let to = place_named(command);
        let start = from.pose.to_frame().map_err(|_| Planning::NoStart)?;
        let here = same_location(&from.place, &to);
        let route = Self {
            opening: goal.opening,
            departure: ChangingPose { number: 0, pose: from.pose },
            goal: ChangingPose { number: 0, pose: Pose::from_frame(&goal.frame) },
            ..Self::default()
        };
        if here && near(&start, &goal.frame, THERE_INCHES, THERE_RADIANS) {
            return Ok(Self { complete: true, ..route });
        }
        let depart = match from.gone_to {
            GoneTo::Drum => return Err(Planning::InDrum),
            GoneTo::Location => data.depart_location(&from.place),
            GoneTo::Object(ObjectGrip { object, grip }) => data.depart(&object, grip, &from.place),
            GoneTo::View(ObjectGrip { object, grip }) => data.view_depart(&object, grip, &from.place),
        };
        let between = if here { Some(PathId::NULL) } else { data.trajectory(&from.place, &to) };
        let mut route = Self {
            depart: depart.unwrap_or(PathId::NULL),
            between: between.ok_or(Planning::NoTrajectory)?,
            approach: goal.approach,
            ..route
        };
        route.stop = route.stop_parameters(data).ok_or(Planning::NoSpeed)?;
        Ok(route)
    }

    /// Parameters of the final motion: those of the approach's stop line; where no approach is written, those
    /// of the last point before the goal (ASSUMED, SPECNOTES).
    fn stop_parameters(&self, data: &TaskData<'_>) -> Option<TrajParaId> {
        [self.approach, self.between, self.depart]
            .into_iter()
            .find_map(|path| Some(data.path(path).last()?.para))
    }

    /// The next point to go through; `None` if the goal is next, or the route is complete.
    fn next_point<'a>(&self, data: &TaskData<'a>) -> Option<(Part, &'a PathPoint)> {
        if self.complete {
            return None;
        }
        let part = |part, path| data.path(path).iter().map(move |point| (part, point));
        part(Part::Depart, self.depart)
            .chain(part(Part::Between, self.between))
            .chain(part(Part::Approach, self.approach))
            .filter(|(_, point)| point.target != Target::Stop)
            .nth(usize::from(self.commanded))
    }

    /// What lies ahead.
    #[must_use]
    pub fn ahead(&self, data: &TaskData<'_>) -> Ahead {
        match self.next_point(data) {
            Some(_) if self.leg(data).is_some() => Ahead::Through,
            Some(_) => Ahead::Missing,
            None if self.complete => Ahead::Nothing,
            None => Ahead::Stop,
        }
    }

    /// True while the next point is a depart point: the fingers must not move yet
    /// (docs/design/motion.md "Finger opening").
    #[must_use]
    pub fn departing(&self, data: &TaskData<'_>) -> bool {
        matches!(self.next_point(data), Some((Part::Depart, _)))
    }

    /// The next leg. `None` if a record is missing or the route is complete.
    #[must_use]
    pub fn leg(&self, data: &TaskData<'_>) -> Option<Leg> {
        let record =
            |pose: u32, movetable: MovtabId| LegGoal::Record { pose, movetable: movetable.to_option() };
        let Some((part, point)) = self.next_point(data) else {
            let at = record(self.goal.number, MovtabId::NULL);
            return (!self.complete).then_some(Leg { at, parameters: self.stop });
        };
        let at = match (point.target, part) {
            (Target::Pose(id), _) => record(id.number(), MovtabId::NULL),
            (Target::LocationPoint(id), _) => {
                let locpt = data.locpt(id)?;
                record(locpt.pose.number(), locpt.movetable)
            }
            (Target::Movetable(id), Part::Depart) => record(self.departure.number, id),
            (Target::Movetable(id), Part::Approach) => record(self.goal.number, id),
            (Target::Movetable(_), Part::Between) => LegGoal::Computed(self.between_frame(data)?),
            (Target::Stop, _) => return None,
        };
        Some(Leg { at, parameters: point.para })
    }

    /// The frame of the next trajectory point, each relative to the one before it (VII.6), the first to the
    /// departure.
    fn between_frame(&self, data: &TaskData<'_>) -> Option<Frame> {
        let departure = self.departure.pose.to_frame().ok()?;
        let points = data.path(self.between);
        let before = data.path(self.depart).len();
        let last = usize::from(self.commanded).checked_sub(before)?;
        points.get(..=last)?.iter().try_fold(departure, |frame, point| data.point_frame(point, &frame))
    }

    /// Note that the next leg has been commanded.
    pub fn advance(&mut self, data: &TaskData<'_>) {
        if self.next_point(data).is_some() {
            self.commanded = self.commanded.saturating_add(1);
        } else {
            self.complete = true;
        }
    }
}

/// Which part of a route a point belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Depart,
    Between,
    Approach,
}
