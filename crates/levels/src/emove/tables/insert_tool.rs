//! INSERT-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// INSERT-TOOL (V.2.1): DELTA-MOVE, CAL-SENSOR, and a GO-WHILE that the insertion force ends. Done at
    /// once if the tool is in the drum, and not half let go. The robot comes from before the drum: nothing
    /// else is known to be a way. Sent again after an interruption it goes on from where the robot is at the
    /// drum (docs/design/recovery.md "Drum"); the sensor is calibrated only where the tool touches nothing.
    pub INSERT_TOOL: fn insert_tool(enum InsertToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                 => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing | Other | Something          => Fail(NothingHeld);
            3:  held: NotKnown                             => Fail(HeldNotKnown);
            4:  held: Right, fingers: Empty                => Fail(ReleaseNotEnded);
            5:  at: InDrum                                 => Finish;
            6:  at: Before | There                         => DeltaMove(InsNear) -> Approaching;
            7:  drum: Before                               => DeltaMove(InsNear) -> Approaching;
            8:  drum: Entering | Inside                    => GoWhile(InsIn)     -> Inserting;
            9:  drum: Off | Sliding | Beside               => Fail(NotPrepared);
        }
        /// The tool is moving to the drum.
        Approaching {
            10: work: Over                                 => CalSensor          -> Calibrating;
        }
        /// The force sensor is being calibrated.
        Calibrating {
            11: work: Over                                 => GoWhile(InsIn)     -> Inserting;
        }
        /// The tool is moving into the drum.
        Inserting {
            12: work: Over                                 => StandInDrum;
        }
    }
}
