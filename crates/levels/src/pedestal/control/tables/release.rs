//! RELEASE: let the object go.

use rcs_core::{handshake::Lower, old_table};

use super::{Action, Step};

old_table! {
    /// RELEASE (VI.7.1): open the hand to `grasp-size`; no command to the table.
    pub RELEASE: fn release(step: Step, hand: Lower) -> (Action, Step) {
        //   step    hand                        action     next
        1: ( Start , _                       ) => Open     , Move  ;
        2: ( Move  , Error | Joystick | Lost ) => FailHand , Start ;
        3: ( Move  , Pending | Executing     ) => Wait     , Move  ;
        4: ( Move  , Done                    ) => Finish   , Start ;
    }
}
