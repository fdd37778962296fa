//! The path to a goal, shared by the MOV-… commands.

use rcs_core::decision_table;

decision_table! {
    /// MOTION: a series of GO-THRU and one GOTO-PT (V.2.1 MOV-TO-LOC). Before it, FINGERS decides on finger motion,
    /// and on the wait of the final motion for the fingers.
    pub MOTION: fn motion(enum MotionStep, struct of super::Senses) -> super::Action {
        any {
            1: work: Busy      => Wait;
        }
        /// On the through points; no order yet at first.
        Moving {
            2: ahead: Through  => GoThru;
            3: ahead: Missing  => Fail(BadRecord);
            4: ahead: Stop     => GotoPt  -> Stopping;
            5: ahead: Nothing  => Arrive;
            6: ahead: Rejoin   => GotoPt  -> Rejoining;
        }
        /// On the final motion.
        Stopping {
            7: otherwise       => Arrive;
        }
        /// On the return to the way after manual motion.
        Rejoining {
            8: otherwise       => Wait    -> Moving;
        }
    }
}
