//! The remedy of a failure: repeat the command after a PAUSE, or act at the cell first (docs/reasons.md).

use super::Reason;

impl Reason {
    /// The operator's action before the same command can succeed; `None` if PAUSE and the same command may be enough.
    ///
    /// An operator is needed if the job or the task data are wrong, if an object or the robot is at an unknown place,
    /// or if a device or program must be switched on (extension: the manual has no reasons).
    #[must_use]
    pub const fn remedy(self) -> Option<&'static str> {
        Some(match self {
            Self::None
            | Self::Restarted
            | Self::NothingHeld
            | Self::GraspMissed
            | Self::WrongGripper
            | Self::NothingSeen
            | Self::NotRecognised
            | Self::VisionSilent
            | Self::VisionImplausible
            | Self::GripUnattainable
            | Self::GripTimeout
            | Self::GripNotCalibrated
            | Self::QuickChangeFault
            | Self::QuickChangeStuck
            | Self::NotDetached
            | Self::NotAttached
            | Self::WrongGripperId
            | Self::LinkError
            | Self::NotAtGoal
            | Self::SensorError
            | Self::DataBase
            | Self::DataBaseSilent
            | Self::JawsStuck
            | Self::PedestalError
            | Self::PedestalSilent
            | Self::TableStuck
            | Self::HandMissed
            | Self::HandTimeout
            | Self::HandUnattainable
            | Self::PinsFail
            | Self::DeviceSilent
            | Self::NoEffect => return None,
            Self::UnknownCommand
            | Self::NoDestination
            | Self::NoObjectNamed
            | Self::EqualGrips
            | Self::NotNearDrum
            | Self::HolsterOnly
            | Self::RegripNeeded => "send the right command, then `job skip`; correct the job",
            Self::PedestalOnly => "send REFIXTURE, which regrips the object on the pedestal, then `job skip`",
            Self::UnknownObject
            | Self::UnknownLocation
            | Self::SectorOutOfRange
            | Self::NoArrayForObject
            | Self::UnknownGrip
            | Self::NoGripMovetable
            | Self::NoTrajectory
            | Self::NoApproach
            | Self::BadRecord
            | Self::BadParameters
            | Self::NoHolster
            | Self::NoRelativeMove
            | Self::UnknownSensor
            | Self::NoPedestalData
            | Self::PedestalCannot
            | Self::TableLimit
            | Self::CheckFailed
            | Self::InterfaceRefused => {
                "correct the command in the job, or correct the task data and load them"
            }
            Self::NotPrepared => "send the commands that must precede it, or correct the job",
            Self::NeighbourLost | Self::InterfaceSilent => "restart the program of the lost process",
            Self::JoystickOn => "switch the frame at the joystick box off",
            Self::OffPlace => {
                "move the robot back to its place with the joystick box, or open the fingers there"
            }
            Self::UnknownStart => {
                "move the robot back to a known location with the joystick box, and switch the frame off"
            }
            Self::RobotElsewhere => "check where the robot is, then send PAUSE, which adopts its position",
            Self::OffPath => {
                "check where the robot is and what holds it, then send PAUSE, which adopts its position"
            }
            Self::LinkOff => {
                "press Hold again or cycle start at the robot controller's panel, if it shows HOLD; \
                 else start it up there"
            }
            Self::AlreadyHolding => "send the command that places the held object",
            Self::HeldElsewhere => {
                "place the object with TRANSFER, or hold it, send `confirm by hand`, and send POSITION again"
            }
            Self::DeviceTripped => "look at the device, then send `io go DEVICE`",
            Self::NotClamped => {
                "close the vise; if it reports nothing, look at it and send `confirm clamped`"
            }
            Self::ObjectLost => "take the object away, and put it back at the command's source location",
            Self::UnknownHeld => {
                "hold the object, send `confirm by hand`, then POSITION to the place where the robot stands; \
                 put the object back at its place"
            }
            Self::HeldNotKnown => {
                "hold what the gripper may hold, send `confirm by hand`, then POSITION to the place where the \
                 robot stands"
            }
            Self::GripperGone => "put the gripper into its holster, and the object back at its place",
            Self::HolsterOccupied => "empty the holster",
            Self::HolsterEmpty => "put the gripper into its holster",
            Self::InHolster | Self::RingNotLocked => "send the command that changes the gripper again",
            Self::InDrum => {
                "send the interrupted tool command again; RELEASE-TOOL moves an empty gripper out of the drum"
            }
            Self::ReleaseNotEnded => "send the command that releases the object again",
            Self::AtTrayEdge => "put the object farther from the edge of its tray",
            Self::DrumOccupied => {
                "send REMOVE-TOOL with the end-at location TOOL-SAFE, take the other tool out of the drum, and \
                 send INSERT-TOOL again"
            }
            Self::NoToolInDrum => {
                "send RELEASE-TOOL with the end-at location TOOL-SAFE, put the tool into the drum, and send \
                 ACQUIRE-TOOL again"
            }
            Self::ForceUncalibrated => {
                "send REMOVE-TOOL with the end-at location TOOL-SAFE, and then INSERT-TOOL again"
            }
            Self::SentAway => "send the next command",
            Self::ForwardOnly => "send the interrupted command again",
            Self::NotDetected | Self::Detected => "correct what the sensor meets, or the sensor itself",
            Self::PartInPedestal => {
                "send the command that regrips the part again; or hold the part and send \
                 `pedestal release by hand`"
            }
            Self::PedestalHoldsOther | Self::HandUncertain => {
                "look at the part in the pedestal's hand: name it with `write subtask.regrip`, or hold it and \
                 send `pedestal release by hand`"
            }
            Self::HandLost => "take the object out of the pedestal, and put it back at its place",
            Self::HandNotCalibrated => "check the sensors and the air of the pedestal's hand",
            Self::TableAngleUnknown => {
                "hold the part, send `pedestal release by hand`, and put the part back at its place; the next \
                 PRE-GRIP calibrates the table"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_is_the_end_of_a_sentence() {
        let mut needed = 0;
        for reason in Reason::ALL {
            let Some(remedy) = reason.remedy() else { continue };
            needed += 1;
            let first = remedy.chars().next().unwrap_or(' ');
            assert!(first.is_ascii_lowercase() && !remedy.ends_with('.'), "{reason:?}: {remedy}");
        }
        assert!((1..Reason::ALL.len()).contains(&needed), "{needed}");
        assert_eq!((Reason::None.remedy(), Reason::GraspMissed.remedy()), (None, None));
        assert!(Reason::UnknownLocation.remedy().is_some());
    }
}
