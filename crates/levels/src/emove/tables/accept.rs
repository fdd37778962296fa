//! Preconditions of a command before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: the state of the robot in which a new command is refused. Nothing has been ordered then, since HALT has
    /// stopped the robot. A robot that changes a gripper, is half way at the tool drum, or whose gripper is not locked
    /// moves nowhere. A robot whose id pins fail moves only to a plain location. E-PAUSE and RELEASE need nothing.
    /// RECORDS decides next.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                                                                   => consult;
        2:  class: None                                                                     => Refuse(UnknownCommand);
        3:  class: ObjectMove | HolsterMove | Exchange | AtObject | Tool, coupling: Misread => Refuse(PinsFail);
        4:  class: HolsterMove, gripper: Wrong                                              => Refuse(WrongGripper);
        5:  class: ObjectMove | AtObject | Tool, gripper: Wrong | None                      => Refuse(WrongGripper);
        6:  class: Plain | ObjectMove | HolsterMove | AtObject | Tool, exchange: HalfDone   => Refuse(InHolster);
        7:  class: Plain | ObjectMove | HolsterMove | Exchange, drum: HalfDone              => Refuse(InDrum);
        8:  class: Plain | ObjectMove | HolsterMove | AtObject | Tool, coupling: Loose      => Refuse(RingNotLocked);
        9:  target: Holster                                                                 => Refuse(HolsterOnly);
        10: class: Tool, start: Unknown                                                     => Refuse(UnknownStart);
        11: target: Plain                                                                   => consult;
    }
}
