//! Executes requests of operators between two ticks.

use std::path::{Component, Path};

use closed_loop::workstation::orders;
use diagnostics::JOBS;
use os_io::files;
use rcs_core::tick::Tick;
use record::OperatorLine;
use sessions::operator::Event;
use taskdata::load::{
    Job, Source,
    job::{JobLine, Step, Workstation},
};

use super::Run;
use crate::{
    judge::check_job,
    load::{Answer, LoadError, LoadSource},
    operator::{A_TICK, Input, Later, RequestContext, WORKSTATION},
};

/// Longest wait for a robot that is coming to rest after a motion by hand. It is less than the second for which the
/// sender of a request waits.
const REST_TICKS: u64 = 20;

impl Run {
    /// Executes an operator's event after a tick, for a run without other operators; it takes effect in the next tick.
    /// A session begins with [`Event::Connected`]. Errors: a refusal, the end of the run, or another source of inputs.
    pub fn ask(&mut self, who: &str, event: Event) -> Result<String, String> {
        if !self.asked.ask(who, event) {
            return Err("the operators of this run are elsewhere".to_owned());
        }
        self.step();
        self.asked
            .take_verdict()
            .unwrap_or_else(|| Err("the run has ended, or a block is being checked".to_owned()))
    }

    /// Execute the requests since the last tick. They take effect in the next tick.
    pub(super) fn operate(&mut self, tick: Tick) {
        let first = tick.next();
        if let Some(answer) = self.follow_load(tick) {
            self.loaded(tick, answer);
        }
        let mut awaited = self.operator.awaited();
        for _ in 0..A_TICK {
            let (input, since) = match awaited.take() {
                Some(awaited) => awaited,
                None => match self.asked.next(first) {
                    Some(input) => (input, tick),
                    None => break,
                },
            };
            let desk = self.closed.desk();
            let mut around = RequestContext {
                tick,
                memory: desk.memory,
                inputs: desk.inputs,
                store: desk.generations.next(desk.memory, None),
                gate: desk.gate,
                unchecked: self.config.unchecked,
                data: &self.config.data,
                neighbours: &mut self.neighbours,
                workstation: desk.workstation,
                loading: self.loads.is_loading(),
            };
            let verdict = self.operator.carry_out(&input, &mut around);
            let verdict = match (self.operator.take_later(), input.refusal()) {
                (None, _) => verdict,
                // In a repetition, the request has the tick of its execution.
                (Some(Later::Await), None) if input.is_of_a_session() && tick.since(since) < REST_TICKS => {
                    self.operator.keep(input, since);
                    continue;
                }
                (Some(Later::Await), _) => verdict,
                (Some(Later::Withdraw), _) => {
                    self.loads.withdraw(input.source());
                    verdict
                }
                // A log does not contain the text of an unreadable request.
                (Some(_), Some(why)) => Err(why.to_owned()),
                (Some(Later::Play(job)), None) => self.play(tick, &job),
                (Some(Later::Load(block)), None) => {
                    if let Some(answer) = self.load(block, LoadSource::Operator(input)) {
                        self.loaded(tick, answer);
                    }
                    continue;
                }
            };
            self.settle(first, input, verdict);
        }
        self.operator.end_tick(self.closed.workstation.cell.is_table_led_by_hand());
    }

    /// Execute the load that the workstation controller has requested. It takes effect in the next tick.
    pub(super) fn load_for_workstation(&mut self, tick: Tick) {
        let Some((block, line)) = self.neighbours.load_asked() else { return };
        let asker = LoadSource::Workstation(line);
        let answer = match self.asked.recorded_refusal() {
            Some(why) => Some((asker, Err(LoadError::Recorded(why)))),
            None => self.load(block, asker),
        };
        if let Some(answer) = answer {
            self.loaded(tick, answer);
        }
    }

    fn loaded(&mut self, tick: Tick, (asker, verdict): Answer) {
        match asker {
            LoadSource::Operator(input) => {
                self.settle(tick.next(), input, verdict.map_err(|error| error.to_string()));
            }
            LoadSource::Workstation(line) => {
                let verdict = verdict.map_err(|error| error.in_line());
                if let Some(log) = &mut self.log {
                    log.operator(OperatorLine {
                        tick: tick.next(),
                        source: WORKSTATION.to_owned(),
                        line,
                        answer: verdict.clone().unwrap_or_default(),
                        refused: verdict.clone().err(),
                    });
                }
                self.neighbours.load_answered(verdict.err());
            }
        }
    }

    fn settle(&mut self, first: Tick, input: Input, verdict: Result<String, String>) {
        self.operator.count(&input, &verdict);
        self.asked.keep(&verdict);
        let line = input.line(first, &verdict);
        if let Some(difference) = input.answer(first, &verdict) {
            self.observer.message(&format!("tick {first}: {difference}"));
        }
        if let (Some(log), Some(line)) = (&mut self.log, line) {
            log.operator(line);
        }
    }

    fn play(&mut self, tick: Tick, name: &str) -> Result<String, String> {
        let number = self.loads.played.saturating_add(1);
        let source = match self.asked.recorded_job(number) {
            Some(recorded) => recorded.ok_or("the log has no text of the job")?,
            None => job_named(name, &self.config.data)?,
        };
        let (job, _) = Job::from_source(source, self.closed.generations().current()).map_err(|report| {
            let errors: Vec<_> = report.errors().map(|error| error.to_string()).collect();
            format!("the job {name} has errors: {}", errors.join("; "))
        })?;
        self.can_be_played(&job)?;
        if !self.config.unchecked {
            check_job(&job, self.closed.generations().current(), None)
                .map_err(|error| format!("{error}: {}", error.details().trim_end().replace('\n', "; ")))?;
        }
        self.neighbours.job_under_way()?.play(tick, job.steps.clone()).map_err(|error| error.to_string())?;
        self.loads.played = number;
        if let Some(log) = &mut self.log {
            log.played(tick.next(), number, &job);
        }
        let lines = job.steps.len();
        self.job.steps = job.steps;
        Ok(format!("the job {name} plays, lines: {lines}"))
    }

    /// A job that is started during a run must load no blocks, not hand over, and need only what the cell has.
    fn can_be_played(&self, job: &Job) -> Result<(), String> {
        if job.steps.is_empty() {
            return Err(format!("the job {} has no line", job.name));
        }
        let cell = self.closed.workstation.cell.description();
        job.steps.iter().try_for_each(|JobLine { step, line, .. }| {
            let (Step::Workstation(action) | Step::After { action, .. }) = step else { return Ok(()) };
            let cannot = |why: String| Err(format!("line {line} of the job {}: {why}", job.name));
            match action {
                Workstation::Load { .. } => {
                    cannot("load blocks with `load OFFSET BLOCK`, or start the run with this job".to_owned())
                }
                Workstation::HandOver => cannot("start the run with this job".to_owned()),
                action => orders(action, cell)
                    .and_then(|orders| orders.iter().try_for_each(|order| cell.admits(order)))
                    .or_else(|error| cannot(error.to_string())),
            }
        })
    }
}

fn job_named(name: &str, data: &Path) -> Result<Source, String> {
    let mut parts = Path::new(name).components();
    if !matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None)) {
        let jobs = data.join(JOBS.directory);
        return Err(format!("the name of a job under {} was expected; found {name}", jobs.display()));
    }
    let path = JOBS.named(Path::new(name), data).map_err(|error| error.to_string())?;
    let text = files::read_text(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(Source { name: path.display().to_string(), text: text.into() })
}
