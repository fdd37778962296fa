//! The command line.

use std::{env, path::PathBuf};

use clap::{Parser, ValueEnum};
use executive::memory::RunName;

use crate::rcs_console::{model::Screen, view::Look};

/// The help of `--data`, which applies only to a run or a log without data of its own.
const DATA: &str = "Task data whose blocks screen 5 lists [with --operate those of the run, with a log those in the log; \
                    else data, or built-in, the data of the program]";

/// Shows what every control process does and why: in a run, or at any tick of a log. With --operate it operates the run
#[derive(Debug, Parser)]
#[command(
    name = "rcs-console",
    version,
    about = "Shows what every control process does and why: in a run, or at any tick of a log",
    mut_arg("data", |data| data.help(DATA)),
    after_help = "\
Examples:
  rcs-console                                  the run in progress; waits for one if there is none
  rcs-console --run linkbar-4711               one of several runs
  rcs-console --operate                        also stop, command and recover the run (docs/operator.md)
  rcs-console --log runs/linkbar.mcap          a log
  rcs-console --log runs/linkbar.mcap --once ladder --tick 623   one screen as text

Exit status: 0 quit; 1 the terminal has disappeared; 2 usage, or what is to be shown cannot be read."
)]
pub struct Cli {
    /// The run to look at [default: the only one in progress]
    #[arg(long, value_name = "NAME")]
    pub run: Option<RunName>,
    /// The log to look at; with --run the log of that run, which a key opens
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Operate the run, instead of only looking at it; the run needs --clock real
    #[arg(long, conflicts_with_all = ["once", "tick"])]
    pub operate: bool,
    /// The run ends when this console quits: set by `rcs-run --console`
    #[arg(long, hide = true, requires = "run")]
    pub ends_run: bool,
    /// The data.
    #[command(flatten)]
    pub data: crate::pages::DataArgument,
    /// Whether to use colours, which only repeat what the text says; auto follows NO_COLOR and TERM=dumb
    #[arg(long, value_enum, default_value_t = Colour::Auto)]
    pub colour: Colour,
    /// Draw with ASCII only [default: if the locale is not UTF-8]
    #[arg(long)]
    pub ascii: bool,
    /// Print one screen as text and exit
    #[arg(long, value_enum, value_name = "SCREEN")]
    pub once: Option<Screen>,
    /// Begin at this tick of a log
    #[arg(long, value_name = "N", requires = "log")]
    pub tick: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// If the terminal has colours and NO_COLOR is not set
    Auto,
    /// No colours
    Never,
}

impl Cli {
    /// The look of the text, from the options and the environment.
    #[must_use]
    pub fn look(&self) -> Look {
        let set = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
        let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(set);
        Look {
            colour: self.colour == Colour::Auto
                && set("NO_COLOR").is_none()
                && set("TERM").is_none_or(|term| term != "dumb"),
            ascii: self.ascii || !is_utf8(locale.as_deref()),
        }
    }
}

fn is_utf8(locale: Option<&str>) -> bool {
    let locale = locale.unwrap_or_default().to_lowercase();
    locale.contains("utf-8") || locale.contains("utf8")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn command_line_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn locale_selects_the_characters() {
        assert!(is_utf8(Some("en_GB.UTF-8")) && is_utf8(Some("C.utf8")));
        assert!(!is_utf8(Some("C")) && !is_utf8(None));
    }
}
