//! Reads a log once, tick by tick; the other modules analyse the ticks.

use std::path::Path;

use closed_loop::{
    account::{Alarms, has_worked},
    chain::Processes,
    failure::{Failure, Watch},
};
use interfaces::{CommonMemory, ExternalInputs, hws::HwsReport};
use levels::ladder::Ladder;
use rcs_core::{plain::from_bytes, tick::Tick};
use record::{Log, ReadError, Timing, reader::LoggedTick};
use runtime::result::FailureResult;
use serde::Serialize;

use crate::Error;

pub struct Moment {
    pub tick: Tick,
    pub gap: u64, // number of missing ticks before it
    pub external: ExternalInputs,
    pub before: CommonMemory, // common memory at the start of the tick, which the processes read
    pub after: CommonMemory,  // common memory at the end of the tick, with the outputs of the processes
    pub timing: Option<Timing>, // timing of the tick, if recorded
    pub world: Option<u64>,   // digest of the simulated cell before the tick, if recorded
}

/// Opens a log, which must have this program's layout.
pub fn open(path: &Path) -> Result<Log, Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let log = Log::open(path).map_err(failed)?;
    log.check_layout().map_err(failed)?;
    if let Some(damage) = log.damage() {
        os_io::stderr_line!("rcs-log: {}: {damage}", path.display());
    }
    Ok(log)
}

/// Calls `each` for every tick of a log in order, until it returns false.
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

/// The ticks of a log up to its end or its damage, with the states of the processes where recorded.
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

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CommandStory {
    pub text: String,
    pub first_tick: u64, // tick in which Task took it
    pub last_tick: u64,  // tick in which it ended, or the last tick of the log
    pub status: String,
    /// The unconfirmed goals of a finished command; empty if the sensors confirm all goals.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unconfirmed: &'static str,
}

impl CommandStory {
    #[must_use]
    pub fn remark(&self) -> String {
        if self.unconfirmed.is_empty() {
            String::new()
        } else {
            format!(", unconfirmed: {}", self.unconfirmed)
        }
    }
}

/// The commands of a run, and its failure.
pub struct CommandHistory {
    /// Commands in order.
    pub commands: Vec<CommandStory>,
    pub failure: Option<Failure>, // the reason why the last failed command failed
    processes: Processes,
    watch: Box<Watch>,
    alarms: Alarms,
    number: u32,
    last: Option<HwsReport>,
}

/// A history that is used only for commands. It explains a failure with the tables of this program.
impl Default for CommandHistory {
    fn default() -> Self {
        Self::new(Ladder::processes())
    }
}

impl CommandHistory {
    /// An empty chronicle. `processes` are those of the log.
    pub fn new(processes: Processes) -> Self {
        Self {
            commands: Vec::new(),
            failure: None,
            processes,
            watch: Box::default(),
            alarms: Alarms::default(),
            number: 0,
            last: None,
        }
    }

    pub fn note(&mut self, moment: &Moment) {
        self.watch.observe(moment.tick, &moment.external, &moment.before, &moment.after);
        let status = &moment.after.task.status;
        if has_worked(&moment.before.task.status, status) {
            self.alarms.worked(moment.tick);
        }
        if status.echo != self.number {
            self.number = status.echo;
            self.last = None;
            self.commands.push(CommandStory {
                text: moment.external.hws.in_words().to_string(),
                first_tick: moment.tick.0,
                last_tick: moment.tick.0,
                status: String::new(),
                unconfirmed: "",
            });
        }
        let Some(command) = self.commands.last_mut() else { return };
        if self.last.is_none_or(|last| last == HwsReport::Executing) {
            command.last_tick = moment.tick.0;
            status.report.text().clone_into(&mut command.status);
            command.unconfirmed = status.unconfirmed.text();
        }
        if self.last != Some(status.report) && status.report == HwsReport::Error {
            self.failure = self.watch.failure(self.processes);
            self.failure.iter().cloned().for_each(|failure| self.alarms.failed(failure));
        }
        self.last = Some(status.report);
    }

    /// The failure as the run attached it at its end, or from the lines of a killed run. `None` without a failure.
    pub fn failed(&self, log: &Log) -> Option<FailureResult> {
        if let Some(failed) = FailureResult::of_log(log) {
            return failed;
        }
        let mut alarms = self.alarms.clone();
        for line in log.lines() {
            alarms.line(line.tick, &line.source, &line.code, &line.text);
        }
        let account = alarms.account()?;
        Some(FailureResult { account, line: None, remedy: None, chain: None })
    }
}
