//! PAUSE: do nothing.

use rcs_core::{handshake::Lower, old_table};

use super::{Action, Step};

old_table! {
    /// PAUSE (VI.7.1): do nothing. A turning table stops; the hand goes on to the end of what it was told, since half a grasp
    /// holds nothing.
    pub PAUSE: fn pause(step: Step, table: Lower) -> (Action, Step) {
        //   step    table                       action      next
        1: ( Start , _                       ) => StopTable , Move  ;
        2: ( Move  , Error | Joystick | Lost ) => FailTable , Start ;
        3: ( Move  , Pending | Executing     ) => Wait      , Move  ;
        4: ( Move  , Done                    ) => Finish    , Start ;
    }
}
