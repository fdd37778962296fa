//! Detects that the commanded frame is at rest, so that every stream of points ends at rest, however the run ends.

use geometry::pose::WireFrame;
use interfaces::CommonMemory;

/// The robot is at rest when the commanded frame has not changed for this many ticks.
pub const AT_REST: u32 = 5;
/// It also counts as at rest after this many ticks, 3 s, with the velocity knob at zero: no ramp takes longer.
pub const AT_LAST: u32 = 75;

/// Observes the commanded frame after each tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct RestWatch {
    commanded: WireFrame,
    unchanged: u32,
}

impl RestWatch {
    /// Observe a tick.
    pub fn observe(&mut self, memory: &CommonMemory) {
        let commanded = memory.prim.t3i.frame;
        self.unchanged = if commanded == self.commanded { self.unchanged.saturating_add(1) } else { 0 };
        self.commanded = commanded;
    }

    /// True if the commanded frame is at rest.
    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        self.unchanged >= AT_REST
    }
}
