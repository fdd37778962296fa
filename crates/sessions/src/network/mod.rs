//! Transport of mailboxes between the controller and neighbours in other processes, over a Unix socket. `rcs-gateway`
//! carries them to other machines.
//!
//! The mailboxes are in the controller's common memory, which the network reads and writes (IX). The tick
//! copies them and never waits for a socket; one thread per connection sends and receives changes. As in the
//! original, a mailbox holds the latest mailgram, without a queue.
//!
//! ```text
//!   tick -- Endpoint -- mailboxes in memory -- Link -- thread with Session -- Line -- Peer in another process
//! ```
//!
//! * [`neighbours::line`]: roles, frames, and the protocol of a connection, without I/O;
//! * [`endpoint`]: the tick's side of the mailboxes, `shared`: the network's; [`event`]: events for the tick;
//! * [`listener`], `accept_queue`, `server`: the controller's end of connections, [`peer`]: the neighbour's;
//! * [`operators`]: operators, whose connections carry lines instead of mailboxes.
//!
//! In fast clock the tick waits for the pulse of every connected neighbour, so that runs with neighbours in
//! other processes are equal bit for bit.

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
