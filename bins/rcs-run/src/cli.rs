//! The command line: the subcommands and the exit statuses.

use clap::{Parser, Subcommand};

use crate::rcs_run::{
    arguments::{
        BoardArguments, CheckArguments, InitArguments, IoCalibrateArguments, IoReleaseArguments,
        IoTestArguments, JobsArguments, LatencyArguments, LinkTestArguments, PoseArguments, RunArguments,
        SendArguments, StatusArguments,
    },
    campaign::CampaignArguments,
    new::NewArguments,
};

/// The RCS-II/T3 controller: runs jobs in the simulated cell, with a robot at a serial port, or with one by EGM.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-run",
    version,
    about = "The RCS-II/T3 controller",
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  rcs-run                              run the linkbar as fast as the cell can be simulated
  rcs-run linkbar --clock real         the same, one tick every 40 ms
  rcs-run my.job --seed 7 --json       a job file, other noise, the result as JSON
  rcs-run --faults air-lost            the air fails in the middle of the job
  rcs-run --boards split               one operating system process per board; the same result, bit for bit
  rcs-run link-test --robot serial:/dev/ttyUSB0
                                       test the serial line to a robot; nothing moves
  rcs-run --robot serial:/dev/ttyUSB0 --clock real
                                       command the robot there; gripper, tray, vise and camera are simulated
  rcs-run check                        check the task data without running anything
  rcs-run check --explain 'MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0'
                                       the whole path of a command, and how long it takes
  rcs-run --network unix:/tmp/rcs.sock --outside workstation --clock real
                                       take commands from a workstation controller in another process
  rcs-run new part HINGE --size 3x1.5x1 --like LCLEVIS
                                       data for a part of another size, tested before they are shown
  rcs-run jobs                         the jobs, one line each
  rcs-run status                       what the run in the other terminal is doing
  rcs-run tables > tables.md           all decision tables

Exit status: 0 finished; 1 the job failed; 2 usage, configuration or data error;
3 stopped by the user, an emergency stop, a lost link or a lost device, or no link to test.
The reason is the last line on standard error."
)]
pub struct Cli {
    /// What to do; without it, run a job.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Arguments of `run`, which may be left out.
    #[command(flatten)]
    pub run: RunArguments,
}

