//! The outcome of a run.

use ::neighbours::workstation::player::BegunStep;
use closed_loop::chain::Chain;
use closed_loop::field::Field;
use os_io::shell;
use os_io::text::amount;
use rcs_core::tick::TICK_S;
use record::journal::Entry;

use super::Run;
use crate::{
    config::ClockKind,
    event::Event,
    field, pace,
    result::{
        self, CommandResult, EgmResult, EmergencyResult, FailureResult, FaultsResult, FieldResult,
        ItemResult, PortResult, RunResult, SIMULATED,
    },
    resume,
    verdict::Ending,
};

#[non_exhaustive]
pub struct RunOutcome {
    pub ending: Ending,
    pub result: RunResult,
    pub steps: Vec<BegunStep>, // all steps of the job, including actions of the workstation
    pub log: String,           // file and size of the log, or the reason why it ended, as text
    pub slowest: String,
    pub remedy: Option<&'static str>, // the operator's action before a failed job can continue
}

impl RunOutcome {
    /// True if the job has finished, every part is at its place, and no contact was a collision.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        matches!(self.ending, Ending::Finished)
    }
}

impl Run {
    /// End the run and its log. A run that has not ended is reported as stopped.
    #[must_use]
    pub fn finish(mut self) -> RunOutcome {
        let wall_s = self.started.map_or(0.0, |started| started.elapsed().as_secs_f64());
        self.end_field();
        let ending = self.ending.take().unwrap_or(Ending::Stopped);
        let ending = self.checked(ending);
        self.end_journal(&ending);
        let mut result = self.result(&ending, wall_s);
        let log = self.finish_log(&ending, &mut result);
        // Shared memory is removed first: a caller may start the next run of the same name at once.
        drop(self.mirror.take());
        drop(self.live.take());
        RunOutcome {
            result,
            steps: self.neighbours.all_steps(),
            log,
            slowest: pace::slowest(self.runner.stage_times()),
            remedy: self.remedy,
            ending,
        }
    }

    fn result(&mut self, ending: &Ending, wall_s: f64) -> RunResult {
        let ticks = self.closed.tick().0;
        let simulated_s = ticks as f64 * TICK_S;
        let ramp_ticks = self.ramp.as_ref().map_or(0, |ramp| ramp.ticks);
        let steps = self.neighbours.all_steps();
        // With real devices, the cell of this program does not show what has become of the parts.
        let is_judged = !self.closed.workstation.has_real_devices();
        let commands = steps.iter().filter(|step| step.is_command).map(|step| CommandResult {
            text: result::bare(&step.text),
            status: step.outcome.text(),
            unconfirmed: step.unconfirmed.text(),
            ticks: step.ticks,
        });
        RunResult {
            journal_trouble: self.journal_trouble.take(),
            job: self.job.name.clone(),
            ending: ending.word(),
            data: self.data.clone(),
            commands: commands.collect(),
            retries: self.neighbours.retried().iter().map(Into::into).collect(),
            ticks: ticks - u64::from(ramp_ticks),
            ramp_ticks,
            simulated_s,
            wall_s,
            realtime_factor: simulated_s / wall_s,
            overruns: self.pace.skipped(),
            overruns_by: self.pace.overruns(),
            allocations_after_start: self.runner.allocations(),
            tick_us: self.runner.times().summary().into(),
            part_us: pace::times(self.runner.stage_times()),
            late_us: self.pace.late(),
            realtime: self.pace.verdict(),
            boards: self.closed.course().levels().results(),
            link: (&self.closed.memory().t3i.status.counters).into(),
            operator: self.operator.requests(),
            faults: self.closed.line().faults().map(FaultsResult::from),
            field: self.field_result(),
            cell_faults: self.closed.workstation.cell.faults().into_iter().map(Into::into).collect(),
            port: self.robot.port().map(PortResult::from),
            egm: self.robot.egm().map(EgmResult::from),
            emergency_stop: self.closed.workstation.last_emergency().map(EmergencyResult::from),
            digest: self.closed.digest().to_string(),
            simulated: (self.robot.is_elsewhere() && is_judged).then_some(SIMULATED),
            digest_before_ramp: self
                .ramp
                .as_ref()
                .map_or_else(|| self.closed.digest(), |ramp| ramp.before)
                .to_string(),
            parts: if is_judged { self.closed.workstation.cell.parts() } else { Vec::new() },
            data_base: self.items(),
            truth: self.closed.workstation.is_whole().then(|| self.closed.truth().result().clone()),
            contacts: if is_judged { self.closed.contacts().collisions().to_vec() } else { Vec::new() },
            clearance: self.closed.contacts().nearest().filter(|_| is_judged).cloned(),
            events: std::mem::take(&mut self.events),
            log: None,
            failure: match ending {
                Ending::Failed(account) => {
                    let line = self.neighbours.line_at(account.first.tick);
                    Some(FailureResult {
                        account: account.clone(),
                        line: line.map(str::to_owned),
                        remedy: self.remedy.map(str::to_owned),
                        chain: Some(Chain::of(account, &self.history)),
                    })
                }
                Ending::Finished | Ending::Stopped | Ending::StoppedByUser => None,
            },
        }
    }

