//! The way from where the robot is to the goal of a command (V.2.1 MOV-TO-LOC): depart points, intermediate
//! trajectory, approach points, stop.
//!
//! ```text
//!   stance --depart--> . --trajectory--> . --approach--> . --stop--> goal
//!   data of the object      by the pair       data of the new
//!   that was gone to        of locations      object and grip
//! ```

use rcs_core::{
    Plain,
    frame::Frame,
    interface::{
        Reason,
        emove::{EmoveCommand, EmoveVerb},
    },
};
use taskdata::files::{EndEffId, MovtabId, PathId, PathPoint, Place, Target, TaskData, TrajParaId, VisionId};

use super::state::{Sort, Stance};
use crate::places::place_of;

/// Opening, 0.01 in, when pictures are taken: the camera looks between the open fingers (V.2.1 MOV-TO-VU).
/// The parts gripper opens as wide; the others open to their stop.
pub const FULL_OPENING: i32 = 500;
/// The robot is at a goal if it is within this many inches …
pub const THERE_INCHES: f64 = 0.02;
/// … and this many radians (0.1 degree) of it.
pub const THERE_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0;

/// What lies ahead on the route.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ahead {
    /// Nothing: the robot is at the goal.
    Nothing,
    /// A point to go through.
    Through,
    /// The goal, to stop at.
    Stop,
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
    /// Opening of the fingers at the goal, 0.01 in; negative if it does not matter.
    pub opening: i32,
    /// The opening has been commanded.
    pub opening_sent: bool,
    /// The pose departed from (changing record).
    pub departure: u32,
    /// The goal (changing record).
    pub goal: u32,
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
        /// Record of MOVTAB, 0 for none.
        movetable: u32,
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
    /// Opening of the fingers, 0.01 in; negative if it does not matter.
    pub opening: i32,
    /// What is gone to.
    pub sort: Sort,
}

