//! Connecting and disconnecting the neighbours (IV.4), and the Active Pedestal (IV.5).

use interfaces::{ProcessId, data_base::Connection};

use super::{Ask::Line, Condition, Procedure, Show, Step, event, real, said, state};

const PEDESTAL_RUNS: &[Condition] =
    &[Condition::Run(&[ProcessId::Pedestal, ProcessId::Hand, ProcessId::RotaryTable])];

/// IV.4.1.
pub const WORKSTATION: Procedure = Procedure {
    section: "IV.4.1",
    title: "Connect the workstation controller",
    steps: &[
        Step {
            how: "rcs-run JOB --stand-alone --network ADDRESS --outside workstation starts such a run.",
            ..said("a", "the run lets a workstation controller connect")
        },
        Step {
            ask: &[Line(super::robot::HOME)],
            warning: "the robot moves to HOME",
            show: Show::Frame,
            until: "7",
            ..state("b", "the robot is at HOME", &[Condition::AtHome])
        },
        Step {
            how: "If it is needed: do its procedure first.",
            ..said("c", "the Data System is connected, or is not needed")
        },
        Step {
            ask: &[Line("PAUSE")],
            until: "7",
            ..state(
                "d",
                "PAUSE was the last command, and is finished",
                &[Condition::Have(&[ProcessId::Task], "PAUSE"), Condition::Says(ProcessId::Task, "finished")],
            )
        },
        Step {
            how: "The manual edits and loads blocks 903, 907, 188 and 641. Here the line does it.",
            ..said("1-6", "the next line of the job is ** workstation")
        },
        Step {
            ask: &[Line("job go")],
            how: "GO. Its commands are executed from now on; an operator may stop the robot, but not command it.",
            warning: "the workstation controller moves the robot from now on",
            until: "8",
            ..state(
                "7",
                "the workstation controller commands",
                &[Condition::Commands("the workstation controller commands")],
            )
        },
        Step {
            how: "It is closed between two commands: the job then sends PAUSE and continues.",
            ..state("8", "disconnected: the job commands again", &[Condition::Commands("the job")])
        },
    ],
};

/// IV.4.2.
pub const DATA_SYSTEM: Procedure = Procedure {
    section: "IV.4.2",
    title: "Connect the Data System",
    steps: &[
        Step {
            how: "Blocks 903 and 907: READ-DAS-STATUS and WRITE-DAS-COMMAND always run here.",
            ..said("1-2", "the Data System runs, in this run or as rcs-neighbour")
        },
        Step {
            ask: &[Line("STARTUP")],
            how: "667 line 0. Screen 5 shows Aborting, Initiating, Connecting, Finished.",
            until: "4",
            ..state(
                "3",
                "STARTUP is finished: the Data System receives moves",
                &[Condition::DataSystem(Connection::Open)],
            )
        },
        Step {
            ask: &[Line("SHUTDOWN")],
            how: "667 line 1, when it is no longer needed.",
            ..event(
                "4",
                "SHUTDOWN is finished: it receives nothing more",
                &[Condition::Taken, Condition::DataSystem(Connection::Closed)],
            )
        },
    ],
};

/// IV.4.3.
pub const PEDESTAL: Procedure = Procedure {
    section: "IV.4.3",
    title: "Connect the Active Pedestal",
    steps: &[
        Step {
            how: "rcs-run --outside pedestal, and rcs-neighbour pedestal; else it is part of this run.",
            ..state("1", "the pedestal is a system of its own, and answers", &[Condition::PedestalAnswers])
        },
        Step { show: Show::Pedestal, ..state("2", "its processes run", PEDESTAL_RUNS) },
    ],
};

/// IV.4.4.
pub const VISION: Procedure = Procedure {
    section: "IV.4.4",
    title: "Check the vision system",
    steps: &[Step {
        how: "It is connected with the run. The first LOCATE-OBJ of a MOVE asks it for a picture.",
        show: Show::Vision,
        ..state("1", "vision has answered the last request", &[Condition::VisionAnswers])
    }],
};

/// IV.5.1.
pub const PEDESTAL_START: Procedure = Procedure {
    section: "IV.5.1",
    title: "Start the Active Pedestal",
    steps: &[
        real("1", "SHIFT F1: ok"),
        real("2", "SHIFT F2: ok"),
        real("3", "init-cm: ok"),
        real("4", "SHIFT F3: :R ped>"),
        real("5", "BOOT-SYSTEM: ok"),
        real("6", "SHIFT F3: :R hand>"),
        Step {
            how: "38 LOAD. Here it calibrates itself at the start.",
            show: Show::Pedestal,
            ..state("7", "the hand is calibrated", &[Condition::HandCalibrated])
        },
        Step {
            show: Show::Pedestal,
            ..state("8", "BGO: the hand process runs", &[Condition::Run(&[ProcessId::Hand])])
        },
        real("9", "^X: :R ped>"),
        Step {
            how: "38 LOAD. Here it calibrates itself at the start, and parks.",
            show: Show::Pedestal,
            until: "11",
            ..state("10", "the rotary table is calibrated, at -20.0 degrees", &[Condition::TableAt(-200)])
        },
        Step { show: Show::Pedestal, ..state("11", "CLP: the pedestal process runs", PEDESTAL_RUNS) },
    ],
};

/// IV.5.2.
pub const PEDESTAL_SHUT_DOWN: Procedure = Procedure {
    section: "IV.5.2",
    title: "Shut down the Active Pedestal",
    steps: &[
        Step {
            ask: &[Line("PAUSE")],
            how: "^C. Nothing may be in its hand that must not fall.",
            show: Show::Pedestal,
            ..state("1", "no command moves it", &[Condition::Have(&[ProcessId::Task], "PAUSE")])
        },
        real("2", "WUNLOAD: its disk is shut down"),
        real("3", "terminal, rack and rotary table controller are off"),
    ],
};
