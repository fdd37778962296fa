use rcs_core::decision_table;

decision_table! {
    /// INTERLOCK: while the part is in the pedestal's hand, only commands that finish or undo the regrip are
    /// accepted. A robot that leaves with the part would tear it out. A robot that holds nothing and is clear of the
    /// pedestal may leave.
    pub INTERLOCK: fn interlock(super::Interlock) -> super::Action or () {
        1: asked: Before                                              => consult;
        2: pedestal: Free                                             => consult;
        3: verb: None | Pause | FixGrip | Release                     => consult;
        4: verb: GetEndeff,                       gripper: Right      => consult;
        5: verb: GotoEndpt | GotoDest | Position, robot: Empty        => consult;
        6: verb: GetEndeff | GetObject | PlaceObj | MoveObjToDest     => Fail(PartInPedestal);
        7: verb: GotoEndpt | GotoDest | Position                      => Fail(PartInPedestal);
        8: verb: InsertTool | ReleaseTool | AcquireTool | RemoveTool  => Fail(PartInPedestal);
    }
}
