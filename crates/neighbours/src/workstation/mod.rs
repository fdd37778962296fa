//! The workstation controller (HWSC) and Task (V.4.2, IX.1).
//!
//! The mailboxes contain the fields of the manual in their order, without gaps. Values that it does not give are
//! CHOSEN in [`command`] and [`status`].
//!
//! ```text
//!   HWSC --command::encode--> F6000 --Gate--> HwsCommand --> Task
//!   HWSC <--status::decode--- F6200 <-------- HwsStatus  <-- Task
//! ```
//!
//! [`Gate`] is Task's READ-HWS-COMMAND and WRITE-HWS-STATUS (Figure IV.1). A refused mailgram never reaches Task,
//! which continues. [`player`] emulates a workstation controller that plays jobs.

pub mod cell;
pub mod command;
mod gate;
pub mod player;
pub mod status;

pub use gate::{Gate, Judge, Refusal, Unchecked};
pub use status::{Status, TaskState};
