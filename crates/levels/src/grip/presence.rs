//! Part presence between the fingers of Grip, by strain gages and potentiometer alone.
//!
//! A part is between the fingers if both strain gages read a force and the fingers are above the closed end of travel.
//! At the closed end the fingers press on each other and also read a force. The fingers are empty if neither gage reads
//! a force. Contact of one finger alone is not enough: a part held with little force may touch only one of them. A
//! value is valid after `PRESENCE_TICKS`.

use interfaces::{
    device::{ADC_FULL_SCALE, GripSensors},
    grip::Felt,
};

use super::{
    goal::{CLOSED_END, OPEN_END},
    state::{Sensed, State, Touch},
    tables::{
        GripPhase, Measured,
        presence::{
            ClosedEnd, Contacts, Count, GripContact, Pads, Period, Stillness, Validity, presence, touch,
        },
    },
};

pub(super) const CONTACT: f64 = 1.0; // lb
pub(super) const MISSED_AT_END: f64 = 0.02; // in above the closed opening: no smaller opening exists
/// 0.2 s, longer than it takes to push a part from one finger to the other.
pub(super) const PRESENCE_TICKS: u8 = 5;
const STILL_COUNTS: u16 = 6; // above the noise, below a fine flow
const BEYOND: f64 = 0.15; // in; an opening farther beyond an end of travel is a sensor failure
const LEAST_PLAUSIBLE_FORCE: f64 = -5.0; // lb; a smaller reading is a sensor failure

impl State {
    pub(super) fn detect(&mut self, before: Option<&GripSensors>, measured: &Measured) {
        let still = match (before, &self.sensed) {
            (Some(before), Some(Sensed { last, .. })) => {
                last.potentiometer.abs_diff(before.potentiometer) <= STILL_COUNTS
            }
            _ => false,
        };
        self.still_ticks = if still { self.still_ticks.saturating_add(1) } else { 0 };
        let is_valid = before.is_some()
            && self.phase == GripPhase::Valid
            && self.sensed.is_some_and(|sensed| is_plausible(&sensed.last, measured));
        let touch = touch(self.felt, &pads(measured, still)).action;
        self.touch_ticks = if touch == self.touch { self.touch_ticks.saturating_add(1) } else { 1 };
        self.touch = touch;
        let contact = GripContact {
            readings: if is_valid { Validity::Valid } else { Validity::Invalid },
            touch,
            period: if self.touch_ticks >= PRESENCE_TICKS { Period::Long } else { Period::Short },
        };
        let decision = presence(self.felt, &contact);
        self.felt = decision.next;
        match decision.action {
            Count::Continue => {}
            Count::Restart => (self.touch, self.touch_ticks) = (Touch::Unclear, 0),
        }
    }

    /// Notes that the fingers are empty: the calibration has opened them and read no force.
    pub(super) fn set_empty(&mut self) {
        (self.felt, self.touch, self.touch_ticks) = (Felt::Nothing, Touch::Free, PRESENCE_TICKS);
    }
}

fn pads(measured: &Measured, still: bool) -> Pads {
    Pads {
        contact: match (measured.left > CONTACT, measured.right > CONTACT) {
            (false, false) => Contacts::None,
            (true, false) | (false, true) => Contacts::One,
            (true, true) => Contacts::Both,
        },
        closed_end: if measured.opening <= CLOSED_END + MISSED_AT_END {
            ClosedEnd::Reached
        } else {
            ClosedEnd::Above
        },
        potentiometer: if still { Stillness::Still } else { Stillness::Changed },
    }
}

pub(super) fn is_plausible(counts: &GripSensors, measured: &Measured) -> bool {
    let inside = |counts: u16| counts > 0 && counts < ADC_FULL_SCALE;
    inside(counts.potentiometer)
        && inside(counts.strain_left)
        && inside(counts.strain_right)
        && (CLOSED_END - BEYOND..=OPEN_END + BEYOND).contains(&measured.opening)
        && measured.left.min(measured.right) >= LEAST_PLAUSIBLE_FORCE
}
