//! Common memory for other programs (docs/design/memory.md "Shared memory"): the buffers of a run in shared memory.
//!
//! The run publishes the outputs of its processes once a tick. Other programs attach and leave at any time and read the
//! latest values; they cannot affect a tick. Each writer (a control process, the HWSC, the devices, the executive) has
//! one iceoryx2 *blackboard* service: latest value, one writer, no allocation.
//!
//! A value is bytes, never a Rust structure: the tick that wrote it, then the byte image ([`rcs_core::plain`]). So there
//! is no padding, no pointer and no enum that another program could make illegal; a reader decodes with checks.
//!
//! * `slot`: one value in shared memory, also for the boards;
//! * [`mod@layout`]: the list of services, [`buffers`]: writing and reading them;
//! * [`Announced`]: a run before its first tick;
//! * [`publish`]: the writer's side, for the run;
//! * [`attach`]: the readers' side;
//! * [`history`]: the headers of the last ten seconds, [`cell`]: the view of the simulated cell;
//! * [`mirror`]: the status for programs that do not know the buffers;
//! * [`name`], [`place`]: names, directories and prefixes, and the check that only this user can use them;
//! * [`presence`]: which programs of a run are alive;
//! * [`runs`]: entering, finding and removing runs;
//! * [`limit`]: time limit of the set-up.

mod announced;
pub mod attach;
pub mod buffers;
pub mod cell;
mod error;
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
pub use limit::{OnStuck, SET_UP_LIMIT, within_limit};
pub use mirror::Mirror;
pub use name::{NameError, RunName};
pub(crate) use place::{have_room, reserve};
pub use place::{layout, load_file, operator_socket, prefix, root};
pub(crate) use publish::PUBLISHER;
pub use publish::Publisher;
pub(crate) use runs::is_there;
pub use runs::{clean, clean_objects, list, traces};
pub use text::Text;
