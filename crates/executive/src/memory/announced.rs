//! The announcement of a run, so that other programs find it while it waits, perhaps for hours, before its first tick.
//! It takes the role [`RUN`] and writes a phrase about its state into its directory.

use std::{fs, path::PathBuf};

use super::{
    error::SharedMemoryError,
    name::RunName,
    place::{have_salt, layout, lock, own_directory, place, prefix},
    presence::{self, Presence},
    publish::PUBLISHER,
    runs,
};

const RUN: &str = "run"; // the role of the program that has announced a run
const PHASE: &str = "phase"; // file of the phrase, in the directory of a run
const LONGEST: u64 = 1024; // longest phrase that is read, bytes
/// Names that are tried for a run without a given name. A program with several runs of a job needs more than one.
const NAMES: u32 = 100;

/// Announces a run until it is dropped. Drop it after the publisher of the run.
pub struct Announced {
    name: RunName,
    presence: Option<Presence>,
}

impl Announced {
    /// Announce a run of this name. Fails with [`SharedMemoryError::NameInUse`] if a living run has the name.
    pub fn named(name: RunName) -> Result<Self, SharedMemoryError> {
        let _lock = lock()?;
        have_salt()?;
        let (place, prefix) = (place(&name, &layout()), prefix(&name, &layout()));
        if presence::is_held(&prefix, RUN) || presence::is_held(&prefix, PUBLISHER) {
            let phase = phase(&name).unwrap_or_else(|| "runs".to_owned());
            return Err(SharedMemoryError::NameInUse { run: name, phase });
        }
        runs::remove_remains(&name, &layout())?;
        let presence = Presence::enter(&prefix, RUN)?;
        own_directory(place)?;
        let announced = Self { name, presence: Some(presence) };
        announced.say("starts");
        Ok(announced)
    }

    pub fn of_job(job: &str) -> Result<Self, SharedMemoryError> {
        let first = RunName::unique(job);
        let mut last = Self::named(first.clone());
        for number in 1..NAMES {
            if !matches!(last, Err(SharedMemoryError::NameInUse { .. })) {
                break;
            }
            last = Self::named(first.numbered(number));
        }
        last
    }

    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Set the run's state, as a phrase after its name, for other programs.
    pub fn say(&self, phase: &str) {
        let path = path(&self.name);
        let new = path.with_extension("new");
        let _ = fs::write(&new, phase).and_then(|()| fs::rename(&new, &path));
    }
}

impl Drop for Announced {
    fn drop(&mut self) {
        drop(self.presence.take());
        // A reader keeps the files; `rcs-run clean` handles a failure.
        let _ = runs::remove_if_deserted(&self.name, &layout());
    }
}

fn path(name: &RunName) -> PathBuf {
    place(name, &layout()).join(PHASE)
}

#[must_use]
pub fn phase(name: &RunName) -> Option<String> {
    let path = path(name);
    // Another program of this user may have written anything there.
    let is_short = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file() && found.len() <= LONGEST);
    let phase = is_short.then(|| fs::read_to_string(&path).ok()).flatten()?;
    Some(phase.chars().filter(|c| !c.is_control()).collect())
}

/// State of a living run that has not published its buffers yet; `None` for any other run.
#[must_use]
pub fn starting(name: &RunName) -> Option<String> {
    let starts = runs::is_there(name, RUN) && !runs::is_there(name, PUBLISHER);
    starts.then(|| phase(name).unwrap_or_else(|| "starts".to_owned()))
}
