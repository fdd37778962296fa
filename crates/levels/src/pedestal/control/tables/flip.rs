//! FLIP: turn the object round.

use rcs_core::{handshake::Lower, interface::Reason::ObjectLost, old_table};

use super::{Action, Object, Step};

old_table! {
    /// FLIP (VI.7.1): turn the table by the relative `table-angle`; no command to the hand. Notices an object that comes loose.
    pub FLIP: fn flip(step: Step, table: Lower, object: Object) -> (Action, Step) {
        //   step    table                      object        action             next
        1: ( _     , _                        , Lost        ) => Fail(ObjectLost) , Start ;
        2: ( Start , _                        , None | Held ) => TurnOver         , Move  ;
        3: ( Move  , Error | Joystick | Lost  , None | Held ) => FailTable        , Start ;
        4: ( Move  , Pending | Executing      , None | Held ) => Wait             , Move  ;
        5: ( Move  , Done                     , None | Held ) => Finish           , Start ;
    }
}
