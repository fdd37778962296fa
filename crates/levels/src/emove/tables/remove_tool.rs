//! REMOVE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.2.1): CAL-SENSOR and a guarded move that the extraction force ends: a GO-WHILE, though
    /// the manual says GO-UNTIL, for the force is what must not come (SPECNOTES.md, contradiction 18). Done
    /// at once if the tool is out.
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                 => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing | Other      => Fail(NothingHeld);
            3: held: Something         => Fail(NothingHeld);
            4: held: NotKnown          => Fail(HeldNotKnown);
            5: held: Right, at: There     => Finish;
            6: held: Right, at: Elsewhere | Before => Fail(NotPrepared);
            7: held: Right, at: InDrum    => CalSensor       -> Calibrating;
        }
        /// The force sensor is being calibrated.
        Calibrating {
            8: work: Over                 => GoWhile(RemOut) -> Removing;
        }
        /// The tool is being pulled out.
        Removing {
            9: work: Over                 => Stand;
        }
    }
}