    /// End the couplers: their outputs become safe and are read back.
    fn end_field(&mut self) {
        let (tick, inputs) = (self.closed.tick(), *self.closed.inputs());
        let Some(field) = self.closed.workstation.field.as_deref_mut() else { return };
        match (field, &mut self.field) {
            (Field::Simulated(field), _) => field.end(&inputs),
            (Field::External(desk), Some(port)) => port.end(desk, &inputs),
            (Field::External(_), None) => {}
        }
        let events = self.closed.workstation.field.as_deref_mut().map(|field| field.desk_mut().take_events());
        for event in events.into_iter().flatten().map(Event::Field) {
            self.observer.message(&event.to_string());
            self.log_event(tick.next(), &event);
            self.events.push(tick, &event);
        }
    }

    fn field_result(&self) -> Option<FieldResult> {
        let desk = self.closed.workstation.field.as_deref()?.desk();
        let simulated = field::simulated(&self.config, desk.mapping());
        Some(FieldResult::new(desk, simulated, self.field.as_ref()))
    }

    /// Write the last entry of the journal. A finished run leaves nothing to resume.
    fn end_journal(&mut self, ending: &Ending) {
        let Some(journal) = self.journal.take() else { return };
        let clock = if self.config.clock == ClockKind::Real { resume::now() } else { 0 };
        let over = matches!(ending, Ending::Finished);
        let entry = Entry { over, ..resume::entry(&self.closed, self.neighbours.job(), clock) };
        let path = journal.path().to_owned();
        self.journal_trouble = journal
            .finish(Some(&entry))
            .map(|why| format!("the journal {} is incomplete: {why}", path.display()));
    }

    fn items(&mut self) -> Vec<ItemResult> {
        let items = match (self.closed.books_mut(), self.neighbours.data_system()) {
            (Some(books), _) => books.items(),
            (None, Some(elsewhere)) => elsewhere.items(),
            (None, None) => Ok(Vec::new()),
        };
        let items = items.inspect_err(|why| {
            self.observer.message(&format!("the items cannot be listed: {why}"));
        });
        items.unwrap_or_default().into_iter().map(Into::into).collect()
    }

    /// End the log and describe it. A finished job stays finished if its log could not be written.
    fn finish_log(&mut self, ending: &Ending, result: &mut RunResult) -> String {
        self.show_state();
        let Some(mut log) = self.log.take() else { return "none".to_owned() };
        let tick = self.closed.tick().next();
        if let Ending::Failed(account) = ending {
            for sentence in account.sentences() {
                log.event(tick, &Event::WentWrong(sentence));
            }
        }
        if let Some(failure) = &result.failure {
            log.failure(tick, failure);
        }
        let outcome = ending.text().into_owned();
        let path = self.log_path.take();
        match log.finish(self.closed.digest(), outcome, result.facts()) {
            Ok(summary) => {
                result.log = path;
                let (file, size) = (shell::path(&summary.path), summary.bytes as f64 / 1e6);
                let lost = match summary.lost.ticks {
                    0 => String::new(),
                    lost => format!("; no room for {}", amount(lost, "tick")),
                };
                let earlier = match summary.earlier {
                    0 => String::new(),
                    earlier => format!("; {} before, under the times of their ends", amount(earlier, "log")),
                };
                format!("{file} ({size:.1} MB{lost}{earlier})")
            }
            Err(error) => {
                self.observer.message(&format!("the log ended before the run did: {error}"));
                format!("{} is incomplete: {error}", path.map(shell::path).unwrap_or_default())
            }
        }
    }
}
