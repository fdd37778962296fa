//! INSERT-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// INSERT-TOOL (V.2.1): DELTA-MOVE, CAL-SENSOR, and a GO-WHILE that the insertion force ends. Done at
    /// once if the tool is in the drum. The robot comes from before the drum: nothing else is known to be a way.
    pub INSERT_TOOL: fn insert_tool(enum InsertToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                         => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing | Other | Something  => Fail(NothingHeld);
            3: held: NotKnown                     => Fail(HeldNotKnown);
            4: held: Right, at: InDrum            => Finish;
            5: held: Right, at: Elsewhere         => Fail(NotPrepared);
            6: held: Right, at: Before | There    => DeltaMove(InsNear) -> Approaching;
        }
        /// The tool is moving to the drum.
        Approaching {
            7: work: Over                         => CalSensor          -> Calibrating;
        }
        /// The force sensor is being calibrated.
        Calibrating {
            8: work: Over                         => GoWhile(InsIn)     -> Inserting;
        }
        /// The tool is moving into the drum.
        Inserting {
            9: work: Over                         => StandInDrum;
        }
    }
}
