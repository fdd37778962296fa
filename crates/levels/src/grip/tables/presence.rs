//! Part presence between the fingers, from readings that have to last. No header names the rows.

use rcs_core::{Actions, Plain, Variables, decision_table};

use crate::grip::state::Touch;

/// Fingers whose strain gage reads a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Contacts {
    /// None.
    None,
    /// One.
    One,
    /// Both.
    Both,
}

/// The opening, compared with the closed end of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ClosedEnd {
    /// There the fingers press on each other.
    Reached,
    /// Not reached.
    Above,
}

/// The potentiometer, compared with the tick before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Stillness {
    /// It reads the same within its noise.
    Still,
    /// It has changed, or there was no reading before.
    Changed,
}

/// The readings of the sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Validity {
    /// Calibrated, plausible, and there were readings in the tick before.
    Valid,
    /// One of these is not so.
    Invalid,
}

/// How long the touch has been the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Period {
    /// Less than 0.2 s.
    Short,
    /// 0.2 s or longer.
    Long,
}

/// What happens to the count of ticks with the same touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Count {
    /// It continues.
    Continue,
    /// It starts again.
    Restart,
}

/// The state variables of [`TOUCH`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Pads {
    /// The fingers with a force.
    pub contact: Contacts,
    /// The opening.
    pub closed_end: ClosedEnd,
    /// The potentiometer.
    pub potentiometer: Stillness,
}

/// The state variables of [`PRESENCE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct GripContact {
    /// The readings.
    pub readings: Validity,
    /// What the fingers touch.
    pub touch: Touch,
    /// How long that has been the same.
    pub period: Period,
}

decision_table! {
    /// TOUCH: what the fingers touch in this tick. Moving fingers may push a part; fingers that hold one may be moved a
    /// little.
    pub TOUCH: fn touch(interfaces::grip::Felt, self::Pads) -> crate::grip::state::Touch {
        any {
            1: contact: None                          => Free;
            2: contact: One                           => Unclear;
            3: contact: Both, closed_end: Reached     => Free;
            4: contact: Both, potentiometer: Still    => Both;
        }
        Something {
            5: contact: Both, potentiometer: Changed  => Both;
        }
        Nothing | NotKnown {
            6: contact: Both, potentiometer: Changed  => Unclear;
        }
    }
}

decision_table! {
    /// PRESENCE: what is between the fingers. A touch counts when it has lasted. An earlier contact is only evidence
    /// against *nothing*.
    pub PRESENCE: fn presence(interfaces::grip::Felt, self::GripContact) -> self::Count {
        any {
            1: readings: Invalid             => Restart   -> NotKnown;
            2: touch: Free,    period: Long  => Continue  -> Nothing;
            3: touch: Both,    period: Long  => Continue  -> Something;
            4: touch: Unclear, period: Long  => Continue  -> NotKnown;
        }
        Nothing {
            5: touch: Both | Unclear         => Continue  -> NotKnown;
        }
        any {
            6: otherwise                     => Continue;
        }
    }
}

#[cfg(test)]
mod tests {
    use interfaces::grip::Felt;

    use super::*;

    #[test]
    fn invalid_readings_say_nothing_whatever_was_known() {
        for &felt in Felt::ALL {
            for &touch in Touch::ALL {
                let contact = GripContact { readings: Validity::Invalid, touch, period: Period::Long };
                let decision = presence(felt, &contact);
                assert_eq!(
                    (decision.action, decision.next),
                    (Count::Restart, Felt::NotKnown),
                    "{felt} {touch}"
                );
            }
        }
    }

    #[test]
    fn short_touch_only_ends_nothing() {
        for &felt in Felt::ALL {
            for &touch in Touch::ALL {
                let contact = GripContact { readings: Validity::Valid, touch, period: Period::Short };
                let is_doubtful = felt == Felt::Nothing && touch != Touch::Free;
                let expected = if is_doubtful { Felt::NotKnown } else { felt };
                assert_eq!(presence(felt, &contact).next, expected, "{felt} {touch}");
            }
        }
    }

    #[test]
    fn contact_of_moving_fingers_is_unclear_unless_a_part_is_held() {
        for &felt in Felt::ALL {
            let pads = Pads {
                contact: Contacts::Both,
                closed_end: ClosedEnd::Above,
                potentiometer: Stillness::Changed,
            };
            let expected = if felt == Felt::Something { Touch::Both } else { Touch::Unclear };
            assert_eq!(touch(felt, &pads).action, expected, "{felt}");
            let closed = Pads { closed_end: ClosedEnd::Reached, ..pads };
            assert_eq!(touch(felt, &closed).action, Touch::Free, "{felt}");
        }
    }
}
