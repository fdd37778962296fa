//! E-PAUSE (V.2.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Link, Situation, Tooling, Whereabouts};

coded_enum! {
    /// Reference action of E-PAUSE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// Prim is initializing the link.
        Initializing = "initializing",
        /// The processes below are pausing.
        Pausing = "pausing",
    }
}

decision_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits for the calibration of the
    /// parts gripper (VI.3.1 UP-INIT), and finds out where the robot is.
    pub E_PAUSE: fn e_pause(step: Step, link: Link, prim: Lower, tooling: Tooling, whereabouts: Whereabouts) -> (Action, Step) {
        //     step                       link   Prim                       tooling      whereabouts         action                          next
        1:  ( Start                    , Down , _                       , _          , _               ) => RobotInit                      , Initializing ;
        2:  ( Start                    , Up   , _                       , _          , _               ) => Pause                          , Pausing      ;
        3:  ( Initializing             , _    , Pending | Executing     , _          , _               ) => Wait                           , Initializing ;
        4:  ( Initializing             , _    , Done                    , _          , _               ) => Pause                          , Pausing      ;
        5:  ( Pausing                  , _    , Pending | Executing     , _          , _               ) => Wait                           , Pausing      ;
        6:  ( Pausing                  , _    , Done                    , Busy       , _               ) => Wait                           , Pausing      ;
        7:  ( Pausing                  , _    , Done                    , RingFaulty , _               ) => Fail(Reason::QuickChangeFault) , Start        ;
        8:  ( Pausing                  , _    , Done                    , GripFaulty , _               ) => FailGrip                       , Start        ;
        9:  ( Pausing                  , _    , Done                    , Ready      , Searching       ) => Wait                           , Pausing      ;
        10: ( Pausing                  , _    , Done                    , Ready      , Known | Unknown ) => Finish                         , Start        ;
        11: ( Initializing | Pausing   , _    , Error | Joystick | Lost , _          , _               ) => PassUp                         , Start        ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = e_pause(step, s.link, s.prim, s.tooling, s.whereabouts);
    Choice { table: &E_PAUSE, row, action, step: next.code() }
}
