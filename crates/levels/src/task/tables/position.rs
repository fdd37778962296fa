use rcs_core::decision_table;

decision_table! {
    /// POSITION (V.4.1): release the held object, then move to the position, with the parameters of a virtual object
    /// if one is named. The position is the source location, or the destination if the source is null (SPECNOTES.md,
    /// contradiction 24). The gripper stays closed if the robot could not leave or the object would fall (an
    /// extension: SPECNOTES.md). A command that names an object at the robot's fixture belongs to hold-and-seat
    /// (VIII.2): the ledge of the fixture supports the part. An update is sent for a released object that the
    /// database has as held by the robot (an extension: SPECNOTES.md), also by a POSITION that is repeated after the
    /// release.
    pub POSITION: fn position(enum PositionStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                  => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing                               => Position                -> Moving;
            3:  way: NoStart                                => Fail(UnknownStart);
            4:  way: NoTrajectory                           => Fail(NoTrajectory);
            5:  support: Place | Secured                    => Release                 -> Releasing;
            6:  support: Jaws, way: Here, handling: Object  => Release                 -> Releasing;
            7:  support: Jaws                               => Fail(NotClamped);
            8:  support: None, held: Right | Other          => Fail(HeldElsewhere);
            9:  support: None, held: Something              => Fail(UnknownHeld);
            10: support: None, held: NotKnown               => Fail(HeldNotKnown);
        }
        /// The held object is being released.
        Releasing {
            11: update: Pending                             => SendPendingAndPosition  -> Leaving;
            12: otherwise                                   => Position                -> Moving;
        }
        /// The robot moves to the position.
        Moving {
            13: update: Pending                             => SendPending             -> Updating;
            14: otherwise                                   => Finish;
        }
        /// The robot moves to the position, and the update is sent.
        Leaving {
            15: update: Pending                             => AwaitUpdate             -> Updating;
            16: otherwise                                   => Finish;
        }
        /// The update is sent.
        Updating {
            17: update: Pending                             => SendPending;
            18: otherwise                                   => Finish;
        }
    }
}
