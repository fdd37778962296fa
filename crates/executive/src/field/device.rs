//! A device with its thread. The thread exchanges data twice per tick: 1 ms after a slot of the run's clock, with the
//! outputs of its tick, and 8 ms before the next one, for fresh inputs. It keeps the grid by itself, since waking it
//! would take up the run's time.

use std::{
    io,
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use couplers::{InWords, Mode, Orders, OutWords, Plan, PlanError, Report, Session, State};
use os_io::alloc::Section;
use rcs_core::Plain;

use crate::{
    clock::{Monotonic, SLOT, Time},
    field::{
        latest::{self, latest},
        link::TcpLink,
        lock::Lock,
    },
};

/// Times of the exchanges in a slot.
const EXCHANGES: [Duration; 2] = [Duration::from_millis(1), Duration::from_millis(32)];
/// Longest time that a dropped device may take to confirm its last outputs.
const MOST_ENDING: Duration = Duration::from_millis(300);

#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error("no thread for the device at {address}: {source}")]
    Thread { address: SocketAddr, source: io::Error },
    #[error("another process of this machine controls the device at {address}: end it first")]
    InUse { address: SocketAddr },
    #[error("the device at {address} cannot be taken: {source}")]
    Lock { address: SocketAddr, source: io::Error },
}

pub struct Device {
    orders: latest::Writer<Orders>,
    reports: latest::Reader<Report>,
    newest: Orders,
    start: Arc<AtomicU64>, // start of slot 0, ns of `CLOCK_MONOTONIC`
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _lock: Lock,
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

impl Device {
    /// The thread connects and reads, and writes nothing before [`Self::order`]. It calls `prepare` first, for example
    /// to request real-time scheduling. A device that does not answer is not an error: its report shows it.
    pub fn open(
        address: SocketAddr,
        timeout: Duration,
        plan: Plan,
        prepare: impl FnOnce() + Send + 'static,
    ) -> Result<Self, DeviceError> {
        let lock = Lock::take(address, plan.unit)?;
        let link = TcpLink::new(address, plan.unit, timeout);
        let session = Session::new(plan)?;
        let newest = Orders { tick: 0, mode: Mode::Watch, go: 0, words: OutWords::ZERO };
        let (orders, to_do) = latest(newest);
        let (done, reports) = latest(*session.report());
        let start = Arc::new(AtomicU64::new(nanoseconds(Monotonic.now())));
        let stop = Arc::new(AtomicBool::new(false));
        let worker = Worker {
            link,
            session,
            orders: to_do,
            reports: done,
            start: Arc::clone(&start),
            stop: Arc::clone(&stop),
        };
        let thread = thread::Builder::new()
            .name("field".into())
            .spawn(move || {
                prepare();
                worker.run();
            })
            .map_err(|source| DeviceError::Thread { address, source })?;
        Ok(Self { orders, reports, newest, start, stop, thread: Some(thread), _lock: lock })
    }

    /// Aligns the exchanges with the slots of the run's clock: `start` is the time of slot 0, of `CLOCK_MONOTONIC`.
    pub fn align(&self, start: Duration) {
        self.start.store(nanoseconds(start), Ordering::Relaxed);
    }

    /// Gives the orders of a tick. Does not wait.
    pub fn order(&mut self, orders: &Orders) {
        self.newest = *orders;
        self.orders.write(orders);
    }

    /// Shortly before a tick, brings the newest report, and the memory of the orders, into the caches of this core. The
    /// thread gets the same orders once more. Without this, an order takes some microseconds: each of its cache lines is
    /// with the core that has read it last.
    pub fn warm_up(&mut self) {
        self.reports.read();
        self.orders.write(&self.newest);
    }

    /// The newest report. Does not wait.
    pub fn report(&mut self) -> &Report {
        self.reports.read()
    }

    /// The newest inputs with their age now, ns; `None` before the first answer.
    pub fn inputs(&mut self) -> Option<(InWords, u64)> {
        let now = nanoseconds(Monotonic.now());
        let report = self.reports.read();
        report.age(now).map(|age| (report.inputs, age))
    }

    /// Writes the final outputs, and waits until they are read back, at most 0.3 s. Returns true if confirmed.
    pub fn end(&mut self) -> bool {
        let end = Orders { tick: self.newest.tick.wrapping_add(1), mode: Mode::End, ..self.newest };
        self.order(&end);
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already reported it.
            let _ = thread.join();
        }
        matches!(self.report().state, State::Ended(true))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if self.thread.is_some() {
            self.end();
        }
    }
}

struct Worker {
    link: TcpLink,
    session: Session,
    orders: latest::Reader<Orders>,
    reports: latest::Writer<Report>,
    start: Arc<AtomicU64>,
    stop: Arc<AtomicBool>,
}

impl Worker {
    fn run(mut self) {
        let mut ending = None;
        loop {
            let ended = matches!(self.session.report().state, State::Ended(_));
            let now = Monotonic.now();
            let stop = self.stop.load(Ordering::Relaxed);
            if stop && (ended || now >= *ending.get_or_insert(now + MOST_ENDING)) {
                return;
            }
            let start = Duration::from_nanos(self.start.load(Ordering::Relaxed));
            let next = next_exchange(start, now);
            while Monotonic.now() < next {
                Monotonic.sleep_until(next);
            }
            // Counted like the run's tick: nothing is allocated after the start.
            let _section = Section::enter();
            let orders = *self.orders.read();
            self.session.exchange(&mut self.link, &orders);
            self.reports.write(self.session.report());
        }
    }
}

/// The time of the next exchange after `now`, on the grid that begins at `start`.
fn next_exchange(start: Duration, now: Duration) -> Duration {
    let slot = |number: u128| {
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        EXCHANGES.map(|offset| start + SLOT * number + offset)
    };
    let elapsed = now.saturating_sub(start).as_nanos() / SLOT.as_nanos();
    let times = slot(elapsed).into_iter().chain(slot(elapsed + 1));
    times.into_iter().find(|time| *time > now).unwrap_or(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exchanges_are_on_the_grid_of_the_run() {
        let ms = Duration::from_millis;
        let start = ms(1000);
        for (now, next) in
            [(1000, 1001), (1001, 1032), (1031, 1032), (1032, 1041), (1039, 1041), (41_005, 41_032)]
        {
            assert_eq!(next_exchange(start, ms(now)), ms(next), "at {now} ms");
        }
        // The run's clock may begin later than the thread.
        assert_eq!(next_exchange(start, ms(990)), ms(1001));
    }
}
