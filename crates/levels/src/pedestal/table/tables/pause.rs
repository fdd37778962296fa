//! PAUSE: stop.

use rcs_core::{interface::Reason::TableStuck, old_table};

use super::{Action, Clock, Motor, Step};

old_table! {
    /// PAUSE: a turning table stops; one that does not answer is left alone.
    pub PAUSE: fn pause(motor: Motor, clock: Clock) -> (Action, Step) {
        //   motor               clock        action              next
        1: ( Pending           , Running ) => Wait             , Start ;
        2: ( Turning           , Running ) => Stop             , Start ;
        3: ( Pending | Turning , Expired ) => Lose(TableStuck) , Start ;
        4: ( Standing | Silent , _       ) => Finish           , Start ;
    }
}
