//! Steps at the robot controller that several procedures share (III.6, IV.3.1, IV.3.3, IV.3.4).

use super::{Ask::Line, Ask::ReleaseEStops, Condition, Show, Step, event, state};

pub const FAULT_RESET: Step = Step {
    ask: &[ReleaseEStops, Line("panel fault-reset")],
    how: "It resets only when all emergency stops are out, and the Prim Interface Box has power.",
    show: Show::Screen,
    ..state(
        "",
        "the E-stops are out, and FAULT RESET is out",
        &[Condition::EStopsOut, Condition::Reached("hydraulics disabled")],
    )
};

pub const HYDRAULICS: Step = Step {
    ask: &[Line("panel hydraulics enable")],
    how: "The red lights on the robot and HYD ENABLED come on.",
    show: Show::Screen,
    ..state("", "HYDRAULICS stands at ENABLE", &[Condition::Reached("hydraulics enabled")])
};

pub const MANUAL: Step = Step {
    ask: &[Line("panel manual on")],
    how: "One hand covers the E-stop of the control panel.",
    warning: "the arm becomes live and jumps by several inches, its end by about 10 in",
    show: Show::Hand,
    ..state("", "MANUAL is on: the hand has jumped and is at rest", &[Condition::Reached("manual")])
};

pub const ALIGN: Step = Step {
    ask: &[Line("panel align")],
    how: "Base, shoulder and elbow to their arrows; the gripper straight down or out; its line \
          through the elbow; the camera on top. Some axes have an asterisk elsewhere, too.",
    warning: "the arm moves",
    show: Show::Aligned,
    ..state("", "all six axes are aligned", &[Condition::Aligned])
};

pub const AUTO: Step = Step {
    ask: &[Line("panel auto")],
    warning: "the arm jumps again and moves directly to HOME, even if something is in its way",
    show: Show::Hand,
    ..state("", "AUTO: the robot has moved to HOME", &[Condition::Reached("auto, at HOME")])
};

pub const CYCLE_START: Step = Step {
    ask: &[Line("panel cycle-start")],
    how: "If a WD warning appears: its procedure is in the list.",
    warning: "the robot makes two short vertical motions by itself",
    show: Show::Screen,
    ..state("", "CYCLE START: the program has reached DEPC", &[Condition::Reached("DEPC")])
};

pub const INTERRUPT: Step = Step {
    ask: &[Line("panel interrupt")],
    show: Show::Screen,
    ..event("", "INTERRUPT is pressed", &[Condition::Taken])
};

pub const CANCEL: Step = Step {
    ask: &[Line("panel cancel")],
    show: Show::Screen,
    ..event("", "CANCEL is pressed", &[Condition::Taken])
};

pub const CANCEL_AGAIN: Step = Step {
    ask: &[Line("panel cancel")],
    show: Show::Screen,
    ..state("", "CANCEL is pressed again: pre-manual", &[Condition::At("pre-manual")])
};
