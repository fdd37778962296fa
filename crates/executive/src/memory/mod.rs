//! Common memory for other programs (docs/design/memory.md "Shared memory"): the buffers of a run in shared memory.
//!
//! Other programs attach and leave at any time; they cannot affect a tick. Each writer has one iceoryx2 *blackboard*
//! service: latest value, one writer, no allocation. A value is the tick that wrote it, then the byte image
//! ([`rcs_core::plain`]), which a reader decodes with checks.

mod announced;
pub mod attach;
pub mod buffers;
pub mod cell;
mod error;
pub mod field;
pub mod history;
pub mod layout;
pub mod limit;
pub mod mirror;
mod name;
mod objects;
mod place;
mod presence;
pub mod publish;
pub mod runs;
pub(crate) mod slot;
mod text;

pub use announced::{Announced, phase, starting};
pub use attach::{Attached, ReadError};
pub use error::SharedMemoryError;
pub use limit::{OnTimeout, SET_UP_LIMIT, within_limit};
pub use mirror::Mirror;
pub use name::{NameError, RunName};
pub(crate) use place::{have_room, reserve};
pub use place::{layout, load_file, operator_socket, prefix, root};
pub(crate) use publish::PUBLISHER;
pub use publish::Publisher;
pub(crate) use runs::is_there;
pub use runs::{clean, clean_objects, list, traces};
pub use text::Text;
