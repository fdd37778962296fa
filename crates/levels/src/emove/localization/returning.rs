//! Return of a robot to its place or its path (docs/design/recovery.md "Return").
//!
//! ```text
//!   at its place     within 0.02 in: there; within 0.5 in: straight back, unless the held part may be clamped
//!   off its path     to the nearest point of the segment
//!   moved farther    back along the record of how the joystick box has moved it; or straight to a resting place;
//!                    or out of a nest, against its approach
//! ```

use geometry::{
    frame::{Frame, Vector, norm},
    pose::Pose,
};
use interfaces::{
    emove::{GoneTo, Holding, Offset as Deviation, RobotPlace, Way},
    location::Site,
};
use taskdata::files::{Locpt, LocptId, Target, TaskData, TrajParaId};

use super::{
    Localization,
    path::{foot, route_of, segment},
    surroundings::is_plain,
    track,
};
use crate::{
    emove::{
        EmoveInputs,
        motion::{
            flight::{Flight, Rejoin},
            route::{Planning, approach_to},
        },
        robot_place::{self, THERE_INCHES, THERE_RADIANS, commanded_pose, near, present_frame},
        tables::{
            Knowledge,
            resume::{EmoveOffset, EmoveStanding, Stance, stance},
            returning::{BroughtObject, EmoveOrigin, Lost, Near, Return, returning},
        },
    },
    places::is_in_mbd,
};

/// A closing vise or pedestal shifts the hand by at most this, in: the part has 0.06 in of play (docs/cell.md
/// "Budget"), and the fingers yield.
const CLAMP_INCHES: f64 = 0.1;
const CLAMP_RADIANS: f64 = 0.5 * core::f64::consts::PI / 180.0; // half a degree
/// A robot within this short distance (IV.3.3 step 19) moves straight to a resting place. ASSUMED.
const RESTING_INCHES: f64 = 12.0;
const RESTING_RADIANS: f64 = 45.0 * core::f64::consts::PI / 180.0; // 45 degrees
const NEST_INCHES: f64 = 2.0; // within which a robot leaves a nest along its approach line
const NEST_RADIANS: f64 = 10.0 * core::f64::consts::PI / 180.0; // 10 degrees

pub(in crate::emove) struct StartPlace {
    pub place: Option<RobotPlace>,
    pub way: Option<Way>,    // an interrupted path, instead of a place
    pub offset: EmoveOffset, // the robot's offset from its place
    pub rejoin: Option<Rejoin>,
    pub is_out: bool, // the robot returns to the end of the depart leg
}

/// The parameters of the approach's stop line. If the place has no approach, the parameters of the last point of a
/// trajectory to the place. A motion to the place uses the same parameters (SPECNOTES).
fn parameters_at(at: &RobotPlace, data: &TaskData<'_>) -> Option<TrajParaId> {
    let last = |path| Some(data.path(path).last()?.para);
    approach_to(at, data).and_then(last).or_else(|| {
        let leads_there = |end| data.aliases(&at.site.place()).any(|alias| alias == end);
        data.trajectories.iter().filter(|trajectory| leads_there(trajectory.end)).find_map(|it| last(it.path))
    })
}

/// True if a part carried to a place, or grasped there, may be clamped. A tray does not clamp. No sensor reads the
/// vises, nor the pedestal's hand to 0.01 in.
fn clamps(at: &RobotPlace, data: &TaskData<'_>) -> bool {
    let is_tray = at.site.sector.is_some() || is_in_mbd(at.site.record, data);
    matches!(at.gone_to, GoneTo::Object(_) | GoneTo::Brought(_)) && !is_tray
}

/// A robot may move straight to a location whose plain approach has no points.
fn is_resting(id: LocptId, locpt: &Locpt, data: &TaskData<'_>) -> bool {
    let site = Site::point(locpt.name, id);
    let approach = data.approach_location(&site.place()).map(|path| data.path(path));
    is_plain(&site, data) && approach.is_some_and(|path| path.len() == 1)
}

/// The nearest location, within reach of a straight move. It stays the nearest one during the move.
fn resting_place(present: &Frame, data: &TaskData<'_>) -> Option<RobotPlace> {
    let off = |locpt: &Locpt| norm(&(locpt.frame.position - present.position));
    let numbered = (1..).map(LocptId::new).zip(data.locpts);
    let (id, nearest) = numbered.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b)))?;
    let is_near = near(&nearest.frame, present, RESTING_INCHES, RESTING_RADIANS);
    (is_near && is_resting(id, nearest, data)).then(|| RobotPlace {
        gone_to: GoneTo::Location,
        site: Site::point(nearest.name, id),
        pose: Pose::from_frame(&nearest.frame),
    })
}

