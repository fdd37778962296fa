use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.4.1): get the tool gripper, go to the destination, which is TOOL-SAFE, and grasp a tool in the
    /// tool drum. The command finishes at once if the tool is held there. Repeated after an interruption at the drum,
    /// it continues from there.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                      => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right, drum: Inside                       => Finish;
            3:  held: Right | Other                             => Fail(AlreadyHolding);
            4:  drum: Inside                                    => AcquireTool  -> Acquiring;
            5:  held: Something                                 => Fail(UnknownHeld);
            6:  held: NotKnown                                  => Fail(HeldNotKnown);
            7:  tool: Free, station: Unplaced, resumed: AtTool  => AcquireTool  -> Acquiring;
            8:  held: Nothing                                   => GetEndeff    -> Gripper;
        }
        /// The tool gripper is being fetched.
        Gripper {
            9:  otherwise                                       => GotoDest     -> Approaching;
        }
        /// The robot moves to the destination, near the drum.
        Approaching {
            10: otherwise                                       => AcquireTool  -> Acquiring;
        }
        /// The tool is being grasped.
        Acquiring {
            11: otherwise                                       => Finish;
        }
    }
}
