//! The watchdog of an emulated coupler: which requests start, restart and reset it, what it refuses, and its registers.

use modbus::{Exception, Request};

use crate::{MS, kind::Kind};

/// Most settings of a kind.
const MOST_SETTINGS: usize = 4;

/// Number of a connection.
pub type Client = u64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle, // not started since the coupler was switched on, or since the reset
    Active {
        until: u64,
    },
    /// It has fired. `is_resetting` is true after the first of two words of the reset.
    Fired {
        is_resetting: bool,
    },
}

#[derive(Clone, Debug)]
pub(super) struct Watchdog {
    kind: Kind,
    state: State,
    /// The values of the kind's settings, in their order.
    settings: [u16; MOST_SETTINGS],
    start: u16,   // value of the register that starts it
    by_hand: u16, // time of a kind without a register for it, ms
    fallbacks: u32,
    writer: Option<(Client, u64)>, // the connection that wrote outputs last, and when
}

fn delivered(kind: Kind) -> [u16; MOST_SETTINGS] {
    let mut values = [0; MOST_SETTINGS];
    if let Some(watchdog) = &kind.facts().watchdog {
        for (value, setting) in values.iter_mut().zip(watchdog.settings) {
            *value = setting.delivered;
        }
    }
    values
}

/// True if the request writes outputs, also in part.
fn writes_outputs(kind: Kind, request: &Request<'_>) -> bool {
    let outputs = &kind.facts().outputs;
    match *request {
        Request::WriteCoil { .. } | Request::WriteCoils { .. } => true,
        Request::WriteRegister { address: first, .. }
        | Request::WriteRegisters { first, .. }
        | Request::ReadWriteRegisters { first, .. } => outputs.contains(&first),
        _ => false,
    }
}

impl Watchdog {
    /// As delivered; `by_hand` is the time of a kind that has no register for it, ms.
    pub(super) fn new(kind: Kind, by_hand: u16) -> Self {
        let settings = delivered(kind);
        Self { kind, state: State::Idle, settings, start: 0, by_hand, fallbacks: 0, writer: None }
    }

    /// Switches the coupler off and on.
    pub(super) fn restart(&mut self) {
        *self = Self { fallbacks: self.fallbacks, ..Self::new(self.kind, self.by_hand) };
    }

    pub(super) const fn fallbacks(&self) -> u32 {
        self.fallbacks
    }

    /// The value of a setting.
    fn setting(&self, register: u16) -> Option<u16> {
        let settings = self.kind.facts().watchdog.iter().flat_map(|watchdog| watchdog.settings);
        let found = settings.zip(self.settings).find(|(setting, _)| setting.register == register);
        found.map(|(_, value)| value)
    }

    /// Its time, ns; 0 if it is off.
    fn time(&self) -> u64 {
        let ms = match self.kind {
            Kind::Bk9000 | Kind::Turck => u64::from(self.settings[0]),
            // The type 2 of a watchdog switches it off.
            Kind::Ek9000 => u64::from(if self.settings[1] == 2 { 0 } else { self.settings[0] }),
            Kind::Wago => 100 * u64::from(self.settings[0]),
            Kind::Values => u64::from(self.by_hand),
            Kind::Plain => 0,
        };
        ms * MS
    }

    /// True if the outputs hold their values when it fires.
    pub(super) fn holds(&self) -> bool {
        self.kind == Kind::Ek9000 && self.setting(0x1123) == Some(1)
    }

    /// True if it fires now.
    pub(super) fn advance(&mut self, now: u64) -> bool {
        let fires = matches!(self.state, State::Active { until } if now >= until);
        if fires {
            self.state = State::Fired { is_resetting: false };
            self.fallbacks = self.fallbacks.saturating_add(1);
        }
        fires
    }

    fn activate(&mut self, now: u64) {
        let time = self.time();
        self.state = if time > 0 { State::Active { until: now + time } } else { State::Idle };
    }

