//! Position of the robot in the change of a gripper, and progress of the change (docs/design/recovery.md "Exchange").
//!
//! ```text
//!   bare:     above --- fast --- slow (seat)      QC-ATTACH reads it from left to right and down,
//!                                 |               QC-DETACH the other way round
//!   mated:       up --- lift --- back (low)
//! ```
//!
//! All points follow from the pose of the holster and the relative moves of the two commands.

use geometry::{
    frame::{Frame, norm},
    pose::Pose,
};
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, Exchange},
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    fingers::gripper_on,
    gripper::{Gripper, is_open},
    relative::Relative,
    robot_place::{gone_to, is_led, present_frame, robot_at},
    state::State,
    tables::{Along, Shut},
    way::beside,
    whereabouts::{ASIDE_INCHES, LOST_RADIANS},
};
use crate::places::pose_of;

/// The robot is at the seat within this, in: much less than a relative move is long.
const AT_POINT: f64 = 0.12;
/// It is at the low point within this, in: QCD-DOWN may end a little above or below it.
const AT_LOW: f64 = 0.3;
/// It is clear of the holster within this of the upper points, or beyond them, in.
const CLEAR: f64 = 0.3;
/// It is on a segment within [`ASIDE_INCHES`], and this much above it on the way to the seat: QCD-SEAT begins
/// where the large sensors see the ears, up to half an inch above the low point (V.2.1). QCD-UP ends as much
/// above its point, in.
const ABOVE: f64 = 0.6;

/// The points of the exchange in a holster.
struct Points {
    above: Frame,
    fast: Frame,
    slow: Frame,
    back: Frame,
    lift: Frame,
    up: Frame,
}

impl Points {
    /// The points for a command that names a holster, whose pose is `base`.
    fn of(command: &EmoveCommand, base: &Frame, data: &TaskData<'_>) -> Option<Self> {
        let moved = |from: &Frame, relative: Relative| {
            Some(data.moved(from, relative.record(command, data)?.movetable))
        };
        let slow = moved(base, Relative::QcaSlow)?;
        Some(Self {
            above: moved(&slow, Relative::QcdUp)?,
            fast: moved(base, Relative::QcaFast)?,
            slow,
            back: moved(base, Relative::QcaBack)?,
            lift: moved(base, Relative::QcaLift)?,
            up: moved(base, Relative::QcaUp)?,
        })
    }

    /// Where a frame is along them.
    fn along(&self, present: &Frame) -> Along {
        let at = |point: &Frame| norm(&(present.position - point.position));
        let segments = [
            (beside(present, &self.above, &self.fast), ASIDE_INCHES, Along::Out),
            (beside(present, &self.fast, &self.slow), ASIDE_INCHES, Along::Coming),
            (beside(present, &self.slow, &self.back), ABOVE, Along::Sliding),
            (beside(present, &self.back, &self.lift), ASIDE_INCHES, Along::Lifting),
            (beside(present, &self.lift, &self.up), ASIDE_INCHES, Along::Raising),
        ];
        let within = segments.into_iter().filter(|(distance, limit, _)| distance <= limit);
        let nearest = within.min_by(|(a, ..), (b, ..)| a.total_cmp(b));
        let turned = self.slow.distance(present).radians > LOST_RADIANS;
        if at(&self.slow) <= AT_POINT && !turned {
            Along::Seat
        } else if at(&self.back) <= AT_LOW && !turned {
            Along::Low
        } else if at(&self.above) <= ABOVE {
            Along::Above
        } else if at(&self.up) <= CLEAR {
            Along::Clear
        } else {
            match nearest {
                Some((.., segment)) if !turned => segment,
                _ => Along::Off,
            }
        }
    }
}

/// The pose of a command's location.
pub(super) fn base(command: &EmoveCommand, memory: &CommonMemory, data: &TaskData<'_>) -> Option<Frame> {
    pose_of(command.pose?, memory, data)
}

const fn is_exchange(verb: EmoveVerb) -> bool {
    matches!(verb, EmoveVerb::QcAttach | EmoveVerb::QcDetach)
}

impl State {
    /// Position of the robot in the exchange of the command.
    pub(super) fn along(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Along {
        if !is_exchange(command.command) {
            return Along::Off;
        }
        let base = base(command, inputs.memory, inputs.data);
        let points = base.and_then(|base| Points::of(command, &base, inputs.data));
        match (points, present_frame(inputs.memory)) {
            (Some(points), Some(present)) => points.along(&present),
            _ => Along::Off,
        }
    }

    /// Are the fingers at the opening with which the gripper goes through its holster?
    pub(super) fn shut(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Shut {
        let opening = gripper_on(command, inputs.data).map(|on| on.appr_size);
        let attached = Gripper::attached(inputs.memory);
        match opening {
            _ if attached.is_uncalibrated(inputs.memory) => Shut::Raw,
            Some(opening) if attached.stands_at(opening, inputs.memory) => Shut::Shut,
            _ => Shut::Open,
        }
    }

    /// A relative move of the command is ordered: a robot that changes a gripper is in the holster.
    pub(super) fn note_exchange(
        &mut self,
        command: &EmoveCommand,
        memory: &CommonMemory,
        data: &TaskData<'_>,
    ) {
        let gripper = command.end_effector_id.filter(|_| is_exchange(command.command));
        if let (Some(gripper), Some(base)) = (gripper, base(command, memory, data)) {
            let place = robot_at(command, gone_to(command), Pose::from_frame(&base));
            self.beliefs.exchange = Some(Exchange { gripper, place });
        }
    }

    /// A robot that is away from the holster when the operator gives it back changes no gripper any more.
    pub(super) fn sense_exchange(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let (Some(exchange), Some(present)) = (self.beliefs.exchange, present_frame(inputs.memory)) else {
            return;
        };
        let command = EmoveCommand {
            location_kind: exchange.place.kind,
            location_record: exchange.place.record,
            location_array: exchange.place.array,
            ..EmoveCommand::default()
        };
        let base = exchange.place.pose.to_frame().ok();
        let points = base.and_then(|base| Points::of(&command, &base, inputs.data));
        let along = points.map_or(Along::Off, |points| points.along(&present));
        if along == Along::Off && !is_led(inputs.memory) {
            self.beliefs.exchange = None;
        }
    }

    /// The gripper whose change is not finished: the robot is in its holster, or the gripper hangs on a ring that is
    /// not locked, at any position of the robot.
    pub(super) fn changing(&self, memory: &CommonMemory) -> Option<u8> {
        let loose = memory.quick_change.status.end_effector_id.filter(|_| is_open(memory));
        self.beliefs.exchange.map(|exchange| exchange.gripper).or(loose)
    }

    /// Where a gripper is left in the holster of a command.
    pub(super) fn seat_pose(
        &self,
        command: &EmoveCommand,
        memory: &CommonMemory,
        data: &TaskData<'_>,
    ) -> Option<Pose> {
        let base = base(command, memory, data)?;
        Some(Pose::from_frame(&Points::of(command, &base, data)?.slow))
    }
}
