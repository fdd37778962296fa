//! An emulated coupler with process data, settings and a watchdog, as the manual of its kind describes it. It was not
//! compared with a real coupler: SPECNOTES.md lists the assumptions.

mod watchdog;

use modbus::{Bits, Error, Exception, Request, Tables, Words, server};
use rcs_core::Plain as _;

pub use self::watchdog::Client;
use self::watchdog::Watchdog;
use crate::{
    MS,
    kind::Kind,
    plan::{Area, InWords, OutWords, Plan, Span},
};

/// Words of process data in each direction: the registers of a kind, and its bits.
const WORDS: usize = 512;
/// Units that a coupler answers in addition to its own: both mean the server itself (MG 4.4.2).
const ITSELF: [u8; 2] = [0, 255];
/// Time in which the counter of its program increases by one, ns.
const COUNTED: u64 = 100 * MS;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CouplerFault {
    #[default]
    None,
    Freeze,         // it answers, but its inputs and the counter of its program no longer change
    Stale,          // it answers with the answer to the previous request
    Terminals(u16), // its terminals report this status word
}

/// Consecutive addresses of a table, and their place in the words of a direction.
#[derive(Clone, Copy, Debug)]
struct Block {
    span: Span,
    word: usize,
}

#[derive(Clone, Debug)]
pub struct Emulated {
    kind: Kind,
    unit: u8,
    readable: Vec<Block>, // tables of inputs
    writable: Vec<Block>, // tables of outputs
    inputs: [u16; WORDS],
    outputs: [u16; WORDS],
    safe: [u16; WORDS], // outputs after the fallback
    frozen: [u16; WORDS],
    frozen_at: u64,
    lengths: [u16; 4], // of the process data: analog outputs, analog inputs, digital outputs, digital inputs
    alive: Option<Span>, // the counter of its program
    watchdog: Watchdog,
    fault: CouplerFault,
    client: Client, // the connection whose request is carried out
    now: u64,
    writes: u64, // number of writes of outputs that were carried out
    previous: Answer,
}

#[derive(Clone, Debug)]
struct Answer {
    bytes: [u8; modbus::MOST_FRAME_BYTES],
    length: usize,
}

/// Word and bit of an address; the bit is 0 for a register.
fn place(blocks: &[Block], area: Area, address: u16) -> Option<(usize, u16)> {
    blocks.iter().filter(|block| block.span.area == area).find_map(|block| {
        let offset = address.checked_sub(block.span.first).filter(|offset| *offset < block.span.count)?;
        let (word, bit) = if area.has_bits() { (offset / 16, offset % 16) } else { (offset, 0) };
        Some((block.word + usize::from(word), bit))
    })
}

/// The tables of a direction. Registers of a kind with known lengths begin at the start of its process data.
fn blocks(spans: &[Span], start: Option<u16>) -> Vec<Block> {
    let mut word = 0;
    let block = |span: &Span| {
        let first = start.filter(|_| !span.area.has_bits()).unwrap_or(span.first).min(span.first);
        let span = Span { first, count: span.count + (span.first - first), ..*span };
        let block = Block { span, word };
        word += span.words();
        block
    };
    spans.iter().map(block).collect()
}

/// Copies the values of the addresses of a block to the image of a span, or from it.
fn transfer(span: &Span, start: usize, blocks: &[Block], mut copy: impl FnMut(usize, u16, usize, u16)) {
    for offset in 0..span.count {
        let Some((word, bit)) = place(blocks, span.area, span.first + offset) else { continue };
        let (index, image_bit) = if span.area.has_bits() { (offset / 16, offset % 16) } else { (offset, 0) };
        copy(word, bit, start + usize::from(index), image_bit);
    }
}

/// Copies a register, or one bit.
const fn copied(area: Area, from: u16, from_bit: u16, to: u16, to_bit: u16) -> u16 {
    if area.has_bits() { (to & !(1 << to_bit)) | ((from >> from_bit & 1) << to_bit) } else { from }
}

impl Emulated {
    /// A coupler as delivered. It has `inputs` and `outputs` registers, which are bits as well, and all are 0.
    #[must_use]
    pub fn new(kind: Kind, unit: u8, inputs: u16, outputs: u16) -> Self {
        let facts = kind.facts();
        let block = |area, first, count| Block { span: Span { area, first, count }, word: 0 };
        Self {
            kind,
            unit,
            readable: vec![
                block(Area::Input, *facts.inputs.start(), inputs),
                block(Area::Discrete, 0, inputs.saturating_mul(16)),
            ],
            writable: vec![
                block(Area::Holding, *facts.outputs.start(), outputs),
                block(Area::Coil, *facts.coils.start(), outputs.saturating_mul(16)),
            ],
            inputs: [0; WORDS],
            outputs: [0; WORDS],
            safe: [0; WORDS],
            frozen: [0; WORDS],
            frozen_at: 0,
            lengths: [outputs.saturating_mul(16), inputs.saturating_mul(16), 0, 0],
            alive: None,
            watchdog: Watchdog::new(kind, 0),
            fault: CouplerFault::None,
            client: 0,
            now: 0,
            writes: 0,
            previous: Answer { bytes: [0; modbus::MOST_FRAME_BYTES], length: 0 },
        }
    }

