//! Transport of mailboxes between the controller and neighbours in other processes, over a Unix socket. `rcs-gateway`
//! carries them to other machines.
//!
//! The mailboxes are in the controller's common memory (IX). The tick copies them and never waits for a socket; one
//! thread per connection sends and receives changes. A mailbox holds the latest mailgram, without a queue.
//!
//! ```text
//!   tick -- Endpoint -- mailboxes in memory -- Link -- thread with Session -- Line -- Peer in another process
//! ```
//!
//! In fast clock the tick waits for every neighbour, so that runs are bit-identical.

mod accept_queue;
pub mod endpoint;
pub mod event;
pub mod listener;
pub mod operators;
pub mod peer;
mod server;
mod shared;

pub use neighbours::line::{Address, ClockKind, Role, address, clock, frame, role, session};

pub use endpoint::{Endpoint, Presence, StopHandle};
pub use event::{Disconnect, NetEvent};
pub use listener::Listener;
pub use operators::Operators;
pub use peer::{Peer, PeerError, Received, connect_operator};
pub use shared::{AttachError, EndpointHandle};
