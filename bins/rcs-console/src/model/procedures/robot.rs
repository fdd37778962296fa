//! The robot from power-up to shut-down (IV.1, IV.3.2 to IV.3.4).

use interfaces::{ProcessId, data_base::Connection};

use super::{Ask::Line, Condition, Procedure, Show, Step, Watch, controller, event, real, said, state, step};

const LEVELS: &[ProcessId] = &[ProcessId::Task, ProcessId::Subtask, ProcessId::Emove, ProcessId::Prim];
/// The processes that have PAUSE also without a link to the robot.
const PAUSING: &[ProcessId] = &[ProcessId::Task, ProcessId::Subtask, ProcessId::Emove];
const BOARD_2: &[ProcessId] = &[ProcessId::Emove, ProcessId::Prim]; // the processes of board 2
const BOARD_6: &[ProcessId] = &[ProcessId::Task, ProcessId::Subtask]; // the processes of board 6
const BELOW: &[ProcessId] = &[
    ProcessId::T3i,
    ProcessId::Emove,
    ProcessId::Prim,
    ProcessId::QuickChange,
    ProcessId::Grip,
    ProcessId::VGrip,
    ProcessId::ToolGrip,
];
/// The command that moves to HOME (block 863, line 3).
pub const HOME: &str = "MOVE -- 0 -- 0 0 HOME 0 -- 0";

/// IV.1.
pub const POWER_UP: Procedure = Procedure {
    section: "IV.1",
    title: "Power up",
    steps: &[
        real("1", "the displays of the hall and the cameras have power"),
        Step {
            ask: &[Line("panel power on")],
            how: "The screen shows ERROR-E22, and FAULT RESET is lit until step 5 of IV.3.3.",
            show: Show::Screen,
            ..state("2", "CONTROL POWER of the robot controller is on", &[Condition::Reached("fault")])
        },
        Step {
            how: "Its process turns it to the + limit, sets its counter and parks it; its keys are on screen 6.",
            show: Show::Pedestal,
            ..state("3", "the rotary table is at -20.0 degrees", &[Condition::TableAt(-200)])
        },
        Step {
            show: Show::Pedestal,
            ..state(
                "4",
                "the controller of the Active Pedestal runs",
                &[Condition::Run(&[ProcessId::Pedestal, ProcessId::Hand, ProcessId::RotaryTable])],
            )
        },
        Step {
            how: "The Prim Interface Box has power with it: the joystick box and its E-stop work.",
            ..state("5", "the controller runs: all levels are stepped", &[Condition::Run(LEVELS)])
        },
        real("6", "the terminals have power"),
    ],
};

/// IV.3.2.
pub const SET_UP: Procedure = Procedure {
    section: "IV.3.2",
    title: "Set up to run stand-alone",
    steps: &[
        Step {
            how: "Block 903: READ-HWS-COMMAND is out. A job or an operator commands.",
            ask: &[Line("job wait")],
            ..state("1", "no workstation controller commands", &[Condition::Commands("the job")])
        },
        Step {
            how: "Block 907 and DB-DONE: without STARTUP nothing is sent to the Data System.",
            ..state("2", "the Data System is not connected", &[Condition::DataSystem(Connection::Closed)])
        },
        Step {
            ask: &[Line("PAUSE")],
            how: "863 12 12 LINE-LOAD.",
            ..state("3", "Task has the command PAUSE", &[Condition::Have(&[ProcessId::Task], "PAUSE")])
        },
        Step {
            how: "GO on board 6, SSGO on board 0. A run begins with all boards going; screen 5 stops them.",
            ask: &[Line("joystick free TASK"), Line("joystick free SUBTASK")],
            ..state("4", "Task and Subtask run, and the pulse comes", &[Condition::Run(BOARD_6)])
        },
        Step {
            how: "Blocks 903 and 907 of Subtask, E-move and Prim: see the procedures of IV.4.",
            ..said("5", "the required neighbours are connected")
        },
        Step {
            how: "GO on boards 4, 2 and 8. A gripper that is not on the robot is dormant.",
            ask: &[Line("joystick free EMOVE"), Line("joystick free PRIM")],
            ..state("6", "T3 Interface, E-move, Prim and the grippers run", &[Condition::Run(BELOW)])
        },
    ],
};

