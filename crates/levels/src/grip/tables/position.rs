//! POSITION and OPEN-GRIP: move the fingers to an opening.

use rcs_core::{
    interface::Reason::{GripTimeout, WrongGripper},
    old_table,
};

use super::{
    Action, Clock,
    Flow::{Coarse, Fine, Medium},
    Gripper, Opening, Rest,
};
use crate::grip::Step;

old_table! {
    /// POSITION, OPEN-GRIP (VI.3.1): servo the fingers to `sposition`.
    pub POSITION: fn position(step: Step, gripper: Gripper, clock: Clock, opening: Opening, rest: Rest) -> (Action, Step) {
        //    step           gripper    clock     opening      rest          action               next
         1: ( _            , Detached , _       , _          , _       ) => Fail(WrongGripper) , Start  ;
         2: ( _            , Attached , Expired , _          , _       ) => Fail(GripTimeout)  , Start  ;
         3: ( Start | Move , Attached , Running , VeryNarrow , _       ) => Open(Coarse)       , Move   ;
         4: ( Start | Move , Attached , Running , Narrow     , _       ) => Open(Medium)       , Move   ;
         5: ( Start | Move , Attached , Running , BitNarrow  , _       ) => Open(Fine)         , Move   ;
         6: ( Start | Move , Attached , Running , Right      , _       ) => Stop               , Settle ;
         7: ( Start | Move , Attached , Running , BitWide    , _       ) => Close(Fine)        , Move   ;
         8: ( Start | Move , Attached , Running , Wide       , _       ) => Close(Medium)      , Move   ;
         9: ( Start | Move , Attached , Running , VeryWide   , _       ) => Close(Coarse)      , Move   ;
        10: ( Settle       , Attached , Running , _          , Waiting ) => Stop               , Settle ;
        11: ( Settle       , Attached , Running , Right      , Rested  ) => Finish             , Settle ;
        12: ( Settle       , Attached , Running ,
              VeryNarrow | Narrow | BitNarrow | BitWide | Wide | VeryWide
                                                             , Rested  ) => Stop               , Move   ;
    }
}
