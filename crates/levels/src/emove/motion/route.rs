//! The path from the place of the robot to the goal of a command (V.2.1 MOV-TO-LOC): depart points, intermediate
//! trajectory, approach points, stop. [`super::flight`] continues an interrupted path.
//!
//! ```text
//!   departure --depart--> . --trajectory--> . --approach--> . --stop--> goal
//!   data of the object         by the pair       data of the new
//!   at the departure           of locations      object and grip
//! ```

use geometry::{frame::Frame, pose::Pose};
use interfaces::emove::{EmoveCommand, EmoveVerb, GoneTo, Leg as Part, ObjectGrip, RobotPlace};
use rcs_core::Plain;
use taskdata::files::{MovtabId, PathId, PathPoint, Target, TaskData, TrajParaId};

use crate::emove::robot_place::{gone_to, robot_at};

/// Opening for pictures, 0.01 in: the camera looks between the open fingers (V.2.1 MOV-TO-VU). The parts gripper
/// opens this wide; the others open to their stop.
pub const FULL_OPENING: i32 = 500;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Planning {
    /// A way exists, or the command needs none.
    Planned,
    /// No record contains the pose of the command.
    NoPose,
    /// The pose of the command is not a valid frame.
    BadPose,
    /// Object and grip have no record of END-EFF-PARA.
    NoSizes,
    /// Object, grip and location have no grip movetable.
    NoGrip,
    /// The object has no record of VISION-PARA.
    NoView,
    /// The task data have no approach for object and grip at the location.
    NoApproach,
    /// The robot's place is unknown.
    NoStart,
    /// The robot has been moved off its place, and the held part may be clamped there.
    OffPlace,
    /// The robot stopped on a way that it can only continue, and the goal is another one.
    ForwardOnly,
    /// The fingers are around a tool in the drum.
    InDrum,
    /// No trajectory leads from the robot's place to the location of the goal.
    NoTrajectory,
    /// The task data do not specify the speed of the approach.
    NoSpeed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ahead {
    /// A point on the way back to the position before manual motion.
    Rejoin,
    /// None: the robot is at the goal, or has been sent there.
    Nothing,
    /// A point to go through.
    Through,
    /// The goal, to stop at.
    Stop,
    /// A point whose record is missing.
    Missing,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Route {
    pub from: RobotPlace,
    pub to: RobotPlace,
    /// Relative to the pose of departure. It is the approach in reverse with a brought object, or if no depart exists.
    pub depart: PathId,
    pub between: PathId,
    /// Points relative to the goal, and the stop.
    pub approach: PathId,
    pub stop: TrajParaId,     // parameters of the final motion
    pub commanded: u16,       // points commanded so far
    pub complete: bool,       // the goal has been commanded, or is not needed
    pub opening: Option<i32>, // at the goal, 0.01 in; `None` if no opening is required
    pub opening_sent: bool,
    pub departure: u32, // record number of the pose, once it is published
    pub goal: u32,      // record number of the pose, once it is published
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmoveLeg {
    pub at: LegGoal,
    pub parameters: TrajParaId,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegGoal {
    Record {
        pose: u32,           // a record of POSE, or a changing record
        movetable: MovtabId, // if the point has one
    },
    Computed(Frame), // a movetable applied to the previous trajectory point
}

#[derive(Clone, Copy, Debug)]
pub struct EmoveGoal {
    pub frame: Frame,         // of the tool
    pub opening: Option<i32>, // 0.01 in; `None` if no opening is required
    pub gone_to: GoneTo,
}

impl EmoveGoal {
    /// `base` is the pose of the command, or of the object found by vision. The error is the missing record.
    pub fn new(command: &EmoveCommand, base: &Frame, data: &TaskData<'_>) -> Result<Self, Planning> {
        let (place, gone_to) = (command.site.place(), gone_to(command));
        let object = command.object.as_ref();
        let grip_frame = || {
            let movetable = object.and_then(|object| data.grip_movetable(object, command.grip, &place));
            Ok(data.moved(base, movetable.ok_or(Planning::NoGrip)?))
        };
        let grip_approach = || object.and_then(|object| data.approach(object, command.grip, &place));
        let (frame, opening, approach) = match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovToHol => {
                let sizes = data.end_eff(command.object_parameters).ok_or(Planning::NoSizes)?;
                (grip_frame()?, Some(sizes.appr_size), grip_approach())
            }
            EmoveVerb::MovObjTo => (grip_frame()?, None, grip_approach()),
            EmoveVerb::MovToVu => {
                let view = data.vision_para(command.object_vision).ok_or(Planning::NoView)?;
                let approach = object.and_then(|object| data.view_approach(object, command.grip, &place));
                (data.moved(base, view.movetable), Some(FULL_OPENING), approach)
            }
            _ => return Ok(Self { frame: *base, opening: None, gone_to }),
        };
        approach.ok_or(Planning::NoApproach)?;
        Ok(Self { frame, opening, gone_to })
    }

    #[must_use]
    pub fn place(&self, command: &EmoveCommand) -> RobotPlace {
        robot_at(command, self.gone_to, Pose::from_frame(&self.frame))
    }
}

#[must_use]
pub fn approach_to(at: &RobotPlace, data: &TaskData<'_>) -> Option<PathId> {
    let there = at.site.place();
    match at.gone_to {
        GoneTo::Location | GoneTo::Drum => data.approach_location(&there),
        GoneTo::Object(ObjectGrip { object, grip }) | GoneTo::Brought(ObjectGrip { object, grip }) => {
            data.approach(&object, grip, &there)
        }
        GoneTo::View(ObjectGrip { object, grip }) => data.view_approach(&object, grip, &there),
    }
}

/// True if the robot leaves along its approach in reverse, because it brought an object or has no depart path.
fn takes_out(from: &RobotPlace, data: &TaskData<'_>) -> bool {
    match from.gone_to {
        GoneTo::Brought(_) => true,
        GoneTo::Object(ObjectGrip { object, grip }) => {
            data.depart(&object, grip, &from.site.place()).is_none()
        }
        GoneTo::Location | GoneTo::View(_) | GoneTo::Drum => false,
    }
}

/// A retraced segment obeys the limits of both ends.
pub(super) fn slower(a: TrajParaId, b: TrajParaId, data: &TaskData<'_>) -> TrajParaId {
    let velocity = |id| data.traj_para(id).map_or(i32::MAX, |parameters| parameters.vel_max);
    if velocity(b) < velocity(a) { b } else { a }
}

impl Route {
    #[must_use]
    pub fn here(from: &RobotPlace, to: &RobotPlace, opening: Option<i32>) -> Self {
        Self { from: *from, to: *to, opening, complete: true, ..Self::default() }
    }

    /// The straight way between two poses at the same place, such as the camera's over a part.
    #[must_use]
    pub fn straight(from: &RobotPlace, to: &RobotPlace, stop: TrajParaId) -> Self {
        Self { from: *from, to: *to, stop, ..Self::default() }
    }

    /// The error is the reason why no way exists.
    pub fn between(from: &RobotPlace, to: &RobotPlace, data: &TaskData<'_>) -> Result<Self, Planning> {
        let (start, end) = (from.site.place(), to.site.place());
        let depart = match from.gone_to {
            GoneTo::Drum => return Err(Planning::InDrum),
            GoneTo::Location => data.depart_location(&start),
            // With the object the robot leaves along its approach, since the depart path may be for empty fingers. The
            // same applies without a depart path, as above a holster.
            GoneTo::Object(ObjectGrip { object, grip }) | GoneTo::Brought(ObjectGrip { object, grip }) => {
                if takes_out(from, data) {
                    data.approach(&object, grip, &start)
                } else {
                    data.depart(&object, grip, &start)
                }
            }
            GoneTo::View(ObjectGrip { object, grip }) => data.view_depart(&object, grip, &start),
        };
        let between =
            if start.has_location_of(&end) { Some(PathId::NULL) } else { data.trajectory(&start, &end) };
        let mut route = Self {
            from: *from,
            to: *to,
            depart: depart.unwrap_or(PathId::NULL),
            between: between.ok_or(Planning::NoTrajectory)?,
            approach: approach_to(to, data).unwrap_or(PathId::NULL),
            ..Self::default()
        };
        route.stop = route.stop_line(data).ok_or(Planning::NoSpeed)?.para;
        Ok(route)
    }

    /// The line of the task data for a point, from 0; the goal is the last point.
    #[must_use]
    pub fn written<'a>(&self, point: u16, data: &TaskData<'a>) -> Option<&'a PathPoint> {
        let through = self.points(data).nth(usize::from(point)).map(|(_, found)| found);
        through.or_else(|| self.stop_line(data))
    }

    /// The parameters of the final motion: the stop line of the approach; without an approach, the last point before
    /// the goal (ASSUMED, SPECNOTES).
    fn stop_line<'a>(&self, data: &TaskData<'a>) -> Option<&'a PathPoint> {
        [self.approach, self.between, self.depart].into_iter().find_map(|path| data.path(path).last())
    }

    /// The through points, in the direction of the goal.
    fn points<'a>(&self, data: &TaskData<'a>) -> impl Iterator<Item = (Part, &'a PathPoint)> + use<'a> {
        let part = |part, path| data.path(path).iter().map(move |point| (part, point));
        let (depart, none): (&[PathPoint], &[PathPoint]) = (data.path(self.depart), &[]);
        let (written, reversed) = if takes_out(&self.from, data) { (none, depart) } else { (depart, none) };
        let depart = written.iter().chain(reversed.iter().rev());
        depart
            .map(|point| (Part::Depart, point))
            .chain(part(Part::Trajectory, self.between))
            .chain(part(Part::Approach, self.approach))
            .filter(|(_, point)| point.target != Target::Stop)
    }

    /// `None` if the goal is next, or the route is complete.
    fn next_point<'a>(&self, data: &TaskData<'a>) -> Option<(Part, &'a PathPoint)> {
        if self.complete { None } else { self.points(data).nth(usize::from(self.commanded)) }
    }

    #[must_use]
    pub fn depart_points(&self, data: &TaskData<'_>) -> u16 {
        let points = data.path(self.depart).iter().filter(|point| point.target != Target::Stop);
        u16::try_from(points.count()).unwrap_or(u16::MAX)
    }

    /// The last point sent, from 0.
    #[must_use]
    pub const fn heading(&self) -> u16 {
        if self.complete { self.commanded } else { self.commanded.saturating_sub(1) }
    }

    #[must_use]
    pub fn part(&self, point: u16, data: &TaskData<'_>) -> Part {
        self.points(data).nth(usize::from(point)).map_or(Part::Approach, |(part, _)| part)
    }

    /// The goal is the last point. `None` if a record is missing.
    #[must_use]
    pub fn point(&self, point: u16, data: &TaskData<'_>) -> Option<(Frame, TrajParaId)> {
        let (departure, goal) = (self.from.pose.to_frame().ok()?, self.to.pose.to_frame().ok()?);
        let mut before = departure;
        for (part, point) in self.points(data).take(usize::from(point).saturating_add(1)) {
            let reference = match part {
                Part::Depart => &departure,
                Part::Trajectory => &before,
                Part::Approach => &goal,
            };
            let frame = data.point_frame(point, reference)?;
            before = if part == Part::Depart { departure } else { frame };
        }
        match self.points(data).nth(usize::from(point)) {
            Some((Part::Depart, found)) => Some((data.point_frame(found, &departure)?, found.para)),
            Some((_, found)) => Some((before, found.para)),
            None => Some((goal, self.stop)),
        }
    }

    #[must_use]
    pub fn ahead(&self, data: &TaskData<'_>) -> Ahead {
        match self.next_point(data) {
            Some(_) if self.leg(data).is_some() => Ahead::Through,
            Some(_) => Ahead::Missing,
            None if self.complete => Ahead::Nothing,
            None => Ahead::Stop,
        }
    }

    /// While the next point is a depart point, the fingers must not move (docs/design/motion.md "Finger opening").
    #[must_use]
    pub fn departing(&self, data: &TaskData<'_>) -> bool {
        matches!(self.next_point(data), Some((Part::Depart, _)))
    }

    /// `None` if a record is missing or the route is complete.
    #[must_use]
    pub fn leg(&self, data: &TaskData<'_>) -> Option<EmoveLeg> {
        let record = |pose: u32, movetable: MovtabId| LegGoal::Record { pose, movetable };
        let Some((part, point)) = self.next_point(data) else {
            let at = record(self.goal, MovtabId::NULL);
            return (!self.complete).then_some(EmoveLeg { at, parameters: self.stop });
        };
        let at = match (point.target, part) {
            (Target::Pose(id), _) => record(id.number(), MovtabId::NULL),
            (Target::LocationPoint(id), _) => {
                let locpt = data.locpt(id)?;
                record(locpt.pose.number(), locpt.movetable)
            }
            (Target::Movetable(id), Part::Depart) => record(self.departure, id),
            (Target::Movetable(id), Part::Approach) => record(self.goal, id),
            (Target::Movetable(_), Part::Trajectory) => {
                LegGoal::Computed(self.point(self.commanded, data)?.0)
            }
            (Target::Stop, _) => return None,
        };
        let reversed = part == Part::Depart && takes_out(&self.from, data);
        let parameters = if reversed { slower(point.para, self.behind(data)?, data) } else { point.para };
        Some(EmoveLeg { at, parameters })
    }

    fn behind(&self, data: &TaskData<'_>) -> Option<TrajParaId> {
        match self.commanded.checked_sub(1) {
            Some(before) => self.points(data).nth(usize::from(before)).map(|(_, point)| point.para),
            None => data.path(self.depart).last().map(|stop| stop.para),
        }
    }

    pub fn advance(&mut self, data: &TaskData<'_>) {
        if self.next_point(data).is_some() {
            self.commanded = self.commanded.saturating_add(1);
        } else {
            self.complete = true;
        }
    }
}
