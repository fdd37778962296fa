//! INSERT-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// INSERT-TOOL (V.2.1): CAL-SENSOR at TOOL-SAFE, DELTA-MOVE to the last point without possible contact, and two
    /// GO-WHILE. The first moves to the fingers of the drum and fails at any contact; the second moves into the drum
    /// and fails if the insertion force is too great. Done at once if the tool is in the drum, and its release has
    /// not begun. The robot must start before the drum, the only known way in. After an interruption the command
    /// continues from the robot's position at the drum (docs/design/recovery.md "Drum"). The force sensor is
    /// calibrated only at TOOL-SAFE: the tool has no contact there, and its weight loads the sensor in the same
    /// direction as at the drum.
    pub INSERT_TOOL: fn insert_tool(enum InsertToolStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                       => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing | Other | Something                => Fail(NothingHeld);
            3:  held: NotKnown                                   => Fail(HeldNotKnown);
            4:  held: Right, fingers: Empty                      => Fail(ReleaseNotEnded);
            5:  at: InDrum                                       => Finish;
            6:  at: Before                                       => CalSensor(Safe)    -> Calibrating;
            7:  at: There, bias: Missing | AtDrum                => Fail(ForceUncalibrated);
            8:  at: There, bias: AtSafe                          => DeltaMove(InsFar)  -> Approaching;
            9:  drum: Before,            bias: Missing | AtDrum  => Fail(ForceUncalibrated);
            10: drum: Before,            bias: AtSafe            => DeltaMove(InsFar)  -> Approaching;
            11: drum: Entering | Inside, bias: Missing           => Fail(ForceUncalibrated);
            12: drum: Entering | Inside, bias: AtDrum | AtSafe   => GoWhile(InsIn)     -> Inserting;
            13: drum: Off | Sliding | Clear                      => Fail(NotPrepared);
        }
        /// The force sensor is being calibrated.
        Calibrating {
            14: otherwise                                        => DeltaMove(InsFar)  -> Approaching;
        }
        /// The tool is moving to the last point without possible contact.
        Approaching {
            15: otherwise                                        => GoWhile(InsNear)   -> Nearing;
        }
        /// The tool is moving to the fingers of the drum.
        Nearing {
            16: otherwise                                        => GoWhile(InsIn)     -> Inserting;
        }
        /// The tool is moving into the drum.
        Inserting {
            17: otherwise                                        => StandInDrum;
        }
    }
}
