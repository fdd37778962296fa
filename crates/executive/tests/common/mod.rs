//! Common code of several tests.

use interfaces::{CommonMemory, Header};
use levels::ladder::PROCESS_COUNT;

pub const fn headers(memory: &mut CommonMemory) -> [&mut Header; PROCESS_COUNT] {
    [
        &mut memory.task.header,
        &mut memory.subtask.header,
        &mut memory.emove.header,
        &mut memory.prim.header,
        &mut memory.t3i.header,
        &mut memory.quick_change.header,
        &mut memory.grip.header,
        &mut memory.v_grip.header,
        &mut memory.tool_grip.header,
        &mut memory.pedestal.header,
        &mut memory.hand.header,
        &mut memory.table.header,
    ]
}
