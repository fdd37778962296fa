//! The robot's position at the tool drum (docs/design/recovery.md "Drum").
//!
//! ```text
//!                 z (left)          - near -- Entering -- in  Inside        x into the drum,
//!                  |               /                      |                 seen from above
//!            x ----+    TOOL-SAFE       Before         Sliding
//!                                  \                      |
//!                                   - back -- Clear --- slid, strike
//! ```
//!
//! All points follow from the pose of the drum's location and the relative moves of the four tool commands.

use geometry::{
    frame::{Frame, norm},
    pose::Pose,
};
use interfaces::{
    CommonMemory,
    emove::{CalibratedAt, EmoveCommand, EmoveVerb, Estimates, GoneTo, RobotPlace},
    location::Site,
};
use rcs_core::Plain;
use taskdata::files::TaskData;

use super::{
    EmoveInputs,
    localization::{ASIDE_INCHES, LOST_RADIANS},
    motion::relative::Relative,
    robot_place::{base, commanded_pose, is_moved_by_hand, near, present_frame, robot_at},
    tables::{
        AtDrum, Bias,
        drum::{AtTheDrum, DrumDecision, EmoveTool, drum},
        number,
    },
};
use crate::execution::Execution;

const SEATED: f64 = 0.15; // in, of depth: the fingers of the drum close on the tool
/// To the right of the way in, the fingers are around the tool within this distance, in. To the left, they are around
/// it up to this distance beyond the end of ACQ-SLIDE, which a sensor determines.
const AROUND: f64 = 0.25;
const WIDE_IN: f64 = 0.75; // in, sideways, for a tool that is not in its place
const FREE: f64 = 0.15; // in beyond INS-NEAR, without contact
/// Greatest distance from INS-NEAR of a robot before the drum, in.
const FAR: f64 = 10.0;
/// Greatest distance of such a robot from the axis of the way in, in: TOOL-SAFE is 6.1 in away.
const WIDE: f64 = 3.0;
const UNMOVED: f64 = 0.1; // in from the pose of the grasp

struct DrumPoints {
    near: Frame,
    inside: Frame,
    slid: Frame,
    aside: Frame,
    around: Frame,
}

impl DrumPoints {
    fn of(site: &Site, base: &Frame, data: &TaskData<'_>) -> Option<Self> {
        let moved =
            |from: &Frame, relative: Relative| Some(data.moved(from, relative.record(site, data)?.movetable));
        let inside = moved(base, Relative::InsIn)?;
        let aside = moved(base, Relative::AcqNear)?;
        Some(Self {
            near: moved(base, Relative::InsNear)?,
            inside,
            slid: moved(&inside, Relative::RelSlide)?,
            around: moved(&aside, Relative::AcqSlide)?,
            aside,
        })
    }

    fn locate(&self, present: &Frame) -> AtDrum {
        let way_in = self.inside.position - self.near.position;
        let way_out = self.slid.position - self.inside.position;
        let offset = present.position - self.inside.position;
        let (long, wide) = (norm(&way_in), norm(&way_out));
        if long <= 0.0 || wide <= 0.0 || self.inside.distance(present).radians > LOST_RADIANS {
            return AtDrum::Off;
        }
        // Depth of the robot beyond INS-NEAR, distance to the right, and distance from that plane.
        let depth = offset.dot(&way_in) / long + long;
        let right = offset.dot(&way_out) / wide;
        let across = norm(&(offset - way_in * ((depth - long) / long) - way_out * (right / wide)));
        let to_the_right = |point: &Frame| (point.position - self.inside.position).dot(&way_out) / wide;
        let aside = to_the_right(&self.aside);
        let is_around = right <= AROUND && right >= to_the_right(&self.around).min(0.0) - AROUND;
        let is_clear = right >= aside - ASIDE_INCHES && right <= wide + ASIDE_INCHES;
        let is_deep = (depth - long).abs() <= ASIDE_INCHES;
        if depth < -FAR || depth > long + ASIDE_INCHES || across > WIDE {
            AtDrum::Off
        } else if depth <= FREE {
            if right.abs() <= WIDE { AtDrum::Before } else { AtDrum::Off }
        } else if across > ASIDE_INCHES {
            AtDrum::Off
        } else if depth >= long - SEATED && is_around {
            AtDrum::Inside
        } else if is_around || (!is_deep && right.abs() <= WIDE_IN) {
            AtDrum::Entering
        } else if is_deep && (AROUND..aside - SEATED / 2.0).contains(&right) {
            AtDrum::Sliding
        } else if is_clear {
            AtDrum::Clear
        } else {
            AtDrum::Off
        }
    }
}

const fn is_tool_command(verb: EmoveVerb) -> bool {
    matches!(
        verb,
        EmoveVerb::InsertTool | EmoveVerb::ReleaseTool | EmoveVerb::AcquireTool | EmoveVerb::RemoveTool
    )
}

fn locate(drum: &RobotPlace, memory: &CommonMemory, data: &TaskData<'_>) -> AtDrum {
    let points = drum.pose.to_frame().ok().and_then(|base| DrumPoints::of(&drum.site, &base, data));
    match (points, present_frame(memory)) {
        (Some(points), Some(present)) => points.locate(&present),
        _ => AtDrum::Off,
    }
}

