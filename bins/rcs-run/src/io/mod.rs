//! `rcs-run io-test`, `io-release` and `io-calibrate`: couplers over TCP without a run.
//!
//! Each command takes the devices of a mapping, and is refused while a run has them. A [`Probe`] is a
//! session with a device in this thread. A question to the person lasts longer than the watchdog, so no session that
//! writes stays open during one.

mod calibrate;
mod expected;
mod hold;
mod outputs;
mod person;
mod probes;
mod release;
mod tally;
mod test;
mod watchdog;
mod wiggle;

use std::{
    thread,
    time::{Duration, Instant},
};

use couplers::{Mode, Orders, OutWords, Refusal, Report, Session, State};
use diagnostics::FIELDS;
use executive::{
    clock::{Monotonic, Time as _},
    field::{DeviceError, Lock, TcpLink},
};
use field::Mapping;
use rcs_core::Plain as _;

pub use self::{calibrate::calibrate, release::release, test::test};
use runtime::StartError;

use self::person::Person;
use crate::rcs_run::{arguments::MappingArgument, error::Error};

const PERIOD: Duration = Duration::from_millis(20); // time between two exchanges
/// Time limit of a device's set-up, in addition to its watchdog: a watchdog of an earlier run must expire first.
const SET_UP: Duration = Duration::from_secs(3);
const ENDING: usize = 15; // number of exchanges after which the end of a session is confirmed, or not

/// A mapping whose devices belong to this process until it is dropped.
pub struct Bench {
    pub mapping: Mapping,
    _locks: Vec<Lock>,
}

impl Bench {
    /// Takes the devices. Fails if the mapping cannot be used, or another process has a device.
    pub fn open(argument: &MappingArgument) -> Result<Self, Error> {
        let path = FIELDS.find(&argument.mapping, &argument.data).map_err(StartError::from)?;
        let mapping = runtime::field::read(&path)?;
        let lock = |device: &field::Device| {
            let in_use = |source| StartError::FieldDevice { device: device.name.clone(), source };
            Lock::take(device.address, device.plan.unit).map_err(in_use)
        };
        let locks = mapping.devices.iter().map(lock).collect::<Result<_, _>>()?;
        Ok(Self { mapping, _locks: locks })
    }

    /// Sets up a session with a device. With [`Mode::Watch`] it writes no output.
    pub fn probe(&self, index: usize, mode: Mode) -> Result<Probe, Obstacle> {
        let device = &self.mapping.devices[index];
        let text = |error: DeviceError| Obstacle::new(format!("{}: {error}", device.name));
        let mut probe = Probe::new(device, mode).map_err(text)?;
        let limit = SET_UP + Duration::from_millis(device.plan.watchdog_ms.into());
        let begun = Instant::now();
        loop {
            probe.exchange();
            let report = probe.report();
            if matches!(report.state, State::Running | State::Tripped(_)) {
                return Ok(probe);
            }
            if begun.elapsed() >= limit {
                let now = u64::try_from(Monotonic.now().as_nanos()).unwrap_or(u64::MAX);
                let why = runtime::field::hindrance(&self.mapping, index, report, now);
                let text = why.unwrap_or_else(|| format!("{} is not ready", device.name));
                let on = (report.refusal == Some(Refusal::OutputsOn)).then(|| Box::new(report.acknowledged));
                return Err(Obstacle { text, on });
            }
            thread::sleep(PERIOD);
        }
    }
}

#[derive(Debug)]
pub struct Obstacle {
    /// A sentence with the device.
    pub text: String,
    /// The device's outputs, if some are on that must be off at rest.
    pub on: Option<Box<OutWords>>,
}

impl Obstacle {
    const fn new(text: String) -> Self {
        Self { text, on: None }
    }
}

pub struct Probe {
    link: TcpLink,
    session: Session,
    pub orders: Orders,
}

impl Probe {
    fn new(device: &field::Device, mode: Mode) -> Result<Self, DeviceError> {
        let timeout = Duration::from_millis(device.timeout_ms.into());
        let link = TcpLink::new(device.address, device.plan.unit, timeout);
        let session = Session::new(device.plan.clone())?;
        Ok(Self { link, session, orders: Orders { tick: 0, mode, go: 0, words: OutWords::ZERO } })
    }

    /// Carry out one exchange. Returns its duration.
    pub fn exchange(&mut self) -> Duration {
        self.orders.tick += 1;
        let begun = Instant::now();
        self.session.exchange(&mut self.link, &self.orders);
        begun.elapsed()
    }

    pub fn exchange_for(&mut self, time: Duration) {
        let begun = Instant::now();
        while begun.elapsed() < time {
            self.exchange();
            thread::sleep(PERIOD);
        }
    }

    pub const fn report(&self) -> &Report {
        self.session.report()
    }

    pub const fn link(&mut self) -> &mut TcpLink {
        &mut self.link
    }

    /// Makes the outputs safe, except those that may be on at rest. Returns true if the device has confirmed them.
    pub fn end(mut self) -> bool {
        self.orders.mode = Mode::End;
        for _ in 0..ENDING {
            self.exchange();
            if let State::Ended(confirmed) = self.report().state {
                return confirmed;
            }
            thread::sleep(PERIOD);
        }
        false
    }
}
