//! RELEASE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE (V.2.1): open the gripper to the depart size, and from something unknown by 0.5 in at least; done
    /// at once if it is open and holds nothing. A gripper that is not calibrated knows no size: it opens fully. A robot
    /// that a person has moved off its place goes back there first: an object is let go only there.
    pub RELEASE: fn release(enum ReleaseStep, struct of super::Senses) -> super::Action {
        any {
            1: work: Busy                   => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing, spread: Open  => Finish;
            3: ahead: Rejoin                => GotoPt        -> Correcting;
        }
        /// The robot is going back to its place.
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