/// IV.3.3.
pub const START_UP: Procedure = Procedure {
    section: "IV.3.3",
    title: "Power up the robot and initialize the link",
    steps: &[
        Step {
            ask: &[Line("PAUSE")],
            how: "Prim has it, too; while the link is off, E-move gives it ROBOT-INIT instead.",
            until: "14",
            ..state("1a", "Task, Subtask and E-move have PAUSE", &[Condition::Have(PAUSING, "PAUSE")])
        },
        Step {
            ask: &[Line("board 2 stop")],
            how: "^C on board 2.",
            until: "14",
            ..state("1b", "E-move and Prim are stopped", &[Condition::Held(BOARD_2)])
        },
        Step {
            ask: &[
                Line("robot-init"),
                Line("joystick velocity 0"),
                Line("joystick frame OFF"),
                Line("joystick hold PRIM"),
            ],
            how: ".R on board 2: E-move gives Prim ROBOT-INIT, which sends RESTART to T3 Interface.",
            show: Show::Box,
            until: "14",
            ..state(
                "2",
                "the joystick box is safe: knob 0, frames off, Prim held",
                &[Condition::KnobUp(false), Condition::FrameOn(false), Condition::Held(&[ProcessId::Prim])],
            )
        },
        Step {
            show: Show::Hand,
            ..state(
                "3",
                "T3 Interface shows the position in every tick",
                &[Condition::Run(&[ProcessId::T3i]), Condition::Resolvers],
            )
        },
        Step {
            ask: &[Line("panel power on")],
            show: Show::Screen,
            ..state("4", "CONTROL POWER is on", &[Condition::Reached("fault")])
        },
        Step { id: "5", ..controller::FAULT_RESET },
        Step {
            how: "No person is in the work volume, and nothing that does not belong there. \
                  Each gripper that is not on the robot sits in its own holster.",
            show: Show::Holsters,
            ..said("6", "the work volume is clear, the grippers sit in holsters")
        },
        Step { id: "7", ..controller::HYDRAULICS },
        Step { id: "8", ..controller::MANUAL },
        Step { id: "9", until: "10", ..controller::ALIGN },
        Step { id: "10", ..controller::AUTO },
        Step {
            how: "If not, do the resolver reset, a to q, which is a procedure of its own.",
            show: Show::Frame,
            until: "12",
            ..state("11", "frame-feedback is that of HOME", &[Condition::AtHome])
        },
        Step { id: "12", ..controller::CYCLE_START },
        Step {
            ask: &[Line("PAUSE"), Line("execute EMOVE 8"), Line("execute PRIM 2")],
            how: "The one of step 2 has found no robot controller. E-move gives it again with a new PAUSE.",
            ..event(
                "12b",
                "Prim has restarted the link, and T3 Interface reports finished",
                &[Condition::Taken, Condition::Says(ProcessId::T3i, "finished")],
            )
        },
        Step {
            ask: &[Line("execute PRIM 2")],
            how: "PRIM-LEVEL PRIM-LEVEL II: Prim runs twice, and its outputs equal its inputs.",
            show: Show::Frames,
            until: "15",
            ..event(
                "13",
                "Prim has run twice; tp-xyz, wr->tp and tp->fp agree",
                &[Condition::Taken, Condition::FramesAgree, Condition::AtHome],
            )
        },
        Step {
            ask: &[Line("joystick free PRIM"), Line("board 2 go"), Line("PAUSE")],
            how: "GO on board 2. If it moves, press an E-stop at once.",
            warning: "the robot comes under control; it must not move; have an E-stop at hand",
            show: Show::Hand,
            ..event(
                "14",
                "E-move and Prim run, the link runs, the robot is at rest",
                &[Condition::Taken, Condition::Run(BOARD_2), Condition::LinkRuns, Condition::Stands],
            )
        },
        Step {
            ask: &[Line("joystick frame WORLD"), Line("joystick velocity 500"), Line("joystick up 20")],
            how: "Screen 6 has the box. Enter switches WORLD on, sets the knob to half, and moves up.",
            warning: "the robot moves up by a few inches",
            show: Show::Hand,
            ..event("15", "the robot follows the joystick box", &[Condition::Taken, Condition::Moved])
        },
        Step {
            ask: &[Line("joystick velocity 0"), Line("joystick frame OFF")],
            how: "The manual stops board 6 here. Task waits for its command anyway.",
            show: Show::Box,
            until: "19",
            ..state(
                "16",
                "the knob is at 0 and all frames are off",
                &[Condition::KnobUp(false), Condition::FrameOn(false)],
            )
        },
        Step {
            ask: &[Line(HOME)],
            how: "863 3 3 LINE-LOAD on board 6. With the knob at 0 nothing moves yet.",
            until: "19",
            ..state("17", "Task has the command to HOME", &[Condition::Have(&[ProcessId::Task], "HOME")])
        },
        Step {
            how: "GO on board 6: it is displayed on screen 1.",
            until: "19",
            ..state("18", "Task and Subtask run", &[Condition::Run(BOARD_6)])
        },
        Step {
            ask: &[Line("joystick velocity 500")],
            warning: "the robot moves to HOME; the knob stays up until the next step",
            show: Show::Hand,
            ..event(
                "19",
                "the robot is at HOME, and Task reports finished",
                &[Condition::Taken, Condition::Says(ProcessId::Task, "finished"), Condition::AtHome],
            )
        },
        Step {
            ask: &[Line("joystick velocity 0")],
            how: "Keep it so when the robot is left alone; hold Prim (h) as well.",
            show: Show::Box,
            ..state("19b", "the knob is at 0", &[Condition::KnobUp(false)])
        },
    ],
};

/// IV.3.4, with the parts of IV.2.11 and IV.5.3 that remain.
pub const SHUT_DOWN: Procedure = Procedure {
    section: "IV.3.4",
    title: "Shut down the robot",
    steps: &[
        Step {
            ask: &[Line(HOME), Line("joystick velocity 500"), Line("go")],
            how: "863 line 3; if a trajectory leads to SAFE, MOVE to SAFE first (667 line 10).",
            warning: "the robot moves to HOME",
            show: Show::Hand,
            until: "2",
            ..state(
                "1",
                "the robot is at HOME, and Task reports finished",
                &[Condition::Says(ProcessId::Task, "finished"), Condition::AtHome],
            )
        },
        Step {
            ask: &[Line("estop terminals")],
            warning: "the arm loses its pressure and sinks",
            show: Show::Screen,
            ..state("2", "an E-stop is pressed: no hydraulic pressure", &[Condition::NoPressure])
        },
        Step {
            how: "It keeps the arm from drifting to the floor. Check it whenever the power is off.",
            show: Show::Hand,
            ..said("3", "the shot pin under the shoulder has extended")
        },
        Step {
            ask: &[Line("panel power off")],
            show: Show::Screen,
            ..state("4", "CONTROL POWER is off", &[Condition::At("control power off")])
        },
        step("5", "the run is ended at its own terminal (SIGINT), IV.2.11", Watch::Real),
    ],
};
