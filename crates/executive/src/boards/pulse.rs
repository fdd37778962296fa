//! The system pulse (II.2.3) and the stamps that answer it.
//!
//! Board 0 owns the service `pulse`: the facts of the run ([`RunCard`]), and each tick's number and external inputs
//! ([`SystemPulse`]). Each board owns a service with its [`BoardReport`], which it writes last in a tick. Two event
//! services wake the processes; events carry no data.

use std::{fmt::Debug, time::Duration};

use iceoryx2::{
    node::Node,
    port::{listener::Listener, notifier::Notifier},
    prelude::ipc,
    service::port_factory::event,
};
use interfaces::ExternalInputs;
use rcs_core::{Plain, digest::Digest, plain::DecodeError, tick::Tick};
use taskdata::load::Source;

use super::{BOARDS, Board, exchange::READERS};
use crate::memory::{
    SharedMemoryError,
    layout::{Epoch, layout_version},
    runs::service_name,
    slot::{self, NewService, ServiceReader, SlotReader, SlotWriter},
};

/// Epoch of the services of board 0, which is never replaced: a run ends with it.
const BOARD_0: Epoch = 1;

/// Fingerprint of a program and its data: boards with different fingerprints must not run together.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Fingerprint {
    /// Fingerprint of the program: its version control revision, and the layout of all buffers.
    pub program: u64,
    /// Fingerprint of the task data.
    pub data: u64,
    /// Fingerprint of the job, including the blocks that it loads during the run.
    pub job: u64,
}

impl Fingerprint {
    #[must_use]
    pub fn of<'a>(
        commit: &str,
        data: impl IntoIterator<Item = &'a Source>,
        job: impl IntoIterator<Item = &'a Source>,
    ) -> Self {
        let mut program = Digest::new();
        program.add(commit.as_bytes());
        program.add(&layout_version().to_le_bytes());
        let texts = |sources: &mut dyn Iterator<Item = &'a Source>| {
            let mut digest = Digest::new();
            sources.for_each(|source| digest.add(source.text.as_bytes()));
            digest.value()
        };
        Self {
            program: program.value(),
            data: texts(&mut data.into_iter()),
            job: texts(&mut job.into_iter()),
        }
    }

    /// The difference from the fingerprint of the run, as text; `None` if they are equal.
    #[must_use]
    pub fn difference(&self, run: &Self) -> Option<&'static str> {
        if self.program != run.program {
            Some("it was built from other sources")
        } else if self.data != run.data {
            Some("it has other task data: name the run's directory with --data")
        } else if self.job != run.job {
            Some("it has another job: name the run's job")
        } else {
            None
        }
    }
}

/// Facts of the run that a board needs before the first tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RunCard {
    /// The fingerprint that every board must have.
    pub fingerprint: Fingerprint,
    /// True if ticks come every 40 ms: boards make the real-time requests.
    pub real_time: bool,
    /// The tick after which the run starts: later than [`Tick::BEFORE_START`] if it is resumed.
    pub start: Tick,
}

/// The epoch of each board, in the order of [`Board::ALL`].
pub type Epochs = [Epoch; BOARDS];

/// One pulse.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SystemPulse {
    /// The tick to run; [`RunCard::start`] until all boards have joined.
    pub tick: Tick,
    /// True if the run is over: boards end.
    pub over: bool,
    /// The present epoch of each board.
    pub epochs: Epochs,
    /// The load that boards must check in parallel with their ticks ([`load_file`](crate::memory::load_file)); 0 for
    /// none.
    pub load: u32,
    /// The last load in effect. Earlier loads are also in effect, unless they were refused.
    pub loaded: u32,
    /// External inputs of the tick.
    pub external: ExternalInputs,
}

/// Result of a board's check of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Checked {
    /// The load.
    pub load: u32,
    /// [`Fingerprint::data`] of the task data that include this load; 0 if the load has errors or could not be read.
    pub data: u64,
}

/// Report of a board after each tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct BoardReport {
    /// Fingerprint of its program, data and job.
    pub fingerprint: Fingerprint,
    /// Its process id.
    pub pid: u32,
    /// True if it reads all its neighbours and waits for pulses; false after it has left.
    pub ready: bool,
    /// True if the system granted all its real-time requests, or it made none.
    pub punctual: bool,
    /// Heap allocations in its ticks so far.
    pub allocations: u64,
    /// Time from its wake-up to its stamp in the last tick, ns.
    pub step_ns: u64,
    /// The last load that it has checked.
    pub checked: Checked,
}

const PULSE: u32 = 0;
const CARD: u32 = 1;
const REPORT: u32 = 0; // key of the only slot of a board's service

const PULSE_SERVICE: &str = "pulse";
const WAKE: &str = "pulse/wake";
const DONE: &str = "pulse/done";

fn failed(service: &'static str) -> impl Fn(&dyn Debug) -> SharedMemoryError {
    move |what| SharedMemoryError::service(service, what)
}

fn event(
    node: &Node<ipc::Service>,
    service: &'static str,
) -> Result<event::PortFactory<ipc::Service>, SharedMemoryError> {
    node.service_builder(&service_name(service, BOARD_0)?)
        .event()
        .max_listeners(READERS)
        .max_notifiers(READERS)
        .max_nodes(READERS + 1)
        .open_or_create()
        .map_err(|error| failed(service)(&error))
}

