//! Systems that the controller reaches through mailboxes of the factory network (chapter IX).
//!
//! * [`mailbox`]: the eight mailboxes of Table IX.1 and their heads;
//! * [`mod@layout`]: layouts of mailbox data, defined once for encoding, decoding and documentation;
//! * [`workstation`]: the command and the status of V.4.2 as bytes, and the check of commands;
//! * [`data_system`]: the command of Figure IX.2 as bytes, its status, and a server for the items of the workstation;
//! * [`pedestal`]: the Active Pedestal as a separate system, and its mailboxes as bytes;
//! * [`vision`]: the areas of the vision mailbox (IX.4), which E-move reads and writes;
//! * [`mod@line`]: the bytes between the controller and a neighbour: frames, pulses, and the protocol of both sides.
//!
//! No file, socket, thread or clock: the crate `sessions` carries mailboxes to other processes, and keeps items in a
//! database. A level never uses a mailbox: Task's request to the Data System is a record of common memory
//! ([`interfaces::DataBaseCommand`]), which this crate encodes.

#![forbid(unsafe_code)]

pub mod data_system;
pub mod fields;
pub mod layout;
pub mod line;
pub mod mailbox;
pub mod pedestal;
pub mod vision;
pub mod workstation;
