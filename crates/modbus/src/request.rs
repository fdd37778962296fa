//! The nine requests: functions 1 to 6, 15, 16 and 23, as the bytes after the header.

use crate::{
    Error,
    bytes::{Reader, Writer},
    values::{Bits, Words, bytes_of_bits},
};

/// Function codes.
pub mod function {
    /// Read coils (AP 6.1).
    pub const READ_COILS: u8 = 1;
    /// Read discrete inputs (AP 6.2).
    pub const READ_DISCRETE_INPUTS: u8 = 2;
    /// Read holding registers (AP 6.3).
    pub const READ_HOLDING_REGISTERS: u8 = 3;
    /// Read input registers (AP 6.4).
    pub const READ_INPUT_REGISTERS: u8 = 4;
    /// Write a coil (AP 6.5).
    pub const WRITE_COIL: u8 = 5;
    /// Write a register (AP 6.6).
    pub const WRITE_REGISTER: u8 = 6;
    /// Write coils (AP 6.11).
    pub const WRITE_COILS: u8 = 15;
    /// Write registers (AP 6.12).
    pub const WRITE_REGISTERS: u8 = 16;
    /// Write registers, then read registers (AP 6.17).
    pub const READ_WRITE_REGISTERS: u8 = 23;
    /// Bit of the function in the answer of a server that refuses the request (AP 7).
    pub const REFUSED: u8 = 0x80;
}

/// Greatest number of bits that a request reads (AP 6.1, 6.2).
pub const MOST_READ_BITS: u16 = 2000;
/// Greatest number of registers that a request reads (AP 6.3, 6.4, 6.17).
pub const MOST_READ_WORDS: u16 = 125;
/// Greatest number of coils that a request writes (AP 6.11).
pub const MOST_WRITTEN_BITS: u16 = 1968;
/// Greatest number of registers that a request writes (AP 6.12).
pub const MOST_WRITTEN_WORDS: u16 = 123;
/// Greatest number of registers that a request writes if it also reads (AP 6.17).
pub const MOST_WRITTEN_WORDS_WITH_READ: u16 = 121;
/// Value of a coil that is on (AP 6.5).
pub const COIL_ON: u16 = 0xFF00;
/// Value of a coil that is off (AP 6.5).
pub const COIL_OFF: u16 = 0x0000;

/// A range of addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// First address.
    pub first: u16,
    /// Number of addresses.
    pub count: u16,
}

impl Range {
    fn check(self, most: u16) -> Result<Self, Error> {
        let Self { first, count } = self;
        if !(1..=most).contains(&count) {
            return Err(Error::BadQuantity { most, found: usize::from(count) });
        }
        let last = first.checked_add(count.saturating_sub(1)); // `count` is at least 1 here
        last.map(|_| self).ok_or(Error::BadAddress { first, count })
    }

    /// The addresses in order.
    pub fn addresses(self) -> impl Iterator<Item = u16> {
        (0..self.count).filter_map(move |offset| self.first.checked_add(offset))
    }
}

/// A request to a server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request<'a> {
    /// Read outputs of one bit.
    ReadCoils(Range),
    /// Read inputs of one bit.
    ReadDiscreteInputs(Range),
    /// Read registers that can be written.
    ReadHoldingRegisters(Range),
    /// Read registers that cannot be written.
    ReadInputRegisters(Range),
    /// Write an output of one bit.
    WriteCoil {
        /// Address of the coil.
        address: u16,
        /// Its new state.
        on: bool,
    },
    /// Write a register.
    WriteRegister {
        /// Address of the register.
        address: u16,
        /// Its new value.
        value: u16,
    },
    /// Write consecutive outputs of one bit.
    WriteCoils {
        /// Address of the first one.
        first: u16,
        /// The new states.
        bits: Bits<'a>,
    },
    /// Write consecutive registers.
    WriteRegisters {
        /// Address of the first one.
        first: u16,
        /// The new values.
        words: Words<'a>,
    },
    /// Write consecutive registers, then read others.
    ReadWriteRegisters {
        /// The registers to read.
        read: Range,
        /// Address of the first register to write.
        first: u16,
        /// The new values.
        words: Words<'a>,
    },
}

