//! E-PAUSE (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::prim::JoystickGrip, old_table, table::Decision};

use super::{Action, Choice, Link, Situation, Tooling, Whereabouts};

/// Reference action of E-PAUSE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// Prim is initializing the link.
    Initializing,
    /// The processes below are pausing.
    Pausing,
    /// They pause. The operator may take the robot and give it back as long as the command stands.
    Standing,
}

old_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits
    /// for the calibration of the parts gripper (VI.3.1 UP-INIT), and finds out where the robot is. While it
    /// stands, the joystick box has robot and gripper.
    pub E_PAUSE: fn e_pause(step: Step, link: Link, prim: Lower, tooling: Tooling, whereabouts: Whereabouts, button: JoystickGrip) -> (Action, Step) {
        //     step                     link   Prim                               tooling      whereabouts         button    action         next
        1:  ( Start                  , Down , _                                  , _          , _               , _     ) => RobotInit   , Initializing ;
        2:  ( Start                  , Up   , _                                  , _          , _               , _     ) => Pause       , Pausing      ;
        3:  ( Initializing           , _    , Pending | Executing                , _          , _               , _     ) => Wait        , Initializing ;
        4:  ( Initializing           , _    , Done                               , _          , _               , _     ) => Pause       , Pausing      ;
        5:  ( Initializing           , _    , Joystick                           , _          , _               , _     ) => PassUp      , Start        ;
        6:  ( Pausing                , _    , Pending | Executing                , _          , _               , _     ) => Wait        , Pausing      ;
        7:  ( Pausing                , _    , Done                               , Busy       , _               , _     ) => Wait        , Pausing      ;
        8:  ( Pausing                , _    , Done                               , RingFaulty , _               , _     ) => FailRing    , Start        ;
        9:  ( Pausing                , _    , Done                               , GripFaulty , _               , _     ) => FailGrip    , Start        ;
        10: ( Pausing                , _    , Done                               , Ready      , Searching       , _     ) => Wait        , Pausing      ;
        11: ( Pausing                , _    , Done                               , Ready      , Known | Unknown , _     ) => Finish      , Standing     ;
        12: ( Pausing                , _    , Joystick                           , _          , _               , _     ) => Manual      , Standing     ;
        13: ( Initializing | Pausing , _    , Error | Lost                       , _          , _               , _     ) => PassUp      , Start        ;
        14: ( Standing               , _    , _                                  , _          , _               , Open  ) => OpenByHand  , Standing     ;
        15: ( Standing               , _    , _                                  , _          , _               , Close ) => CloseByHand , Standing     ;
        16: ( Standing               , _    , Joystick                           , _          , _               , None  ) => Manual      , Standing     ;
        17: ( Standing               , _    , Done                               , _          , _               , None  ) => Finish      , Standing     ;
        18: ( Standing               , _    , Pending | Executing | Error | Lost , _          , _               , None  ) => Wait        , Standing     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = e_pause(step, s.link, s.prim, s.tooling, s.whereabouts, s.button);
    Choice { table: &E_PAUSE, row, action, step: next.code() }
}
