//! The Active Pedestal (VI.7): a small RCS itself, which grasps and reorients objects.
//!
//! ```text
//!        Subtask
//!           | PRE-GRIP, GRIP, FLIP, RELEASE, PAUSE
//!       Pedestal                     [`control`]
//!        /     \
//!     Hand    Table                  [`hand`], [`table`]
//!      |        |
//!   8 valves   rotary table controller
//! ```
//!
//! The manual gives the interface of the upper process; the two below are "transparent to the RCS-II/T3
//! controller". Both calibrate themselves at the start (IV.5.1 steps 7 and 10). None of the three opens the hand
//! without a command, not even after a failure.

pub mod control;
pub mod hand;
pub mod table;

pub use self::{control::Pedestal, hand::Hand, table::Table};
