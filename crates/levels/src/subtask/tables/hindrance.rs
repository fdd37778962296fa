//! A part in the pedestal's hand.

use rcs_core::decision_table;

decision_table! {
    /// HINDRANCE: while the part is in the pedestal's hand, alone or together with the robot, only what finishes or undoes
    /// the regrip is done: a robot that leaves with it would tear it out, and the object is nowhere else.
    pub HINDRANCE: fn hindrance(super::Hindrance) -> super::Action or () {
        1: asked: Before                                                        => consult;
        2: pedestal: Free                                                       => consult;
        3: pedestal: HoldsPart, verb: None | Pause | FixGrip | Release          => consult;
        4: pedestal: HoldsPart, verb: GetEndeff, gripper: Right                 => consult;
        5: pedestal: HoldsPart, verb: GetEndeff, gripper: None | Wrong          => Fail(PartInPedestal);
        6: pedestal: HoldsPart, verb: GetObject | PlaceObj | MoveObjToDest      => Fail(PartInPedestal);
        7: pedestal: HoldsPart, verb: GotoEndpt | GotoDest | Position           => Fail(PartInPedestal);
        8: pedestal: HoldsPart, verb: InsertTool | ReleaseTool                  => Fail(PartInPedestal);
        9: pedestal: HoldsPart, verb: AcquireTool | RemoveTool                  => Fail(PartInPedestal);
    }
}
