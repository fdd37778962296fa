use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if a name or a record that it needs is missing. PRECONDITION tests its other
    /// needs.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                            => consult;
        2:  verb: None                               => Fail(UnknownCommand);
        3:  missing: Object                          => Fail(UnknownObject);
        4:  gripper: Invalid                         => Fail(WrongGripper);
        5:  missing: Location                        => Fail(UnknownLocation);
        6:  missing: ObjectName                      => Fail(NoObjectNamed);
        7:  missing: Array                           => Fail(NoArrayForObject);
        8:  missing: Sector                          => Fail(SectorOutOfRange);
        9:  missing: Grip | GripMovetable | Holster  => Fail(NoGripMovetable);
        10: missing: Nothing                         => consult;
    }
}