/// A robot leaves a nest against the direction of the approach until level with the outermost point, then to it.
fn out_of(nest: &RobotPlace, present: &Frame, data: &TaskData<'_>) -> Option<[Frame; 2]> {
    let seat = nest.pose.to_frame().ok()?;
    let first = data.path(approach_to(nest, data)?).first().filter(|point| point.target != Target::Stop)?;
    let outermost = data.point_frame(first, &seat)?;
    let out: Vector = outermost.position - seat.position;
    let length = norm(&out);
    if length <= 0.0 || present.distance(&seat).radians > NEST_RADIANS {
        return None;
    }
    let along = (present.position - seat.position).dot(&out) / length;
    let aside = norm(&(present.position - seat.position - out * (along / length)));
    let is_beside = (-THERE_INCHES..=length + NEST_INCHES).contains(&along) && aside <= NEST_INCHES;
    let level = Frame { position: present.position + out * ((length - along).max(0.0) / length), ..*present };
    is_beside.then_some([level, outermost])
}

fn on_segment(present: &Frame, way: &Way, data: &TaskData<'_>) -> Option<(Frame, TrajParaId)> {
    let (start, end, [_, parameters]) = segment(way, data)?;
    Some((foot(present, &start, &end), parameters))
}

fn to_way(present: &Frame, way: &Way, data: &TaskData<'_>) -> Option<Rejoin> {
    let (foot, parameters) = on_segment(present, way, data)?;
    let beside = !near(present, &foot, THERE_INCHES, THERE_RADIANS);
    beside.then(|| Rejoin::to(Pose::from_frame(&foot), parameters))
}

/// The error is the reason why the return is refused.
pub(in crate::emove) fn settle_at(
    at: &RobotPlace,
    offset: EmoveOffset,
    data: &TaskData<'_>,
) -> Result<Option<Rejoin>, Planning> {
    match stance((), &EmoveStanding { offset }).action {
        Stance::Stay => Ok(None),
        Stance::Correct => {
            let parameters = parameters_at(at, data).ok_or(Planning::NoSpeed)?;
            Ok(Some(Rejoin::to(at.pose, parameters)))
        }
        Stance::RefuseOff => Err(Planning::OffPlace),
        Stance::RefuseStart => Err(Planning::NoStart),
    }
}

/// A closing vise shifts the hand but not the commanded pose; the joystick box moves both.
fn offset(
    at: &RobotPlace,
    present: Option<&Frame>,
    holding: Holding,
    inputs: &EmoveInputs<'_>,
) -> EmoveOffset {
    let Ok(goal) = at.pose.to_frame() else { return EmoveOffset::Unseen };
    let is_there = |frame: &Frame| near(frame, &goal, THERE_INCHES, THERE_RADIANS);
    let is_sent_there = || {
        let commanded = commanded_pose(inputs.memory).and_then(|pose| pose.to_frame().ok());
        commanded.is_some_and(|frame| is_there(&frame))
    };
    let is_clamped = || {
        let gripped = holding.is_held() && clamps(at, inputs.data);
        gripped || at.gone_to == GoneTo::Drum
    };
    match present {
        Some(present) if is_there(present) => EmoveOffset::There,
        Some(present) if is_clamped() => {
            let is_shifted = is_sent_there() && near(present, &goal, CLAMP_INCHES, CLAMP_RADIANS);
            if is_shifted { EmoveOffset::There } else { EmoveOffset::Clamped }
        }
        Some(_) => EmoveOffset::Moved,
        None if is_sent_there() => EmoveOffset::There,
        None => EmoveOffset::Unseen,
    }
}

/// A robot whose hand was shifted by a vise or pedestal that closed on the held part is still at the place.
pub(in crate::emove) fn offset_of_place(
    at: &RobotPlace,
    present: Option<&Frame>,
    holding: Holding,
    inputs: &EmoveInputs<'_>,
) -> Deviation {
    match robot_place::offset(&at.pose, present) {
        Deviation::Slight | Deviation::Off if offset(at, present, holding, inputs) == EmoveOffset::There => {
            Deviation::None
        }
        seen => seen,
    }
}

