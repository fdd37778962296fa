//! RELEASE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE (V.2.1): open the gripper to the depart size, and from something unknown by 0.5 in at least; done
    /// at once if it is open and holds nothing. A gripper that is not calibrated knows no size: it opens fully.
    pub RELEASE: fn release(enum ReleaseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                        => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing, spread: Open       => Finish;
            3: spread: Unknown                   => OpenFully    -> Opening;
            4: held: Nothing, spread: Narrow     => OpenToDepart -> Opening;
            5: held: Right | Other | Something | NotKnown => OpenToDepart -> Opening;
        }
        /// The gripper is opening.
        Opening {
            6: work: Over                        => Finish;
        }
    }
}
