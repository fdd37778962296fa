//! CLOSE-GRIP: grasp with a commanded force.

use rcs_core::{
    interface::Reason::{GripTimeout, WrongGripper},
    old_table,
};

use super::{
    Action, Clock,
    Flow::{Coarse, Fine, Medium},
    Grasp, Gripper, Rest,
};
use crate::grip::Step;

old_table! {
    /// CLOSE-GRIP (VI.3.1): close until both fingers touch, then servo the force to `sforce`. Done as well if there is
    /// nothing between the fingers; E-move tells the two apart by the opening.
    pub CLOSE_GRIP: fn close_grip(step: Step, gripper: Gripper, clock: Clock, grasp: Grasp, rest: Rest) -> (Action, Step) {
        //    step           gripper    clock     grasp           rest          action               next
         1: ( _            , Detached , _       , _             , _       ) => Fail(WrongGripper) , Start  ;
         2: ( _            , Attached , Expired , _             , _       ) => Fail(GripTimeout)  , Start  ;
         3: ( Start | Move , Attached , Running , Far           , _       ) => Close(Coarse)      , Move   ;
         4: ( Start | Move , Attached , Running , Near | Loose  , _       ) => Close(Medium)      , Move   ;
         5: ( Start | Move , Attached , Running , OneFinger     , _       ) => AwaitFinger        , Move   ;
         6: ( Start | Move , Attached , Running , Weak          , _       ) => Close(Fine)        , Move   ;
         7: ( Start | Move , Attached , Running , Firm | Missed , _       ) => Stop               , Settle ;
         8: ( Start | Move , Attached , Running , Strong        , _       ) => Open(Fine)         , Move   ;
         9: ( Start | Move , Attached , Running , Crushing      , _       ) => Open(Medium)       , Move   ;
        10: ( Settle       , Attached , Running , _             , Waiting ) => Stop               , Settle ;
        11: ( Settle       , Attached , Running , Firm | Missed , Rested  ) => Finish             , Settle ;
        12: ( Settle       , Attached , Running ,
              Far | Near | OneFinger | Loose | Weak | Strong | Crushing
                                                                , Rested  ) => Stop               , Move   ;
    }
}
