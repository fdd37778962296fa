//! The control processes of RCS-II/T3 (chapters V and VI), one folder each.
//!
//! Every process is a pure state machine ([`interfaces::process::Process`]) in the manual's three phases:
//! *preprocess* reads input buffers and sets state variables, a *decision table* of the current command selects one
//! row, *postprocess* fills the output buffers. Processes read the buffers of the previous tick, so their order
//! within a tick does not matter. Each folder has the same files: `state`, `preprocess`, `tables` with one file per
//! command, `goals` and `postprocess`.
//!
//! ```text
//!        HWSC                    Data System
//!         | TRANSFER, REFIXTURE ...  | UPDATE
//!        Task -----------------------+            (V.4)
//!         | GET-OBJECT, FIX-GRIP ...
//!      Subtask ----- Active Pedestal              (V.3, VI.7)
//!         |            |-> hand, rotary table
//!         | MOV-TO-OBJ, QC-ATTACH ...
//!       E-move ----- vision                       (V.2)
//!         |   |-> Quick Change                    (VI.2)
//!         |   |-> Grip, V-Grip, Tool-Grip         (VI.3 to VI.5)
//!         | GO-THRU, GO-UNTIL ...
//!        Prim ------ joystick box, force sensor   (V.1)
//!         | POINT
//!    T3 Interface                                 (VI.1)
//!         | DEPC
//! ```

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::as_conversions,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic
    )
)]

/// The unit tests use the package's external name, like those in `tests`, and share the environment with them.
#[cfg(test)]
extern crate self as levels;

#[cfg(test)]
#[path = "../tests/environment/bench.rs"]
mod bench;
pub mod confirm;
#[cfg(test)]
mod coverage;
pub mod emove;
#[cfg(test)]
#[path = "../tests/environment/mod.rs"]
mod environment;
pub mod execution;
pub mod goal;
pub mod grip;
pub mod halt;
pub mod held;
pub mod jaws;
pub mod ladder;
pub mod pedestal;
pub mod places;
pub mod prim;
pub mod quick_change;
pub mod rows;
pub mod subtask;
pub mod t3i;
pub mod task;
pub mod variables;

/// The types of the control processes, each under its identifier in `interfaces::for_each_process!`.
pub mod processes {
    pub use crate::{
        emove::Emove,
        grip::Grip,
        jaws::{ToolGrip, VGrip},
        pedestal::{Hand, Pedestal, Table as RotaryTable},
        prim::Prim,
        quick_change::QuickChange,
        subtask::Subtask,
        t3i::T3i,
        task::Task,
    };
}