impl<'a> Request<'a> {
    /// The function code.
    #[must_use]
    pub const fn function(&self) -> u8 {
        match self {
            Self::ReadCoils(_) => function::READ_COILS,
            Self::ReadDiscreteInputs(_) => function::READ_DISCRETE_INPUTS,
            Self::ReadHoldingRegisters(_) => function::READ_HOLDING_REGISTERS,
            Self::ReadInputRegisters(_) => function::READ_INPUT_REGISTERS,
            Self::WriteCoil { .. } => function::WRITE_COIL,
            Self::WriteRegister { .. } => function::WRITE_REGISTER,
            Self::WriteCoils { .. } => function::WRITE_COILS,
            Self::WriteRegisters { .. } => function::WRITE_REGISTERS,
            Self::ReadWriteRegisters { .. } => function::READ_WRITE_REGISTERS,
        }
    }

    /// True if the request changes coils or registers.
    #[must_use]
    pub const fn writes(&self) -> bool {
        !matches!(
            self,
            Self::ReadCoils(_)
                | Self::ReadDiscreteInputs(_)
                | Self::ReadHoldingRegisters(_)
                | Self::ReadInputRegisters(_)
        )
    }

    /// Reads a request from the bytes after the header. [`Error::exception`] is the server's answer to an error.
    pub fn parse(body: &'a [u8]) -> Result<Self, Error> {
        let mut reader = Reader::new(body);
        let code = reader.byte()?;
        let request = match code {
            function::READ_COILS => Self::ReadCoils(range(&mut reader)?),
            function::READ_DISCRETE_INPUTS => Self::ReadDiscreteInputs(range(&mut reader)?),
            function::READ_HOLDING_REGISTERS => Self::ReadHoldingRegisters(range(&mut reader)?),
            function::READ_INPUT_REGISTERS => Self::ReadInputRegisters(range(&mut reader)?),
            function::WRITE_COIL => {
                let address = reader.word()?;
                let on = match reader.word()? {
                    COIL_ON => true,
                    COIL_OFF => false,
                    found => return Err(Error::BadCoil { found }),
                };
                Self::WriteCoil { address, on }
            }
            function::WRITE_REGISTER => {
                Self::WriteRegister { address: reader.word()?, value: reader.word()? }
            }
            function::WRITE_COILS => {
                let written = range(&mut reader)?;
                written.check(MOST_WRITTEN_BITS)?; // the quantity limits the byte count: check it first
                let count = usize::from(written.count);
                let bits = Bits::new(counted(&mut reader, bytes_of_bits(count))?, count)?;
                Self::WriteCoils { first: written.first, bits }
            }
            function::WRITE_REGISTERS => {
                let written = range(&mut reader)?;
                written.check(MOST_WRITTEN_WORDS)?;
                Self::WriteRegisters { first: written.first, words: words(&mut reader, written)? }
            }
            function::READ_WRITE_REGISTERS => {
                let read = range(&mut reader)?;
                let written = range(&mut reader)?;
                written.check(MOST_WRITTEN_WORDS_WITH_READ)?;
                Self::ReadWriteRegisters { read, first: written.first, words: words(&mut reader, written)? }
            }
            found => return Err(Error::UnknownFunction { found }),
        };
        reader.finish()?;
        request.check()?;
        Ok(request)
    }

