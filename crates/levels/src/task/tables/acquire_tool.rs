//! ACQUIRE-TOOL (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.4.1): get the tool gripper, go to the destination, which is TOOL-SAFE, and grasp a
    /// tool in the tool drum; done at once if it is held there.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                => Wait;
        }
        /// Nothing done yet.
        Start {
            2: holding: NotHeld                          => GetEndeff    -> Gripper;
            3: holding: Held, station: Transfer          => Finish;
            4: holding: Held, station: Safe | Elsewhere  => Fail(AlreadyHolding);
            5: holding: Other                            => Fail(AlreadyHolding);
        }
        /// The tool gripper is being fetched.
        Gripper {
            6: work: Over                                => GotoDest     -> Approaching;
        }
        /// The robot is on its way to the destination, near the drum.
        Approaching {
            7: work: Over                                => AcquireTool  -> Acquiring;
        }
        /// The tool is being grasped.
        Acquiring {
            8: work: Over                                => Finish;
        }
    }
}
