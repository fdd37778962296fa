use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if a name or a record that it needs is missing.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                     => consult;
        2:  verb: None                        => Fail(UnknownCommand);
        3:  verb: FixGrip, named: Location    => Fail(NoObjectNamed);
        4:  verb: FixGrip, pedestal: Missing  => Fail(NoPedestalData);
        5:  missing: Location                 => Fail(UnknownLocation);
        6:  missing: Holster                  => Fail(NoHolster);
        7:  missing: Grip                     => Fail(UnknownGrip);
        8:  missing: GripMovetable            => Fail(NoGripMovetable);
        9:  missing: Object                   => Fail(UnknownObject);
        10: missing: ObjectName               => Fail(NoObjectNamed);
        11: missing: Array                    => Fail(NoArrayForObject);
        12: missing: Sector                   => Fail(SectorOutOfRange);
        13: missing: Nothing                  => consult;
    }
}
