//! An emulated coupler with process data, settings and a watchdog, as in the manual of the BK9000. It was not compared
//! with a real coupler: SPECNOTES.md lists the assumptions.

use modbus::{Bits, Error, Exception, Request, Tables, Words, server};

use rcs_core::Plain as _;

use crate::{
    MS,
    kind::{Kind, bk9000},
    plan::{InWords, OutWords, Plan, Span},
};

const WORDS: usize = 256; // number of registers of process data in each direction
const IDENTITY: &[u8; 14] = b"BK9000 emulate"; // text in the registers of the identity

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CouplerFault {
    #[default]
    None,
    Freeze,         // it answers, but its inputs no longer change
    Stale,          // it answers with the answer to the previous request
    Terminals(u16), // its terminals report this status word
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Watchdog {
    Idle, // no output was written since the start, or since the reset
    Active {
        until: u64,
    },
    /// It has fired. `is_resetting` is true after the first word of the reset.
    Fired {
        is_resetting: bool,
    },
}

#[derive(Clone, Debug)]
pub struct Emulated {
    kind: Kind,
    unit: u8,
    inputs: [u16; WORDS],
    outputs: [u16; WORDS],
    frozen: [u16; WORDS], // inputs at the time at which they froze
    lengths: (u16, u16),  // numbers of registers in the process data: inputs, outputs
    watchdog: Watchdog,
    watchdog_ms: u16,
    watchdog_type: u16,
    fault: CouplerFault,
    now: u64,
    writes: u64,    // number of writes of outputs that were carried out
    fallbacks: u32, // number of times that the watchdog has fired
    previous: Answer,
}

#[derive(Clone, Debug)]
struct Answer {
    bytes: [u8; modbus::MOST_FRAME_BYTES],
    length: usize,
}

impl Emulated {
    /// A coupler as delivered. It has `inputs` and `outputs` registers, and all are 0.
    #[must_use]
    pub const fn new(kind: Kind, unit: u8, inputs: u16, outputs: u16) -> Self {
        Self {
            kind,
            unit,
            inputs: [0; WORDS],
            outputs: [0; WORDS],
            frozen: [0; WORDS],
            lengths: (inputs, outputs),
            watchdog: Watchdog::Idle,
            watchdog_ms: bk9000::DELIVERED_MS,
            watchdog_type: bk9000::ANY_TELEGRAM,
            fault: CouplerFault::None,
            now: 0,
            writes: 0,
            fallbacks: 0,
            previous: Answer { bytes: [0; modbus::MOST_FRAME_BYTES], length: 0 },
        }
    }

    /// A coupler as delivered; `None` if the plan does not consist of registers.
    #[must_use]
    pub fn of(plan: &Plan) -> Option<Self> {
        let length = |spans: &[Span], first: u16| match spans {
            [] => Some(0),
            [span] if !span.area.has_bits() => {
                let length = span.first.checked_add(span.count)?.checked_sub(first)?;
                Some(length).filter(|length| usize::from(*length) <= WORDS)
            }
            _ => None,
        };
        let facts = plan.kind.facts();
        let inputs = length(&plan.reads, *facts.inputs.start())?;
        let outputs = length(&plan.writes, *facts.outputs.start())?;
        Some(Self::new(plan.kind, plan.unit, inputs, outputs)).filter(|_| plan.kind == Kind::Bk9000)
    }

    pub fn show(&mut self, plan: &Plan, image: &InWords) {
        let first = *plan.kind.facts().inputs.start();
        for span in &plan.reads {
            let registers = self.inputs.iter_mut().skip(usize::from(span.first.saturating_sub(first)));
            registers.zip(image.words).take(span.words()).for_each(|(register, word)| *register = word);
        }
    }

    /// The outputs as an image of a plan, at the time of the last call of [`Self::advance`] or [`Self::answer`].
    #[must_use]
    pub fn image(&self, plan: &Plan) -> OutWords {
        let mut image = OutWords::ZERO;
        let first = *plan.kind.facts().outputs.start();
        for span in &plan.writes {
            let registers = self.outputs.iter().skip(usize::from(span.first.saturating_sub(first)));
            image
                .words
                .iter_mut()
                .zip(registers)
                .take(span.words())
                .for_each(|(word, register)| *word = *register);
        }
        image
    }

    pub const fn inputs_mut(&mut self) -> &mut [u16; WORDS] {
        &mut self.inputs
    }

    /// The registers of the outputs, at the time of the last call of [`Self::advance`] or [`Self::answer`].
    #[must_use]
    pub const fn outputs(&self) -> &[u16; WORDS] {
        &self.outputs
    }

    /// The registers of the outputs, for tests in which another controller writes them.
    pub const fn outputs_mut(&mut self) -> &mut [u16; WORDS] {
        &mut self.outputs
    }

    #[must_use]
    pub const fn writes(&self) -> u64 {
        self.writes
    }

    #[must_use]
    pub const fn fallbacks(&self) -> u32 {
        self.fallbacks
    }

    pub const fn set_fault(&mut self, fault: CouplerFault) {
        self.frozen = self.inputs;
        self.fault = fault;
    }

    /// Switches the coupler off and on: the outputs become 0, and the settings are those of the delivery.
    pub const fn restart(&mut self) {
        self.outputs = [0; WORDS];
        self.watchdog = Watchdog::Idle;
        (self.watchdog_ms, self.watchdog_type) = (bk9000::DELIVERED_MS, bk9000::ANY_TELEGRAM);
    }

    /// Advances the time of the coupler, ns: its watchdog may fire.
    pub fn advance(&mut self, now: u64) {
        self.now = self.now.max(now);
        if let Watchdog::Active { until } = self.watchdog
            && self.now >= until
        {
            self.outputs = [0; WORDS];
            self.watchdog = Watchdog::Fired { is_resetting: false };
            self.fallbacks = self.fallbacks.saturating_add(1);
        }
    }

    /// Returns the length of the answer in `buffer`; `now` in ns. On an error the coupler closes the connection.
    pub fn answer(
        &mut self,
        now: u64,
        frame: &[u8],
        buffer: &mut [u8; modbus::MOST_FRAME_BYTES],
    ) -> Result<usize, Error> {
        self.advance(now);
        let length = server::answer(frame, self, buffer)?;
        let current = Answer { bytes: *buffer, length };
        let previous = std::mem::replace(&mut self.previous, current);
        if self.fault == CouplerFault::Stale && previous.length > 0 {
            *buffer = previous.bytes;
            return Ok(previous.length);
        }
        Ok(length)
    }

    fn rearm(&mut self) {
        if self.kind == Kind::Bk9000 && self.watchdog_ms > 0 {
            self.watchdog = Watchdog::Active { until: self.now + u64::from(self.watchdog_ms) * MS };
        }
    }

    /// Index of a register in the process data, which begin at `start`.
    fn index(address: u16, start: u16, length: u16) -> Option<usize> {
        address.checked_sub(start).filter(|offset| *offset < length).map(usize::from)
    }

    fn input(&self, index: usize) -> u16 {
        if self.fault == CouplerFault::Freeze { self.frozen[index] } else { self.inputs[index] }
    }

    fn setting(&self, address: u16) -> Option<u16> {
        if self.kind != Kind::Bk9000 {
            return None;
        }
        let bits = |words: u16| words.saturating_mul(16);
        Some(match address.wrapping_sub(bk9000::LENGTHS) {
            0 => bits(self.lengths.1),
            1 => bits(self.lengths.0),
            2 | 3 => 0,
            _ => match address {
                bk9000::IDENTITY..=0x1006 => {
                    let place = 2 * usize::from(address - bk9000::IDENTITY);
                    u16::from_be_bytes([IDENTITY[place], IDENTITY[place + 1]])
                }
                bk9000::STATUS => {
                    if let CouplerFault::Terminals(status) = self.fault {
                        status
                    } else {
                        0
                    }
                }
                bk9000::WATCHDOG_LEFT => match self.watchdog {
                    Watchdog::Active { until } => {
                        u16::try_from(until.saturating_sub(self.now) / MS).unwrap_or(u16::MAX)
                    }
                    Watchdog::Idle => self.watchdog_ms,
                    Watchdog::Fired { .. } => 0,
                },
                bk9000::WATCHDOG_MS => self.watchdog_ms,
                bk9000::WATCHDOG_RESET => 0,
                bk9000::WATCHDOG_TYPE => self.watchdog_type,
                _ => return None,
            },
        })
    }

    fn write_setting(&mut self, address: u16, value: u16) -> Result<(), Exception> {
        if self.kind != Kind::Bk9000 {
            return Err(Exception::IllegalDataAddress);
        }
        match (address, self.watchdog) {
            (bk9000::WATCHDOG_RESET, Watchdog::Fired { is_resetting }) => {
                self.watchdog = match (is_resetting, value) {
                    (_, first) if first == bk9000::RESET[0] => Watchdog::Fired { is_resetting: true },
                    (true, second) if second == bk9000::RESET[1] => Watchdog::Idle,
                    _ => Watchdog::Fired { is_resetting: false },
                };
            }
            (bk9000::WATCHDOG_RESET, _) => {}
            (bk9000::WATCHDOG_MS, Watchdog::Idle) => self.watchdog_ms = value,
            (bk9000::WATCHDOG_TYPE, Watchdog::Idle) => self.watchdog_type = value,
            (bk9000::WATCHDOG_MS | bk9000::WATCHDOG_TYPE, _) => return Err(Exception::ServerDeviceFailure),
            _ => return Err(Exception::IllegalDataAddress),
        }
        Ok(())
    }

    fn outputs_start(&self) -> u16 {
        *self.kind.facts().outputs.start()
    }

    const fn check_writable(&self) -> Result<(), Exception> {
        match self.watchdog {
            Watchdog::Fired { .. } => Err(Exception::ServerDeviceFailure),
            Watchdog::Idle | Watchdog::Active { .. } => Ok(()),
        }
    }

    fn written(&mut self) {
        self.writes += 1;
        self.rearm();
    }
}

fn bit_place(address: u16) -> (u16, u16) {
    (address / 16, 1 << (address % 16))
}

impl Tables for Emulated {
    fn admit(&mut self, unit: u8, _: &Request<'_>) -> Result<(), Exception> {
        if unit != self.unit {
            return Err(Exception::GatewayTargetFailed);
        }
        if self.watchdog_type == bk9000::ANY_TELEGRAM && matches!(self.watchdog, Watchdog::Active { .. }) {
            self.rearm();
        }
        Ok(())
    }

    fn coil(&mut self, address: u16) -> Result<bool, Exception> {
        let (word, mask) = bit_place(address);
        let index = Self::index(word, 0, self.lengths.1).ok_or(Exception::IllegalDataAddress)?;
        Ok(self.outputs[index] & mask != 0)
    }

    fn discrete_input(&mut self, address: u16) -> Result<bool, Exception> {
        let (word, mask) = bit_place(address);
        let index = Self::index(word, 0, self.lengths.0).ok_or(Exception::IllegalDataAddress)?;
        Ok(self.input(index) & mask != 0)
    }

    fn holding_register(&mut self, address: u16) -> Result<u16, Exception> {
        if let Some(index) = Self::index(address, self.outputs_start(), self.lengths.1) {
            return Ok(self.outputs[index]);
        }
        self.input_register(address)
    }

    fn input_register(&mut self, address: u16) -> Result<u16, Exception> {
        match Self::index(address, 0, self.lengths.0) {
            Some(index) => Ok(self.input(index)),
            None => self.setting(address).ok_or(Exception::IllegalDataAddress),
        }
    }

    fn write_coils(&mut self, first: u16, bits: Bits<'_>) -> Result<(), Exception> {
        self.check_writable()?;
        let last = usize::from(first) + bits.len();
        if last > 16 * usize::from(self.lengths.1) {
            return Err(Exception::IllegalDataAddress);
        }
        for (address, bit) in (first..).zip(bits.iter()) {
            let (word, mask) = bit_place(address);
            let word = &mut self.outputs[usize::from(word)];
            *word = if bit { *word | mask } else { *word & !mask };
        }
        self.written();
        Ok(())
    }

    fn write_registers(&mut self, first: u16, words: Words<'_>) -> Result<(), Exception> {
        let Some(index) = Self::index(first, self.outputs_start(), self.lengths.1) else {
            return (first..)
                .zip(words.iter())
                .try_for_each(|(address, word)| self.write_setting(address, word));
        };
        self.check_writable()?;
        if index + words.len() > usize::from(self.lengths.1) {
            return Err(Exception::IllegalDataAddress);
        }
        words.copy_to(&mut self.outputs[index..index + words.len()]);
        self.written();
        Ok(())
    }
}
