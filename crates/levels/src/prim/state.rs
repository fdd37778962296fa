//! What Prim remembers.

use rcs_core::{handshake::Commander, interface::prim::PrimVerb, record};

use super::{
    motion::{Motion, limits::Limits, segment::FrameData},
    tables::path_clock::Clock,
};
use crate::execution::Execution;

record! {
    /// The current command with its records looked up.
    pub struct Target {
        /// What to do.
        pub verb: PrimVerb,
        /// `^-pose` with `^-movtab` applied; unused by PAUSE and ROBOT-INIT.
        pub goal: FrameData,
        /// Limits of `^-traj-para`.
        pub limits: Limits,
        /// brk-dst of `^-traj-para`, inches of path.
        pub brake_distance: f64,
    }
}

impl Target {
    /// The robot is not to stop at the goal.
    #[must_use]
    pub fn is_through(&self) -> bool {
        self.verb == PrimVerb::GoThru
    }
}

record! {
    /// Everything that Prim remembers.
    pub struct State {
        /// The current command and how far it has come.
        pub execution: Execution,
        /// The command to T3I.
        pub t3i: Commander,
        /// What is to be done.
        pub target: Target,
        /// The robot is commanded by Prim: `motion` holds where it was told to be.
        pub positioned: bool,
        /// The commanded motion.
        pub motion: Motion,
        /// Did the path clock run in the last tick?
        pub clock: Clock,
        /// Ticks since T3I finished the last point of a GOTO-PT.
        pub finished: u32,
        /// The last ticks of them at the goal.
        pub settled: u32,
        /// Number of the newest pose record.
        pub newest_pose: u32,
    }
}