impl Localization {
    /// The return to the place before a command there. The error is the reason why the return is refused.
    pub(in crate::emove) fn stand_still(
        &self,
        holding: Holding,
        inputs: &EmoveInputs<'_>,
    ) -> Result<Flight, Planning> {
        let Some(at) = self.place() else { return Ok(Flight::default()) };
        let present = present_frame(inputs.memory);
        let rejoin = settle_at(at, offset(at, present.as_ref(), holding, inputs), inputs.data)?;
        Ok(Flight { rejoin, ..Flight::default() })
    }

    /// The error is the reason why the robot cannot reach the start.
    pub(in crate::emove) fn origination(
        &self,
        holding: Holding,
        inputs: &EmoveInputs<'_>,
    ) -> Result<StartPlace, Planning> {
        let data = inputs.data;
        let nowhere =
            StartPlace { place: None, way: None, offset: EmoveOffset::There, rejoin: None, is_out: false };
        let present = present_frame(inputs.memory);
        if let Some(place) = self.place() {
            return Ok(StartPlace {
                place: Some(*place),
                offset: offset(place, present.as_ref(), holding, inputs),
                ..nowhere
            });
        }
        if let Some(way) = self.on_path(inputs) {
            let rejoin = present.filter(|_| way.by_hand).and_then(|present| to_way(&present, &way, data));
            return Ok(StartPlace { way: Some(way), rejoin, ..nowhere });
        }
        let present = present.unwrap_or_else(Frame::identity);
        let (left, way) = (self.place, self.way);
        let resting = resting_place(&present, data);
        let out = left.and_then(|nest| out_of(&nest, &present, data));
        let back = StartPlace { offset: EmoveOffset::Moved, ..nowhere };
        let to_place =
            |place: RobotPlace, rejoin| StartPlace { place: Some(place), rejoin: Some(rejoin), ..back };
        let parameters = |at: &RobotPlace| parameters_at(at, data).ok_or(Planning::NoSpeed);
        let record = &self.track;
        match (returning((), &self.lost(resting.is_some(), out.is_some(), holding, inputs)).action, left, way)
        {
            (Return::Retrace, Some(left), _) => {
                let back = Rejoin { track: record.count, ..Rejoin::to(left.pose, parameters(&left)?) };
                Ok(to_place(left, back))
            }
            (Return::Retrace, None, Some(way)) => {
                let way = Way { by_hand: true, ..way };
                let begins = track::points(record).next().and_then(|pose| pose.to_frame().ok());
                let foot =
                    begins.and_then(|begins| on_segment(&begins, &way, data)).ok_or(Planning::NoStart)?;
                let back = Rejoin::to(Pose::from_frame(&foot.0), route_of(&way, data)?.stop);
                let rejoin = Rejoin { track: record.count, ..back };
                Ok(StartPlace { way: Some(way), rejoin: Some(rejoin), ..nowhere })
            }
            (Return::Straight, ..) => {
                let place = resting.ok_or(Planning::NoStart)?;
                Ok(to_place(place, Rejoin::to(place.pose, parameters(&place)?)))
            }
            (Return::Out, Some(nest), _) => {
                let points = out.ok_or(Planning::NoStart)?.map(|frame| Some(Pose::from_frame(&frame)));
                let rejoin = Rejoin { track: 0, points, parameters: parameters(&nest)? };
                Ok(StartPlace { is_out: true, ..to_place(nest, rejoin) })
            }
            (Return::Retrace | Return::Out | Return::Refuse, ..) => Err(Planning::NoStart),
        }
    }

    fn lost(&self, resting: bool, nest: bool, holding: Holding, inputs: &EmoveInputs<'_>) -> Lost {
        let left = self.place;
        let clampable = left.is_some_and(|left| clamps(&left, inputs.data)) && holding.is_held();
        Lost {
            resolvers: match present_frame(inputs.memory) {
                Some(_) => Knowledge::Known,
                None => Knowledge::Unknown,
            },
            course: self.track.course,
            origin: match (left.map(|left| left.gone_to), self.way) {
                (Some(GoneTo::Drum), _) => EmoveOrigin::Drum,
                (Some(_), _) => EmoveOrigin::Place,
                (None, Some(_)) => EmoveOrigin::Way,
                (None, None) => EmoveOrigin::None,
            },
            freight: if clampable { BroughtObject::Clampable } else { BroughtObject::Free },
            near: match (nest, resting) {
                (true, _) => Near::Nest,
                (false, true) => Near::Resting,
                (false, false) => Near::Nothing,
            },
        }
    }
}
