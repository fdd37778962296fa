//! The command to the pedestal (VI.7.2).

use interfaces::pedestal::PedestalCommand;

use super::WORD;
use crate::layout::{At, Codec as _, I32, Spelled, U32, U64, Width as _};

crate::layout! {
    /// The command to the pedestal.
    CommandLayout: PedestalCommand = "a command";
    "cycle-cnt"    (cycle)        U64,            "tick in which the command was written";
    "incr-cmnd#"   (number)       U32,            "1 to 4294967295, then 1 again; 0: no command yet";
    "command"      (command)      Spelled<WORD>,  "PRE-GRIP, GRIP, FLIP, RELEASE, PAUSE; blank for none";
    "grasp-size"   (grasp_size)   I32,            "0.01 in (SPECNOTES.md, contradiction 27)";
    "grasp-force"  (grasp_force)  I32,            "lb";
    "table-angle"  (table_angle)  I32,            "0.1 degree; absolute for PRE-GRIP, relative for FLIP";
}

/// The number of a command, needed also to refuse an undecodable command. `None` if the data end too early.
#[must_use]
pub fn number(data: &[u8]) -> Option<u32> {
    let field = data.get(U64::BYTES..U64::BYTES + U32::BYTES)?;
    U32::take(At { field: "incr-cmnd#", byte: U64::BYTES }, field).ok()
}
