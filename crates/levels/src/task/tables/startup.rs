use rcs_core::decision_table;

decision_table! {
    /// STARTUP (V.4.1): connect the Data System with Abort, Initiate and Startup, which the terminal showed (IV.4.2
    /// step 3). Then send the pending updates.
    pub STARTUP: fn startup(enum StartupStep, super::Situation) -> super::Action {
        any {
            1: work: Busy          => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise           => Abort           -> Aborting;
        }
        /// Abort was sent.
        Aborting {
            3: otherwise           => Initiate        -> Initiating;
        }
        /// Initiate was sent.
        Initiating {
            4: otherwise           => Startup         -> Connecting;
        }
        /// Startup was sent.
        Connecting {
            5: update: Pending     => ConnectAndSend  -> Settling;
            6: update: None | Due  => Connect;
        }
        /// Earlier updates are sent again.
        Settling {
            7: update: Pending     => SendPending;
            8: update: None | Due  => Finish;
        }
    }
}
