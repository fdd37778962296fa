//! Part presence between the fingers, from readings that last. No header names the rows.

use rcs_core::{Actions, Plain, Variables, decision_table};

use crate::grip::state::Touch;

/// Fingers whose strain gage reads a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Contacts {
    /// No finger.
    None,
    /// One finger.
    One,
    /// Both fingers.
    Both,
}

/// The opening, compared with the closed end of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ClosedEnd {
    /// The fingers are at the closed end, where they press on each other.
    Reached,
    /// The fingers are above it.
    Above,
}

/// The potentiometer, compared with the previous tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Stillness {
    /// The reading is the same within its noise.
    Still,
    /// The reading has changed, or there was none before.
    Changed,
}

/// Validity of the sensor readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Validity {
    /// Calibrated, plausible, and also read in the previous tick.
    Valid,
    /// Not calibrated, not plausible, or not read in the previous tick.
    Invalid,
}

/// Duration of the same contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Period {
    /// Less than 0.2 s.
    Short,
    /// 0.2 s or longer.
    Long,
}

/// Update of the count of ticks with the same contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Count {
    /// The count continues.
    Continue,
    /// The count starts again.
    Restart,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Pads {
    /// Fingers whose strain gage reads a force.
    pub contact: Contacts,
    /// The opening, compared with the closed end of travel.
    pub closed_end: ClosedEnd,
    /// The potentiometer, compared with the previous tick.
    pub potentiometer: Stillness,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct GripContact {
    /// The readings.
    pub readings: Validity,
    /// The contact of the fingers.
    pub touch: Touch,
    /// The duration of the same contact.
    pub period: Period,
}

decision_table! {
    /// TOUCH: the contact of the fingers in this tick. Moving fingers may push a part; fingers that hold one may be
    /// moved a little.
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
    /// PRESENCE: the part presence. A contact counts when it has lasted. A shorter one is only evidence against
    /// *nothing*.
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
    fn invalid_readings_make_the_presence_unknown() {
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
