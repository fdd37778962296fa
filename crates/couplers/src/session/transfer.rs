//! The requests of a session: process data, and single registers.

use modbus::{Bits, Request, Response, Words, request::Range};
use rcs_core::Plain;

use super::{PAUSES, Session, buffer};
use crate::{
    link::{Fault, FrameFault, Link},
    plan::{Area, InWords, MOST_OUT, OutWords, Span},
};

const fn reading(span: Span) -> Request<'static> {
    let range = Range { first: span.first, count: span.count };
    match span.area {
        Area::Coil => Request::ReadCoils(range),
        Area::Discrete => Request::ReadDiscreteInputs(range),
        Area::Input => Request::ReadInputRegisters(range),
        Area::Holding => Request::ReadHoldingRegisters(range),
    }
}

/// Copies an answer into the words of a span.
fn store(response: Response<'_>, place: &mut [u16]) {
    match response {
        Response::Words(words) => words.copy_to(place),
        Response::Bits(bits) => {
            place.fill(0);
            for (index, _) in bits.iter().enumerate().filter(|(_, bit)| *bit) {
                if let Some(word) = place.get_mut(index / 16) {
                    *word |= 1 << (index % 16);
                }
            }
        }
        Response::Written => {}
    }
}

/// The words of a span, which begins at `start` of an image.
fn part<'a>(words: &'a [u16], start: &mut usize, span: &Span) -> &'a [u16] {
    let from = *start;
    *start += span.words();
    words.get(from..*start).unwrap_or_default()
}

impl Session {
    /// Exchanges process data: writes `outputs`, if there are any, and reads all inputs.
    pub(super) fn transfer(&mut self, link: &mut impl Link, outputs: Option<&OutWords>) -> Result<(), Fault> {
        let begun = link.now();
        let mut inputs = InWords::ZERO;
        let (mut start, mut reads) = (0, 0);
        if let Some(words) = outputs {
            self.start_watchdog(link)?;
            let written = self.write(link, words);
            if written != Err(Fault::Unanswered) {
                // The device may have carried out the write, or may still do so.
                self.sent = *words;
            }
            if let Some(first) = written? {
                store_first(&mut inputs, &mut start, &first, self.plan.reads[0]);
                reads = 1;
            }
            self.report.acknowledged = *words;
            self.written_at = Some(begun);
        }
        let mut answer = buffer();
        for index in reads..self.plan.reads.len() {
            let span = self.plan.reads[index];
            let response = link.exchange(&reading(span), &mut answer)?;
            if let Some(place) = inputs.words.get_mut(start..start + span.words()) {
                store(response, place);
            }
            start += span.words();
        }
        self.heard_at = link.now();
        self.pause = PAUSES.0;
        self.report.inputs = inputs;
        self.report.read_at = Some(begun);
        self.report.counters.exchanges = self.report.counters.exchanges.wrapping_add(1);
        Ok(())
    }

    /// Writes all spans of outputs. If the kind supports it, the last request also reads the first span of inputs and
    /// returns its words.
    fn write(&mut self, link: &mut impl Link, words: &OutWords) -> Result<Option<InWords>, Fault> {
        let has_read_write = self.plan.kind.facts().has_read_write;
        let first_read = self.plan.reads[0];
        let mut answer = buffer();
        let (mut start, mut read) = (0, None);
        for index in 0..self.plan.writes.len() {
            let span = self.plan.writes[index];
            let words = part(&words.words, &mut start, &span);
            let is_last = index + 1 == self.plan.writes.len();
            if span.area.has_bits() {
                let mut packed = [0; 2 * MOST_OUT];
                for (pair, word) in packed.as_chunks_mut::<2>().0.iter_mut().zip(words) {
                    *pair = word.to_le_bytes();
                }
                let bits = Bits::new(&packed, usize::from(span.count))?;
                link.exchange(&Request::WriteCoils { first: span.first, bits }, &mut answer)?;
            } else if has_read_write && is_last && !first_read.area.has_bits() {
                let range = Range { first: first_read.first, count: first_read.count };
                let request =
                    Request::ReadWriteRegisters { read: range, first: span.first, words: Words::new(words) };
                let mut found = InWords::ZERO;
                store(link.exchange(&request, &mut answer)?, &mut found.words);
                read = Some(found);
            } else {
                let request = Request::WriteRegisters { first: span.first, words: Words::new(words) };
                link.exchange(&request, &mut answer)?;
            }
        }
        Ok(read)
    }

    pub(super) fn read_outputs(&mut self, link: &mut impl Link) -> Result<OutWords, Fault> {
        let mut outputs = OutWords::ZERO;
        let mut answer = buffer();
        let mut start = 0;
        for index in 0..self.plan.writes.len() {
            let span = self.plan.writes[index];
            let response = link.exchange(&reading(span), &mut answer)?;
            if let Some(place) = outputs.words.get_mut(start..start + span.words()) {
                store(response, place);
            }
            start += span.words();
        }
        self.heard_at = link.now();
        Ok(outputs)
    }

    pub(super) fn read_registers<const N: usize>(
        &mut self,
        link: &mut impl Link,
        first: u16,
    ) -> Result<[u16; N], Fault> {
        let count = u16::try_from(N).map_err(|_| Fault::Frame(FrameFault::Request))?;
        let mut answer = buffer();
        let response = link.exchange(&Request::ReadHoldingRegisters(Range { first, count }), &mut answer)?;
        let mut words = [0; N];
        store(response, &mut words);
        self.heard_at = link.now();
        Ok(words)
    }

    /// Reads the first word of a span.
    pub(super) fn read_register(&mut self, link: &mut impl Link, span: Span) -> Result<u16, Fault> {
        let mut answer = buffer();
        let mut word = [0];
        store(link.exchange(&reading(span), &mut answer)?, &mut word);
        self.heard_at = link.now();
        Ok(word[0])
    }

    pub(super) fn write_register(
        &mut self,
        link: &mut impl Link,
        address: u16,
        value: u16,
    ) -> Result<(), Fault> {
        link.exchange(&Request::WriteRegister { address, value }, &mut buffer())?;
        self.heard_at = link.now();
        Ok(())
    }
}

/// Takes over the words of the first span, which were read together with a write.
fn store_first(inputs: &mut InWords, start: &mut usize, found: &InWords, span: Span) {
    for (place, word) in inputs.words.iter_mut().zip(found.words).take(span.words()) {
        *place = word;
    }
    *start = span.words();
}
