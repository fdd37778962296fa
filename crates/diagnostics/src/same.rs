//! Reports equal findings of several lines of jobs once.

use std::collections::HashMap;

use crate::{Diagnostic, Diagnostics, Severity};

const NAMED: usize = 3; // other lines in a help text

impl Diagnostic {
    fn key(&self) -> (bool, &'static str, String) {
        let same = self.problem.same.as_ref().unwrap_or(&self.problem.message);
        (self.problem.severity == Severity::Error, self.problem.code, same.clone())
    }

    /// The name of the file without directories, and the line.
    fn line_in_words(&self) -> Option<String> {
        let name = self.file().rsplit('/').next()?;
        self.line().map(|line| format!("{name} line {line}"))
    }
}

impl Diagnostics {
    /// Keep only the first of equal findings in several reports. Its help lists the lines of the others.
    pub fn merge_repeated(reports: &mut [&mut Self]) {
        let mut lines: HashMap<_, Vec<String>> = HashMap::new();
        for diagnostic in reports.iter().flat_map(|report| &report.diagnostics) {
            lines.entry(diagnostic.key()).or_default().extend(diagnostic.line_in_words());
        }
        for report in reports {
            let all = report.diagnostics.len();
            report.diagnostics.retain_mut(|diagnostic| {
                let Some(lines) = lines.remove(&diagnostic.key()) else { return false };
                let others = lines.get(1..).unwrap_or_default();
                if let [first, ..] = others {
                    let named = others.get(..NAMED).map_or_else(|| others.join(", "), |some| some.join(", "));
                    let more = if others.len() > NAMED { ", \u{2026}" } else { "" };
                    let count = match others.len() {
                        1 => format!("the same in 1 more line ({first})"),
                        count => format!("the same in {count} more lines ({named}{more})"),
                    };
                    let help = diagnostic.problem.help.take();
                    diagnostic.problem.help =
                        Some(help.map_or(count.clone(), |help| format!("{help}; {count}")));
                }
                true
            });
            report.told = all.saturating_sub(report.diagnostics.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{At, Diagnostics, Places, Problems, Source};

    fn report(name: &str, found: &[(u32, &str, Option<&str>)]) -> Diagnostics {
        let source = Source { name: format!("data/jobs/{name}.job"), text: "a\nb\nc\nd\ne\nf\n".into() };
        let mut problems = Problems::default();
        for (line, message, same) in found {
            problems.error("test", At { source: 0, start: (line - 1) * 2, length: 1 }, *message);
            same.iter().for_each(|same| problems.same_as((*same).to_owned()));
        }
        Diagnostics::new(problems, Places::in_lines(std::slice::from_ref(&source)), 0, Vec::new())
    }

    #[test]
    fn an_equal_finding_of_several_lines_is_reported_once() {
        let mut first = report("one", &[(1, "deep", Some("way")), (2, "other", None)]);
        let mut second = report(
            "two",
            &[(3, "deeper", Some("way")), (4, "alone", None), (5, "other", None), (6, "other", None)],
        );
        let mut third = report("three", &[(1, "other", None), (2, "other", None)]);
        Diagnostics::merge_repeated(&mut [&mut first, &mut second, &mut third]);
        let said = |report: &Diagnostics| {
            let all = report.diagnostics().iter();
            all.map(|one| (one.message().to_owned(), one.help().unwrap_or_default().to_owned()))
                .collect::<Vec<_>>()
        };
        let words = |all: &[(&str, &str)]| {
            all.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect::<Vec<_>>()
        };
        assert_eq!(
            said(&first),
            words(&[
                ("deep", "the same in 1 more line (two.job line 3)"),
                (
                    "other",
                    "the same in 4 more lines (two.job line 5, two.job line 6, three.job line 1, \u{2026})"
                ),
            ])
        );
        assert_eq!(said(&second), words(&[("alone", "")]));
        assert_eq!(said(&third), []);
        assert_eq!(third.summary(), "0 errors, 0 warnings and 2 reported above; 0 blocks in 1 file\n");
    }
}