    /// A coupler as delivered, with the process data of a plan. What is set by hand is as in the plan.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        let facts = plan.kind.facts();
        let start = |addresses: &std::ops::RangeInclusive<u16>| facts.lengths.map(|_| *addresses.start());
        let bits = |bits: u32| u16::try_from(bits).unwrap_or(u16::MAX);
        let mut coupler = Self {
            readable: blocks(&plan.reads, start(&facts.inputs)),
            writable: blocks(&plan.writes, start(&facts.outputs)),
            lengths: [bits(plan.output_bits()), bits(plan.input_bits()), 0, 0],
            alive: plan.alive,
            watchdog: Watchdog::new(plan.kind, plan.watchdog_ms),
            ..Self::new(plan.kind, plan.unit, 0, 0)
        };
        let mut start = 0;
        for span in &plan.writes {
            transfer(span, start, &coupler.writable, |word, bit, index, image_bit| {
                let safe = &mut coupler.safe[word];
                *safe = copied(span.area, plan.safe.words[index], image_bit, *safe, bit);
            });
            start += span.words();
        }
        coupler
    }

    pub fn show(&mut self, plan: &Plan, image: &InWords) {
        let mut start = 0;
        for span in &plan.reads {
            transfer(span, start, &self.readable, |word, bit, index, image_bit| {
                let input = &mut self.inputs[word];
                *input = copied(span.area, image.words[index], image_bit, *input, bit);
            });
            start += span.words();
        }
    }

    /// The outputs as an image of a plan, at the time of the last call of [`Self::advance`] or [`Self::answer`].
    #[must_use]
    pub fn image(&self, plan: &Plan) -> OutWords {
        let mut image = OutWords::ZERO;
        let mut start = 0;
        for span in &plan.writes {
            transfer(span, start, &self.writable, |word, bit, index, image_bit| {
                let place = &mut image.words[index];
                *place = copied(span.area, self.outputs[word], bit, *place, image_bit);
            });
            start += span.words();
        }
        image
    }

    pub const fn inputs_mut(&mut self) -> &mut [u16; WORDS] {
        &mut self.inputs
    }

    /// The words of the outputs, at the time of the last call of [`Self::advance`] or [`Self::answer`].
    #[must_use]
    pub const fn outputs(&self) -> &[u16; WORDS] {
        &self.outputs
    }

    /// The words of the outputs, for tests in which another controller writes them.
    pub const fn outputs_mut(&mut self) -> &mut [u16; WORDS] {
        &mut self.outputs
    }

    #[must_use]
    pub const fn writes(&self) -> u64 {
        self.writes
    }

    /// Number of times that the watchdog has fired.
    #[must_use]
    pub const fn fallbacks(&self) -> u32 {
        self.watchdog.fallbacks()
    }

    pub const fn set_fault(&mut self, fault: CouplerFault) {
        self.frozen = self.inputs;
        self.frozen_at = self.now;
        self.fault = fault;
    }

    /// Switches the coupler off and on: the outputs become 0, and the settings are those of the delivery.
    pub fn restart(&mut self) {
        self.outputs = [0; WORDS];
        self.watchdog.restart();
    }

    /// Advances the time of the coupler, ns: its watchdog may fire.
    pub fn advance(&mut self, now: u64) {
        self.now = self.now.max(now);
        if self.watchdog.advance(self.now) && !self.watchdog.holds() {
            self.outputs = self.safe;
        }
    }

    /// Returns the length of the answer in `buffer` to a frame of the connection `client`; `now` in ns. On an error the
    /// coupler closes the connection.
    pub fn answer(
        &mut self,
        now: u64,
        client: Client,
        frame: &[u8],
        buffer: &mut [u8; modbus::MOST_FRAME_BYTES],
    ) -> Result<usize, Error> {
        self.advance(now);
        self.client = client;
        let length = server::answer(frame, self, buffer)?;
        let current = Answer { bytes: *buffer, length };
        let previous = std::mem::replace(&mut self.previous, current);
        if self.fault == CouplerFault::Stale && previous.length > 0 {
            *buffer = previous.bytes;
            return Ok(previous.length);
        }
        Ok(length)
    }

    fn input(&self, area: Area, address: u16) -> Option<(u16, u16)> {
        let inputs = if self.fault == CouplerFault::Freeze { &self.frozen } else { &self.inputs };
        place(&self.readable, area, address).map(|(word, bit)| (inputs[word], bit))
    }

    /// A register of inputs, of the watchdog, or about the coupler.
    fn register(&self, area: Area, address: u16) -> Option<u16> {
        if self.alive.is_some_and(|span| (span.area, span.first) == (area, address)) {
            let now = if self.fault == CouplerFault::Freeze { self.frozen_at } else { self.now };
            // The counter wraps.
            return u16::try_from((now / COUNTED) % (1 << 16)).ok();
        }
        if let Some((value, _)) = self.input(area, address) {
            return Some(value);
        }
        let facts = self.kind.facts();
        let offset = |first: u16, count: u16| address.checked_sub(first).filter(|offset| *offset < count);
        if let Some(index) = facts.lengths.and_then(|first| offset(first, 4)) {
            return Some(self.lengths[usize::from(index)]);
        }
        if let Some(index) = facts.identity.and_then(|(first, count)| offset(first, count)) {
            let name = self.kind.text().bytes().map(|byte| byte.to_ascii_uppercase());
            let mut bytes = name.chain(*b" emulate").chain(std::iter::repeat(0)).skip(2 * usize::from(index));
            return Some(u16::from_be_bytes([bytes.next()?, bytes.next()?]));
        }
        match (&facts.status, self.fault) {
            (Some(status), CouplerFault::Terminals(word)) if status.register == address => Some(word),
            (Some(status), _) if status.register == address => Some(status.good),
            _ => self.watchdog.read(address, self.now),
        }
    }

    fn write(&mut self, area: Area, values: impl ExactSizeIterator<Item = u16>, first: u16) -> Option<()> {
        let last = first.checked_add(u16::try_from(values.len()).ok()?.checked_sub(1)?)?;
        place(&self.writable, area, last)?;
        place(&self.writable, area, first)?;
        for (address, value) in (first..=last).zip(values) {
            if let Some((word, bit)) = place(&self.writable, area, address) {
                self.outputs[word] = copied(area, value, 0, self.outputs[word], bit);
            }
        }
        self.writes += 1;
        self.watchdog.written(self.client, self.now);
        Some(())
    }
}

