//! `rcs-log golden`: converts logs of whole runs to small files for replay in tests, each with a text for review.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use os_io::replace::replace;
use os_io::text::amount;
use record::golden;
use serde::Serialize;

use crate::{Answer, Error, print, story::open};

/// Arguments of `golden`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The logs
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Where NAME.golden and NAME.txt go for a log NAME.mcap
    #[arg(long, short, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
struct Made {
    goldens: Vec<One>,
}

#[derive(Debug, Serialize)]
struct One {
    file: PathBuf,
    ticks: u64,
    bytes: u64,
    digest: String,
}

pub fn golden(arguments: &Arguments) -> Result<ExitCode, Error> {
    let make = |path: &PathBuf| make(path, &arguments.output);
    let goldens = arguments.files.iter().map(make).collect::<Result<_, _>>()?;
    print(&Made { goldens }, arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

fn make(path: &Path, directory: &Path) -> Result<One, Error> {
    let failed = |source| Error::Golden { path: path.to_owned(), source };
    let golden = golden::from_log(&open(path)?).map_err(failed)?;
    let played = golden::replay(&golden).map_err(failed)?;
    if let Some((first, last)) = played.difference {
        return Err(Error::NotGolden { path: path.to_owned(), first, last });
    }
    let name = path.file_stem().unwrap_or(path.as_os_str());
    let file = directory.join(name).with_added_extension(golden::EXTENSION);
    let text = directory.join(name).with_added_extension("txt");
    let unwritten = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Write { path, source }
    };
    fs::create_dir_all(directory).map_err(unwritten(directory))?;
    golden::write(&golden, &file).map_err(failed)?;
    replace(&text, played.summary.as_bytes()).map_err(unwritten(&text))?;
    let bytes = fs::metadata(&file).map_err(unwritten(&file))?.len();
    Ok(One { file, ticks: played.ticks, bytes, digest: played.digest.to_string() })
}

impl fmt::Display for Made {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.goldens.iter().try_for_each(|One { file, ticks, bytes, digest }| {
            let ticks = amount(*ticks, "tick");
            writeln!(f, "{}: {ticks}, {:.1} kB, digest {digest}", file.display(), *bytes as f64 / 1e3)
        })
    }
}
