//! Details of a failure in addition to its reason: names and distances (docs/design/failures.md "Detail").

use core::fmt;

use geometry::units::Length;
use rcs_core::name::{Name10, Name16};

use crate::{
    CommonMemory, Fault, HwsCommand, ProcessId, Reason, StatusReport, emove::NearPlace, t3i::PathLeft,
};

/// Smallest distance along an axis that is shown, inches: the resolution of a written pose (VII.1).
const LEAST_SHOWN: f64 = 0.005;

/// Details of a reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// No detail.
    None,
    /// The ends of the missing trajectory.
    Pair(Name10, Name16),
    /// The known places nearest to the robot.
    Near([Option<NearPlace>; 2]),
    /// The place from which the robot was moved away.
    Off(NearPlace),
    /// The commanded and the fed-back pose of a robot that left its path.
    Left(PathLeft),
}

impl Detail {
    /// Details of the fault that a process reports. `memory` is common memory after the first tick with that report.
    #[must_use]
    pub fn of(process: ProcessId, fault: Fault, hws: &HwsCommand, memory: &CommonMemory) -> Self {
        match (process, fault) {
            (ProcessId::Emove | ProcessId::Task, Fault::Reason(Reason::UnknownStart)) => {
                Self::Near(memory.emove.nearest)
            }
            (ProcessId::Emove, Fault::Reason(Reason::NoTrajectory)) => {
                let estimates = &memory.emove.estimates;
                let from = estimates.place.or(estimates.way.map(|way| way.from));
                from.map_or(Self::None, |from| {
                    Self::Pair(
                        from.site.location,
                        Name16::clipped(memory.subtask.emove.site.location.as_str()),
                    )
                })
            }
            (ProcessId::Emove, Fault::Reason(Reason::OffPlace)) => {
                off_place(memory).map_or(Self::None, Self::Off)
            }
            (_, Fault::Reason(Reason::OffPath)) => memory.t3i.status.left.map_or(Self::None, Self::Left),
            // RELEASE-TOOL and REMOVE-TOOL of Task end at the drum; then the robot moves to the end-at location.
            (ProcessId::Task, Fault::Reason(Reason::NoTrajectory)) if leaves_drum(hws) => {
                hws.end_at.map_or(Self::None, |to| Self::Pair(Name10::clipped(DRUM), to))
            }
            // Task refuses POSITION itself (V.4.1).
            (ProcessId::Task, Fault::Reason(Reason::NoTrajectory)) => {
                let ends = memory.subtask.status.at.zip(hws.source.or(hws.destination));
                ends.map_or(Self::None, |(at, to)| Self::Pair(at.site.location, to))
            }
            _ => Self::None,
        }
    }

    /// Details of the reason of Task's status, which may originate in a lower process. `memory` is after the tick.
    #[must_use]
    pub fn of_command(reason: Reason, hws: &HwsCommand, memory: &CommonMemory) -> Self {
        let emove = &memory.emove.status;
        let below = emove.report == StatusReport::Error && emove.reason == reason;
        let process = if below { ProcessId::Emove } else { ProcessId::Task };
        Self::of(process, Fault::Reason(reason), hws, memory)
    }
}

fn off_place(memory: &CommonMemory) -> Option<NearPlace> {
    let place = memory.emove.estimates.place?;
    let present = memory.changing_pose(memory.prim.status.sensor_pose?)?.to_frame().ok()?;
    Some(NearPlace::seen(place.site.location, &place.pose.to_frame().ok()?, &present))
}

const DRUM: &str = "TOOL-TRNS";

fn leaves_drum(hws: &HwsCommand) -> bool {
    let word = Name10::clipped(hws.command.as_str());
    ["RELEASE-TOOL", "REMOVE-TOOL"].iter().any(|command| Name10::clipped(command) == word)
}

/// `: none leads from BENCH to VISE (...)`, a suffix of the reason; `{:#}` omits the remedy.
impl fmt::Display for Detail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => return Ok(()),
            Self::Pair(from, to) => write!(f, ": none leads from {from} to {to}")?,
            Self::Left(left) => write!(f, ": {left}")?,
            Self::Near(places) => {
                let mut separator = ": ";
                for place in places.iter().flatten() {
                    write!(f, "{separator}{place}")?;
                    separator = "; ";
                }
            }
            Self::Off(place) => write!(f, ": {place}")?,
        }
        match self {
            Self::Pair(from, to) if !f.alternate() => write!(
                f,
                " (go by way of another location, or write the trajectory {from}-{to} and reload the task data)"
            ),
            Self::Near(_) if !f.alternate() => f.write_str(
                " (move it with the joystick box to within 0.5 in and 2 degrees of a known location, then send \
                 PAUSE)",
            ),
            Self::Off(_) if !f.alternate() => f.write_str(
                " (move it back with the joystick box to within 0.02 in and 0.1 degree, or open the fingers there, \
                 then send the command again)",
            ),
            _ => Ok(()),
        }
    }
}

