//! `rcs-log`: examines the logs of runs.
//!
//! | subcommand | question |
//! |---|---|
//! | [`info`] | what ran, how long did it take, how did it end? |
//! | [`why`] | what did each level do in a tick, by which row, and what failed first? |
//! | [`replay`] | would the present program do the same on the same inputs? |
//! | [`diff`] | where do two runs differ? |
//! | [`fork`] | what would have happened with another command, datum, seed or fault? |
//! | [`compare`] | what do other data change in the jobs? |
//! | [`page`] | the run on one page for a browser |
//! | [`serve`] | the run as a viewer shows it |
//! | [`golden`] | the run as a small file for tests |

mod compare;
mod diff;
mod difference;
mod fork;
mod golden;
mod info;
mod page;
mod parallel;
mod replay;
mod serve;
mod story;
mod why;

use std::{io, path::PathBuf, process::ExitCode};

use clap::{Args, Parser, Subcommand};

const DIFFERENT: u8 = 1; // exit status of a negative answer: a replay that differs, two logs that differ
const UNUSABLE: u8 = 2; // exit status of a usage or file error

/// Examines the logs of runs: what happened, why, and whether the present program would do the same.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-log",
    version,
    about = "Examines the logs of runs: what happened, why, and whether the present code would do the same",
    after_help = "\
Examples:
  rcs-log info runs/linkbar.mcap            what ran, its commands, link, end
  rcs-log why runs/linkbar.mcap             why it failed, from Task down to the link
  rcs-log why runs/linkbar.mcap --tick 1200 what each level did in a tick, and by which row
  rcs-log replay runs/*.mcap                compute every tick again and compare every bit
  rcs-log replay --data data runs/linkbar.mcap  with other task data: what would they have changed?
  rcs-log diff a.mcap b.mcap                where two runs differ
  rcs-log fork runs/linkbar.mcap --tick 4600 --set 'line=** wait 50'   what if the next line came 2 s later?
  rcs-log compare data ../new/data          what do other data change in the jobs?
  rcs-log open runs/linkbar.mcap            look through the run in a browser
  rcs-log page runs/linkbar.mcap -o run.html    the same page as one file, to send by e-mail
  rcs-log serve runs/linkbar.mcap --rate 5  play the run in Foxglove or Lichtblick, five times as fast
  rcs-log golden runs/*.mcap -o tests/goldens   small files for tests, with their texts

Exit status: 0 done, and no difference was found; 1 a difference was found; 2 usage, or a file cannot be used.
The reason is the last line on standard error."
)]
struct Cli {
    /// What to look for.
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// What ran, how long, with which commands, and how it ended
    Info(info::Arguments),
    /// What each level did, and by which row: in the tick of the failure, or in any other
    Why(why::Arguments),
    /// Compute the control processes again on the recorded inputs, and compare every output buffer of every tick
    Replay(replay::Arguments),
    /// Where two runs differ: the first difference, then all by buffer and field
    Diff(diff::Arguments),
    /// Run a log again up to a tick, make changes, run on to the end, and print the differences
    ///
    /// The run begins at tick 0 with the job, data and seed of the log. Each tick up to the change is compared with the
    /// log: if one differs, the fork ends with an error. Changes:
    ///
    ///   datum FILE:BLOCK:LINE[-LINE]:WORD=VALUE   a word of the task data; += and -= add to a number
    ///   line=LINE             a line of the job, before its next one: line='** wait 50'
    ///   command=COMMAND       another command instead of the next one
    ///   seed=N                other sensor noise, other positions of delivered parts
    ///   fault=FILE.toml       the faults of this fault plan can begin
    ///   cell KEY=VALUE        another value in cell.toml; needs --tick 0
    ///
    /// `rcs-log why` prints FILE, BLOCK and LINE; words count from 1. Exit status 0 if the fork was run.
    #[command(verbatim_doc_comment)]
    Fork(fork::Arguments),
    /// Run jobs with two data directories, and print the differences
    Compare(compare::Arguments),
    /// Write the log as one page for a browser: cell, decisions, and the chain of a failure
    ///
    /// The page needs no other file and no network, and shows every tick. It holds a copy of the log without the
    /// channel `/replay`, so keep the log if you want to replay the run.
    Page(page::Arguments),
    /// Write the page as `page` does, and open it in a browser
    Open(page::Arguments),
    /// Play a log in Foxglove or Lichtblick on this machine, as rcs-run --live shows a run
    ///
    /// The log plays once, from its start. It starts when a viewer has subscribed to a channel. The program ends when
    /// the log has ended and the last viewer has disconnected.
    Serve(serve::Arguments),
    /// Make the small files that tests replay, and their texts for review
    ///
    /// A log is refused unless it is complete and undamaged, and this program computes every tick of it with the same
    /// result: a golden is the reference of a test.
    Golden(golden::Arguments),
}

/// The files and the form of the answer, which all subcommands have.
#[derive(Clone, Debug, Args)]
struct Answer {
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

#[derive(Debug, thiserror::Error)]
enum Error {
    #[error("{}", .source.of(.path))]
    Read { path: PathBuf, source: record::ReadError },
    #[error("{}: tick {tick} is not in the log, which has ticks {first} to {last}", path.display())]
    NoTick {
        path: PathBuf,
        tick: u64,  // the requested tick
        first: u64, // first tick of the log
        last: u64,  // last tick of the log
    },
    #[error("{}: the log holds no tick", .0.display())]
    Empty(PathBuf),
    #[error("the task data under {}:\n{report}", path.display())]
    Data {
        path: PathBuf,
        report: String, // all errors of the task data
    },
    #[error("{}: {source}", path.display())]
    Golden { path: PathBuf, source: record::golden::GoldenError },
    #[error(
        "{}: this program differs from the log from tick {first} to {last}: name a log of this program",
        path.display()
    )]
    NotGolden {
        path: PathBuf,
        first: u64, // first tick of the stretch that differs
        last: u64,  // last tick of that stretch
    },
    #[error("{}: {source}", path.display())]
    Fork { path: PathBuf, source: Box<fork::ForkError> },
    #[error("{source}")]
    Start { source: Box<runtime::StartError> },
    #[error("neither {} nor {} has a job: name directories with jobs/NAME.job", .0.display(), .1.display())]
    NoJobs(PathBuf, PathBuf),
    #[error("{}: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("viewers cannot connect at 127.0.0.1:{port}: {source}; --port names another one")]
    Port {
        port: u16, // the port on 127.0.0.1
        source: io::Error,
    },
    #[error(transparent)]
    NoRandom(#[from] sessions::live::NoRandom),
    #[error("the answer cannot be written: {0}")]
    Output(#[from] io::Error),
}

fn main() -> ExitCode {
    programs::shipped::carry();
    let cli: Cli = programs::pages::parse();
    let outcome = match cli.command {
        Command::Info(arguments) => info::info(&arguments),
        Command::Why(arguments) => why::why(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        Command::Diff(arguments) => diff::diff(&arguments),
        Command::Fork(arguments) => fork::fork(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Page(arguments) => page::page(&arguments),
        Command::Open(arguments) => page::open(&arguments),
        Command::Serve(arguments) => serve::serve(&arguments),
        Command::Golden(arguments) => golden::golden(&arguments),
    };
    outcome.unwrap_or_else(|error| {
        os_io::stderr_line!("rcs-log: {error}");
        ExitCode::from(UNUSABLE)
    })
}

fn print<T: serde::Serialize + std::fmt::Display>(answer: &T, json: bool) -> Result<(), Error> {
    if json {
        let text = serde_json::to_string(answer).map_err(io::Error::from)?;
        return Ok(os_io::console::json(&(text + "\n"))?);
    }
    Ok(os_io::console::answer(&answer.to_string())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn command_line_definitions_are_consistent() {
        Cli::command().debug_assert();
    }
}
