//! Relative moves: the short straight motions at holsters and tool drum (V.2.1 QC-DETACH … REMOVE-TOOL).
//!
//! The manual keeps them in code; here a command names each, and task data say for the name and the location
//! where it leads, how fast, and what guards it (file REL-MOVES). Some lead from the pose of the command's
//! location, wherever the robot has come to stand; others lead from where it stands, because a guarded move
//! before it ended where the sensor said.

use rcs_core::{
    Plain,
    interface::{
        EmoveOutputs, Reason,
        emove::{EmoveCommand, EmoveVerb},
        pose_range,
        prim::PrimVerb,
    },
    name::Name10,
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{PoseId, RelativeMove, TaskData};

use super::{Emove, Slot, sensing::present_frame};
use crate::places::place_of;

/// The relative moves by their names in task data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Relative {
    /// QC-DETACH: down into the holster until its large sensors see the ears.
    #[text = "QCD-DOWN"]
    QcdDown,
    /// QC-DETACH: forward until the small sensors see the ears at the seat.
    #[text = "QCD-SEAT"]
    QcdSeat,
    /// QC-DETACH: up out of the gripper.
    #[text = "QCD-UP"]
    QcdUp,
    /// QC-ATTACH: fairly rapidly close to the gripper.
    #[text = "QCA-FAST"]
    QcaFast,
    /// QC-ATTACH: slowly onto the gripper.
    #[text = "QCA-SLOW"]
    QcaSlow,
    /// QC-ATTACH: back out of the seat.
    #[text = "QCA-BACK"]
    QcaBack,
    /// QC-ATTACH: a distance out of the holster.
    #[text = "QCA-LIFT"]
    QcaLift,
    /// QC-ATTACH: completely out of the holster.
    #[text = "QCA-UP"]
    QcaUp,
    /// WITHDRAW.
    #[text = "WITHDRAW"]
    Withdraw,
    /// INSERT-TOOL: to the drum.
    #[text = "INS-NEAR"]
    InsNear,
    /// INSERT-TOOL: in, unless the insertion force is too great.
    #[text = "INS-IN"]
    InsIn,
    /// RELEASE-TOOL: to the right until the strike plate gives a moment.
    #[text = "REL-SLIDE"]
    RelSlide,
    /// RELEASE-TOOL: back from the machine tool.
    #[text = "REL-BACK"]
    RelBack,
    /// ACQUIRE-TOOL: towards the machine tool.
    #[text = "ACQ-NEAR"]
    AcqNear,
    /// ACQUIRE-TOOL: on until the strike plate is touched.
    #[text = "ACQ-STRIKE"]
    AcqStrike,
    /// ACQUIRE-TOOL: to the left until the fingers are around the tool.
    #[text = "ACQ-SLIDE"]
    AcqSlide,
    /// REMOVE-TOOL: out, unless the extraction force is too great.
    #[text = "REM-OUT"]
    RemOut,
}

/// From where a relative move leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// From the pose of the command's location.
    Location,
    /// From where the robot was last told to stand.
    Stand,
}

impl Relative {
    /// From where the move leads.
    #[must_use]
    pub const fn reference(self) -> Reference {
        match self {
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
            | Self::InsNear
            | Self::InsIn
            | Self::AcqNear
            | Self::AcqStrike => Reference::Location,
        }
    }

    /// Does a sensor guard the move?
    #[must_use]
    pub const fn is_guarded(self) -> bool {
        matches!(
            self,
            Self::QcdDown
                | Self::QcdSeat
                | Self::InsIn
                | Self::RelSlide
                | Self::AcqStrike
                | Self::AcqSlide
                | Self::RemOut
        )
    }

    /// The move's record for a place.
    ///
    /// # Errors
    /// [`Reason::NoRelativeMove`] if task data have none, [`Reason::UnknownSensor`] if it is to be guarded
    /// and is not.
    pub fn record<'d>(self, command: &EmoveCommand, data: &TaskData<'d>) -> Result<&'d RelativeMove, Reason> {
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let found =
            data.relative_move(&Name10::clipped(self.text()), &place).ok_or(Reason::NoRelativeMove)?;
        if self.is_guarded() && data.sensor(&found.sensor).is_none() {
            return Err(Reason::UnknownSensor);
        }
        Ok(found)
    }
}

/// The relative moves of a command, in their order.
#[must_use]
pub const fn moves_of(verb: EmoveVerb) -> &'static [Relative] {
    use Relative::{
        AcqNear, AcqSlide, AcqStrike, InsIn, InsNear, QcaBack, QcaFast, QcaLift, QcaSlow, QcaUp, QcdDown,
        QcdSeat, QcdUp, RelBack, RelSlide, RemOut, Withdraw,
    };
    match verb {
        EmoveVerb::QcDetach => &[QcdDown, QcdSeat, QcdUp],
        EmoveVerb::QcAttach => &[QcaFast, QcaSlow, QcaBack, QcaLift, QcaUp],
        EmoveVerb::Withdraw => &[Withdraw],
        EmoveVerb::InsertTool => &[InsNear, InsIn],
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

/// Look up all that the relative moves of a command need, before anything moves.
///
/// # Errors
/// The [`Reason`] why the command cannot be executed.
pub fn check(command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<(), Reason> {
    for relative in moves_of(command.command) {
        relative.record(command, inputs.data)?;
        let located = if command.pose < pose_range::CHANGING {
            inputs.data.pose(PoseId::new(command.pose)).is_some()
        } else {
            inputs.memory.changing_pose(command.pose).is_some()
        };
        if relative.reference() == Reference::Location && !located {
            return Err(Reason::NoDestination);
        }
    }
    Ok(())
}

impl Emove {
    /// DELTA-MOVE, GO-UNTIL or GO-WHILE to Prim.
    pub(super) fn send_relative(
        &mut self,
        verb: PrimVerb,
        relative: Relative,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let pose = match relative.reference() {
            Reference::Location => Some(command.pose),
            Reference::Stand => {
                commanded_pose(inputs).map(|pose| self.publish(Slot::Departure, pose, outputs))
            }
        };
        let (Some(pose), Ok(found)) = (pose, relative.record(command, inputs.data)) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        self.send_prim(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = found.movetable.number();
        outputs.prim.trajectory_parameters = found.para.number();
        if relative.is_guarded() {
            outputs.prim.sensor = found.sensor;
        }
        self.state.undetected = 0;
        self.state.stance.known = false;
    }
}

/// Where the robot was last told to be; where the resolvers say that it is, if Prim commands nothing.
pub(super) fn commanded_pose(inputs: &Inputs<'_, TaskData<'_>>) -> Option<Pose> {
    let commanded = inputs.memory.changing_pose(inputs.memory.prim.status.present_pose).copied();
    commanded.or_else(|| present_frame(inputs.memory).map(|frame| Pose::from_frame(&frame)))
}

#[cfg(test)]
mod tests {
    use taskdata::load::guarded::{Beginning, RELATIVE_MOVES};

    use super::{Reference, Relative};

    /// The checker of task data has its own list: it must ask for what E-move looks for, and no more. A move that E-move makes
    /// from where the robot stands may begin anywhere for the checker, one from the location only there.
    #[test]
    fn the_checker_of_task_data_knows_the_same_moves() {
        let mut ours: Vec<&str> = Relative::ALL.iter().map(|relative| relative.text()).collect();
        let mut known: Vec<&str> = RELATIVE_MOVES.iter().map(|known| known.name).collect();
        ours.sort_unstable();
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