    /// Called with each request before it is carried out. It may restart the watchdog, or be refused.
    pub(super) fn admit(&mut self, request: &Request<'_>, client: Client, now: u64) -> Result<(), Exception> {
        let is_fired = matches!(self.state, State::Fired { .. });
        let is_active = matches!(self.state, State::Active { .. });
        let writes = writes_outputs(self.kind, request);
        match self.kind {
            Kind::Bk9000 if is_fired && writes => return Err(Exception::ServerDeviceFailure),
            Kind::Ek9000 if writes && (is_fired || self.is_locked(client, now)) => {
                return Err(Exception::ServerDeviceFailure);
            }
            Kind::Bk9000 | Kind::Ek9000 if is_active && self.setting(0x1122) == Some(1) => {
                self.activate(now);
            }
            Kind::Wago if is_fired => {
                let is_reset = matches!(*request, Request::WriteRegister { address: 0x1003 | 0x1008, .. });
                return if is_reset { Ok(()) } else { Err(Exception::ServerDeviceFailure) };
            }
            Kind::Wago if is_active && self.is_in_mask(request.function()) => self.activate(now),
            Kind::Turck if is_active => self.activate(now),
            // It watches the connection.
            Kind::Values => self.activate(now),
            _ => {}
        }
        Ok(())
    }

    /// Called after outputs were written.
    pub(super) fn written(&mut self, client: Client, now: u64) {
        self.writer = Some((client, now));
        if matches!(self.kind, Kind::Bk9000 | Kind::Ek9000 | Kind::Turck) {
            self.activate(now);
        }
    }

    fn is_locked(&self, client: Client, now: u64) -> bool {
        let has_lock = self.setting(0x1124) == Some(1);
        has_lock && self.writer.is_some_and(|(writer, at)| writer != client && now < at + self.time() / 2)
    }

    /// True if a function restarts the watchdog of a WAGO: bit 0 of the first mask is function 1.
    fn is_in_mask(&self, function: u8) -> bool {
        let index = u32::from(function).saturating_sub(1);
        let mask = if index < 16 { self.settings[1] } else { self.settings[2] };
        mask.checked_shr(index % 16).is_some_and(|mask| mask & 1 == 1)
    }

    /// The value of one of its registers; `None` if it has no register there.
    pub(super) fn read(&self, register: u16, now: u64) -> Option<u16> {
        let left = || match self.state {
            State::Active { until } => u16::try_from(until.saturating_sub(now) / MS).unwrap_or(u16::MAX),
            State::Idle => u16::try_from(self.time() / MS).unwrap_or(u16::MAX),
            State::Fired { .. } => 0,
        };
        let special = match (self.kind, register) {
            (Kind::Bk9000 | Kind::Ek9000 | Kind::Turck, 0x1020) => Some(left()),
            (Kind::Bk9000 | Kind::Ek9000, 0x1121) | (Kind::Wago, 0x1008) => Some(0),
            (Kind::Ek9000, 0x1021) => Some(u16::try_from(self.fallbacks).unwrap_or(u16::MAX)),
            (Kind::Wago, 0x1003) => Some(self.start),
            (Kind::Wago, 0x1006) => Some(match self.state {
                State::Idle => 0,
                State::Active { .. } => 1,
                State::Fired { .. } => 2,
            }),
            _ => None,
        };
        special.or_else(|| self.setting(register))
    }

    /// Writes one of its registers.
    pub(super) fn write(&mut self, register: u16, value: u16, now: u64) -> Result<(), Exception> {
        match (self.kind, register) {
            (Kind::Bk9000 | Kind::Ek9000, 0x1121) => {
                if let State::Fired { is_resetting } = self.state {
                    self.state = match (is_resetting, value) {
                        (_, 0xBECF) => State::Fired { is_resetting: true },
                        (true, 0xAFFE) => State::Idle,
                        _ => State::Fired { is_resetting: false },
                    };
                }
            }
            (Kind::Wago, 0x1008) if matches!(value, 0xAA55 | 0x55AA) => self.state = State::Idle,
            (Kind::Wago, 0x1008) => return Err(Exception::IllegalDataValue),
            (Kind::Wago, 0x1003) => {
                if value != 0 && value != self.start {
                    self.activate(now);
                }
                self.start = value;
            }
            _ => {
                let settings = self.kind.facts().watchdog.iter().flat_map(|watchdog| watchdog.settings);
                let index = settings.into_iter().position(|setting| setting.register == register);
                let place = index.and_then(|index| self.settings.get_mut(index));
                let place = place.ok_or(Exception::IllegalDataAddress)?;
                // The time of a Turck can always be changed.
                if self.kind != Kind::Turck && self.state != State::Idle {
                    return Err(Exception::ServerDeviceFailure);
                }
                *place = value;
            }
        }
        Ok(())
    }
}
