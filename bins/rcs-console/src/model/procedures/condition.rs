//! Conditions of a procedure's steps, evaluated on the picture of the run, its cell and its answers.

use geometry::pose::WireFrame;
use interfaces::{
    ProcessId,
    data_base::Connection,
    device::{JoystickBox, VisionStatus},
};
use rcs_core::tick::Tick;

use crate::rcs_console::{
    model::Operating,
    picture::{Absence, Picture},
    source::Cell,
};

/// HOME as printed in the manual (IV.3.3 step 11).
pub const HOME: WireFrame =
    WireFrame { tool: [0, -7145, -1483], wrist_to_tool: [0, -2123, -2119], tool_to_finger: [3000, 0, 0] };
/// Tolerance of HOME's values, and of two frames that must agree (IV.3.3 steps 11 and 13).
pub const TOLERANCE: i32 = 4;
const STANDS: i32 = 4; // a robot that has moved at most this far is at rest, 0.01 in
const STANDS_FOR: u64 = 50; // ticks for which the robot must be at rest: 2 s
const MOVED: i32 = 10; // a robot that has moved this far has moved, 0.01 in

/// The stages of the robot controller's start-up (IV.3.3), in order.
pub const STAGES: [&str; 11] = [
    "control power off",
    "fault",
    "hydraulics disabled",
    "hydraulics enabled",
    "hydraulics starting",
    "manual",
    "pre-manual",
    "moving to HOME",
    "auto, at HOME",
    "vertical motions",
    "DEPC",
];

