//! The contract of a device: when its outputs are safe, when its inputs are valid, and when a person must release it.
//!
//! | event | action of the session |
//! |---|---|
//! | connected for the first time | refuses outputs that may not be on; sets the watchdog, reads it back |
//! | a request fails | counts it; the next exchange carries the newest outputs, and no request is repeated |
//! | no answer for `stale_ms` | resets the connection and connects again, after 20 to 320 ms |
//! | back in time, outputs and settings as left | continues |
//! | back later, or not as left | trips |
//! | tripped | writes the safe outputs until an operator releases the device |
//! | no orders for three ticks | writes the safe outputs once, then nothing, so that the watchdog fires too |
//! | end | writes the final outputs, reads them back, disconnects |
//!
//! The image is a state, not a list of events: a device may carry it out twice.

mod setup;
mod transfer;

use modbus::{Exception, MOST_FRAME_BYTES};
use rcs_core::Plain;

use crate::{
    MS,
    link::{Fault, Link},
    plan::{OutWords, Plan, PlanError},
    report::{Mode, Orders, Refusal, Report, State, Trip},
};

/// A device that returns later than this trips, even if its watchdog time is longer or it has no watchdog.
const MOST_GAP_MS: u64 = 500;
/// Three ticks without orders, minus the jitter of the exchanges, so that the third missing image is noticed when due.
const MOST_SILENCE: u64 = 116 * MS;
/// First and longest pause before a new connection. Inputs are then valid at most ten ticks after the end of a cut.
const PAUSES: (u64, u64) = (20 * MS, 320 * MS);
/// Period in which outputs, settings and status of the device are read back.
const CHECKED_EVERY: u64 = 1000 * MS;
const MOST_ENDING: u64 = 150 * MS; // time within which the final outputs must be confirmed
/// Period in which the counter of a device's program is read, and time in which it must change. A device that stops is
/// found within the sum and one exchange.
const COUNTED_EVERY: u64 = 500 * MS;
const MOST_STILL: u64 = 1000 * MS;
/// Time after which a coupler must have released its write lock, in addition to half the time of its watchdog.
const LOCK_MARGIN: u64 = 100 * MS;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Not connected; the next attempt may begin at this time.
    Closed {
        next: u64,
    },
    Setup, // connected; the device must be set up
    Back,  // connected again; the device must be as it was left
    Open,
}

#[derive(Clone, Copy, Debug)]
struct Alive {
    value: u16,
    since: u64,
    next: u64, // when it is read again
}

#[derive(Clone, Debug)]
pub struct Session {
    plan: Plan,
    phase: Phase,
    report: Report,
    sent: OutWords, // the last image that was sent; the device may not have carried it out
    written_at: Option<u64>, // when the last write began that the device acknowledged
    heard_at: u64,  // when the device answered last, or was connected
    pause: u64,     // pause before the next attempt to connect
    /// Number of the newest orders, and when they were first seen. `None` until the run writes outputs.
    orders: Option<(u64, u64)>,
    go: u32,
    next_check: u64,
    checks: usize, // checks of the device so far
    alive: Option<Alive>,
    is_started: bool,    // the watchdog was started, if its kind needs it
    fallbacks: u16,      // how often the watchdog had fired at the set-up, if the device counts it
    locked_until: u64,   // the device may refuse writes until then, because of an earlier connection
    ending: Option<u64>, // when the end was first asked for
}

