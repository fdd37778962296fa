//! POSITION (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// POSITION (V.4.1): release what is held, then move to the position, with the parameters of a virtual
    /// object if one is named. The position is the source location, or the destination if the source is null
    /// (SPECNOTES.md, contradiction 24).
    pub POSITION: fn position(enum PositionStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                       => Wait;
        }
        /// Nothing done yet.
        Start {
            2: holding: Held | Other            => Release                -> Releasing;
            3: holding: NotHeld, source: Named  => Position(Source)       -> Moving;
            4: holding: NotHeld, source: Null   => Position(Destination)  -> Moving;
        }
        /// The held object is being released.
        Releasing {
            5: source: Named                    => Position(Source)       -> Moving;
            6: source: Null                     => Position(Destination)  -> Moving;
        }
        /// The robot is on its way.
        Moving {
            7: work: Over                       => Finish;
        }
    }
}
