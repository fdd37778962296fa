//! The file to which a campaign appends each judged branch, so that a stopped campaign can continue.
//!
//! Each line is a JSON object: the campaign, the branch, and the rows and states that it was the first to reach. A
//! drawn branch lists all. A campaign reads only lines with its own undisturbed run, program and procedure.

use std::{
    borrow::Cow,
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{self, Read as _, Seek as _, Write as _},
    path::{Path, PathBuf},
};

use crate::pages::VERSION;
use rcs_core::digest::Digest;
use runtime::StartError;
use serde::{Deserialize, Serialize};

use super::{
    branch::Facility, coverage::Coverage, parent::Parent, pool::Plan, trial::Procedure, verdict::BranchResult,
};
use crate::rcs_run::error::Error;

#[derive(Deserialize, Serialize)]
struct Line<'a> {
    campaign: String,
    #[serde(flatten)]
    branch: Cow<'a, BranchResult>,
    #[serde(flatten)]
    met: Cow<'a, Coverage>,
}

/// The branches judged before, and the file to which new ones are appended, if any.
#[derive(Debug, Default)]
pub struct Journal {
    file: Option<(PathBuf, File)>,
    campaign: String,
    known: HashMap<(u64, String), Judged>,
}

pub type Judged = (BranchResult, Coverage);

/// Identifies a campaign: equal branches of the same campaign end the same way.
#[must_use]
pub fn campaign(facility: &Facility, parent: &Parent, procedure: Procedure, drawn: bool) -> String {
    let Procedure { recovery, tries, until } = procedure;
    format!(
        "{} seed {} digest {}{} by {VERSION}: {recovery:?}, {tries} tries, judged at {until:?}{}",
        facility.job.name,
        facility.seed,
        parent.digest,
        couplers(facility),
        if drawn { ", drawn" } else { "" }
    )
}

/// The digest of the mapping, if there is one.
fn couplers(facility: &Facility) -> String {
    facility.mapping.as_ref().map_or_else(String::new, |mapping| {
        let mut digest = Digest::new();
        digest.add(format!("{mapping:?}").as_bytes());
        format!(" couplers {digest}")
    })
}

impl Journal {
    /// Read the lines of a campaign from the file, or create it. An incomplete last line is removed.
    pub fn open(path: &Path, campaign: &str) -> Result<Self, Error> {
        let read = |source| StartError::Read { path: path.to_owned(), source };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(read)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(read)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let mut journal = Self { campaign: campaign.to_owned(), ..Self::default() };
        for (number, line) in (1_usize..).zip(text[..whole].lines()) {
            let line: Line<'_> = serde_json::from_str(line).map_err(|error| {
                Error::Campaign(format!(
                    "{}:{number}: expected a branch of a campaign: {error}; name another file with --journal, or \
                     remove the line",
                    path.display()
                ))
            })?;
            if line.campaign == campaign {
                let branch = line.branch.into_owned();
                let place = (branch.at, branch.interruption.clone());
                journal.known.insert(place, (branch, line.met.into_owned()));
            }
        }
        let write = |source| Error::Write { path: path.to_owned(), source };
        file.set_len(whole as u64).and_then(|()| file.seek(io::SeekFrom::End(0))).map_err(write)?;
        journal.file = Some((path.to_owned(), file));
        Ok(journal)
    }

    #[must_use]
    pub fn known(&self, plan: &Plan) -> Option<&Judged> {
        self.known.get(&(plan.at, plan.series.to_string()))
    }

    pub fn write(&self, result: &BranchResult, met: &Coverage) -> Result<(), Error> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let (branch, met) = (Cow::Borrowed(result), Cow::Borrowed(met));
        let line = Line { campaign: self.campaign.clone(), branch, met };
        let mut text = serde_json::to_string(&line).map_err(io::Error::from)?;
        text.push('\n');
        // One write per line: lines of several threads do not mix.
        (&*file).write_all(text.as_bytes()).map_err(|source| Error::Write { path: path.clone(), source })
    }
}
