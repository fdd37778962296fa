//! What is between the fingers of Grip, by strain gages and potentiometer alone.
//!
//! A part is between the fingers if both feel force and stand above the closed end of travel, where fingers that are
//! shut on each other feel force too; nothing is between them if neither feels any. Contact of one finger alone is not
//! enough: a part that is held with little force may touch only one of them. A value counts after `FELT_TICKS`; until
//! then a certain value does not become *nothing*.

use interfaces::{
    device::{ADC_FULL_SCALE, GripSensors},
    grip::Felt,
};

use super::{
    goal::{CLOSED_END, OPEN_END},
    state::{Sensed, State, Touch},
    tables::{Measured, Phase},
};

/// A finger that feels more than this touches something, lb.
pub(super) const CONTACT: f64 = 1.0;
/// The same near the closed end, where no opening is below: in above the closed end.
pub(super) const MISSED_AT_END: f64 = 0.02;
/// Ticks for which the sensors must say the same (0.2 s): longer than it takes to push a part from one finger
/// to the other.
pub(super) const FELT_TICKS: u8 = 5;
/// Readings of the potentiometer that differ by more than this from the last are those of fingers that move,
/// counts: the noise, and less than a fine flow.
const STILL_COUNTS: u16 = 6;
/// So far beyond an end of travel no fingers are: the potentiometer fails, in.
const BEYOND: f64 = 0.15;
/// A finger that feels less than this has a strain gage that fails, lb.
const LEAST_PLAUSIBLE_FORCE: f64 = -5.0;

impl State {
    /// Take what the fingers touch in this tick; `before` are the readings of the tick before.
    pub(super) fn feel(&mut self, before: Option<&GripSensors>, measured: &Measured) {
        let still = match (before, &self.sensed) {
            (Some(before), Some(Sensed { last, .. })) => {
                last.potentiometer.abs_diff(before.potentiometer) <= STILL_COUNTS
            }
            _ => false,
        };
        self.still_ticks = if still { self.still_ticks.saturating_add(1) } else { 0 };
        let touch = match (before, &self.sensed) {
            (Some(_), Some(sensed)) if self.phase == Phase::Valid && is_plausible(&sensed.last, measured) => {
                touch(measured, still || self.felt == Felt::Something)
            }
            _ => {
                (self.felt, self.touch, self.touch_ticks) = (Felt::NotKnown, Touch::Unclear, 0);
                return;
            }
        };
        self.touch_ticks = if touch == self.touch { self.touch_ticks.saturating_add(1) } else { 1 };
        self.touch = touch;
        self.felt = match (touch, self.felt) {
            (Touch::Free, _) if self.touch_ticks >= FELT_TICKS => Felt::Nothing,
            (Touch::Both, _) if self.touch_ticks >= FELT_TICKS => Felt::Something,
            (Touch::Unclear, _) if self.touch_ticks >= FELT_TICKS => Felt::NotKnown,
            (Touch::Both | Touch::Unclear, Felt::Nothing) => Felt::NotKnown,
            (_, felt) => felt,
        };
    }

    /// The calibration has opened the fingers and read them without force: there is nothing between them.
    pub(super) fn feel_nothing(&mut self) {
        (self.felt, self.touch, self.touch_ticks) = (Felt::Nothing, Touch::Free, FELT_TICKS);
    }
}

/// Fingers at rest may be pushed a little: this does not release the held part.
fn touch(measured: &Measured, at_rest: bool) -> Touch {
    match (measured.left > CONTACT, measured.right > CONTACT) {
        (false, false) => Touch::Free,
        (true, true) if measured.opening <= CLOSED_END + MISSED_AT_END => Touch::Free,
        (true, true) if at_rest => Touch::Both,
        (true, true) | (true, false) | (false, true) => Touch::Unclear,
    }
}

/// Can the fingers of a gripper read so?
pub(super) fn is_plausible(counts: &GripSensors, measured: &Measured) -> bool {
    let inside = |counts: u16| counts > 0 && counts < ADC_FULL_SCALE;
    inside(counts.potentiometer)
        && inside(counts.strain_left)
        && inside(counts.strain_right)
        && (CLOSED_END - BEYOND..=OPEN_END + BEYOND).contains(&measured.opening)
        && measured.left.min(measured.right) >= LEAST_PLAUSIBLE_FORCE
}
