//! WITHDRAW (V.2.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Load, Situation};
use crate::emove::relative::Relative::Withdraw;

/// Reference action of WITHDRAW.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The robot is on its way.
    Moving,
}

old_table! {
    /// WITHDRAW (V.2.1): a DELTA-MOVE from above E-move. What the robot carries must not be lost.
    pub WITHDRAW: fn withdraw(step: Step, load: Load, prim: Lower) -> (Action, Step) {
        //    step     load   Prim                       action                     next
        1: ( Start  , _    , _                       ) => DeltaMove(Withdraw)      , Moving ;
        2: ( Moving , Lost , _                       ) => FailLost                 , Start  ;
        3: ( Moving , Kept , Pending | Executing     ) => Wait                     , Moving ;
        4: ( Moving , Kept , Done                    ) => Stand                    , Start  ;
        5: ( Moving , Kept , Error | Joystick | Lost ) => PassUp                   , Start  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = withdraw(step, s.load, s.prim);
    Choice { table: &WITHDRAW, row, action, step: next.code() }
}
