//! Stops, and the recovery from them (III.6, IV.3.1, IV.3.3 steps 11 and 12, IV.3.4).

use interfaces::ProcessId;

use super::{Ask::Line, Condition, Procedure, Show, Step, Watch, controller, event, real, said, state, step};

/// III.6 and IV.3.1.
pub const E_STOP: Procedure = Procedure {
    section: "III.6",
    title: "Stop the robot, and start again after an E-stop",
    steps: &[
        Step {
            ask: &[Line("stop")],
            how: "The best stop, if there is time: Space on every screen. The robot ramps to rest.",
            show: Show::Box,
            until: "8",
            ..state("1", "the velocity knob is at 0", &[Condition::KnobUp(false)])
        },
        Step {
            ask: &[Line("joystick hold PRIM")],
            how: "The next best: h on every screen.",
            show: Show::Box,
            until: "12",
            ..state("2", "Prim is held", &[Condition::Held(&[ProcessId::Prim])])
        },
        Step {
            ask: &[Line("estop terminals")],
            how: "Only if the two above do not stop it. s leaves this step out.",
            warning: "the arm loses its pressure and sinks; away from HOME and SAFE it may hit something",
            show: Show::Hand,
            until: "8",
            ..state("3", "an E-stop is in: no hydraulic pressure", &[Condition::NoPressure])
        },
        Step {
            how: "The hand sinks until the shot pin holds the shoulder, or until it lies on something.",
            show: Show::Hand,
            ..said("4", "the shot pin, and where the arm sinks, have been checked")
        },
        Step {
            how: "If damage threatens or occurs: steps 6 to 8 at once.",
            show: Show::Hand,
            ..said("5", "it can settle without damage, or power comes back now")
        },
        Step { id: "6", ..controller::FAULT_RESET },
        Step { id: "7", ..controller::HYDRAULICS },
        Step { id: "8", ..controller::MANUAL },
        Step { id: "9", until: "10", ..controller::ALIGN },
        Step { id: "10", ..controller::AUTO },
        Step { id: "11", ..controller::CYCLE_START },
        Step {
            ask: &[Line("joystick free PRIM"), Line("PAUSE")],
            how: "PAUSE adopts the position of the robot, and restarts the link.",
            warning: "the robot comes under control; it must not move",
            show: Show::Hand,
            ..event(
                "12",
                "Prim runs, the link runs, the robot is at rest",
                &[
                    Condition::Taken,
                    Condition::Run(&[ProcessId::Prim]),
                    Condition::LinkRuns,
                    Condition::Says(ProcessId::Task, "finished"),
                    Condition::Stands,
                ],
            )
        },
        Step {
            ask: &[Line("joystick velocity 1000"), Line("go")],
            show: Show::Box,
            ..state("13", "the knob is up again", &[Condition::KnobUp(true)])
        },
        Step {
            ask: &[Line("job go")],
            how: "The job sends PAUSE and the line that was interrupted. :job skip continues after it.",
            warning: "the robot continues its job",
            ..state("14", "the job plays", &[Condition::Commands("the job plays")])
        },
    ],
};

/// IV.3.3 step 12.
pub const WARNING: Procedure = Procedure {
    section: "IV.3.3",
    title: "Recover from a warning of the robot controller",
    steps: &[
        Step {
            show: Show::Screen,
            how: "Screen 3 explains the code.",
            ..said("12", "the warning has been read")
        },
        Step { id: "12a", ..controller::INTERRUPT },
        Step { id: "12b", ..controller::CANCEL },
        Step { id: "12c", until: "12d", ..controller::CANCEL_AGAIN },
        Step { id: "12d", ..controller::AUTO },
        Step { id: "12e", ..controller::CYCLE_START },
        Step {
            ask: &[Line("PAUSE")],
            how: ".R: PAUSE lets Prim execute RESTART, and adopts the position.",
            show: Show::Frames,
            ..event(
                "12f",
                "the link runs, and the frames agree",
                &[
                    Condition::Taken,
                    Condition::Says(ProcessId::Task, "finished"),
                    Condition::LinkRuns,
                    Condition::FramesAgree,
                ],
            )
        },
    ],
};

/// Note on the three address switches and the button of a joint (IV.3.3 step 11).
const SWITCHES: &str = "The switches are read from the left: 4, 2, 1.";

const AT_HOME: &str = "It sets the reading of the joint to that of HOME, where the robot must be.";

/// IV.3.3 step 11, a to q.
pub const RESOLVERS: Procedure = Procedure {
    section: "IV.3.3",
    title: "Reset the resolver electronics, 11 a to q",
    steps: &[
        real("a", "the Resolver Electronics Box has power"),
        Step {
            ask: &[Line("resolvers manual")],
            ..event("b", "MANUAL/AUTO stands at MANUAL", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("c", "address switches down, down, down") },
        Step {
            ask: &[Line("resolvers joint 0")],
            how: AT_HOME,
            ..event("d", "the button of joint 0 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("e", "address switches down, down, up") },
        Step {
            ask: &[Line("resolvers joint 1")],
            how: AT_HOME,
            ..event("f", "the button of joint 1 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("g", "address switches down, up, down") },
        Step {
            ask: &[Line("resolvers joint 2")],
            how: AT_HOME,
            ..event("h", "the button of joint 2 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("i", "address switches down, up, up") },
        Step {
            ask: &[Line("resolvers joint 3")],
            how: AT_HOME,
            ..event("j", "the button of joint 3 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("k", "address switches up, down, down") },
        Step {
            ask: &[Line("resolvers joint 4")],
            how: AT_HOME,
            ..event("l", "the button of joint 4 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("m", "address switches up, down, up") },
        Step {
            ask: &[Line("resolvers joint 5")],
            how: AT_HOME,
            ..event("n", "the button of joint 5 is pressed", &[Condition::Taken])
        },
        Step { how: SWITCHES, ..real("o", "address switches down, down, down") },
        Step {
            ask: &[Line("resolvers auto")],
            ..event("p", "MANUAL/AUTO stands at AUTO", &[Condition::Taken])
        },
        Step { show: Show::Frame, ..state("q", "frame-feedback is that of HOME", &[Condition::AtHome]) },
    ],
};

/// IV.3.4, second part.
pub const MANUAL_CONTROL: Procedure = Procedure {
    section: "IV.3.4",
    title: "Return the robot to the teach pendant",
    steps: &[
        Step {
            id: "1",
            how: "After a failure this may be better than moving to HOME first, or the only way.",
            ..controller::INTERRUPT
        },
        Step { id: "2", ..controller::CANCEL },
        Step { id: "3", until: "4", ..controller::CANCEL_AGAIN },
        Step {
            how: "Near HOME the robot may be shut down: IV.3.4 from step 2 on.",
            show: Show::Hand,
            ..step("4", "the robot is moved near to HOME with the pendant", Watch::Said)
        },
    ],
};
