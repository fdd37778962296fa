//! REMOVE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.2.1): CAL-SENSOR and a guarded move that the extraction force ends: a GO-WHILE, though
    /// the manual says GO-UNTIL, for the force is what must not come (SPECNOTES.md, contradiction 18). Done
    /// at once if the tool is out. Sent again after an interruption it goes on pulling, without calibrating
    /// the sensor against a tool that is half out (docs/design/recovery.md "Drum").
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                 => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing | Other | Something          => Fail(NothingHeld);
            3:  held: NotKnown                             => Fail(HeldNotKnown);
            4:  at: There                                  => Finish;
            5:  at: Before                                 => Fail(NotPrepared);
            6:  at: InDrum                                 => CalSensor          -> Calibrating;
            7:  drum: Inside | Entering | Sliding          => GoWhile(RemOutOn)  -> Removing;
            8:  drum: Before                               => Stand;
            9:  drum: Off | Beside                         => Fail(NotPrepared);
        }
        /// The force sensor is being calibrated.
        Calibrating {
            10: work: Over                                 => GoWhile(RemOut)    -> Removing;
        }
        /// The tool is being pulled out.
        Removing {
            11: work: Over                                 => Stand;
        }
    }
}
