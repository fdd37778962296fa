use rcs_core::decision_table;

decision_table! {
    /// ORDERED: the result of the last order to E-move or the pedestal. A failure ends the command. A pause of both
    /// waits for a moving pedestal, but not for a silent one.
    pub ORDERED: fn ordered(super::Subordinates) -> super::Action or crate::execution::Work {
        1:  ordered: Nothing                                   => consult(Over);
        2:  ordered: Emove,    emove: Pending | Executing      => consult(Busy);
        3:  ordered: Emove,    emove: Done                     => consult(Over);
        4:  ordered: Emove,    emove: Error | Joystick | Lost  => PassUp;
        5:  ordered: Pedestal, pedestal: Moving                => consult(Busy);
        6:  ordered: Pedestal, pedestal: Done                  => consult(Over);
        7:  ordered: Pedestal, pedestal: Cannot                => PassUpPedestal(PedestalCannot);
        8:  ordered: Pedestal, pedestal: Faulty                => PassUpPedestal(PedestalError);
        9:  ordered: Pedestal, pedestal: Silent                => PassUpPedestal(PedestalSilent);
        10: ordered: Both,     emove: Error | Joystick | Lost  => PassUp;
        11: ordered: Both,     emove: Pending | Executing      => consult(Busy);
        12: ordered: Both,     emove: Done, pedestal: Moving   => consult(Busy);
        13: ordered: Both,     emove: Done, pedestal: Done     => consult(Over);
        14: ordered: Both,     emove: Done, pedestal: Cannot   => consult(Over);
        15: ordered: Both,     emove: Done, pedestal: Faulty   => consult(Over);
        16: ordered: Both,     emove: Done, pedestal: Silent   => consult(Over);
    }
}
