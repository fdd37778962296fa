//! RELEASE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE (V.2.1): open the gripper to the depart size, for an unknown object by at least 0.5 in; done at once
    /// if it is open and holds nothing. An uncalibrated gripper has no measured size and opens fully. A robot moved
    /// off its place by the operator returns there first: an object is released only there.
    pub RELEASE: fn release(enum ReleaseStep, struct of super::Senses) -> super::Action {
        any {
            1: work: Busy                   => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing, spread: Open  => Finish;
            3: ahead: Rejoin                => GotoPt        -> Correcting;
        }
        /// The robot is returning to its place.
        Correcting {}
        Start | Correcting {
            4: spread: Unknown              => OpenFully     -> Opening;
            5: spread: Narrow | Open        => OpenToDepart  -> Opening;
        }
        /// The gripper is opening.
        Opening {
            6: otherwise                    => Finish;
        }
    }
}
