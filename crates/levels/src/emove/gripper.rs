//! The gripper on the robot. Quick Change reads its id from the pins in every tick.

use geometry::units::hundredths;
use interfaces::{
    CommonMemory, GripOutputs, JawsOutputs, emove::Dormancy, grip::Felt, quick_change::RingPosition,
};
use rcs_core::Plain;

use crate::jaws::{CylindricalPartGripper, JawsKind, Parameters, ToolGripper};

const PARTS_CLOSED: i32 = 10; // 0.01 in
const PARTS_BAND: i32 = 2; // 0.01 in (the servo's own band, `levels::grip`)
const STILL: i32 = 10; // 0.01 in/s: above the noise of the potentiometer, below the slowest motion by air
const RELEASE_OPENING: i32 = 25; // 0.01 in more than the grasp: the object is released
/// Least force of a contact, lb. Forces are reported in whole pounds, and no grasp is weaker than 3 lb.
const CONTACT_FORCE: i32 = 1;
const JAWS_BAND: i32 = 10; // 0.01 in: opening of jaws on an object of the grasp size (ASSUMED)
const STOP_BAND: i32 = 5; // 0.01 in

/// The code is `endeff-id#` (III.3.6 to III.3.8).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveGripper {
    /// The robot is bare.
    None,
    /// Parts gripper.
    #[text = "parts gripper"]
    Parts,
    /// v-gripper.
    #[text = "v-gripper"]
    V,
    /// Tool gripper.
    #[text = "tool gripper"]
    Tool,
}

pub(super) const fn is_open(memory: &CommonMemory) -> bool {
    matches!(memory.quick_change.status.ring, RingPosition::Unlocked | RingPosition::Between)
}

impl EmoveGripper {
    #[must_use]
    pub fn of(id: Option<u8>) -> Self {
        id.and_then(Self::from_code).unwrap_or_default()
    }

    #[must_use]
    pub const fn id(self) -> Option<u8> {
        match self {
            Self::None => None,
            Self::Parts | Self::V | Self::Tool => Some(self.code()),
        }
    }

    #[must_use]
    pub fn attached(memory: &CommonMemory) -> Self {
        Self::of(memory.quick_change.status.end_effector_id)
    }

    /// Stops of the grippers without a sensor in between, 0.01 in.
    pub(super) fn stops(self) -> Option<(i32, i32)> {
        let Parameters { closed, opened, .. } = match self {
            Self::V => CylindricalPartGripper::PARAMETERS,
            Self::Tool => ToolGripper::PARAMETERS,
            Self::None | Self::Parts => return None,
        };
        Some((hundredths(closed), hundredths(opened)))
    }

    /// True if it opens and closes between stops, without a force sensor (VI.4).
    #[must_use]
    pub fn has_stops(self) -> bool {
        self.stops().is_some()
    }

    #[must_use]
    pub const fn felt(self, memory: &CommonMemory) -> Felt {
        let (header, felt) = match (self, self.jaws(memory)) {
            (Self::None, _) => return Felt::Nothing,
            (_, Some(jaws)) => (&jaws.header, jaws.status.felt),
            (_, None) => (&memory.grip.header, memory.grip.status.felt),
        };
        if header.republished { Felt::NotKnown } else { felt }
    }

    #[must_use]
    pub fn closed(self) -> i32 {
        match self.stops() {
            Some((closed, _)) => closed,
            None => PARTS_CLOSED,
        }
    }

    /// Only the process of this gripper is awake (II.2.3).
    #[must_use]
    pub const fn dormancy(self) -> Dormancy {
        Dormancy {
            grip: !matches!(self, Self::Parts),
            v_grip: !matches!(self, Self::V),
            tool_grip: !matches!(self, Self::Tool),
        }
    }

    /// A process that woke in this tick does not execute a command of this tick (docs/design/handshake.md "Wake").
    pub(super) const fn is_asleep(self, memory: &CommonMemory) -> bool {
        let dormant = &memory.emove.dormant;
        match self {
            Self::None => false,
            Self::Parts => dormant.grip,
            Self::V => dormant.v_grip,
            Self::Tool => dormant.tool_grip,
        }
    }

    pub(super) const fn jaws(self, memory: &CommonMemory) -> Option<&JawsOutputs> {
        match self {
            Self::V => Some(&memory.v_grip),
            Self::Tool => Some(&memory.tool_grip),
            Self::None | Self::Parts => None,
        }
    }

