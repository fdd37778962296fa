//! The gripper exchange: quick change, attached gripper, and position of the robot in the holster
//! (docs/design/recovery.md "Exchange").
//!
//! ```text
//!   bare:     above --- fast --- slow (seat)      QC-ATTACH reads it from left to right and down,
//!                                 |               QC-DETACH the other way round
//!   mated:       up --- lift --- back (low)
//! ```
//!
//! All points follow from the pose of the holster and the relative moves of the two commands.

use core::mem;

use geometry::{
    frame::{Frame, norm},
    pose::Pose,
};
use interfaces::{
    CommonMemory, EmoveOutputs, Reason,
    emove::{EmoveCommand, EmoveVerb, Estimates, Exchange},
    location::Site,
    quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeVerb, RingPosition},
};
use rcs_core::{
    Plain,
    handshake::{Commander, Lower},
    tick::Tick,
};
use taskdata::files::TaskData;

use super::{
    EmoveInputs,
    grasp::gripper_on,
    gripper::{EmoveGripper, is_open},
    localization::{ASIDE_INCHES, LOST_RADIANS, path::beside},
    motion::relative::Relative,
    robot_place::{base, gone_to, is_moved_by_hand, present_frame, robot_at},
    tables::{EmoveHolster, ExchangePosition, Lock, Ring, Shut},
};

const AT_POINT: f64 = 0.12; // in: much shorter than any relative move
const AT_LOW: f64 = 0.3; // in: QCD-DOWN may end a little above or below the low point
const CLEAR: f64 = 0.3; // in: clear of the holster near the upper points, or beyond them
/// Height above a segment on the way to the seat, in: QCD-SEAT begins where the large sensors see the ears, up to 0.5
/// in above the low point (V.2.1). QCD-UP ends as far above its point.
const ABOVE: f64 = 0.6;

struct HolsterPoints {
    above: Frame,
    fast: Frame,
    slow: Frame,
    back: Frame,
    lift: Frame,
    up: Frame,
}

