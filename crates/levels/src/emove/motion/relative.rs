//! Relative moves: the short straight motions at holsters and tool drum (V.2.1 QC-DETACH … REMOVE-TOOL).
//!
//! A command names each, and task data (file REL-MOVES) give its movetable, parameters and sensor for the name and
//! the location. Some start from the pose of the command's location, independent of the robot's position. Others
//! start from the robot's position, because a sensor ended the guarded move before.

use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb},
    location::Site,
    pose_range,
};
use rcs_core::{Plain, name::Name10};
use taskdata::files::{PoseId, RelativeMove, TaskData};

/// The relative moves by their names in task data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum Relative {
    /// QC-DETACH: down into the holster until its large sensors see the ears.
    QcdDown,
    /// QC-DETACH: forward until the small sensors see the ears at the seat.
    QcdSeat,
    /// QC-DETACH: up out of the gripper.
    QcdUp,
    /// QC-DETACH: the rest of the way up, from the seat of the holster.
    #[text = "QCD-UP"]
    QcdOut,
    /// QC-ATTACH: fairly rapidly close to the gripper.
    QcaFast,
    /// QC-ATTACH: slowly onto the gripper.
    QcaSlow,
    /// QC-ATTACH: back out of the seat.
    QcaBack,
    /// QC-ATTACH: a distance out of the holster.
    QcaLift,
    /// QC-ATTACH: completely out of the holster.
    QcaUp,
    /// WITHDRAW.
    Withdraw,
    /// INSERT-TOOL: to the last point without possible contact.
    InsFar,
    /// INSERT-TOOL: to the fingers of the drum, unless an obstacle is met.
    InsNear,
    /// INSERT-TOOL: in, unless the insertion force is too great.
    InsIn,
    /// RELEASE-TOOL: to the right until the strike plate exerts a moment.
    RelSlide,
    /// RELEASE-TOOL: the rest of the slide.
    #[text = "REL-SLIDE"]
    RelSlideOn,
    /// RELEASE-TOOL: back from the machine tool.
    RelBack,
    /// RELEASE-TOOL: the rest of the way back.
    #[text = "REL-BACK"]
    RelBackOn,
    /// ACQUIRE-TOOL: towards the machine tool.
    AcqNear,
    /// ACQUIRE-TOOL: on until the gripper touches the strike plate.
    AcqStrike,
    /// ACQUIRE-TOOL: to the left until the fingers are around the tool.
    AcqSlide,
    /// ACQUIRE-TOOL: the rest of the slide.
    #[text = "ACQ-SLIDE"]
    AcqSlideOn,
    /// REMOVE-TOOL: out, unless the extraction force is too great.
    RemOut,
    /// REMOVE-TOOL: the rest of the way out.
    #[text = "REM-OUT"]
    RemOutOn,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// From the pose of the command's location.
    Location,
    /// From the last commanded position of the robot.
    Stand,
    /// From the seat of the gripper in the holster.
    Seat,
    /// From the start of an interrupted move at the drum.
    Start,
}

impl Relative {
    #[must_use]
    pub const fn reference(self) -> Reference {
        match self {
            Self::QcdOut => Reference::Seat,
            Self::RelSlideOn | Self::RelBackOn | Self::AcqSlideOn | Self::RemOutOn => Reference::Start,
            Self::QcdSeat
            | Self::QcdUp
            | Self::Withdraw
            | Self::RelSlide
            | Self::RelBack
            | Self::AcqSlide
            | Self::RemOut => Reference::Stand,
            Self::QcdDown
            | Self::QcaFast
            | Self::QcaSlow
            | Self::QcaBack
            | Self::QcaLift
            | Self::QcaUp
            | Self::InsFar
            | Self::InsNear
            | Self::InsIn
            | Self::AcqNear
            | Self::AcqStrike => Reference::Location,
        }
    }

    #[must_use]
    pub const fn is_guarded(self) -> bool {
        matches!(
            self,
            Self::QcdDown
                | Self::QcdSeat
                | Self::InsNear
                | Self::InsIn
                | Self::RelSlide
                | Self::RelSlideOn
                | Self::AcqStrike
                | Self::AcqSlide
                | Self::AcqSlideOn
                | Self::RemOut
                | Self::RemOutOn
        )
    }