/// The device is not ready. It stays in its phase, and its connection has not failed.
enum Stop {
    Fault(Fault),
    Refused(Refusal),
    Trip(Trip),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl Session {
    /// A session that has not connected yet. Fails if the plan cannot be followed.
    pub fn new(plan: Plan) -> Result<Self, PlanError> {
        plan.check()?;
        Ok(Self {
            plan,
            phase: Phase::Closed { next: 0 },
            report: Report::STARTING,
            sent: OutWords::ZERO,
            written_at: None,
            heard_at: 0,
            pause: PAUSES.0,
            orders: None,
            go: 0,
            next_check: 0,
            checks: 0,
            alive: None,
            is_started: false,
            fallbacks: 0,
            locked_until: 0,
            ending: None,
        })
    }

    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    #[must_use]
    pub const fn report(&self) -> &Report {
        &self.report
    }

    /// Carries out one exchange. Does nothing after the end. Does not allocate.
    pub fn exchange(&mut self, link: &mut impl Link, orders: &Orders) {
        if matches!(self.report.state, State::Ended(_)) {
            return;
        }
        self.watch(link, orders);
        if self.report.state == State::Silent {
            return;
        }
        if let Err(stop) = self.advance(link, orders) {
            self.stopped(link, stop);
        }
        self.check_age(link);
        self.check_end(link, orders);
    }

    /// Checks that the orders are new. Without new ones, writes the safe outputs once.
    fn watch(&mut self, link: &mut impl Link, orders: &Orders) {
        let now = link.now();
        match self.orders {
            None if matches!(orders.mode, Mode::Run | Mode::Safe) => {
                (self.orders, self.go) = (Some((orders.tick, now)), orders.go);
            }
            Some((tick, _)) if tick != orders.tick => {
                self.orders = Some((orders.tick, now));
                if self.report.state == State::Silent {
                    self.trip(Trip::NoOrders);
                }
            }
            Some((_, since))
                if now.saturating_sub(since) > MOST_SILENCE
                    && orders.mode != Mode::End
                    && !matches!(self.report.state, State::Silent | State::Starting) =>
            {
                let is_safe = self.phase == Phase::Open && self.write_safe(link).is_ok();
                if !is_safe {
                    self.close(link);
                }
                self.report.state = State::Silent;
            }
            _ => {}
        }
    }

    fn write_safe(&mut self, link: &mut impl Link) -> Result<(), Fault> {
        let safe = self.plan.safe;
        self.transfer(link, Some(&safe))
    }

    fn advance(&mut self, link: &mut impl Link, orders: &Orders) -> Result<(), Stop> {
        if let Phase::Closed { next } = self.phase {
            if link.now() < next {
                self.refuse_release(orders);
                return Ok(());
            }
            link.connect()?;
            self.heard_at = link.now();
            if self.plan.kind.facts().has_write_lock {
                let half = u64::from(self.plan.watchdog_ms) * MS / 2;
                self.locked_until = self.heard_at.saturating_add(half + LOCK_MARGIN);
            }
            self.report.counters.connections = self.report.counters.connections.wrapping_add(1);
            let is_known = matches!(self.report.state, State::Running | State::Stale);
            self.phase = if is_known { Phase::Back } else { Phase::Setup };
        }
        match self.phase {
            Phase::Setup => self.set_up(link, orders)?,
            Phase::Back => self.come_back(link)?,
            Phase::Open | Phase::Closed { .. } => {}
        }
        self.phase = Phase::Open;
        self.report.refusal = None;
        match (self.report.state, orders.mode) {
            (State::Starting, Mode::Safe) | (State::Running | State::Stale, Mode::Safe) => {
                self.trip(Trip::Ordered);
                self.phase = Phase::Open;
            }
            (State::Starting | State::Stale, _) => self.report.state = State::Running,
            _ => {}
        }
        if self.report.state == State::Running {
            // The thread may have been stopped although its connection is in order.
            self.check_gap(link.now())?;
        }
        self.release(orders);
        match (orders.mode, self.report.state) {
            (Mode::End, _) => return self.finish(link).map_err(Stop::Fault),
            (Mode::Watch, _) => self.transfer(link, None)?,
            (Mode::Run, State::Running) => self.write_unless_locked(link, &orders.words)?,
            _ => {
                let safe = self.plan.safe;
                self.write_unless_locked(link, &safe)?;
            }
        }
        self.check_device(link)
    }

    /// Exchanges process data. While an earlier connection has the write lock, only reads the inputs.
    fn write_unless_locked(&mut self, link: &mut impl Link, words: &OutWords) -> Result<(), Stop> {
        match self.transfer(link, Some(words)) {
            Err(fault @ Fault::Exception(_)) if link.now() < self.locked_until => {
                self.note(fault);
                self.transfer(link, None).map_err(Stop::Fault)
            }
            done => done.map_err(refused),
        }
    }

    fn release(&mut self, orders: &Orders) {
        if orders.go == self.go || !matches!(self.report.state, State::Tripped(_)) {
            self.go = orders.go;
            return;
        }
        if orders.mode == Mode::Run && orders.words.outside(&self.plan.rest).is_zero() {
            self.go = orders.go;
            self.report.state = State::Running;
        } else {
            self.refuse_release(orders);
        }
    }

    fn refuse_release(&mut self, orders: &Orders) {
        if orders.go != self.go && self.orders.is_some() {
            self.go = orders.go;
            self.report.counters.refused_releases = self.report.counters.refused_releases.wrapping_add(1);
        }
    }

    fn stopped(&mut self, link: &mut impl Link, stop: Stop) {
        match stop {
            Stop::Refused(refusal) => self.report.refusal = Some(refusal),
            Stop::Trip(cause) => self.trip(cause),
            Stop::Fault(fault) => {
                self.note(fault);
                if fault.ends_connection() {
                    self.close(link);
                }
            }
        }
    }

    const fn note(&mut self, fault: Fault) {
        self.report.fault = Some(fault);
        self.report.counters.failures = self.report.counters.failures.wrapping_add(1);
    }

    /// Resets a connection without an answer, and marks the inputs as stale.
    fn check_age(&mut self, link: &mut impl Link) {
        let now = link.now();
        let limit = u64::from(self.plan.stale_ms) * MS;
        if !matches!(self.phase, Phase::Closed { .. }) && now.saturating_sub(self.heard_at) > limit {
            self.close(link);
        }
        if self.report.state == State::Running && self.report.age(now).is_some_and(|age| age > limit) {
            self.report.state = State::Stale;
        }
    }

    fn trip(&mut self, cause: Trip) {
        if !matches!(self.report.state, State::Tripped(_)) {
            self.report.state = State::Tripped(cause);
            self.report.counters.trips = self.report.counters.trips.wrapping_add(1);
        }
        if !matches!(self.phase, Phase::Closed { .. }) {
            self.phase = Phase::Setup;
        }
    }

    fn close(&mut self, link: &mut impl Link) {
        link.reset();
        self.phase = Phase::Closed { next: link.now().saturating_add(self.pause) };
        self.pause = (self.pause * 2).min(PAUSES.1);
    }

    fn finish(&mut self, link: &mut impl Link) -> Result<(), Fault> {
        let confirmed = if self.written_at.is_none() {
            // No output was written.
            true
        } else {
            let last =
                if self.report.state == State::Running { self.report.acknowledged } else { self.plan.safe };
            let outputs = self.plan.at_end(&last);
            self.transfer(link, Some(&outputs))?;
            self.read_outputs(link)? == outputs
        };
        self.end(link, confirmed);
        Ok(())
    }

    /// Ends without confirmation if the device does not answer: its watchdog makes the outputs safe.
    fn check_end(&mut self, link: &mut impl Link, orders: &Orders) {
        if orders.mode == Mode::End && !matches!(self.report.state, State::Ended(_)) {
            let now = link.now();
            let since = *self.ending.get_or_insert(now);
            if now.saturating_sub(since) >= MOST_ENDING {
                self.end(link, false);
            }
        }
    }

    fn end(&mut self, link: &mut impl Link, confirmed: bool) {
        self.close(link);
        self.report.state = State::Ended(confirmed);
    }

    /// Compares outputs, status and settings with the expected values, one per exchange and each once per second.
    fn check_device(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        self.check_alive(link)?;
        let now = link.now();
        if now < self.next_check {
            return Ok(());
        }
        let count = 2 + self.kept_registers();
        match self.checks % count {
            0 => {
                let outputs = self.read_outputs(link).map_err(refused)?;
                if self.written_at.is_none() {
                    // The watchdog of an earlier run may have changed them.
                    self.report.acknowledged = outputs;
                } else if outputs != self.report.acknowledged {
                    return Err(Stop::Trip(Trip::Outputs));
                }
            }
            1 => self.check_status(link)?,
            index => self.check_kept(link, index - 2)?,
        }
        self.checks = (self.checks + 1) % count;
        // Counted from the time at which it was due, so that delays do not add up.
        self.next_check = (self.next_check + CHECKED_EVERY / u64::try_from(count).unwrap_or(1)).max(now);
        Ok(())
    }

    fn check_status(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        let Some(status) = &self.plan.kind.facts().status else { return Ok(()) };
        let [found] = self.read_registers(link, status.register)?;
        if found & status.mask == status.good { Ok(()) } else { Err(Stop::Trip(Trip::Terminals(found))) }
    }

    /// Trips if the counter of the device's program stands still.
    fn check_alive(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        let now = link.now();
        let Some(span) = self.plan.alive.filter(|_| self.alive.is_none_or(|alive| now >= alive.next)) else {
            return Ok(());
        };
        let value = self.read_register(link, span)?;
        let since = self.alive.filter(|alive| alive.value == value).map_or(now, |alive| alive.since);
        self.alive = Some(Alive { value, since, next: now + COUNTED_EVERY });
        if now.saturating_sub(since) >= MOST_STILL { Err(Stop::Trip(Trip::Frozen)) } else { Ok(()) }
    }
}

/// A device that refuses what it accepted before trips. One that is busy only misses an exchange.
fn refused(fault: Fault) -> Stop {
    match fault {
        Fault::Exception(code) if code != Exception::ServerDeviceBusy.code() => {
            Stop::Trip(Trip::Refused(code))
        }
        fault => Stop::Fault(fault),
    }
}

const fn buffer() -> [u8; MOST_FRAME_BYTES] {
    [0; MOST_FRAME_BYTES]
}