    /// Writes the bytes after the header.
    pub(crate) fn emit(&self, data: &mut Writer<'_>) -> Result<(), Error> {
        self.check()?;
        data.byte(self.function())?;
        match *self {
            Self::ReadCoils(read)
            | Self::ReadDiscreteInputs(read)
            | Self::ReadHoldingRegisters(read)
            | Self::ReadInputRegisters(read) => put_range(data, read),
            Self::WriteCoil { address, on } => {
                data.word(address)?;
                data.word(coil(on))
            }
            Self::WriteRegister { address, value } => {
                data.word(address)?;
                data.word(value)
            }
            Self::WriteCoils { first, bits } => {
                put_range(data, bits_range(first, bits))?;
                put_bits(data, bits.len(), bits.iter().map(Ok))
            }
            Self::WriteRegisters { first, words } => {
                put_range(data, words_range(first, words))?;
                put_words(data, words.len(), words.iter().map(Ok))
            }
            Self::ReadWriteRegisters { read, first, words } => {
                put_range(data, read)?;
                put_range(data, words_range(first, words))?;
                put_words(data, words.len(), words.iter().map(Ok))
            }
        }
    }

    fn check(&self) -> Result<(), Error> {
        match *self {
            Self::ReadCoils(read) | Self::ReadDiscreteInputs(read) => read.check(MOST_READ_BITS),
            Self::ReadHoldingRegisters(read) | Self::ReadInputRegisters(read) => read.check(MOST_READ_WORDS),
            Self::WriteCoil { .. } | Self::WriteRegister { .. } => return Ok(()),
            Self::WriteCoils { first, bits } => bits_range(first, bits).check(MOST_WRITTEN_BITS),
            Self::WriteRegisters { first, words } => words_range(first, words).check(MOST_WRITTEN_WORDS),
            Self::ReadWriteRegisters { read, first, words } => {
                read.check(MOST_READ_WORDS)?;
                words_range(first, words).check(MOST_WRITTEN_WORDS_WITH_READ)
            }
        }
        .map(|_| ())
    }
}

pub(crate) const fn coil(on: bool) -> u16 {
    if on { COIL_ON } else { COIL_OFF }
}

/// A count that no range can have is refused by the check of the quantity.
pub(crate) fn bits_range(first: u16, bits: Bits<'_>) -> Range {
    Range { first, count: u16::try_from(bits.len()).unwrap_or(u16::MAX) }
}

/// The range of registers; see [`bits_range`].
pub(crate) fn words_range(first: u16, words: Words<'_>) -> Range {
    Range { first, count: u16::try_from(words.len()).unwrap_or(u16::MAX) }
}

fn range(reader: &mut Reader<'_>) -> Result<Range, Error> {
    Ok(Range { first: reader.word()?, count: reader.word()? })
}

fn put_range(data: &mut Writer<'_>, range: Range) -> Result<(), Error> {
    data.word(range.first)?;
    data.word(range.count)
}

/// Reads a byte count, which must be `expected`, and that number of bytes.
pub(crate) fn counted<'a>(reader: &mut Reader<'a>, expected: usize) -> Result<&'a [u8], Error> {
    let found = reader.byte()?;
    if usize::from(found) != expected {
        return Err(Error::BadByteCount { expected: u8::try_from(expected).unwrap_or(u8::MAX), found });
    }
    reader.take(expected)
}

fn words<'a>(reader: &mut Reader<'a>, range: Range) -> Result<Words<'a>, Error> {
    counted(reader, usize::from(range.count).saturating_mul(2)).map(Words::in_frame)
}

/// Writes the byte count and the bits. Unused bits of the last byte are 0 (AP 6.1).
pub(crate) fn put_bits(
    data: &mut Writer<'_>,
    count: usize,
    bits: impl Iterator<Item = Result<bool, Error>>,
) -> Result<(), Error> {
    data.byte(u8::try_from(bytes_of_bits(count)).unwrap_or(u8::MAX))?;
    let mut bits = bits.peekable();
    while bits.peek().is_some() {
        let mut byte = 0;
        for (shift, bit) in bits.by_ref().take(8).enumerate() {
            byte |= u8::from(bit?) << shift;
        }
        data.byte(byte)?;
    }
    Ok(())
}

pub(crate) fn put_words(
    data: &mut Writer<'_>,
    count: usize,
    mut words: impl Iterator<Item = Result<u16, Error>>,
) -> Result<(), Error> {
    data.byte(u8::try_from(count.saturating_mul(2)).unwrap_or(u8::MAX))?;
    words.try_for_each(|word| data.word(word?))
}
