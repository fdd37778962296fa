//! DOUBT: what a resumed controller keeps of an earlier run (docs/design/resume.md "Not known").

use interfaces::{
    CommonMemory,
    emove::{Estimates, Seat},
};
use rcs_core::{Actions, Plain, Variables, decision_table};

/// The last knowledge, compared with the end of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum RunEnd {
    /// The journal is whole, and no other file shows a later change.
    Reached,
    /// The knowledge is that of a log up to the end of its run.
    Logged,
    /// The entry or the image after the last complete one is missing or damaged.
    CutOff,
    /// The journal notes that the disk did not accept the next entry.
    Trouble,
    /// Another file shows that the run continued after the last entry.
    Continued,
}

impl RunEnd {
    /// The reason for the doubt as a clause; `None` without doubt.
    #[must_use]
    pub const fn doubt(self) -> Option<&'static str> {
        match self {
            Self::Reached | Self::Logged => None,
            Self::CutOff => Some("the record of the run was cut off"),
            Self::Trouble => Some("the disk did not accept the next entry of the journal"),
            Self::Continued => Some("the run continued after the last entry of the journal"),
        }
    }
}

/// A part of the knowledge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Estimate {
    /// The object in the gripper, its grip and its seat; whether the gripper is empty.
    HeldObject,
    /// The present line of the job, and its delayed actions.
    JobLine,
    /// The place and the path of the robot.
    RobotPlace,
    /// The object placed last, and the object that vision has located.
    PlacedObject,
    /// The part in the pedestal's hand.
    PedestalPart,
    /// A person's confirmation that something supports the held object.
    Confirmation,
    /// The database update that becomes due when the held object is released.
    CarriedItem,
    /// The holster of an unfinished gripper change, the drum of an unfinished tool command. They forbid motions.
    Unfinished,
    /// The calibrations of grippers, hand and rotary table.
    Calibration,
    /// The database updates that the Data System has not accepted, and the numbers of its session.
    PendingUpdates,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Evidence {
    /// The part of the knowledge.
    pub estimate: Estimate,
    /// The last knowledge, compared with the end of the run.
    pub end: RunEnd,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Fate {
    /// Adopt the estimate, as far as the sensors agree.
    Keep,
    /// Start without the estimate.
    Drop,
    /// Start without the estimate; a person names it with `resume held` or `resume line`.
    Ask,
}

decision_table! {
    /// DOUBT: how a resumed controller treats each estimate. If the record does not reach to the end of the run, the
    /// command under way may have changed the cell since then. A log does not contain the delayed actions of the job.
    pub DOUBT: fn doubt(self::Evidence) -> self::Fate {
        1: end: Reached                                                              => Keep;
        2: end: Logged,                       estimate: JobLine                      => Ask;
        3: end: Logged                                                               => Keep;
        4: end: CutOff | Trouble | Continued, estimate: HeldObject | JobLine         => Ask;
        5: end: CutOff | Trouble | Continued, estimate: RobotPlace | PlacedObject    => Drop;
        6: end: CutOff | Trouble | Continued, estimate: PedestalPart | Confirmation  => Drop;
        7: end: CutOff | Trouble | Continued, estimate: CarriedItem                  => Drop;
        8: end: CutOff | Trouble | Continued, estimate: Unfinished | Calibration     => Keep;
        9: end: CutOff | Trouble | Continued, estimate: PendingUpdates               => Keep;
    }
}

/// True if a person must name the line of the job.
#[must_use]
pub fn asks_for_line(end: RunEnd) -> bool {
    doubt((), &Evidence { estimate: Estimate::JobLine, end }).action == Fate::Ask
}

/// Kept buffers without the estimates that DOUBT does not keep.
#[must_use]
pub fn doubted(kept: &CommonMemory, end: RunEnd) -> CommonMemory {
    let mut memory = *kept;
    for estimate in Estimate::ALL {
        match doubt((), &Evidence { estimate: *estimate, end }).action {
            Fate::Keep => {}
            Fate::Drop | Fate::Ask => forget(*estimate, &mut memory),
        }
    }
    memory
}

fn forget(estimate: Estimate, memory: &mut CommonMemory) {
    let estimates = &mut memory.emove.estimates;
    match estimate {
        Estimate::HeldObject => {
            (estimates.held, estimates.grasping, estimates.empty) = (None, None, false);
            estimates.seat = Seat::NotKnown;
        }
        Estimate::RobotPlace => {
            (estimates.place, estimates.way, estimates.disturbed) = (None, None, None);
            estimates.track = Estimates::ZERO.track;
        }
        Estimate::PlacedObject => (estimates.placed, estimates.located) = (None, None),
        Estimate::PedestalPart => (memory.subtask.regrip, memory.pedestal.status.gripped) = (None, false),
        Estimate::Confirmation => memory.task.confirmed = None,
        Estimate::CarriedItem => (memory.task.updates.taking, memory.task.updates.carried) = (None, None),
        // The line of the job is beside the buffers, in the entry; the others are never dropped.
        Estimate::JobLine | Estimate::Unfinished | Estimate::Calibration | Estimate::PendingUpdates => {}
    }
}

#[cfg(test)]
mod tests {
    use interfaces::{hws::Confirmed, operator::Support};

    use super::*;

    const DOUBTED: [RunEnd; 3] = [RunEnd::CutOff, RunEnd::Trouble, RunEnd::Continued];

    #[test]
    fn doubt_clears_what_the_command_may_have_changed() {
        let mut memory = CommonMemory::default();
        memory.emove.estimates.empty = true;
        memory.pedestal.status.gripped = true;
        memory.task.confirmed = Some(Confirmed { by: Support::Clamped, at: None });
        for end in DOUBTED {
            let doubted = doubted(&memory, end);
            assert!(!doubted.emove.estimates.empty && !doubted.pedestal.status.gripped);
            assert_eq!((doubted.emove.estimates.seat, doubted.task.confirmed), (Seat::NotKnown, None));
            assert!(asks_for_line(end) && end.doubt().is_some());
        }
        for end in [RunEnd::Reached, RunEnd::Logged] {
            assert_eq!(doubted(&memory, end), memory);
        }
        assert!(asks_for_line(RunEnd::Logged) && !asks_for_line(RunEnd::Reached));
    }

    #[test]
    fn every_dropped_estimate_is_cleared_and_every_kept_one_stays() {
        for end in DOUBTED {
            for estimate in Estimate::ALL {
                let fate = doubt((), &Evidence { estimate: *estimate, end }).action;
                let mut memory = CommonMemory::default();
                memory.emove.estimates.empty = true;
                memory.emove.estimates.place = Some(interfaces::emove::RobotPlace::default());
                memory.emove.estimates.placed = Some(interfaces::emove::PlacedObject::default());
                memory.pedestal.status.gripped = true;
                memory.task.confirmed = Some(Confirmed { by: Support::Clamped, at: None });
                memory.task.updates.taking = Some(Default::default());
                let mut forgotten = memory;
                forget(*estimate, &mut forgotten);
                let is_beside = *estimate == Estimate::JobLine;
                assert_eq!(
                    forgotten == memory,
                    fate == Fate::Keep || is_beside,
                    "{estimate:?} after {end:?}"
                );
            }
        }
    }
}