fn listener(
    node: &Node<ipc::Service>,
    service: &'static str,
) -> Result<Listener<ipc::Service>, SharedMemoryError> {
    event(node, service)?.listener_builder().create().map_err(|error| failed(service)(&error))
}

fn notifier(
    node: &Node<ipc::Service>,
    service: &'static str,
) -> Result<Notifier<ipc::Service>, SharedMemoryError> {
    event(node, service)?.notifier_builder().create().map_err(|error| failed(service)(&error))
}

/// Sleep until a notification comes or the time has passed. A signal ends the sleep early.
pub(super) fn sleep(listener: &Listener<ipc::Service>, at_most: Duration) {
    // Without a working listener the caller checks more often, but does not busy-wait.
    if listener.timed_wait(|_| (), at_most).is_err() {
        std::thread::sleep(at_most.min(Duration::from_millis(1)));
    }
}

pub(super) struct PulseGiver {
    pulse: SlotWriter<{ slot::size::<SystemPulse>() }, SystemPulse>,
    wake: Notifier<ipc::Service>,
    pub(super) done: Listener<ipc::Service>,
}

impl PulseGiver {
    pub(super) fn create(
        node: &Node<ipc::Service>,
        card: &RunCard,
        first: &SystemPulse,
    ) -> Result<Self, SharedMemoryError> {
        let service = NewService::new(node, PULSE_SERVICE, BOARD_0, READERS)?
            .slot::<{ slot::size::<SystemPulse>() }, _>(PULSE, first.tick, first)
            .slot::<{ slot::size::<RunCard>() }, _>(CARD, first.tick, card)
            .create()?;
        let pulse = service.slot(PULSE)?;
        Ok(Self { pulse, wake: notifier(node, WAKE)?, done: listener(node, DONE)? })
    }

    /// Write a pulse and wake the boards.
    pub(super) fn give(&mut self, pulse: &SystemPulse) {
        self.pulse.write(pulse.tick, pulse);
        self.wake();
    }

    /// Wake the boards once more. A missing stamp reveals a board that cannot be woken.
    pub(super) fn wake(&self) {
        let _ = self.wake.notify();
    }
}

pub(super) struct PulseTaker {
    pulse: SlotReader<{ slot::size::<SystemPulse>() }, SystemPulse>,
    card: SlotReader<{ slot::size::<RunCard>() }, RunCard>,
    pub(super) wake: Listener<ipc::Service>,
    done: Notifier<ipc::Service>,
}

impl PulseTaker {
    pub(super) fn open(node: &Node<ipc::Service>) -> Result<Self, SharedMemoryError> {
        let service = ServiceReader::open(node, PULSE_SERVICE, BOARD_0)?;
        Ok(Self {
            pulse: service.slot(PULSE)?,
            card: service.slot(CARD)?,
            wake: listener(node, WAKE)?,
            done: notifier(node, DONE)?,
        })
    }

    pub(super) fn card(&self) -> Result<RunCard, DecodeError> {
        self.card.read().map(|(_, card)| card)
    }

    pub(super) fn pulse(&self) -> Result<SystemPulse, DecodeError> {
        self.pulse.read().map(|(_, pulse)| pulse)
    }

    /// Notify board 0 that there is a stamp to read. If this fails, board 0 soon checks by itself.
    pub(super) fn done(&self) {
        let _ = self.done.notify();
    }
}

pub(super) struct ReportWriter(SlotWriter<{ slot::size::<BoardReport>() }, BoardReport>);

impl ReportWriter {
    pub(super) fn create(
        node: &Node<ipc::Service>,
        board: Board,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        NewService::new(node, board.name(), epoch, READERS)?
            .slot::<{ slot::size::<BoardReport>() }, _>(REPORT, Tick::BEFORE_START, &BoardReport::ZERO)
            .create()?
            .slot(REPORT)
            .map(Self)
    }

    /// Write the report and stamp `tick`: it is done.
    pub(super) fn write(&mut self, tick: Tick, report: &BoardReport) {
        self.0.write(tick, report);
    }
}

pub(super) struct ReportReader(SlotReader<{ slot::size::<BoardReport>() }, BoardReport>);

impl ReportReader {
    pub(super) fn open(
        node: &Node<ipc::Service>,
        board: Board,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        ServiceReader::open(node, board.name(), epoch)?.slot(REPORT).map(Self)
    }

    pub(super) fn read(&self) -> Result<(Tick, BoardReport), DecodeError> {
        self.0.read()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source { name: "x".into(), text: text.into() }
    }

    #[test]
    fn fingerprints_of_program_data_and_job_differ() {
        let of = |commit, data, job| Fingerprint::of(commit, [&source(data)], [&source(job)]);
        let run = of("abc", "1", "2");
        assert_eq!(of("abc", "1", "2").difference(&run), None);
        for (other, word) in [
            (of("abd", "1", "2"), "sources"),
            (of("abc", "3", "2"), "task data"),
            (of("abc", "1", "3"), "job"),
        ] {
            assert!(other.difference(&run).is_some_and(|text| text.contains(word)), "{word}");
        }
    }
}
