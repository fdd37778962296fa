//! The last lines of a run: where the parts are, then the commands with which a person continues.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use os_io::shell;
use runtime::{Ending, RunOutcome};

use crate::rcs_run::programs::start_of;

/// The script that opens a log in Rerun; it is in the directory of the viewers.
const RERUN: &str = "rerun.sh";
const LAYOUT: &str = "foxglove.json";

/// Layouts of the viewers in the working directory or this program's sources; `None` if installed without them.
fn viewers() -> Option<PathBuf> {
    let here = PathBuf::from("viewers");
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.join(&here);
    [here, sources].into_iter().find(|directory| directory.join(RERUN).is_file())
}

pub struct LastLines<'a>(pub &'a RunOutcome);

impl fmt::Display for LastLines<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(RunOutcome { ending, result, .. }) = self;
        writeln!(f)?;
        if result.simulated.is_some() {
            writeln!(f, "In the simulated cell, which follows the robot:")?;
        }
        if result.field.as_ref().is_some_and(|field| field.is_real) {
            writeln!(f, "The devices are real: this program does not know where the parts are.")?;
        } else if result.parts.is_empty() {
            writeln!(f, "No part is in the cell.")?;
        }
        // A held part is listed first, because it is the most important information for the operator.
        let (held, others): (Vec<_>, Vec<_>) = result.parts.iter().partition(|part| part.held);
        for part in held.into_iter().chain(others) {
            writeln!(f, "{part}")?;
        }
        if let Some(trouble) = &result.journal_trouble {
            writeln!(f, "{trouble}; the run cannot be resumed from it")?;
        }
        let Some(log) = result.log.as_deref().map(shell::path) else { return Ok(()) };
        let tick = match ending {
            Ending::Failed(account) => format!(" --tick {}", account.first.shown_at()),
            Ending::Finished | Ending::Stopped | Ending::StoppedByUser => String::new(),
        };
        writeln!(f)?;
        writeln!(f, "watch      {} --log {log}{tick}", start_of("rcs-console"))?;
        writeln!(f, "look       {} open {log}    # in a browser", start_of("rcs-log"))?;
        match viewers() {
            Some(viewers) => {
                let (rerun, layout) = (shell::path(viewers.join(RERUN)), shell::path(viewers.join(LAYOUT)));
                writeln!(f, "open       {rerun} {log}    # or in Foxglove, with the layout {layout}")?;
            }
            None => writeln!(f, "open       rerun {log}    # or open the file in Foxglove or Lichtblick")?,
        }
        writeln!(f, "ask why    {} why {log}", start_of("rcs-log"))
    }
}
