//! REMOVE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.2.1): CAL-SENSOR and a guarded move that the extraction force ends. It is a GO-WHILE, although
    /// the manual says GO-UNTIL, because the force must not occur (SPECNOTES.md, contradiction 18). Done at once if
    /// the tool is out. A partly released tool is not pulled. After an interruption the command continues to pull
    /// (docs/design/recovery.md "Drum"). At a tool that is half out, the sensor is calibrated only if it has lost its
    /// calibration with its power: no other command leads out.
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                        => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing | Other | Something                 => Fail(NothingHeld);
            3:  held: NotKnown                                    => Fail(HeldNotKnown);
            4:  held: Right, fingers: Empty                       => Fail(ReleaseNotEnded);
            5:  at: There                                         => Finish;
            6:  at: Before                                        => Fail(NotPrepared);
            7:  at: InDrum                                        => CalSensor(Drum)    -> Calibrating;
            8:  drum: Inside | Entering | Sliding, bias: Missing  => CalSensor(Drum)    -> Calibrating;
            9:  drum: Inside | Entering | Sliding, bias: AtDrum | AtSafe => GoWhile(RemOutOn) -> Removing;
            10: drum: Before                                      => Stand;
            11: drum: Off | Clear                                 => Fail(NotPrepared);
        }
        /// The force sensor is being calibrated.
        Calibrating {
            12: otherwise                                         => GoWhile(RemOut)    -> Removing;
        }
        /// The tool is being pulled out.
        Removing {
            13: otherwise                                         => Stand;
        }
    }
}
