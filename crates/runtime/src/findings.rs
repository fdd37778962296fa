//! Findings that do not prevent a run. The run reports their number, and `rcs-run check` shows them, with warnings
//! about motions that only it has.

use diagnostics::{Diagnostic, Diagnostics};
use os_io::text::amount;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    data: Count, // Task data, including forms that do not fit the cell
    job: Count,
    cell: Count,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Count {
    errors: usize,
    warnings: usize,
}

impl Count {
    fn of(report: &Diagnostics) -> Self {
        Self::default().and(report, |_| true)
    }

    /// Adds the findings of the report that meet a condition.
    fn and(self, report: &Diagnostics, is_of: impl Fn(&&Diagnostic) -> bool) -> Self {
        Self {
            errors: self.errors + report.errors().filter(&is_of).count(),
            warnings: self.warnings + report.warnings().filter(&is_of).count(),
        }
    }
}

/// The line about findings of a kind in a source, if there are any.
fn line(count: usize, one: &str, source: &str) -> Option<String> {
    let them = if count == 1 { "it" } else { "them" };
    (count > 0).then(|| format!("{} in {source}; rcs-run check shows {them}", amount(count, one)))
}

impl Findings {
    /// Task data with errors are not compared with the cell: a difference may only be a consequence of the error.
    #[must_use]
    pub fn of(data: &Diagnostics, job: &Diagnostics, of_cell: &Diagnostics, of_job: &Diagnostics) -> Self {
        let is_sound = !data.has_errors();
        let is_form = |finding: &&Diagnostic| is_sound && finding.block().is_some();
        let is_entry = |finding: &&Diagnostic| is_sound && finding.block().is_none();
        let mut job = if is_sound { job.clone().with(of_job.clone()) } else { job.clone() };
        // Equal findings of several lines are counted once.
        Diagnostics::merge_repeated(&mut [&mut job]);
        Self {
            data: Count::of(data).and(of_cell, is_form),
            job: Count::of(&job),
            cell: Count::default().and(of_cell, is_entry),
        }
    }

    /// One line per source with warnings, and one per kind of tolerated error. `unchecked` if commands may use
    /// data with errors.
    #[must_use]
    pub fn lines(self, unchecked: bool) -> Vec<String> {
        let lines = [
            line(self.data.warnings, "warning", "the task data"),
            line(self.job.warnings, "warning", "the job"),
            line(self.cell.warnings, "warning", "the cell description"),
            line(self.cell.errors, "error", "the cell description"),
        ];
        let of_data = (self.data.errors > 0).then(|| {
            let effect = match unchecked {
                true => "--unchecked: commands that use these data are executed",
                false => "commands that use these data are refused",
            };
            let count = amount(self.data.errors, "error");
            format!("{count} in the task data; {effect}; rcs-run check shows all")
        });
        lines.into_iter().chain([of_data]).flatten().collect()
    }
}