pub struct Sight<'a> {
    pub picture: &'a Picture,
    pub cell: &'a Cell,
    /// The session with the run; `None` on a console without `--operate`.
    pub operating: Option<&'a Operating>,
    pub begun: Begun, // the state at the beginning of the step
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Begun {
    pub tick: Tick,
    pub tool: Option<[i32; 3]>, // tool point from the resolvers, 0.01 in
    pub asked: Option<u32>,     // number of the last request before those of the step; `None` before Enter
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    Reached(&'static str), // the robot controller has reached this stage of its start-up, or a later one
    At(&'static str),      // the robot controller is at this stage
    NoPressure,
    EStopsOut,
    Aligned, // all six axes are marked with an asterisk
    LinkRuns,
    Resolvers,
    AtHome,      // the resolvers show HOME to within [`TOLERANCE`]
    FramesAgree, // the frame that Prim receives and the frame that it outputs agree to within [`TOLERANCE`]
    Stands,      // the robot has been at rest since the step began, for at least two seconds
    Moved,       // the robot has moved since the step began
    Have(&'static [ProcessId], &'static str),
    Says(ProcessId, &'static str),
    Run(&'static [ProcessId]),
    Held(&'static [ProcessId]),
    KnobUp(bool),  // the velocity knob is not at zero (true), or at zero (false)
    FrameOn(bool), // a coordinate switch is on (true), or none is (false)
    HandCalibrated,
    TableAt(i32), // the rotary table is calibrated and at this angle, 0.1 degree
    DataSystem(Connection),
    PedestalAnswers, // the pedestal is a separate system, and answers
    VisionAnswers,   // the last request to the vision system was answered
    JobWaits,
    Commands(&'static str), // the run's status line names this source of commands
    Taken,
}

impl Sight<'_> {
    /// The value of a condition; `None` if the console cannot determine it.
    #[must_use]
    pub fn holds(&self, condition: Condition) -> Option<bool> {
        let (memory, external) = (&self.picture.memory, &self.picture.external);
        let joystick = &external.devices.joystick;
        match condition {
            Condition::Reached(stage) => Some(place(self.stage()?) >= place(stage)),
            Condition::At(stage) => Some(self.stage()? == stage),
            Condition::NoPressure => Some(!self.shown()?.lamps.hydraulics_on),
            Condition::EStopsOut => Some(self.shown()?.estops == [false; 5]),
            Condition::Aligned => Some(self.shown()?.aligned == [true; 6]),
            Condition::LinkRuns => Some(memory.t3i.status.link_running),
            Condition::Resolvers => Some(memory.t3i.status.resolver_frame.is_some()),
            Condition::AtHome => Some(largest(&self.frame_feedback(), &HOME) <= TOLERANCE),
            Condition::FramesAgree => Some(self.frames_agree()),
            Condition::Stands => {
                let since = self.picture.tick.since(self.begun.tick);
                Some(self.way()? <= STANDS && since >= STANDS_FOR)
            }
            Condition::Moved => Some(self.way()? >= MOVED),
            Condition::Have(processes, command) => {
                Some(processes.iter().all(|process| self.picture.command(*process).contains(command)))
            }
            Condition::Says(process, report) => Some(memory.said(process).report == report),
            Condition::Run(processes) => Some(processes.iter().all(|process| self.runs(*process))),
            Condition::Held(processes) => {
                let stands = |process: &ProcessId| {
                    matches!(self.picture.absence(*process), Some(Absence::Held | Absence::Stopped))
                };
                Some(processes.iter().all(stands))
            }
            Condition::KnobUp(up) => Some((joystick.velocity > 0) == up),
            Condition::FrameOn(on) => Some((joystick.frame != 0) == on),
            Condition::HandCalibrated => Some(memory.hand.status.initialized),
            Condition::TableAt(angle) => Some(memory.table.status.position == Some(angle)),
            Condition::DataSystem(connection) => Some(memory.task.connection == connection),
            Condition::PedestalAnswers => Some(external.pedestal.elsewhere && external.pedestal.answers),
            Condition::VisionAnswers => {
                let (asked, answer) = (&memory.emove.vision, &external.devices.vision);
                let seen = answer.echo == asked.number && answer.status != VisionStatus::Busy;
                Some(asked.number > 0 && seen)
            }
            Condition::JobWaits => Some(self.operating?.job_waits()),
            Condition::Commands(commander) => Some(self.operating?.status.contains(commander)),
            Condition::Taken => Some(self.operating?.has_taken_since(self.begun.asked?)),
        }
    }

    pub(super) fn shown(&self) -> Option<&executive::memory::cell::ControllerView> {
        match self.cell {
            Cell::Shown(view) => Some(&view.controller),
            Cell::NotPublished | Cell::Recorded(_) => None,
        }
    }

    fn stage(&self) -> Option<&str> {
        Some(self.shown()?.stage.as_str())
    }

    fn runs(&self, process: ProcessId) -> bool {
        matches!(self.picture.absence(process), None | Some(Absence::Dormant | Absence::Elsewhere))
    }

    /// `frame-feedback` as in IV.3.3 step 11. It is computed from the resolvers, even while the link runs.
    pub(super) fn frame_feedback(&self) -> WireFrame {
        let status = &self.picture.memory.t3i.status;
        status.resolver_frame.unwrap_or(status.frame_feedback)
    }

    /// The frames that Prim reads and writes (IV.3.3 step 13). After ROBOT-INIT, before its first point, Prim
    /// has not written one, so its present pose is used.
    pub(super) fn prim_frames(&self) -> (WireFrame, WireFrame) {
        let memory = &self.picture.memory;
        let present = memory.prim.status.present_pose.and_then(|number| memory.changing_pose(number));
        let present =
            present.and_then(|pose| pose.to_frame().ok()).map(|frame| WireFrame::from_frame(&frame));
        (memory.t3i.status.frame_feedback, present.unwrap_or(memory.prim.t3i.frame))
    }

    fn frames_agree(&self) -> bool {
        let (got, given) = self.prim_frames();
        largest(&got, &given) <= TOLERANCE
    }

    /// Tool point from the resolvers, 0.01 in.
    pub(super) fn tool(&self) -> Option<[i32; 3]> {
        self.picture.memory.t3i.status.resolver_frame.map(|frame| frame.tool)
    }

    /// Largest distance in X, Y or Z of the tool point from its position when the step began, 0.01 in.
    pub(super) fn way(&self) -> Option<i32> {
        let (now, was) = (self.tool()?, self.begun.tool?);
        now.iter().zip(was).map(|(now, was)| (now - was).abs()).max()
    }

    pub(super) const fn joystick(&self) -> &JoystickBox {
        &self.picture.external.devices.joystick
    }
}

/// Index of a stage in the start-up; `None`, for an unknown stage, is less than every index.
fn place(stage: &str) -> Option<usize> {
    STAGES.iter().position(|known| *known == stage)
}

#[must_use]
pub const fn rows(frame: &WireFrame) -> [[i32; 3]; 3] {
    [frame.tool, frame.wrist_to_tool, frame.tool_to_finger]
}

#[must_use]
pub fn largest(frame: &WireFrame, other: &WireFrame) -> i32 {
    let (frame, other) = (rows(frame).concat(), rows(other).concat());
    frame.iter().zip(other).map(|(is, should)| (is - should).abs()).max().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use executive::memory::{Text, cell::CellView};
    use interfaces::{CommonMemory, ExternalInputs};

    fn picture() -> Picture {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        Picture { tick: Tick(100), external, memory, timing: None }
    }

    fn cell(stage: &str) -> Cell {
        let mut view = CellView::default();
        view.controller.stage = Text::clipped(stage);
        Cell::Shown(Box::new(view))
    }

    fn holds(picture: &Picture, cell: &Cell, begun: Begun, condition: Condition) -> Option<bool> {
        Sight { picture, cell, operating: None, begun }.holds(condition)
    }

    #[test]
    fn home_and_stages_equal_those_of_the_cell() {
        assert_eq!((HOME, TOLERANCE), (plant::t3::HOME, plant::t3::HOME_TOLERANCE));
        use plant::t3::Stage;
        let stages = [
            Stage::Dark,
            Stage::Faulted,
            Stage::Ready,
            Stage::Enabled,
            Stage::Rising,
            Stage::Manual,
            Stage::PreManual,
            Stage::Homing,
            Stage::Auto,
            Stage::Rehearsing,
            Stage::Depc,
        ];
        assert_eq!(stages.map(Stage::text), STAGES);
    }

    #[test]
    fn later_stages_also_reach_a_stage() {
        let reached = |stage, wanted| {
            holds(&picture(), &cell(stage), Begun::default(), Condition::Reached(wanted)).unwrap()
        };
        assert!(reached("DEPC", "manual") && reached("manual", "manual") && !reached("fault", "manual"));
        assert!(reached("pre-manual", "manual") && !reached("pre-manual", "auto, at HOME"));
        let at_a_port = holds(&picture(), &Cell::NotPublished, Begun::default(), Condition::Reached("DEPC"));
        assert_eq!(at_a_port, None, "a robot at a port does not show its console");
    }

    #[test]
    fn rest_and_motion_are_relative_to_the_step_start() {
        let (mut picture, cell) = (picture(), cell("DEPC"));
        let begun = Begun { tick: Tick(40), tool: Some([0, 0, 0]), asked: None };
        let both = |picture: &Picture| {
            [Condition::Stands, Condition::Moved].map(|wanted| holds(picture, &cell, begun, wanted))
        };
        assert_eq!(both(&picture), [None, None], "the resolver readings are invalid");
        picture.memory.t3i.status.resolver_frame = Some(WireFrame { tool: [0, 3, -4], ..HOME });
        assert_eq!(both(&picture), [Some(true), Some(false)]);
        picture.memory.t3i.status.resolver_frame = Some(WireFrame { tool: [0, 11, 0], ..HOME });
        assert_eq!(both(&picture), [Some(false), Some(true)]);
        picture.tick = Tick(60);
        picture.memory.t3i.status.resolver_frame = Some(WireFrame { tool: [0, 0, 0], ..HOME });
        assert_eq!(both(&picture), [Some(false), Some(false)], "it has not stood for long");
    }

    #[test]
    fn home_tolerance_is_four() {
        let (mut picture, cell) = (picture(), cell("DEPC"));
        let mut at_home = |frame| {
            picture.memory.t3i.status.resolver_frame = Some(frame);
            holds(&picture, &cell, Begun::default(), Condition::AtHome)
        };
        assert_eq!(at_home(WireFrame { tool: [3, -7142, -1487], ..HOME }), Some(true));
        assert_eq!(at_home(WireFrame { tool: [5, -7145, -1483], ..HOME }), Some(false));
        assert_eq!(at_home(WireFrame { tool: [0, 7145, -1483], ..HOME }), Some(false), "a wrong sign");
    }
}
