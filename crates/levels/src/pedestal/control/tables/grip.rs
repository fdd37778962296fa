//! GRIP: close the hand on the object.

use rcs_core::{handshake::Lower, interface::Reason::GraspMissed, old_table};

use super::{Action, Object, Step};

old_table! {
    /// GRIP (VI.7.1): grasp the object with `grasp-force`; no command to the table. A hand that has closed on nothing is an error,
    /// since the robot is about to let go.
    pub GRIP: fn grip(step: Step, hand: Lower, object: Object) -> (Action, Step) {
        //   step    hand                      object        action              next
        1: ( Start , _                       , _           ) => Close             , Move  ;
        2: ( Move  , Error | Joystick | Lost , _           ) => FailHand          , Start ;
        3: ( Move  , Pending | Executing     , _           ) => Wait              , Move  ;
        4: ( Move  , Done                    , Held        ) => Gripped           , Start ;
        5: ( Move  , Done                    , None | Lost ) => Fail(GraspMissed) , Start ;
    }
}