/// `HOME is 4.41 in (-X 4.40 in, +Z 0.30 in) and 0.5 degrees away`: the motion along the axes of `WORLD` (III.3.3).
impl fmt::Display for NearPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { location, inches, degrees, offset } = self;
        write!(f, "{location} is {inches:.2} in")?;
        let mut separator = " (";
        for (axis, along) in ["X", "Y", "Z"].into_iter().zip(offset) {
            if along.abs() >= LEAST_SHOWN {
                let sign = if *along < 0.0 { '-' } else { '+' };
                write!(f, "{separator}{sign}{axis} {}", Length(along.abs()))?;
                separator = ", ";
            }
        }
        let close = if separator == " (" { "" } else { ")" };
        write!(f, "{close} and {degrees:.1} degrees away")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        emove::{RobotPlace, Standing},
        location::Site,
    };
    use std::string::ToString as _;

    fn named(location: &str) -> Site {
        Site { location: Name10::clipped(location), ..Site::default() }
    }

    fn said(
        process: ProcessId,
        reason: Reason,
        hws: &HwsCommand,
        memory: &CommonMemory,
    ) -> std::string::String {
        Detail::of(process, Fault::Reason(reason), hws, memory).to_string()
    }

    #[test]
    fn missing_trajectory_is_named_by_its_ends() {
        let mut memory = CommonMemory::default();
        let from = RobotPlace { site: named("BENCH"), ..RobotPlace::default() };
        memory.emove.estimates.place = Some(from);
        memory.subtask.emove.site = named("VISE");
        let mut hws = HwsCommand { destination: Some(Name16::clipped("TRAY")), ..HwsCommand::default() };
        let text = said(ProcessId::Emove, Reason::NoTrajectory, &hws, &memory);
        assert!(text.starts_with(": none leads from BENCH to VISE ("), "{text}");
        assert!(text.contains("trajectory BENCH-VISE"), "{text}");
        assert_eq!(said(ProcessId::Task, Reason::NoTrajectory, &hws, &memory), "");
        let at = Standing { site: named("SAFE"), ..Standing::default() };
        memory.subtask.status.at = Some(at);
        let text = said(ProcessId::Task, Reason::NoTrajectory, &hws, &memory);
        assert!(text.starts_with(": none leads from SAFE to TRAY ("), "{text}");
        hws.source = Some(Name16::clipped("HOME"));
        assert!(said(ProcessId::Task, Reason::NoTrajectory, &hws, &memory).contains("from SAFE to HOME"));
        assert_eq!(said(ProcessId::Emove, Reason::NoApproach, &hws, &memory), "");
    }

    #[test]
    fn a_lost_robot_reports_the_nearest_place() {
        let (mut memory, hws) = (CommonMemory::default(), HwsCommand::default());
        assert!(
            said(ProcessId::Emove, Reason::UnknownStart, &hws, &memory).starts_with(" (move it with the")
        );
        let near = |name, inches, degrees, offset| {
            Some(NearPlace { location: Name10::clipped(name), inches, degrees, offset })
        };
        memory.emove.nearest =
            [near("HOME", 1.234, 0.5, [-1.2, 0.004, 0.3]), near("SAFE", 20.0, 90.0, [0.0; 3])];
        assert!(said(ProcessId::Task, Reason::UnknownStart, &hws, &memory).starts_with(
            ": HOME is 1.23 in (-X 1.20 in, +Z 0.30 in) and 0.5 degrees away; SAFE is 20.00 in and 90.0 degrees away (move it"
        ));
    }

    #[test]
    fn reason_of_emove_has_the_detail_of_emove() {
        let mut memory = CommonMemory::default();
        let from = RobotPlace { site: named("BENCH"), ..RobotPlace::default() };
        memory.emove.estimates.place = Some(from);
        memory.subtask.emove.site = named("VISE");
        let hws = HwsCommand::default();
        let said = |memory: &CommonMemory| Detail::of_command(Reason::NoTrajectory, &hws, memory);
        assert_eq!(said(&memory), Detail::None);
        (memory.emove.status.report, memory.emove.status.reason) =
            (StatusReport::Error, Reason::NoTrajectory);
        assert_eq!(std::format!("{:#}", said(&memory)), ": none leads from BENCH to VISE");
    }
}