impl HolsterPoints {
    fn of(site: &Site, base: &Frame, data: &TaskData<'_>) -> Option<Self> {
        let moved =
            |from: &Frame, relative: Relative| Some(data.moved(from, relative.record(site, data)?.movetable));
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

    fn along(&self, present: &Frame) -> ExchangePosition {
        let at = |point: &Frame| norm(&(present.position - point.position));
        let segments = [
            (beside(present, &self.above, &self.fast), ASIDE_INCHES, ExchangePosition::Out),
            (beside(present, &self.fast, &self.slow), ASIDE_INCHES, ExchangePosition::Coming),
            (beside(present, &self.slow, &self.back), ABOVE, ExchangePosition::Sliding),
            (beside(present, &self.back, &self.lift), ASIDE_INCHES, ExchangePosition::Lifting),
            (beside(present, &self.lift, &self.up), ASIDE_INCHES, ExchangePosition::Raising),
        ];
        let within = segments.into_iter().filter(|(distance, limit, _)| distance <= limit);
        let nearest = within.min_by(|(a, ..), (b, ..)| a.total_cmp(b));
        let turned = self.slow.distance(present).radians > LOST_RADIANS;
        if at(&self.slow) <= AT_POINT && !turned {
            ExchangePosition::Seat
        } else if at(&self.back) <= AT_LOW && !turned {
            ExchangePosition::Low
        } else if at(&self.above) <= ABOVE {
            ExchangePosition::Above
        } else if at(&self.up) <= CLEAR {
            ExchangePosition::Clear
        } else {
            match nearest {
                Some((.., segment)) if !turned => segment,
                _ => ExchangePosition::Off,
            }
        }
    }
}

const fn is_exchange(verb: EmoveVerb) -> bool {
    matches!(verb, EmoveVerb::QcAttach | EmoveVerb::QcDetach)
}

const HOLSTER_SENSORS: u8 = 0x0F;

/// ASSUMED: the parts gripper uses the right holster, the v-gripper the left, the tool gripper the centre.
pub(super) fn holster(gripper: Option<u8>, memory: &CommonMemory) -> EmoveHolster {
    let status = &memory.prim.status;
    let bits = match EmoveGripper::of(gripper) {
        EmoveGripper::None => return EmoveHolster::Empty,
        EmoveGripper::Parts => status.holster_right,
        EmoveGripper::V => status.holster_left,
        EmoveGripper::Tool => status.holster_centre,
    };
    match bits & HOLSTER_SENSORS {
        0 => EmoveHolster::Empty,
        HOLSTER_SENSORS => EmoveHolster::Full,
        _ => EmoveHolster::Partial,
    }
}

pub(super) fn along(command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> ExchangePosition {
    if !is_exchange(command.command) {
        return ExchangePosition::Off;
    }
    let base = base(command, inputs.memory, inputs.data);
    let points = base.and_then(|base| HolsterPoints::of(&command.site, &base, inputs.data));
    match (points, present_frame(inputs.memory)) {
        (Some(points), Some(present)) => points.along(&present),
        _ => ExchangePosition::Off,
    }
}

pub(super) fn shut(command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> Shut {
    let opening = gripper_on(command, inputs.data).map(|on| on.appr_size);
    let attached = EmoveGripper::attached(inputs.memory);
    match opening {
        _ if attached.is_uncalibrated(inputs.memory) => Shut::Raw,
        Some(opening) if attached.stands_at(opening, inputs.memory) => Shut::Shut,
        _ => Shut::Open,
    }
}

pub(super) fn seat_pose(command: &EmoveCommand, memory: &CommonMemory, data: &TaskData<'_>) -> Option<Pose> {
    let base = base(command, memory, data)?;
    Some(Pose::from_frame(&HolsterPoints::of(&command.site, &base, data)?.slow))
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripperExchange {
    commander: Commander,
    attached: EmoveGripper,    // the gripper in the previous tick
    holster: Option<Exchange>, // the holster of an exchange in progress
}

impl GripperExchange {
    pub(super) const fn adopt(&mut self, estimates: &Estimates) {
        self.holster = estimates.exchange;
    }

    pub const fn adopt_gripper(&mut self, attached: EmoveGripper) {
        self.attached = attached;
    }

    pub(super) const fn write_to(&self, estimates: &mut Estimates) {
        estimates.exchange = self.holster;
    }

    pub(super) fn start(&mut self, tick: Tick, memory: &CommonMemory) {
        let (order, ring) = (&memory.emove.quick_change, &memory.quick_change.status);
        self.commander.start_from(tick, order.number, ring.echo);
    }

    pub(super) fn send(&mut self, verb: QuickChangeVerb, tick: Tick, outputs: &mut EmoveOutputs) {
        outputs.quick_change = QuickChangeCommand { number: self.commander.send(tick), command: verb };
    }

    pub(super) fn status(&self, tick: Tick, memory: &CommonMemory) -> Lower {
        self.commander.status_of(tick, &memory.quick_change)
    }

    pub(super) fn lock(&self, tick: Tick, memory: &CommonMemory) -> Lock {
        match (self.status(tick, memory), memory.quick_change.status.ring) {
            (Lower::Lost, _) | (_, RingPosition::Implausible) => Lock::Faulty,
            (_, RingPosition::Locked) => Lock::Locked,
            (_, RingPosition::Unlocked) => Lock::Unlocked,
            (_, RingPosition::Unread | RingPosition::Between) => Lock::Between,
        }
    }

    pub(super) fn ring(&self, tick: Tick, memory: &CommonMemory) -> Ring {
        match (self.status(tick, memory), memory.quick_change.status.report) {
            (Lower::Pending | Lower::Executing, _) => Ring::Busy,
            (Lower::Error | Lower::Joystick | Lower::Lost, _) => Ring::Faulty,
            (Lower::Done, QuickChangeReport::Locked) => Ring::Locked,
            (Lower::Done, QuickChangeReport::Unlocked) => Ring::Unlocked,
            (Lower::Done, _) => Ring::Busy,
        }
    }

    pub(super) fn fault(&self, tick: Tick, memory: &CommonMemory) -> Reason {
        match self.status(tick, memory) {
            Lower::Lost => Reason::NeighbourLost,
            _ if memory.quick_change.status.report == QuickChangeReport::Stuck => Reason::QuickChangeStuck,
            _ => Reason::QuickChangeFault,
        }
    }

    /// True if the id pins read no gripper although the ring stayed locked since one was attached. Their contact is
    /// bad, and the held object is unknown until they read again. A gripper that its own holster detects, while the
    /// robot is in no holster, has been torn off the ring.
    pub(super) fn is_misread(&self, memory: &CommonMemory) -> bool {
        let read = EmoveGripper::attached(memory);
        let locked = memory.quick_change.status.ring == RingPosition::Locked;
        let rests = self.holster.is_none() && holster(self.attached.id(), memory) == EmoveHolster::Full;
        locked && self.attached != EmoveGripper::None && read != self.attached && !rests
    }

    /// Bad contact of the pins does not make the robot bare: Subtask would fetch the attached gripper again.
    pub(super) fn end_effector_id(&self, memory: &CommonMemory) -> Option<u8> {
        if self.is_misread(memory) { self.attached.id() } else { memory.quick_change.status.end_effector_id }
    }

    pub(super) fn sense_gripper(&mut self, memory: &CommonMemory) -> bool {
        let attached = EmoveGripper::attached(memory);
        attached != mem::replace(&mut self.attached, attached)
    }

    /// Notes that a relative move begins, so the robot is in the holster.
    pub(super) fn note_move(&mut self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) {
        let gripper = command.end_effector_id.filter(|_| is_exchange(command.command));
        if let (Some(gripper), Some(base)) = (gripper, base(command, inputs.memory, inputs.data)) {
            let place = robot_at(command, gone_to(command), Pose::from_frame(&base));
            self.holster = Some(Exchange { gripper, place });
        }
    }

    pub(super) const fn is_half_done(&self) -> bool {
        self.holster.is_some()
    }

    pub(super) const fn end(&mut self) {
        self.holster = None;
    }

    /// An exchange ends if the robot is away from the holster when the operator gives it back.
    pub(super) fn sense(&mut self, inputs: &EmoveInputs<'_>) {
        let (Some(exchange), Some(present)) = (self.holster, present_frame(inputs.memory)) else {
            return;
        };
        let base = exchange.place.pose.to_frame().ok();
        let points = base.and_then(|base| HolsterPoints::of(&exchange.place.site, &base, inputs.data));
        let along = points.map_or(ExchangePosition::Off, |points| points.along(&present));
        if along == ExchangePosition::Off && !is_moved_by_hand(inputs.memory) {
            self.holster = None;
        }
    }

    /// The gripper whose exchange is not finished: the robot is in its holster, or the ring is not locked, at any
    /// position of the robot.
    pub(super) fn changing(&self, memory: &CommonMemory) -> Option<u8> {
        let loose = memory.quick_change.status.end_effector_id.filter(|_| is_open(memory));
        self.holster.map(|exchange| exchange.gripper).or(loose)
    }

    /// Searches renumber the commands (docs/evidence.md).
    pub const fn commander(&mut self) -> &mut Commander {
        &mut self.commander
    }
}
