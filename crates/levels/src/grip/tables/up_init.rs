//! UP-INIT: find scale and offset of the sensors.

use rcs_core::{
    interface::Reason::{GripNotCalibrated, WrongGripper},
    old_table,
};

use super::{Action, Calibrating, Clock, Gripper};
use crate::grip::Phase;

old_table! {
    /// UP-INIT (VI.3.1): close and open the gripper and read the sensors at both ends of travel and without force. Runs by
    /// itself if the gripper is there when the system is booted, and before the first command that moves the fingers.
    pub UP_INIT: fn up_init(phase: Phase, gripper: Gripper, clock: Clock, readings: Calibrating) -> (Action, Phase) {
        //    phase                     gripper    clock     readings        action                    next
         1: ( _                       , Detached , _       , _           ) => Fail(WrongGripper)      , Deferred ;
         2: ( Missing | Deferred
              | Valid | Failed        , Attached , _       , _           ) => CloseFully              , Closing  ;
         3: ( Closing|Opening|Venting , Attached , Expired , _           ) => Fail(GripNotCalibrated) , Failed   ;
         4: ( Closing                 , Attached , Running , Unsteady    ) => CloseFully              , Closing  ;
         5: ( Closing                 , Attached , Running , Steady      ) => NoteClosed              , Opening  ;
         6: ( Opening                 , Attached , Running , Unsteady    ) => OpenFully               , Opening  ;
         7: ( Opening                 , Attached , Running , Steady      ) => NoteOpen                , Venting  ;
         8: ( Venting                 , Attached , Running , Unsteady    ) => Vent                    , Venting  ;
         9: ( Venting                 , Attached , Running , Steady      ) => Calibrate               , Valid    ;
        10: ( Closing|Opening|Venting , Attached , Running , Implausible ) => Fail(GripNotCalibrated) , Failed   ;
    }
}
