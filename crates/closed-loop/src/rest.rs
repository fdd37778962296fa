//! Detects that the commanded frame is at rest, so that every run ends its stream of points at rest.

use geometry::pose::WireFrame;
use interfaces::CommonMemory;

/// Ticks without a change of the commanded frame after which the robot is at rest.
pub const AT_REST: u32 = 5;
/// Ticks with the velocity knob at zero after which it is also treated as at rest: 3 s, longer than any ramp.
pub const AT_LAST: u32 = 75;

#[derive(Clone, Copy, Debug, Default)]
pub struct RestWatch {
    commanded: WireFrame,
    unchanged: u32,
}

impl RestWatch {
    pub fn observe(&mut self, memory: &CommonMemory) {
        let commanded = memory.prim.t3i.frame;
        self.unchanged = if commanded == self.commanded { self.unchanged.saturating_add(1) } else { 0 };
        self.commanded = commanded;
    }

    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        self.unchanged >= AT_REST
    }
}