/// What else to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a job (the same as without a subcommand)
    Run(Box<RunArguments>),
    /// Exchange frames with a robot at a serial port and judge the link; the robot is commanded to the position it
    /// reports
    LinkTest(LinkTestArguments),
    /// Test the couplers of a mapping over TCP: identity, watchdog, times, inputs; outputs only if you ask for it
    IoTest(IoTestArguments),
    /// Switch off outputs that an earlier controller has left on, after a question per coupler
    IoRelease(IoReleaseArguments),
    /// Read an input in two known states, and print `raw` and `counts` for the mapping
    IoCalibrate(IoCalibrateArguments),
    /// Run one board of a run that was started with --boards manual
    Board(BoardArguments),
    /// Load task data, jobs and the cell description; print what was loaded, and all errors and warnings
    Check(CheckArguments),
    /// List the jobs, one line each
    Jobs(JobsArguments),
    /// Print every decision table as Markdown
    Tables,
    /// Measure how late this machine wakes a thread on the 40 ms grid, and say whether that is good enough for a robot
    Latency(LatencyArguments),
    /// Print what a run is doing now: each process with its command, its status, and the row that fired
    Status(StatusArguments),
    /// Send an operator's requests to a run: a stop, a command, a line for the cell
    Send(SendArguments),
    /// Interrupt a job at many ticks, recover it as an operator would, and judge how each branch ends
    Campaign(CampaignArguments),
    /// Print the nine numbers of a pose and whether the arm can reach it; write its form
    Pose(PoseArguments),
    /// Write the data that comes with the program into DIR/data, for you to change
    Init(InitArguments),
    /// Make task data and cell entries for a new part, tool, place or tray, test them, and show or write the changes
    New(NewArguments),
    /// Remove the shared memory that killed runs left behind
    Clean,
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use clap::CommandFactory;
    use executive::{boards::Board, overrun::Policy};
    use runtime::ClockKind;

    use super::*;
    use crate::rcs_run::clock::Clock;

    #[test]
    fn command_line_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn run_may_be_left_out() {
        let short = Cli::parse_from(["rcs-run", "other", "--seed", "7", "--log", "none"]);
        assert!(short.command.is_none());
        let long = Cli::parse_from(["rcs-run", "run", "other", "--seed", "7", "--log", "none"]);
        let Some(Command::Run(long)) = long.command else { panic!("run was asked for") };
        assert_eq!((short.run.job, short.run.seed, short.run.log), (long.job, long.seed, long.log));
        assert_eq!(Cli::parse_from(["rcs-run"]).run.job, "linkbar");
    }

    #[test]
    fn database_option_accepts_its_old_name() {
        let database = |option| Cli::parse_from(["rcs-run", option, "items.db"]).run.database;
        assert_eq!(database("--database"), Some(PathBuf::from("items.db")));
        assert_eq!(database("--data-base"), database("--database"));
    }

    #[test]
    fn board_option_accepts_boards_with_processes() {
        crate::shipped::carry();
        let board = |number| {
            let command = Cli::try_parse_from(["rcs-run", "board", number, "--run", "x", "linkbar"])?.command;
            let Some(Command::Board(arguments)) = command else { panic!("board was asked for") };
            Ok::<_, clap::Error>(arguments.board)
        };
        assert_eq!(board("8").ok(), Some(Board::Eight));
        let error = board("0").expect_err("it is rcs-run itself");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("--boards split"), "{error}");
        assert!(board("3").is_err());
    }

    #[test]
    fn the_console_is_for_eyes() {
        let clock = |words: &[&str]| Cli::parse_from(words).run.clock;
        assert_eq!(clock(&["rcs-run", "--console"]).kind, ClockKind::Real);
        assert_eq!(clock(&["rcs-run", "--console", "--clock", "5x"]).speed, 5);
        assert_eq!(clock(&["rcs-run"]).kind, ClockKind::Fast);
    }

    #[test]
    fn a_clock_has_a_speed() {
        let clock = |text| Cli::try_parse_from(["rcs-run", "--clock", text]).map(|cli| cli.run.clock);
        assert_eq!(clock("fast").ok(), Some(Clock { kind: ClockKind::Fast, speed: 1 }));
        assert_eq!(clock("real").ok(), Some(Clock { kind: ClockKind::Real, speed: 1 }));
        assert_eq!(clock("5x").ok(), Some(Clock { kind: ClockKind::Real, speed: 5 }));
        for wrong in ["0x", "21x", "x", "5", "slow"] {
            assert!(clock(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_live_view_has_a_port() {
        let live = |arguments: &[&str]| {
            let all = ["rcs-run"].iter().chain(arguments);
            Cli::try_parse_from(all).map(|cli| (cli.run.job, cli.run.live))
        };
        assert_eq!(live(&[]).ok(), Some(("linkbar".into(), None)));
        assert_eq!(live(&["shift", "--live"]).ok(), Some(("shift".into(), Some(8765))));
        assert_eq!(live(&["--live", "--clock", "real"]).ok(), Some(("linkbar".into(), Some(8765))));
        assert_eq!(live(&["--live", "9000"]).ok(), Some(("linkbar".into(), Some(9000))));
        let error = live(&["--live", "shift"]).expect_err("that is not a port").to_string();
        assert!(error.contains("name the job before --live"), "{error}");
        assert!(live(&["--live-origin", "http://localhost:80"]).is_err());
        assert!(live(&["--live", "--live-origin", "localhost"]).is_err());
    }

    #[test]
    fn overrun_policy_parses_from_text() {
        let overrun = |text| Cli::try_parse_from(["rcs-run", "--overrun", text]).map(|cli| cli.run.overrun);
        assert_eq!(Cli::parse_from(["rcs-run"]).run.overrun, Policy::Count);
        assert_eq!(overrun("hold:3").ok(), Some(Policy::Hold(3)));
        let error = overrun("wait").expect_err("no such policy");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("count, hold[:SLOTS] or stop[:SLOTS] was expected"), "{error}");
    }
}
