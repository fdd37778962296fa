//! Sources of an operator's inputs: sessions, or a log.

use std::{collections::VecDeque, path::Path};

use executive::memory::{RunName, operator_socket};
use rcs_core::tick::Tick;
use record::{Attachment, Log, OperatorLine, Part};
use sessions::operator::{Entrance, Event, Given, Listener};
use taskdata::load::Source;

use super::request::is_question;
use crate::{
    config::{ClockKind, OperatorAccess, RunConfig},
    error::StartError,
    observer::Observer,
};

pub enum Inputs {
    None,
    Sessions(Listener),
    /// A log, read tick by tick, with the texts that were loaded during the run.
    Recorded(VecDeque<OperatorLine>, Texts),
    /// The program that runs the tick (`Run::ask`): requests for the next tick, and the last verdict.
    Program(VecDeque<(String, Event)>, Option<Result<String, String>>),
}

#[derive(Default)]
pub struct Texts {
    blocks: Vec<(u32, Source)>, // blocks, by the generation of the task data that each created
    jobs: Vec<(u32, Source)>,
    /// The log's verdicts on loads of the workstation controller, which requests them again in a repetition.
    workstation: VecDeque<OperatorLine>,
    end: Tick, // the last tick of the log
}

/// Source of the loads that the workstation controller requests; no operator can have this name.
pub const WORKSTATION: &str = "workstation controller";

pub enum Input {
    Given(Given),
    Recorded(OperatorLine, Event),
    Program(String, Event), // an input of the program that runs the tick
}

impl Input {
    pub fn source(&self) -> &str {
        match self {
            Self::Given(given) => given.source.as_str(),
            Self::Recorded(line, _) => &line.source,
            Self::Program(source, _) => source,
        }
    }

    /// True if it is from a session, which waits for the answer.
    pub const fn is_of_a_session(&self) -> bool {
        matches!(self, Self::Given(_))
    }

    /// The input, marked as late if it is from a session that no longer waits for the answer.
    pub fn judged(self) -> Self {
        match self {
            Self::Given(given) => Self::Given(given.judged()),
            other => other,
        }
    }

    pub const fn event(&self) -> &Event {
        match self {
            Self::Given(given) => &given.event,
            Self::Recorded(_, event) | Self::Program(_, event) => event,
        }
    }

    /// The reason of a refusal in the log, if the log refused the input.
    pub fn refusal(&self) -> Option<&str> {
        match self {
            Self::Given(_) | Self::Program(..) => None,
            Self::Recorded(line, _) => line.refused.as_deref(),
        }
    }

    /// True if it changes nothing.
    pub fn is_question(&self) -> bool {
        self.event().line().is_some_and(is_question)
    }

    /// Its line in the log, with the first tick in which it has an effect; `None` if it changes nothing.
    pub fn line(&self, tick: Tick, verdict: &Result<String, String>) -> Option<OperatorLine> {
        (!self.is_question()).then(|| OperatorLine {
            tick,
            source: self.source().to_owned(),
            line: self.event().to_string(),
            answer: verdict.clone().unwrap_or_default(),
            refused: verdict.clone().err(),
        })
    }

    /// Answer it. Returns a verdict in a repetition that differs from that of the log.
    pub fn answer(self, tick: Tick, verdict: &Result<String, String>) -> Option<String> {
        match self {
            Self::Given(given) => {
                let ok = |text: &String| {
                    if text.is_empty() { format!("tick {tick}") } else { format!("tick {tick}: {text}") }
                };
                given.answer(verdict.as_ref().map(ok).map_err(Clone::clone));
                None
            }
            Self::Program(..) => None,
            Self::Recorded(line, _) => {
                let (was, is) = (line.refused.as_deref(), verdict.as_ref().err().map(String::as_str));
                (was != is).then(|| {
                    let said = |why: Option<&str>| {
                        why.map_or("was taken".to_owned(), |why| format!("was refused: {why}"))
                    };
                    format!("`{}` {} in the log, and now {}", line.line, said(was), said(is))
                })
            }
        }
    }
}

