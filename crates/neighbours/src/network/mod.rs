//! How mailboxes travel between the controller and neighbours in other processes, or on other machines.
//!
//! The mailboxes are the controller's: common memory, which the network fills and empties (IX). The tick copies in and out of
//! it and never waits for the network; threads of their own carry what is new. As in the original a mailbox holds the latest
//! mailgram, and nothing queues.
//!
//! ```text
//!   tick --Desk--> mailboxes in memory <--Counter-- threads <--socket--> Peer in another process
//! ```
//!
//! * [`role`]: who a neighbour is, and which mailboxes are his;
//! * [`frame`]: a mailgram on the line, and the pulse that tells of ticks;
//! * [`hello`]: how a connection begins, and who is let in, `door`: who waits for it; [`seal`]: that a frame comes from him;
//! * [`office`]: the mailboxes between tick and threads; [`news`]: what the tick hears of who comes and goes;
//! * [`listener`]: the controller's end of the line, [`peer`]: the neighbour's;
//! * [`station`]: a controller in a Zenoh network, between machines (with the feature `zenoh`).
//!
//! In fast clock the tick waits for the pulse of every neighbour that is there, so that runs with neighbours in other processes
//! have the same bits every time.

pub mod address;
mod door;
pub mod frame;
pub mod hello;
pub mod listener;
pub mod news;
pub mod office;
#[cfg(feature = "zenoh")]
mod over_zenoh;
pub mod peer;
pub mod role;
pub mod seal;
pub mod station;
mod stream;

pub use address::Address;
pub use hello::Secret;
pub use listener::Listener;
pub use news::{News, Parting};
pub use office::Desk;
pub use peer::{Peer, PeerError, Received};
pub use role::Role;