    /// The opening, 0.01 in; `None` without a gripper, a calibration, or a reading since the process woke.
    #[must_use]
    pub fn opening(self, memory: &CommonMemory) -> Option<i32> {
        match self.jaws(memory) {
            Some(jaws) => (!jaws.header.republished).then_some(jaws.status.size),
            None => {
                let GripOutputs { header, status, .. } = &memory.grip;
                let known = self == Self::Parts && status.initialized && !header.republished;
                known.then_some(status.position)
            }
        }
    }

    /// True if it must be calibrated before it accepts commands (VI.3.1 UP-INIT).
    #[must_use]
    pub fn is_uncalibrated(self, memory: &CommonMemory) -> bool {
        self == Self::Parts && !memory.grip.status.initialized
    }

    fn is_still(self, memory: &CommonMemory) -> bool {
        let velocity = self.jaws(memory).map_or(memory.grip.status.velocity, |jaws| jaws.status.velocity);
        velocity.saturating_abs() < STILL
    }

    /// True if air moves the fingers to one end, or presses them there. Jaws stuck at the other end may still move.
    pub(super) fn has_air(self, to_close: bool, memory: &CommonMemory) -> bool {
        self.jaws(memory).is_some_and(|jaws| if to_close { jaws.valves.close } else { jaws.valves.open })
    }

    /// True if the fingers press the object. The parts gripper holds without air, too.
    pub(super) fn presses(self, memory: &CommonMemory) -> bool {
        self.jaws(memory).is_none_or(|jaws| jaws.valves.close)
    }

    /// True if closed fingers with this opening hold an object of `grasp_size`, 0.01 in. The parts gripper closes
    /// until it detects the object: any opening above the grasp size means an object (VIII.9.1). Jaws stop at the
    /// object or at their stop: only the size distinguishes the two.
    #[must_use]
    pub fn grips(self, opening: i32, grasp_size: i32) -> bool {
        match self.stops() {
            Some((closed, _)) => {
                opening.saturating_sub(grasp_size).saturating_abs() <= JAWS_BAND
                    && opening > closed.saturating_add(STOP_BAND)
            }
            None => opening > grasp_size,
        }
    }

    /// True if an object grasped at the opening `grasped` still keeps the fingers apart (0.01 in).
    #[must_use]
    pub fn still_grips(self, opening: i32, grasp_size: i32, grasped: i32) -> bool {
        self.grips(opening, grasp_size) && opening <= grasped.saturating_add(RELEASE_OPENING)
    }

    /// True if the sensors detect no object. Only a calibrated parts gripper can report this.
    #[must_use]
    pub fn senses_nothing(self, memory: &CommonMemory) -> bool {
        let grip = &memory.grip.status;
        self == Self::Parts
            && grip.initialized
            && grip.left_force < CONTACT_FORCE
            && grip.right_force < CONTACT_FORCE
    }

    pub(super) fn closes_for(self, opening: i32) -> bool {
        match self.stops() {
            Some((closed, open)) => {
                opening.saturating_sub(closed).saturating_abs()
                    < opening.saturating_sub(open).saturating_abs()
            }
            None => false,
        }
    }

    /// True if the fingers are where `FingerVerb::Stand` with `opening` would bring them.
    #[must_use]
    pub fn stands_at(self, opening: i32, memory: &CommonMemory) -> bool {
        let Some(now) = self.opening(memory) else { return self == Self::None };
        let at = match self.stops() {
            Some((closed, _)) if self.closes_for(opening) => now <= closed.saturating_add(STOP_BAND),
            Some((_, open)) => now >= open.saturating_sub(JAWS_BAND),
            None => now.saturating_sub(opening).saturating_abs() <= PARTS_BAND,
        };
        at && self.is_still(memory)
    }

    /// True if the fingers are at least as wide open as `FingerVerb::Release` with `opening` would bring them, and no
    /// air closes them; or without a gripper.
    #[must_use]
    pub fn is_open(self, opening: i32, memory: &CommonMemory) -> bool {
        let Some(now) = self.opening(memory) else { return self == Self::None };
        let least = match self.stops() {
            Some((_, open)) => opening.min(open).saturating_sub(JAWS_BAND),
            None => opening.saturating_sub(PARTS_BAND),
        };
        let closes = self.has_air(true, memory) && !self.closes_for(opening);
        now >= least && self.is_still(memory) && !closes
    }
}
