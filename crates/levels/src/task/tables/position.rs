//! POSITION (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// POSITION (V.4.1): release what is held, then move to the position, with the parameters of a virtual
    /// object if one is named. The position is the source location, or the destination if the source is null
    /// (SPECNOTES.md, contradiction 24). Nothing is released if the robot could not go there afterwards. What has
    /// a name is released only there; something unknown, or not known to be there, wherever the robot stands. The
    /// data base is told where an object is let go that it knows as the robot's (an extension: SPECNOTES.md), also
    /// by a POSITION that is sent again when the object has been let go already.
    pub POSITION: fn position(enum PositionStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                  => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing, source: Named                => Position(Source)                  -> Moving;
            3:  held: Nothing, source: Null                 => Position(Destination)             -> Moving;
            4:  way: NoStart                                => Fail(UnknownStart);
            5:  way: NoTrajectory                           => Fail(NoTrajectory);
            6:  held: Right | Other, way: Leads             => Fail(HeldElsewhere);
            7:  way: Here | Leads                           => Release                           -> Releasing;
        }
        /// The held object is being released.
        Releasing {
            8:  update: None | Due, source: Named           => Position(Source)                  -> Moving;
            9:  update: None | Due, source: Null            => Position(Destination)             -> Moving;
            10: update: Owed, source: Named                 => TellOwedAndPosition(Source)       -> Leaving;
            11: update: Owed, source: Null                  => TellOwedAndPosition(Destination)  -> Leaving;
        }
        /// The robot is on its way.
        Moving {
            12: update: None | Due                          => Finish;
        }
        /// The robot is on its way, and the data base is being told where the object is.
        Leaving {
            13: update: Owed                                => AwaitUpdate                       -> Telling;
            14: update: None | Due                          => Finish;
        }
        /// The data base is being told.
        Telling {
            15: update: Owed                                => TellOwed;
            16: update: None | Due                          => Finish;
        }
        Moving {
            17: update: Owed                                => TellOwed                          -> Telling;
        }
    }
}