impl Goal {
    /// The goal of a motion command. `base` is the pose of the command, or where vision found the object.
    ///
    /// # Errors
    /// The [`Reason`] why there is none.
    pub fn new(command: &EmoveCommand, base: &Frame, data: &TaskData<'_>) -> Result<Self, Reason> {
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let grip_frame = || {
            let movetable =
                data.grip_movetable(&command.object, command.grip, &place).ok_or(Reason::NoGripMovetable)?;
            Ok(data.moved(base, movetable))
        };
        let approach = || data.approach(&command.object, command.grip, &place).ok_or(Reason::NoApproach);
        match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovToHol => {
                let parameters =
                    data.end_eff(EndEffId::new(command.object_parameters)).ok_or(Reason::UnknownGrip)?;
                Ok(Self {
                    frame: grip_frame()?,
                    approach: approach()?,
                    opening: parameters.appr_size,
                    sort: Sort::Object,
                })
            }
            EmoveVerb::MovObjTo => {
                Ok(Self { frame: grip_frame()?, approach: approach()?, opening: -1, sort: Sort::Object })
            }
            EmoveVerb::MovToVu => {
                let view = data.vision_para(VisionId::new(command.object_vision)).ok_or(Reason::BadRecord)?;
                Ok(Self {
                    frame: data.moved(base, view.movetable),
                    approach: data
                        .view_approach(&command.object, command.grip, &place)
                        .ok_or(Reason::NoApproach)?,
                    opening: FULL_OPENING,
                    sort: Sort::View,
                })
            }
            EmoveVerb::None
            | EmoveVerb::Pause
            | EmoveVerb::MovToLoc
            | EmoveVerb::LocateObj
            | EmoveVerb::GraspObj
            | EmoveVerb::Release
            | EmoveVerb::QcDetach
            | EmoveVerb::QcAttach
            | EmoveVerb::Withdraw
            | EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => Ok(Self {
                frame: *base,
                approach: data.approach_location(&place).unwrap_or(PathId::NULL),
                opening: -1,
                sort: Sort::Location,
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
    /// Plan the way to `goal` from where the robot is.
    ///
    /// # Errors
    /// [`Reason::UnknownStart`] if it is not known where the robot is, [`Reason::NotPrepared`] if its fingers
    /// are around a tool in the drum, [`Reason::NoTrajectory`] if no trajectory leads from there to the
    /// goal's location, [`Reason::NoApproach`] if nothing says how fast the goal is approached.
    pub fn plan(
        command: &EmoveCommand,
        goal: &Goal,
        stance: &Stance,
        data: &TaskData<'_>,
    ) -> Result<Self, Reason> {
        if !stance.known {
            return Err(Reason::UnknownStart);
        }
        let from = stance.place();
        let to = place_of(command.location_kind, command.location_record, command.location_array);
        let start = stance.pose.to_frame().map_err(|_| Reason::UnknownStart)?;
        let here = same_location(&from, &to);
        if here && near(&start, &goal.frame, THERE_INCHES, THERE_RADIANS) {
            return Ok(Self { complete: true, opening: goal.opening, ..Self::default() });
        }
        let depart = match stance.sort {
            Sort::Drum => return Err(Reason::NotPrepared),
            Sort::Location => data.depart_location(&from),
            Sort::Object => data.depart(&stance.object, stance.grip, &from),
            Sort::View => data.view_depart(&stance.object, stance.grip, &from),
        }
        .unwrap_or(PathId::NULL);
        let between =
            if here { PathId::NULL } else { data.trajectory(&from, &to).ok_or(Reason::NoTrajectory)? };
        let mut route =
            Self { depart, between, approach: goal.approach, opening: goal.opening, ..Self::default() };
        route.stop = route.stop_parameters(data).ok_or(Reason::NoApproach)?;
        Ok(route)
    }

    /// Parameters of the final motion: those of the approach's stop line; where no approach is written, those
    /// of the last point before the goal (ASSUMED, SPECNOTES).
    fn stop_parameters(&self, data: &TaskData<'_>) -> Option<TrajParaId> {
        [self.approach, self.between, self.depart]
            .into_iter()
            .find_map(|path| Some(data.path(path).last()?.para))
    }

    /// The points to go through, in order.
    fn points<'a>(&self, data: &TaskData<'a>) -> impl Iterator<Item = (Part, &'a PathPoint)> + use<'a> {
        let part = |part, path| data.path(path).iter().map(move |point| (part, point));
        part(Part::Depart, self.depart)
            .chain(part(Part::Between, self.between))
            .chain(part(Part::Approach, self.approach))
            .filter(|(_, point)| point.target != Target::Stop)
    }

    /// What lies ahead.
    #[must_use]
    pub fn ahead(&self, data: &TaskData<'_>) -> Ahead {
        if self.complete {
            Ahead::Nothing
        } else if self.points(data).nth(usize::from(self.commanded)).is_some() {
            Ahead::Through
        } else {
            Ahead::Stop
        }
    }

    /// True while the next point is a depart point: the fingers must not move yet
    /// (docs/design/motion.md "Finger opening").
    #[must_use]
    pub fn departing(&self, data: &TaskData<'_>) -> bool {
        !self.complete
            && matches!(self.points(data).nth(usize::from(self.commanded)), Some((Part::Depart, _)))
    }

    /// The next leg; `departure` is the frame departed from. `None` if a record is missing or the route is
    /// complete.
    #[must_use]
    pub fn leg(&self, departure: &Frame, data: &TaskData<'_>) -> Option<Leg> {
        if self.complete {
            return None;
        }
        let Some((part, point)) = self.points(data).nth(usize::from(self.commanded)) else {
            let at = LegGoal::Record { pose: self.goal, movetable: MovtabId::NULL.number() };
            return Some(Leg { at, parameters: self.stop });
        };
        let record = |pose: u32, movetable: MovtabId| LegGoal::Record { pose, movetable: movetable.number() };
        let at = match (point.target, part) {
            (Target::Pose(id), _) => record(id.number(), MovtabId::NULL),
            (Target::LocationPoint(id), _) => {
                let locpt = data.locpt(id)?;
                record(locpt.pose.number(), locpt.movetable)
            }
            (Target::Movetable(id), Part::Depart) => record(self.departure, id),
            (Target::Movetable(id), Part::Approach) => record(self.goal, id),
            (Target::Movetable(_), Part::Between) => LegGoal::Computed(self.between_frame(departure, data)?),
            (Target::Stop, _) => return None,
        };
        Some(Leg { at, parameters: point.para })
    }

    /// The frame of the next trajectory point, each relative to the one before it (VII.6), the first to the
    /// departure.
    fn between_frame(&self, departure: &Frame, data: &TaskData<'_>) -> Option<Frame> {
        let points = data.path(self.between);
        let before = data.path(self.depart).len();
        let last = usize::from(self.commanded).checked_sub(before)?;
        points.get(..=last)?.iter().try_fold(*departure, |frame, point| data.point_frame(point, &frame))
    }

    /// Note that the next leg has been commanded.
    pub fn advance(&mut self, data: &TaskData<'_>) {
        if self.ahead(data) == Ahead::Stop {
            self.complete = true;
        } else {
            self.commanded = self.commanded.saturating_add(1);
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
