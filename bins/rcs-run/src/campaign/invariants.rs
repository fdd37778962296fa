//! What holds after every tick of a branch, whatever has interrupted it.
//!
//! * each process that runs has stamped its outputs with this tick;
//! * nothing was allocated in the tick of the control processes;
//! * T3 Interface has limited no point: Prim keeps the limits itself;
//! * what E-move says of the gripper is true: it holds an object, or nothing.
//!
//! The first three hold at once. Sensors say late, and during a fault wrongly, what is between the fingers: E-move may
//! be wrong for [`PATIENCE`] ticks after an interruption is over.

use executive::alloc;
use interfaces::emove::Holding;
use levels::ladder::{Ladder, ProcessId};

use super::branch::Branch;

/// Ticks for which E-move may be wrong about what is held: 5 s, longer than fingers take for their travel.
const PATIENCE: u32 = 125;

/// Watches the invariants of a branch.
#[derive(Clone, Debug)]
pub struct Invariants {
    allocations: u64,
    limited: u32,
    /// Ticks for which E-move has been wrong.
    wrong: u32,
}

impl Invariants {
    /// Watch from now on.
    #[must_use]
    pub fn from_now(branch: &Branch<'_>) -> Self {
        let limited = branch.memory().t3i.status.counters.limited;
        Self { allocations: alloc::allocations(), limited, wrong: 0 }
    }

    /// True if all held in the last tick.
    #[must_use]
    pub const fn hold(&self) -> bool {
        self.wrong == 0
    }

    /// The invariant that this tick has broken, as a sentence. `disturbed` is true during an interruption.
    pub fn broken(&mut self, branch: &Branch<'_>, disturbed: bool) -> Option<String> {
        let unstamped = unstamped(branch);
        let allocated = alloc::allocations().saturating_sub(self.allocations);
        self.allocations += allocated;
        // A restarted T3 Interface counts from 0 again.
        let limited = branch.memory().t3i.status.counters.limited;
        let more = limited > std::mem::replace(&mut self.limited, limited);
        let misled = misled(branch);
        self.wrong = if misled.is_some() && !disturbed { self.wrong + 1 } else { 0 };
        unstamped
            .or_else(|| (allocated > 0).then(|| "the control processes allocate memory".to_owned()))
            .or_else(|| more.then(|| "T3 Interface limits a point of Prim".to_owned()))
            .or_else(|| misled.filter(|_| self.wrong == PATIENCE))
    }
}

/// A process that runs and has not stamped its outputs with this tick.
fn unstamped(branch: &Branch<'_>) -> Option<String> {
    let (tick, memory) = (branch.at(), branch.memory());
    let names = Ladder::processes().iter().map(|process| process.name);
    let mut late = ProcessId::ALL
        .iter()
        .zip(names)
        .filter(|(id, _)| branch.processes().contains(id) && memory.header(**id).stamp != tick);
    late.next().map(|(_, name)| format!("{name} has not stamped its outputs"))
}

/// E-move's status of the gripper, if it is untrue.
fn misled(branch: &Branch<'_>) -> Option<String> {
    if !branch.processes().contains(&ProcessId::Emove) {
        return None;
    }
    let held = branch.workstation.cell.parts().into_iter().find(|part| part.held);
    untrue(&branch.memory().emove.status.held, held.map(|part| part.name).as_deref())
}

/// What is said to be held, if the gripper holds this part, or none.
fn untrue(said: &Holding, held: Option<&str>) -> Option<String> {
    match (said, held) {
        (Holding::Object(said), None) => {
            Some(format!("E-move says that it holds {}: it holds nothing", said.object))
        }
        (Holding::Nothing, Some(part)) => Some(format!("E-move says that it holds nothing: it holds {part}")),
        (Holding::Object(_) | Holding::Something | Holding::NotKnown, _) | (Holding::Nothing, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use interfaces::emove::ObjectGrip;

    use super::*;

    #[test]
    fn what_is_said_to_be_held_is_true_or_not_known() {
        let object = Holding::Object(ObjectGrip::default());
        assert!(untrue(&object, None).is_some() && untrue(&Holding::Nothing, Some("SHAFT")).is_some());
        assert_eq!(untrue(&object, Some("SHAFT")), None);
        assert_eq!(untrue(&Holding::Nothing, None), None);
        for unknown in [Holding::Something, Holding::NotKnown] {
            assert_eq!((untrue(&unknown, None), untrue(&unknown, Some("SHAFT"))), (None, None));
        }
    }
}
