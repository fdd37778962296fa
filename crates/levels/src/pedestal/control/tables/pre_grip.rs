//! PRE-GRIP: get ready to receive an object.

use rcs_core::{handshake::Lower, old_table};

use super::{Action, Step};

old_table! {
    /// PRE-GRIP (VI.7.1): open the hand to `grasp-size` and turn the table to the absolute `table-angle`, both at once.
    pub PRE_GRIP: fn pre_grip(step: Step, hand: Lower, table: Lower) -> (Action, Step) {
        //   step    hand                     table                           action        next
        1: ( Start , _                      , _                             ) => OpenAndTurn , Move  ;
        2: ( Move  , Error | Joystick | Lost, _                             ) => FailHand    , Start ;
        3: ( Move  , Pending|Executing|Done , Error | Joystick | Lost       ) => FailTable   , Start ;
        4: ( Move  , Pending | Executing    , Pending | Executing | Done    ) => Wait        , Move  ;
        5: ( Move  , Done                   , Pending | Executing           ) => Wait        , Move  ;
        6: ( Move  , Done                   , Done                          ) => Finish      , Start ;
    }
}