impl Tables for Emulated {
    fn admit(&mut self, unit: u8, request: &Request<'_>) -> Result<(), Exception> {
        if unit != self.unit && !ITSELF.contains(&unit) {
            return Err(Exception::GatewayTargetFailed);
        }
        let (most_words, most_bits) = self.kind.facts().most_written;
        let is_long = |found: usize, most: u16| found > usize::from(most);
        match *request {
            Request::ReadWriteRegisters { .. } if matches!(self.kind, Kind::Values | Kind::Plain) => {
                return Err(Exception::IllegalFunction);
            }
            Request::WriteRegisters { words, .. } if is_long(words.len(), most_words) => {
                return Err(Exception::IllegalDataValue);
            }
            Request::WriteCoils { bits, .. } if is_long(bits.len(), most_bits) => {
                return Err(Exception::IllegalDataValue);
            }
            _ => {}
        }
        self.watchdog.admit(request, self.client, self.now)
    }

    fn coil(&mut self, address: u16) -> Result<bool, Exception> {
        let (word, bit) = place(&self.writable, Area::Coil, address).ok_or(Exception::IllegalDataAddress)?;
        Ok(self.outputs[word] >> bit & 1 == 1)
    }

    fn discrete_input(&mut self, address: u16) -> Result<bool, Exception> {
        let (word, bit) = self.input(Area::Discrete, address).ok_or(Exception::IllegalDataAddress)?;
        Ok(word >> bit & 1 == 1)
    }

    fn holding_register(&mut self, address: u16) -> Result<u16, Exception> {
        if let Some((word, _)) = place(&self.writable, Area::Holding, address) {
            return Ok(self.outputs[word]);
        }
        match self.register(Area::Holding, address) {
            Some(value) => Ok(value),
            None => self.input_register(address),
        }
    }

    fn input_register(&mut self, address: u16) -> Result<u16, Exception> {
        self.register(Area::Input, address).ok_or(Exception::IllegalDataAddress)
    }

    fn write_coils(&mut self, first: u16, bits: Bits<'_>) -> Result<(), Exception> {
        let mut values = [0; modbus::request::MOST_WRITTEN_BITS as usize];
        let values = values.get_mut(..bits.len()).ok_or(Exception::IllegalDataValue)?;
        values.iter_mut().zip(bits.iter()).for_each(|(value, bit)| *value = u16::from(bit));
        self.write(Area::Coil, values.iter().copied(), first).ok_or(Exception::IllegalDataAddress)
    }

    fn write_registers(&mut self, first: u16, words: Words<'_>) -> Result<(), Exception> {
        let mut values = [0; modbus::request::MOST_WRITTEN_WORDS as usize];
        let values = values.get_mut(..words.len()).ok_or(Exception::IllegalDataValue)?;
        words.copy_to(values);
        if place(&self.writable, Area::Holding, first).is_some() {
            let written = self.write(Area::Holding, values.iter().copied(), first);
            return written.ok_or(Exception::IllegalDataAddress);
        }
        let mut settings = (first..).zip(values.iter());
        settings.try_for_each(|(address, value)| self.watchdog.write(address, *value, self.now))
    }
}
