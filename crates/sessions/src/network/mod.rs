//! Transport of mailboxes between the controller and neighbours in other processes or on other machines.
//!
//! The mailboxes are in the controller's common memory, which the network reads and writes (IX). The tick copies them
//! and never waits for a socket; a thread for each connection sends and receives changes. As in the original a mailbox
//! holds the latest mailgram, without a queue.
//!
//! ```text
//!   tick -- Endpoint -- mailboxes in memory -- Link -- thread with Session -- Channel -- Peer in another process
//! ```
//!
//! * [`role`]: which neighbours there are, and which mailboxes each has;
//! * `clock`: the clock of the run, and how long it waits for a neighbour;
//! * [`frame`]: a mailgram on the line, and the pulse for each tick; [`session`]: the protocol, without I/O;
//! * [`endpoint`]: the tick's side of the mailboxes, `shared`: the network's; [`event`]: events for the tick;
//! * [`keys`]: TLS between machines, and which certificate is which neighbour;
//! * `socket`, `channel`: bytes of a session over a socket, with TLS or without;
//! * [`listener`], `accept_queue`, `server`: the controller's end of connections, [`peer`]: the neighbour's;
//! * [`operators`]: operators, whose connections carry lines in the place of mailboxes;
//! * [`zenoh_address`], `over_zenoh`: connections through a Zenoh network (with the feature `zenoh`).
//!
//! In fast clock the tick waits for the pulse of every neighbour that is connected, so that runs with
//! neighbours in other processes have the same bits every time.

mod accept_queue;
pub mod address;
mod channel;
pub mod clock;
pub mod endpoint;
pub mod event;
pub mod frame;
pub mod keys;
pub mod listener;
pub mod operators;
#[cfg(feature = "zenoh")]
mod over_zenoh;
pub mod peer;
pub mod role;
mod server;
pub mod session;
mod shared;
mod socket;
pub mod zenoh_address;

pub use address::Address;
pub use clock::ClockKind;
pub use endpoint::{Endpoint, Presence, StopHandle};
pub use event::{Disconnect, NetEvent};
pub use keys::{ControllerKeys, KeysError, NeighbourKeys};
pub use listener::Listener;
pub use operators::Operators;
pub use peer::{Peer, PeerError, Received};
pub use role::Role;
pub use shared::{AttachError, EndpointHandle};
