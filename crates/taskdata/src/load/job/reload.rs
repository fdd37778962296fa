//! Lines `** load FILE`, whose blocks change the task data of later lines. A job with an error in such a block is
//! refused before the first tick.

use std::path::Path;

use diagnostics::{Problems, Source};

use super::{
    super::{Store, lex::words_of_line, source::read},
    source_lines,
};

#[derive(Clone, Debug)]
pub struct Reload {
    pub source: Source,
    pub store: Store, // after the reload
}

/// Each reload is based on the previous one. A file that cannot be loaded is reported at its line.
pub(super) fn reloads(job: &Source, store: &Store, problems: &mut Problems) -> Vec<Reload> {
    let directory = Path::new(&job.name).parent().unwrap_or(Path::new(""));
    let mut loaded: Vec<Reload> = Vec::new();
    for (_, line) in source_lines(job) {
        let words = words_of_line(&line);
        let texts: Vec<&str> = words.iter().map(|word| word.text).collect();
        let Some(file) = file_of(&texts).and_then(|at| words.get(at)) else { continue };
        let path = directory.join(file.text);
        let source = match read(&path, file.text) {
            Ok(source) => source,
            Err(error) => {
                problems.error("job.load", file.at, format!("{} cannot be read: {error}", path.display()));
                continue;
            }
        };
        let newest = loaded.last().map_or(store, |reload| &reload.store);
        match newest.with_blocks(vec![source.clone()]) {
            Ok((store, _)) => loaded.push(Reload { source, store }),
            Err(report) => {
                let first = report.errors().next().map_or("", |error| error.message());
                let errors = match report.errors().count() {
                    1 => "an error".to_owned(),
                    count => format!("{count} errors, the first"),
                };
                problems.error_help(
                    "job.load",
                    file.at,
                    format!("{} has {errors}: {first}", path.display()),
                    "load the file with the other task data (rcs-run check) to see all of them",
                );
            }
        }
    }
    loaded
}

fn file_of(words: &[&str]) -> Option<usize> {
    match words {
        ["**", "load", ..] => Some(2),
        ["**", "after", _, "load", ..] => Some(4),
        _ => None,
    }
}