impl Inputs {
    /// Operators can connect to a run on the 40 ms grid that has shared memory.
    pub fn of(config: &RunConfig, name: &RunName, observer: &mut dyn Observer) -> Result<Self, StartError> {
        if let Some(path) = &config.inputs {
            return Self::recorded(path, observer);
        }
        let can_connect = config.shared_memory && config.clock == ClockKind::Real;
        if config.operator == OperatorAccess::None || !can_connect {
            return Ok(Self::None);
        }
        let path = operator_socket(name);
        match Listener::start(&path, name.as_str()) {
            Ok(listener) => Ok(Self::Sessions(listener)),
            Err(source) if config.stand_by || config.resume.is_some() => {
                Err(StartError::NoOperator { path, source })
            }
            Err(error) => {
                observer.message(&format!("no operator can connect: {}: {error}", path.display()));
                Ok(Self::None)
            }
        }
    }

    fn recorded(path: &Path, observer: &mut dyn Observer) -> Result<Self, StartError> {
        let log = Log::open(path).map_err(|source| StartError::Inputs(Box::new(source)))?;
        match log.part() {
            Some(part @ Part::Later { .. }) => {
                return Err(StartError::LaterInputs { path: path.to_owned(), part });
            }
            Some(part @ Part::First { .. }) => observer.message(&format!(
                "{}: {part}: the operator's inputs after it are not replayed",
                path.display()
            )),
            None => {}
        }
        let end = log.last_tick().unwrap_or_default();
        let (workstation, operators) = log.operator_lines().partition(|line| line.source == WORKSTATION);
        let texts = Texts {
            blocks: log.attachments.iter().filter_map(Attachment::as_reload).collect(),
            jobs: log.attachments.iter().filter_map(Attachment::as_played).collect(),
            workstation,
            end,
        };
        Ok(Self::Recorded(operators, texts))
    }

    #[must_use]
    pub fn socket(&self) -> Option<&Path> {
        match self {
            Self::Sessions(listener) => Some(listener.path()),
            Self::None | Self::Recorded(..) | Self::Program(..) => None,
        }
    }

    #[must_use]
    pub fn entrance(&self) -> Option<Entrance> {
        match self {
            Self::Sessions(listener) => Some(listener.entrance()),
            Self::None | Self::Recorded(..) | Self::Program(..) => None,
        }
    }

    /// The block in a log for a generation of the task data; `None` if the inputs are not from a log.
    #[must_use]
    pub fn recorded_block(&self, generation: u32) -> Option<Option<Source>> {
        let Self::Recorded(_, texts) = self else { return None };
        let found = texts.blocks.iter().find(|(number, _)| *number == generation);
        Some(found.map(|(_, source)| source.clone()))
    }

    /// The reason why the log has refused the next load of the workstation controller, if it has.
    pub fn recorded_refusal(&mut self) -> Option<String> {
        let Self::Recorded(_, texts) = self else { return None };
        texts.workstation.pop_front()?.refused
    }

    #[must_use]
    pub fn have_ended(&self, tick: Tick) -> bool {
        matches!(self, Self::Recorded(lines, texts) if lines.is_empty() && tick >= texts.end)
    }

    /// The job with this number in a log; `None` if the inputs are not from a log.
    #[must_use]
    pub fn recorded_job(&self, played: u32) -> Option<Option<Source>> {
        let Self::Recorded(_, texts) = self else { return None };
        let found = texts.jobs.iter().find(|(number, _)| *number == played);
        Some(found.map(|(_, source)| source.clone()))
    }

    /// Queue a request of the program that runs the tick. Returns false if the inputs have another source.
    pub fn ask(&mut self, source: &str, event: Event) -> bool {
        if matches!(self, Self::None) {
            *self = Self::Program(VecDeque::new(), None);
        }
        let Self::Program(requests, _) = self else { return false };
        requests.push_back((source.to_owned(), event));
        true
    }

    pub fn keep(&mut self, verdict: &Result<String, String>) {
        if let Self::Program(_, last) = self {
            *last = Some(verdict.clone());
        }
    }

    pub const fn take_verdict(&mut self) -> Option<Result<String, String>> {
        if let Self::Program(_, last) = self { last.take() } else { None }
    }

    pub fn next(&mut self, tick: Tick) -> Option<Input> {
        match self {
            Self::None => None,
            Self::Sessions(listener) => listener.try_next().map(Input::Given),
            Self::Recorded(lines, _) => {
                let line = lines.pop_front_if(|line| line.tick <= tick)?;
                let event = Event::from(line.line.as_str());
                Some(Input::Recorded(line, event))
            }
            Self::Program(requests, _) => {
                requests.pop_front().map(|(source, event)| Input::Program(source, event))
            }
        }
    }
}