    #[must_use]
    pub fn record<'d>(self, site: &Site, data: &TaskData<'d>) -> Option<&'d RelativeMove> {
        data.relative_move(&Name10::clipped(self.text()), &site.place())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum RelativeMoves {
    /// No record is missing, or the command has no relative move.
    Found,
    /// A record for the place of the command is missing.
    Missing,
    /// The sensor that guards the move is missing.
    Unguarded,
    /// The pose of the location at which the move starts is missing.
    NoPose,
}

#[must_use]
pub const fn moves_of(verb: EmoveVerb) -> &'static [Relative] {
    use Relative::{
        AcqNear, AcqSlide, AcqStrike, InsFar, InsIn, InsNear, QcaBack, QcaFast, QcaLift, QcaSlow, QcaUp,
        QcdDown, QcdSeat, QcdUp, RelBack, RelSlide, RemOut, Withdraw,
    };
    match verb {
        EmoveVerb::QcDetach => &[QcdDown, QcdSeat, QcdUp],
        EmoveVerb::QcAttach => &[QcaFast, QcaSlow, QcaBack, QcaLift, QcaUp],
        EmoveVerb::Withdraw => &[Withdraw],
        EmoveVerb::InsertTool => &[InsFar, InsNear, InsIn],
        EmoveVerb::ReleaseTool => &[RelSlide, RelBack],
        EmoveVerb::AcquireTool => &[AcqNear, AcqStrike, AcqSlide],
        EmoveVerb::RemoveTool => &[RemOut],
        EmoveVerb::None
        | EmoveVerb::Pause
        | EmoveVerb::MovToLoc
        | EmoveVerb::MovToObj
        | EmoveVerb::MovObjTo
        | EmoveVerb::MovToVu
        | EmoveVerb::LocateObj
        | EmoveVerb::GraspObj
        | EmoveVerb::Release
        | EmoveVerb::MovToHol => &[],
    }
}

#[must_use]
pub fn look_up(command: &EmoveCommand, memory: &CommonMemory, data: &TaskData<'_>) -> RelativeMoves {
    let located = command.pose.is_some_and(|pose| match pose {
        0..pose_range::CHANGING => data.pose(PoseId::new(pose)).is_some(),
        pose_range::CHANGING.. => memory.changing_pose(pose).is_some(),
    });
    let of_move = |relative: &Relative| match relative.record(&command.site, data) {
        None => RelativeMoves::Missing,
        Some(found) if relative.is_guarded() && data.sensor(&found.sensor).is_none() => {
            RelativeMoves::Unguarded
        }
        Some(_) if relative.reference() == Reference::Location && !located => RelativeMoves::NoPose,
        Some(_) => RelativeMoves::Found,
    };
    let mut moves = moves_of(command.command).iter().map(of_move);
    moves.find(|found| *found != RelativeMoves::Found).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use taskdata::load::guarded::{Beginning, RELATIVE_MOVES};

    use super::{Reference, Relative};

    /// The checker of task data has its own list, which must equal that of E-move. A move from the robot's position
    /// may begin anywhere for the checker, a move from the location only there.
    #[test]
    fn task_data_checker_lists_the_same_relative_moves() {
        let mut ours: Vec<&str> = Relative::ALL.iter().map(|relative| relative.text()).collect();
        ours.sort_unstable();
        ours.dedup();
        let mut known: Vec<&str> = RELATIVE_MOVES.iter().map(|known| known.name).collect();
        known.sort_unstable();
        assert_eq!(ours, known);
        for relative in Relative::ALL {
            let known = RELATIVE_MOVES.iter().find(|known| known.name == relative.text()).unwrap();
            assert_eq!(known.guarded, relative.is_guarded(), "{relative}");
            let at_location = relative.reference() == Reference::Location;
            assert!(!at_location || known.from == Beginning::Location, "{relative}");
        }
    }
}
