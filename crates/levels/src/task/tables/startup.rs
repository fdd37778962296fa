//! STARTUP (V.4.1, IV.4.2).

use rcs_core::decision_table;

decision_table! {
    /// STARTUP (V.4.1): connect the Data System: Abort, Initiate, Startup, which the terminal showed (IV.4.2
    /// step 3), and the update that it did not take before, if there is one.
    pub STARTUP: fn startup(enum StartupStep, super::Situation) -> super::Action {
        any {
            1: work: Busy          => Wait;
        }
        /// Nothing done yet.
        Start {
            2: work: Over          => Abort           -> Aborting;
        }
        /// Abort was sent.
        Aborting {
            3: work: Over          => Initiate        -> Initiating;
        }
        /// Initiate was sent.
        Initiating {
            4: work: Over          => Startup         -> Connecting;
        }
        /// Startup was sent.
        Connecting {
            5: update: Owed        => ConnectAndTell  -> Settling;
            6: update: None | Due  => Connect;
        }
        /// The data base is told an earlier update again.
        Settling {
            7: work: Over          => Finish;
        }
    }
}