/// The robot's position moved back by the completed part of an interrupted relative move, which then ends at its
/// original end.
pub(super) fn start_of(
    relative: Relative,
    command: &EmoveCommand,
    memory: &CommonMemory,
    data: &TaskData<'_>,
) -> Option<Pose> {
    let points = DrumPoints::of(&command.site, &base(command, memory, data)?, data)?;
    let start = if relative == Relative::AcqSlideOn { points.aside } else { points.inside };
    let end = data.moved(&start, relative.record(&command.site, data)?.movetable);
    let stand = commanded_pose(memory)?.to_frame().ok()?;
    let way = end.position - start.position;
    let square = way.dot(&way);
    let share = if square > 0.0 { (stand.position - start.position).dot(&way) / square } else { 0.0 };
    Some(Pose::from_frame(&Frame { position: stand.position - way * share, ..stand }))
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ToolDrum {
    /// The drum of an unfinished tool command, between its first and last point. The pose is that of the location.
    half_way: Option<RobotPlace>,
    calibrated: CalibratedAt, // place of the robot at the last order to calibrate the force sensor
}

impl ToolDrum {
    pub(super) const fn adopt(&mut self, estimates: &Estimates) {
        (self.half_way, self.calibrated) = (estimates.drum, estimates.calibrated);
    }

    pub(super) const fn write_to(&self, estimates: &mut Estimates) {
        (estimates.drum, estimates.calibrated) = (self.half_way, self.calibrated);
    }

    pub(super) const fn half_way(&self) -> Option<&RobotPlace> {
        self.half_way.as_ref()
    }

    /// The robot's position at the command's drum, if a tool command is unfinished there.
    pub(super) fn at(&self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> AtDrum {
        match &self.half_way {
            Some(drum) if drum.site.has_location_of(&command.site) => {
                locate(drum, inputs.memory, inputs.data)
            }
            _ => AtDrum::Off,
        }
    }

    pub(super) const fn bias(&self, memory: &CommonMemory) -> Bias {
        match (memory.prim.bias, self.calibrated) {
            (None, _) => Bias::Missing,
            (Some(_), CalibratedAt::Drum) => Bias::AtDrum,
            (Some(_), CalibratedAt::Safe) => Bias::AtSafe,
        }
    }

    pub(super) const fn note_calibration(&mut self, at: CalibratedAt) {
        self.calibrated = at;
    }

    /// True if the fingers are around a tool in the drum. They hold it only if nothing has moved it since. `at` is the
    /// place where the last motion ended.
    pub(super) fn is_around_tool(
        &self,
        at: Option<&RobotPlace>,
        is_held: bool,
        inputs: &EmoveInputs<'_>,
    ) -> bool {
        match (at, &self.half_way, is_held) {
            (Some(place), ..) => place.gone_to == GoneTo::Drum,
            (None, Some(drum), false) => locate(drum, inputs.memory, inputs.data) == AtDrum::Inside,
            _ => false,
        }
    }

    pub(super) fn note_move(&mut self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) {
        let base = base(command, inputs.memory, inputs.data);
        if let (true, Some(base)) = (is_tool_command(command.command), base) {
            self.half_way = Some(robot_at(command, GoneTo::Drum, Pose::from_frame(&base)));
        }
    }

    pub(super) const fn end(&mut self) {
        self.half_way = None;
    }

    /// If the robot moves with the fingers around a tool in the drum, its tool command is unfinished again, because the
    /// tool or the fingers have moved. `at` is the place where the last motion ended. True if the robot was moved.
    pub(super) fn sense_moved_tool(&mut self, at: Option<&RobotPlace>, inputs: &EmoveInputs<'_>) -> bool {
        let Some(at) = at.filter(|at| at.gone_to == GoneTo::Drum) else { return false };
        let Some(present) = present_frame(inputs.memory) else { return false };
        let base = inputs.data.locpt(at.site.record).map(|locpt| locpt.frame);
        let is_there = at.pose.to_frame().is_ok_and(|pose| near(&pose, &present, UNMOVED, LOST_RADIANS));
        if let (Some(base), false) = (base, is_there) {
            self.half_way = Some(RobotPlace { pose: Pose::from_frame(&base), ..*at });
            return true;
        }
        false
    }

    /// Consult DRUM about an unfinished tool command. Returns the place of a robot with the fingers around a tool.
    /// `grasped_at` is the pose of the grasp.
    pub(super) fn sense(
        &mut self,
        grasped_at: Option<Pose>,
        execution: &mut Execution,
        inputs: &EmoveInputs<'_>,
    ) -> Option<RobotPlace> {
        let half_way = self.half_way?;
        let present = present_frame(inputs.memory)?;
        let grasped_here = grasped_at.is_some_and(|pose| {
            pose.to_frame().is_ok_and(|pose| near(&pose, &present, UNMOVED, LOST_RADIANS))
        });
        let situation = AtTheDrum {
            at: locate(&half_way, inputs.memory, inputs.data),
            tool: if grasped_here { EmoveTool::Grasped } else { EmoveTool::Loose },
            outcome: execution.outcome,
        };
        let decision = drum((), &situation);
        execution.rows.beside(&decision.of(number::DRUM));
        match decision.action {
            DrumDecision::Keep => None,
            DrumDecision::Leave if is_moved_by_hand(inputs.memory) => None,
            DrumDecision::Leave => {
                self.half_way = None;
                None
            }
            DrumDecision::Stand => {
                let pose = commanded_pose(inputs.memory).unwrap_or_else(|| Pose::from_frame(&present));
                self.half_way = None;
                Some(RobotPlace { pose, ..half_way })
            }
        }
    }
}
