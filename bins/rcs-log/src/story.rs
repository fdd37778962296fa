//! A log read once, tick by tick: what the other modules ask their questions of.

use std::path::Path;

use executive::failure::{Failure, Watch};
use interfaces::{CommonMemory, ExternalInputs, hws::HwsReport};
use levels::ladder::Ladder;
use rcs_core::{plain::from_bytes, tick::Tick};
use record::{Log, ReadError, Timing, reader::LoggedTick, remarks::hws_text};
use serde::Serialize;

use crate::Error;

/// A tick with its records decoded.
pub struct Moment {
    /// The tick.
    pub tick: Tick,
    /// Ticks that are missing before it.
    pub gap: u64,
    /// What came from outside.
    pub external: ExternalInputs,
    /// What the processes read: common memory as the tick before left it.
    pub before: CommonMemory,
    /// What they wrote.
    pub after: CommonMemory,
    /// How punctual the tick was, where the log says so.
    pub timing: Option<Timing>,
    /// Fingerprint of the simulated cell before the tick, where the log has it.
    pub world: Option<u64>,
}

/// Open a log whose layout is ours.
pub fn open(path: &Path) -> Result<Log, Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let log = Log::open(path).map_err(failed)?;
    log.check_layout().map_err(failed)?;
    if let Some(damage) = log.damage() {
        os_io::stderr_line!("rcs-log: {}: {damage}", path.display());
    }
    Ok(log)
}

/// Show `each` every tick of a log in order, until it returns false.
pub fn walk(log: &Log, path: &Path, mut each: impl FnMut(&Moment) -> bool) -> Result<(), Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let mut before = CommonMemory::default();
    for logged in log.ticks() {
        let moment = decode(&logged.map_err(failed)?, before).map_err(failed)?;
        before = moment.after;
        if !each(&moment) {
            break;
        }
    }
    Ok(())
}

/// The ticks of a log up to its end or its damage, with the states where they were recorded.
pub fn moments(log: &Log) -> impl Iterator<Item = (Moment, Option<Vec<u8>>)> {
    let mut before = CommonMemory::default();
    log.ticks().map_while(move |logged| {
        let logged = logged.ok()?;
        let moment = decode(&logged, before).ok()?;
        before = moment.after;
        Some((moment, logged.state))
    })
}

fn decode(logged: &LoggedTick, before: CommonMemory) -> Result<Moment, ReadError> {
    let damaged = |_| ReadError::Damaged { tick: logged.tick.0 };
    Ok(Moment {
        tick: logged.tick,
        gap: logged.gap,
        external: from_bytes(&logged.external).map_err(damaged)?,
        before,
        after: from_bytes(&logged.memory).map_err(damaged)?,
        timing: logged.timing,
        world: logged.world,
    })
}

/// A command of the workstation controller as the log shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CommandStory {
    /// As people write it.
    pub text: String,
    /// Tick in which Task took it.
    pub first_tick: u64,
    /// Tick in which it ended, or the last one of the log.
    pub last_tick: u64,
    /// How it ended.
    pub status: String,
}

/// The commands of a run, and its failure if Task reported one.
#[derive(Default)]
pub struct Chronicle {
    /// Commands in their order.
    pub commands: Vec<CommandStory>,
    /// Why the last failing command failed.
    pub failure: Option<Failure>,
    watch: Box<Watch>,
    number: u32,
    last: Option<HwsReport>,
}

impl Chronicle {
    /// Take a tick in.
    pub fn note(&mut self, moment: &Moment) {
        self.watch.observe(moment.tick, &moment.external, &moment.before, &moment.after);
        let status = &moment.after.task.status;
        if status.echo != self.number {
            self.number = status.echo;
            self.last = None;
            self.commands.push(CommandStory {
                text: hws_text(&moment.external.hws),
                first_tick: moment.tick.0,
                last_tick: moment.tick.0,
                status: String::new(),
            });
        }
        let Some(command) = self.commands.last_mut() else { return };
        if self.last.is_none_or(|last| last == HwsReport::Executing) {
            command.last_tick = moment.tick.0;
            status.report.text().clone_into(&mut command.status);
        }
        if self.last != Some(status.report) && status.report == HwsReport::Error {
            self.failure = self.watch.failure(Ladder::processes());
        }
        self.last = Some(status.report);
    }
}
