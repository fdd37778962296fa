//! The workstation controller (HWSC) and Task (V.4.2, IX.1).
//!
//! The manual names the fields of the two interfaces, their widths and their order. The mailboxes contain them in that
//! order, without gaps. Values that the manual does not give are marked CHOSEN in [`command`] and [`status`].
//!
//! ```text
//!   HWSC --command::encode--> F6000 --Gate--> HwsCommand --> Task
//!   HWSC <--status::decode--- F6200 <-------- HwsStatus  <-- Task
//! ```
//!
//! [`Gate`] implements Task's READ-HWS-COMMAND and WRITE-HWS-STATUS (Figure IV.1). A refused mailgram never reaches
//! Task, which continues the command in progress. [`player`] is an emulator of the workstation controller that plays
//! jobs.

pub mod cell;
pub mod command;
mod gate;
pub mod player;
pub mod status;

pub use gate::{Gate, Judge, Refusal, Unchecked};
pub use status::{Status, TaskState};
