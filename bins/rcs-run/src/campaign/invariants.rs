//! Invariants that hold after every tick of a branch, whichever interruption preceded it.
//!
//! * each process that runs has stamped its outputs with this tick;
//! * the distance between Prim's successive points is within the link's limit (14 in/s, 1 rad/s). Near the poles of the
//!   T3's wrist T3 Interface takes longer for a point; this is permitted;
//! * E-move's status of the gripper is true: it holds an object, or nothing.
//!
//! The first three hold at all times. E-move may be wrong for [`CORRECTION_TICKS`] ticks after an interruption, because
//! sensors report late.

use executive::alloc;
use geometry::{frame::INCHES_PER_RADIAN, pose::WireFrame};
use interfaces::{
    emove::Holding,
    t3i::{T3iCommand, T3iVerb},
};
use levels::{
    ladder::{Ladder, ProcessId},
    prim::motion::limits::LINK_VELOCITY,
};
use rcs_core::tick::TICK_S;

use super::branch::Branch;

/// Ticks for which E-move may be wrong about the held object: 5 s. The fingers need less time for their travel.
const CORRECTION_TICKS: u32 = 125;
/// Longest step from a point to the next, in: 14 in/s (A 2.3) for a tick, and the rounding of two points.
const STEP_INCHES: f64 = LINK_VELOCITY * TICK_S + 0.02;
/// Longest rotation from a point to the next, at 1 rad/s, radians.
const STEP_RADIANS: f64 = LINK_VELOCITY / INCHES_PER_RADIAN * TICK_S + 0.002;

#[derive(Clone, Debug)]
pub struct Invariants {
    allocations: u64,
    point: Option<WireFrame>, // the last point that Prim has sent since it started the link
    wrong: u32,
}

impl Invariants {
    #[must_use]
    pub fn from_now(branch: &Branch<'_>) -> Self {
        let mut point = None;
        steps_too_far(&mut point, &branch.memory().prim.t3i);
        Self { allocations: alloc::allocations(), point, wrong: 0 }
    }

    #[must_use]
    pub const fn hold(&self) -> bool {
        self.wrong == 0
    }

    /// The invariant broken in this tick, as a sentence. `disturbed` is true during an interruption.
    pub fn broken(&mut self, branch: &Branch<'_>, disturbed: bool) -> Option<String> {
        let unstamped = unstamped(branch);
        let allocated = alloc::allocations().saturating_sub(self.allocations);
        self.allocations += allocated;
        let too_far = steps_too_far(&mut self.point, &branch.memory().prim.t3i);
        let misled = misled(branch);
        self.wrong = if misled.is_some() && !disturbed { self.wrong + 1 } else { 0 };
        unstamped
            .or_else(|| (allocated > 0).then(|| "the control processes allocate memory".to_owned()))
            .or_else(|| too_far.then(|| "Prim sends a point that is too far from the one before".to_owned()))
            .or_else(|| misled.filter(|_| self.wrong == CORRECTION_TICKS))
    }
}

/// True if a point of Prim is too far from the `last` point, which it replaces.
fn steps_too_far(last: &mut Option<WireFrame>, sent: &T3iCommand) -> bool {
    match sent.command {
        T3iVerb::Point => {}
        T3iVerb::Pause => return false,
        T3iVerb::None | T3iVerb::Restart => {
            *last = None;
            return false;
        }
    }
    let before = last.replace(sent.frame).filter(|before| *before != sent.frame);
    let frames = before.map(|before| (before.to_frame(), sent.frame.to_frame()));
    match frames {
        None => false,
        Some((Ok(before), Ok(now))) => {
            let step = before.distance(&now);
            step.inches > STEP_INCHES || step.radians > STEP_RADIANS
        }
        Some(_) => true,
    }
}

fn unstamped(branch: &Branch<'_>) -> Option<String> {
    let (tick, memory) = (branch.at(), branch.memory());
    let names = Ladder::processes().iter().map(|process| process.name);
    let mut late = ProcessId::ALL.iter().zip(names).filter(|(id, _)| {
        branch.closed.course().levels().processes().contains(id) && memory.header(**id).stamp != tick
    });
    late.next().map(|(_, name)| format!("{name} has not stamped its outputs"))
}

/// E-move's status of the gripper as a sentence, if it is false.
fn misled(branch: &Branch<'_>) -> Option<String> {
    if !branch.closed.course().levels().processes().contains(&ProcessId::Emove) {
        return None;
    }
    let held = branch.closed.workstation.cell.parts().into_iter().find(|part| part.held);
    untrue(&branch.memory().emove.status.held, held.map(|part| part.name).as_deref())
}

/// The object that the status claims to be held, if the gripper holds another part or none.
fn untrue(said: &Holding, held: Option<&str>) -> Option<String> {
    match (said, held) {
        (Holding::Object(said), None) => {
            Some(format!("E-move reports that it holds {}: it holds nothing", said.object))
        }
        (Holding::Nothing, Some(part)) => {
            Some(format!("E-move reports that it holds nothing: it holds {part}"))
        }
        (Holding::Object(_) | Holding::Something | Holding::NotKnown, _) | (Holding::Nothing, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use geometry::frame::{Frame, Vector, rotation_by};
    use interfaces::emove::ObjectGrip;

    use super::*;

    #[test]
    fn point_step_beyond_the_limit_breaks_the_invariant() {
        let at = |inches: f64, radians: f64| {
            WireFrame::from_frame(&Frame {
                position: Vector::new(60.0 + inches, 0.0, 0.0),
                rotation: rotation_by(&Vector::new(0.0, radians, 0.0)),
            })
        };
        let sent = |command, frame| T3iCommand { command, frame, ..T3iCommand::default() };
        let mut last = None;
        for (command, frame, too_far) in [
            (T3iVerb::Point, at(0.0, 0.0), false),
            (T3iVerb::Point, at(0.56, 0.04), false),
            (T3iVerb::Point, at(1.15, 0.04), true),
            (T3iVerb::Point, at(1.15, 0.09), true),
            (T3iVerb::Pause, WireFrame::default(), false),
            (T3iVerb::Point, at(9.0, 0.09), true),
            (T3iVerb::Restart, WireFrame::default(), false),
            (T3iVerb::Point, at(20.0, 0.0), false),
        ] {
            assert_eq!(steps_too_far(&mut last, &sent(command, frame)), too_far, "{command:?} {frame:?}");
        }
    }

    #[test]
    fn reported_held_object_is_true_or_unknown() {
        let object = Holding::Object(ObjectGrip::default());
        assert!(untrue(&object, None).is_some() && untrue(&Holding::Nothing, Some("SHAFT")).is_some());
        assert_eq!(untrue(&object, Some("SHAFT")), None);
        assert_eq!(untrue(&Holding::Nothing, None), None);
        for unknown in [Holding::Something, Holding::NotKnown] {
            assert_eq!((untrue(&unknown, None), untrue(&unknown, Some("SHAFT"))), (None, None));
        }
    }
}
