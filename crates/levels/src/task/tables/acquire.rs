use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE (V.4.1): get the proper end effector, move to the object and grasp it. If the object comes from the
    /// MBD, the database receives an update (an extension: SPECNOTES.md).
    pub ACQUIRE: fn acquire(enum AcquireStep, super::Situation) -> super::Action {
        any {
            1: work: Busy              => Wait;
        }
        /// Nothing done yet.
        Start {
            2: update: Pending         => SendPending  -> Settling;
        }
        /// An earlier update is sent again.
        Settling {
            3: update: Pending         => SendPending;
        }
        Start | Settling {
            4: otherwise               => GetEndeff    -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            5: otherwise               => GetObject    -> Object;
        }
        /// The object is being fetched.
        Object {
            6: update: Due             => Update       -> Updating;
            7: update: None | Pending  => Finish;
        }
        /// The update that the robot has the object is sent.
        Updating {
            8: otherwise               => Finish;
        }
    }
}
