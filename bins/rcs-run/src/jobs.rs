//! `rcs-run jobs`: lists the jobs of a data directory, one line each.

use std::{borrow::Cow, fmt, path::Path, process::ExitCode};

use diagnostics::JOBS;
use os_io::files;
use serde::Serialize;

use crate::rcs_run::{answer::answer, arguments::JobsArguments, error::Error};

const COMMENT: char = '%'; // sign that begins a comment in a job
const WIDEST: usize = 100; // greatest length of a line, characters

#[derive(Debug, Serialize)]
struct Listed {
    job: String,
    about: String, // first sentence of the comment at the top of the file; empty without one
}

#[derive(Debug, Serialize)]
struct Jobs {
    jobs: Vec<Listed>,
}

/// Print the list. Fails with [`Error::Unlisted`] if a job cannot be read, [`Error::Output`].
pub fn jobs(arguments: &JobsArguments) -> Result<ExitCode, Error> {
    let listed = JOBS.all(&arguments.data).iter().map(|path| list(path)).collect::<Result<_, _>>()?;
    answer(&Jobs { jobs: listed }, arguments.json)?;
    Ok(ExitCode::SUCCESS)
}

fn list(path: &Path) -> Result<Listed, Error> {
    let text = files::read_text(path).map_err(|source| Error::Unlisted { path: path.to_owned(), source })?;
    let job = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Listed { job, about: first_sentence(&text) })
}

/// The first sentence of the comment with which a job begins.
fn first_sentence(text: &str) -> String {
    let comment: Vec<&str> = text.lines().map_while(|line| line.trim().strip_prefix(COMMENT)).collect();
    let words = comment.join(" ").split_whitespace().collect::<Vec<_>>().join(" ");
    let end = words.find(". ").map_or(words.len(), |at| at);
    words.get(..end).unwrap_or_default().trim_end_matches('.').to_owned()
}

impl fmt::Display for Jobs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.jobs.iter().map(|listed| listed.job.len()).max().unwrap_or(0);
        for Listed { job, about } in &self.jobs {
            writeln!(f, "{}", clipped(format!("{job:width$}  {about}").trim_end()))?;
        }
        Ok(())
    }
}

fn clipped(line: &str) -> Cow<'_, str> {
    let Some((end, _)) = line.char_indices().nth(WIDEST) else { return line.into() };
    let head = line.get(..end).unwrap_or(line);
    format!("{} ...", head.rsplit_once(' ').map_or(head, |(words, _)| words)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn job_description_is_the_first_sentence_of_its_comment() {
        let about = |text| first_sentence(text);
        assert_eq!(about("% The linkbar (VIII.2). Lines with\n% == are commands.\n"), "The linkbar (VIII.2)");
        assert_eq!(about("% A long\n% sentence.\n\n% Not this.\n"), "A long sentence");
        assert_eq!(about("** wait 1\n% Not this."), "");
        assert_eq!(clipped("short"), "short");
        assert_eq!(clipped(&"word ".repeat(30)), "word ".repeat(20) + "...");
    }
}
