//! The command line of `rcs-run campaign`.

use std::path::PathBuf;

use crate::pages::{DataArgument, with_names};
use clap::{
    Args,
    builder::{ArgPredicate, StringValueParser},
};
use diagnostics::FAULTS;
use runtime::FieldConfig;

use super::{interruption::first_words, operator::Recovery, trial::Until};

/// Arguments of `rcs-run campaign`.
#[derive(Clone, Debug, Args)]
pub struct CampaignArguments {
    /// Names of jobs in the data directory, or paths
    #[arg(default_value = "linkbar", value_parser = crate::pages::job(), hide_possible_values = true)]
    pub jobs: Vec<String>,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// Seed of the cell's sensor noise and of the positions of delivered parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Put emulated couplers between the controller and the cell, as mapped by sim:NAME or sim:FILE (docs/field.md)
    #[arg(long, value_name = "sim:NAME")]
    pub field: Option<FieldConfig>,
    /// Interruptions, separated by commas: pause, pause-twice, refused, replaced, answer-lost, answer-late,
    /// answer-damaged, hold, nudge, away, estop, power, power:arm, power:air, held or held:PROCESS, restart or
    /// restart:PROCESS, fault or fault:FILE, none or all; jog:X:Y:Z (0.01 in), take:PART, move:PART:X:Y, swap:PART:KIND, add:KIND:PLACE:SECTOR,
    /// each with :next or :again for the next command or the one before; with --field also
    /// outage:DEVICE, outage:DEVICE:SECONDS or outage:DEVICE/DEVICE:SECONDS, where robot is the line to the robot
    /// controller; with --judge rest also cut, lost or lost:PROCESS; hold+35:pause is hold, and pause 35 ticks after it [with --random: all]
    #[arg(
        long,
        value_name = "KIND",
        value_delimiter = ',',
        value_parser = with_names(StringValueParser::new(), interruption_names),
        hide_possible_values = true,
        default_value = "pause",
        default_value_if("random", ArgPredicate::IsPresent, "all")
    )]
    pub interrupt: Vec<String>,
    /// Draw N branches at random: the tick, and one or several of the interruptions that --interrupt names
    #[arg(long, value_name = "N", conflicts_with_all = ["ticks", "changes", "at", "markdown"])]
    pub random: Option<usize>,
    /// Draw N branches in which a person moves the robot aside, or moves, exchanges, adds or removes a part; one in
    /// ten runs to the end of the job
    #[arg(long, value_name = "N", conflicts_with_all = ["ticks", "changes", "at", "states", "random"])]
    pub truth: Option<usize>,
    /// Largest number of interruptions of a branch that is drawn
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=9))]
    pub longest: u8,
    /// Seed of the draw: another seed draws other branches
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub draw: u64,
    /// Fork once every so many ticks [default: 23 without --changes and --at]
    #[arg(long, value_name = "EVERY", value_parser = clap::value_parser!(u64).range(1..))]
    pub ticks: Option<u64>,
    /// Fork at each tick in which a step or a command number changes, and at the two after it
    #[arg(long)]
    pub changes: bool,
    /// Fork at the first tick of each state of the control processes: their steps, and the rows that they fired last
    #[arg(long, conflicts_with_all = ["ticks", "changes", "at", "random"])]
    pub states: bool,
    /// Fork at every so many of the ticks within 10 of a change of an output
    #[arg(long, value_name = "EVERY", conflicts_with_all = ["ticks", "changes", "at", "states", "random"], value_parser = clap::value_parser!(u64).range(1..))]
    pub outputs: Option<u64>,
    /// Fork at these ticks; one tick with one interruption prints the whole branch
    #[arg(long, value_name = "N", value_delimiter = ',', conflicts_with_all = ["ticks", "changes"])]
    pub at: Vec<u64>,
    /// What the operator does first when a command was interrupted or has failed
    #[arg(long, value_enum, default_value_t = Recovery::Pause)]
    pub recovery: Recovery,
    /// How often the operator sends the interrupted command again, each time after a PAUSE
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub tries: u32,
    /// When a branch is judged
    #[arg(long, value_enum, default_value_t = Until::Next)]
    pub judge: Until,
    /// Branches that are run at the same time
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=64))]
    pub threads: u8,
    /// Write each branch into this file as soon as it is judged, and skip the branches that the file has already: a
    /// campaign that was stopped continues. Branches of other data, seeds, programs or procedures stay in the file and
    /// are not used
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
    /// Print one JSON object per job on standard output, one per line, and nothing else there
    #[arg(long)]
    pub json: bool,
    /// Write the table as Markdown, one column per job. In a FILE that has the table already, columns of other jobs
    /// stay
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Ticks before and after the interruption for which a single branch prints every row that fires
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub around: u64,
}

/// The interruptions that completions offer: all first words, and a `fault` with each fault file.
fn interruption_names() -> Vec<String> {
    let faults = crate::pages::names(&FAULTS).into_iter().map(|name| format!("fault:{name}"));
    first_words().map(str::to_owned).chain(faults).collect()
}
