//! Results of the orders of a command.

use rcs_core::decision_table;

decision_table! {
    /// ORDERED: wait for hand and table. A failure ends the command; also the loss of the object in FLIP.
    pub ORDERED: fn ordered(super::Subordinates) -> super::Action or () {
        1: verb: Flip, object: Lost                               => Lose(HandLost);
        2: ordered: Nothing                                       => consult;
        3: ordered: Hand | Both,  hand: Error | Joystick | Lost   => PassUpHand;
        4: ordered: Table | Both, table: Error | Joystick | Lost  => PassUpTable;
        5: ordered: Hand | Both,  hand: Pending | Executing       => Wait;
        6: ordered: Table | Both, table: Pending | Executing      => Wait;
        7: ordered: Hand | Table | Both                           => consult;
    }
}
