//! The command after EXECUTE and ACCEPT, and the first phase of the calibration. No header names the rows.

use interfaces::grip::GripVerb;
use rcs_core::{Actions, Plain, Variables, decision_table};

use super::Attachment;
use crate::execution::Course;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Acceptance {
    /// The command is accepted.
    Accepted,
    /// The command is refused.
    Refused,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TargetOpening {
    /// The open end of travel.
    OpenEnd,
    /// Less than that.
    Narrower,
}

/// The event for which START is consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripBeginning {
    /// The process starts.
    Start,
    /// The process was dormant.
    Wake,
}

/// The calibration in the output buffers, from before a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Written {
    /// The calibration is present.
    Calibration,
    /// The calibration is missing.
    Nothing,
}

/// The command buffer of a process that starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum StartBuffer {
    /// The buffer is empty.
    Empty,
    /// The buffer has a command: the system was started before.
    Command,
}

/// Use of the calibration in the output buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Adoption {
    /// The calibration stays as it is.
    Keep,
    /// The calibration is adopted when the sensors agree.
    Adopt,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Commanded {
    /// The decision of EXECUTE.
    pub course: Course,
    /// The verdict of ACCEPT.
    pub acceptance: Acceptance,
    /// The verb.
    pub verb: GripVerb,
    /// The commanded opening.
    pub target: TargetOpening,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Started {
    /// The event.
    pub beginning: GripBeginning,
    /// The calibration in the output buffers.
    pub written: Written,
    /// Whether the gripper is attached.
    pub gripper: Attachment,
    /// The command buffer.
    pub buffer: StartBuffer,
}

decision_table! {
    /// COMMAND: the command in execution, for the following tables.
    pub COMMAND: fn command(self::Commanded) -> super::GripActivity {
        1: course: Rest                           => Nothing;
        2: course: Refuse                         => Refused;
        3: acceptance: Refused                    => Refused;
        4: verb: None                             => Refused;
        5: verb: Pause                            => Pause;
        6: verb: UpInit                           => UpInit;
        7: verb: OpenGrip, target: OpenEnd        => OpenWide;
        8: verb: Position | OpenGrip | CloseGrip  => Motion;
    }
}

decision_table! {
    /// START: the first phase of the calibration when a process starts or wakes. If the process became dormant
    /// during a calibration, before E-move knew the gripper, the calibration starts again. A gripper that is
    /// attached later, or when the process is restarted, may hold a part: UP-INIT calibrates it.
    pub START: fn start(super::GripPhase, self::Started) -> self::Adoption {
        Valid {
            1: otherwise                           => Keep;
        }
        any {
            2: written: Calibration                => Adopt  -> Adopting;
        }
        Closing | Opening | Venting | Widening {
            3: beginning: Wake, gripper: Attached  => Keep   -> Missing;
        }
        any {
            4: beginning: Wake                     => Keep   -> Deferred;
            5: gripper: Detached                   => Keep   -> Deferred;
            6: buffer: Command                     => Keep   -> Deferred;
            7: otherwise                           => Keep;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grip::tables::{GripActivity, GripPhase};

    #[test]
    fn only_full_open_grip_needs_no_calibration() {
        for &verb in GripVerb::ALL {
            for &target in TargetOpening::ALL {
                let commanded =
                    Commanded { course: Course::Continue, acceptance: Acceptance::Accepted, verb, target };
                let is_wide = verb == GripVerb::OpenGrip && target == TargetOpening::OpenEnd;
                assert_eq!(
                    command((), &commanded).action == GripActivity::OpenWide,
                    is_wide,
                    "{verb} {target}"
                );
                let refused = Commanded { acceptance: Acceptance::Refused, ..commanded };
                assert_eq!(command((), &refused).action, GripActivity::Refused);
            }
        }
    }

    #[test]
    fn only_a_gripper_attached_at_the_start_calibrates_itself() {
        for &beginning in GripBeginning::ALL {
            for &gripper in Attachment::ALL {
                for &buffer in StartBuffer::ALL {
                    let started = Started { beginning, written: Written::Nothing, gripper, buffer };
                    let is_boot = (beginning, gripper, buffer)
                        == (GripBeginning::Start, Attachment::Attached, StartBuffer::Empty);
                    let expected = if is_boot { GripPhase::Missing } else { GripPhase::Deferred };
                    assert_eq!(
                        start(GripPhase::Missing, &started).next,
                        expected,
                        "{beginning} {gripper} {buffer}"
                    );
                    assert_eq!(start(GripPhase::Valid, &started).next, GripPhase::Valid);
                    let written = Started { written: Written::Calibration, ..started };
                    assert_eq!(start(GripPhase::Missing, &written).next, GripPhase::Adopting);
                }
            }
        }
    }
}
