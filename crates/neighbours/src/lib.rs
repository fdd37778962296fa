//! The neighbours of the controller: what is reached through a mailbox of the factory network (chapter IX).
//!
//! * [`mailbox`]: the eight mailboxes of Table IX.1 and what stands in front of their data;
//! * [`mod@layout`]: how the data of a mailbox are defined, once for encoding, decoding and documentation;
//! * [`workstation`]: the command and the status of V.4.2 to the byte, and what refuses commands that cannot
//!   be;
//! * [`data_system`]: the command of Figure IX.2 to the byte, the status that answers it, and a server that
//!   keeps the items of the workstation in SQLite.
//! * [`pedestal`]: the Active Pedestal as a system of its own, its mailboxes to the byte and both ends of
//!   them.
//! * [`vision`]: the areas of the vision mailbox (IX.4), and what E-move reads and writes there;
//! * [`network`]: how mailboxes travel to other processes.
//!
//! A level never sees a mailbox: what Task asks of the Data System is a record of common memory
//! ([`interfaces::DataBaseCommand`]), and this crate makes bytes of it.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod data_system;
pub mod fields;
pub mod layout;
pub mod mailbox;
pub mod network;
pub mod pedestal;
pub mod vision;
pub mod workstation;
