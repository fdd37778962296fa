//! The server: answers requests from the four tables of a device.

use crate::{
    Bits, Error, Exception, Header, Request, Words,
    bytes::Writer,
    request::{Range, bits_range, coil, function, put_bits, put_words, words_range},
};

/// Tables of a device. Default methods refuse the functions of a missing table. A write changes all values or none.
pub trait Tables {
    /// Called before each request is carried out; an exception refuses it.
    fn admit(&mut self, unit: u8, request: &Request<'_>) -> Result<(), Exception> {
        let _ = (unit, request);
        Ok(())
    }

    /// The coil at an address. Errors: the exception of the answer, such as [`Exception::IllegalDataAddress`].
    fn coil(&mut self, address: u16) -> Result<bool, Exception> {
        let _ = address;
        Err(Exception::IllegalFunction)
    }

    /// The discrete input at an address. Errors: those of [`Self::coil`].
    fn discrete_input(&mut self, address: u16) -> Result<bool, Exception> {
        let _ = address;
        Err(Exception::IllegalFunction)
    }

    /// The holding register at an address. Errors: those of [`Self::coil`].
    fn holding_register(&mut self, address: u16) -> Result<u16, Exception> {
        let _ = address;
        Err(Exception::IllegalFunction)
    }

    /// The input register at an address. Errors: those of [`Self::coil`].
    fn input_register(&mut self, address: u16) -> Result<u16, Exception> {
        let _ = address;
        Err(Exception::IllegalFunction)
    }

    /// Writes coils. Errors: those of [`Self::coil`], or [`Exception::IllegalDataValue`].
    fn write_coils(&mut self, first: u16, bits: Bits<'_>) -> Result<(), Exception> {
        let _ = (first, bits);
        Err(Exception::IllegalFunction)
    }

    /// Writes the holding registers from an address on. Errors: those of [`Self::write_coils`].
    fn write_registers(&mut self, first: u16, words: Words<'_>) -> Result<(), Exception> {
        let _ = (first, words);
        Err(Exception::IllegalFunction)
    }
}

/// Carries out the request in a whole frame, writes the answer or the exception into `buffer`, and returns its length;
/// [`MOST_FRAME_BYTES`](crate::MOST_FRAME_BYTES) are enough. After [`Error::BadProtocol`], [`Error::BadLength`] and
/// [`Error::BadSize`] close the connection. After [`Error::NoRoom`] the request may have been carried out.
pub fn answer(frame: &[u8], tables: &mut impl Tables, buffer: &mut [u8]) -> Result<usize, Error> {
    let (header, body) = Header::split(frame)?;
    let carried_out = header.emit(buffer, |data| {
        let request = Request::parse(body)?;
        tables.admit(header.unit, &request).map_err(Error::Refused)?;
        carry_out(&request, tables, data)
    });
    match carried_out {
        Err(error @ Error::NoRoom { .. }) => Err(error),
        Err(error) => header.emit(buffer, |data| {
            data.byte(body.first().copied().unwrap_or(0) | function::REFUSED)?;
            data.byte(error.exception().code())
        }),
        Ok(length) => Ok(length),
    }
}

fn carry_out(request: &Request<'_>, tables: &mut impl Tables, data: &mut Writer<'_>) -> Result<(), Error> {
    data.byte(request.function())?;
    match *request {
        Request::ReadCoils(read) => put_range_of_bits(data, read, |address| tables.coil(address)),
        Request::ReadDiscreteInputs(read) => {
            put_range_of_bits(data, read, |address| tables.discrete_input(address))
        }
        Request::ReadHoldingRegisters(read) => {
            put_range_of_words(data, read, |address| tables.holding_register(address))
        }
        Request::ReadInputRegisters(read) => {
            put_range_of_words(data, read, |address| tables.input_register(address))
        }
        Request::WriteCoil { address, on } => {
            let state = [u8::from(on)];
            tables.write_coils(address, Bits::new(&state, 1)?).map_err(Error::Refused)?;
            echo(data, address, coil(on))
        }
        Request::WriteRegister { address, value } => {
            tables.write_registers(address, Words::new(&[value])).map_err(Error::Refused)?;
            echo(data, address, value)
        }
        Request::WriteCoils { first, bits } => {
            tables.write_coils(first, bits).map_err(Error::Refused)?;
            echo(data, first, bits_range(first, bits).count)
        }
        Request::WriteRegisters { first, words } => {
            tables.write_registers(first, words).map_err(Error::Refused)?;
            echo(data, first, words_range(first, words).count)
        }
        // AP 6.17: the write operation comes first.
        Request::ReadWriteRegisters { read, first, words } => {
            tables.write_registers(first, words).map_err(Error::Refused)?;
            put_range_of_words(data, read, |address| tables.holding_register(address))
        }
    }
}

fn echo(data: &mut Writer<'_>, first: u16, second: u16) -> Result<(), Error> {
    data.word(first)?;
    data.word(second)
}

/// Each bit from its table.
fn put_range_of_bits(
    data: &mut Writer<'_>,
    read: Range,
    mut bit: impl FnMut(u16) -> Result<bool, Exception>,
) -> Result<(), Error> {
    let bits = read.addresses().map(|address| bit(address).map_err(Error::Refused));
    put_bits(data, usize::from(read.count), bits)
}

/// Writes the registers of a range, each from its table.
fn put_range_of_words(
    data: &mut Writer<'_>,
    read: Range,
    mut word: impl FnMut(u16) -> Result<u16, Exception>,
) -> Result<(), Error> {
    let words = read.addresses().map(|address| word(address).map_err(Error::Refused));
    put_words(data, usize::from(read.count), words)
}

/// A device with its tables in memory; addresses begin with 0.
#[derive(Debug)]
pub struct Memory<'a> {
    /// Coils.
    pub coils: &'a mut [bool],
    /// Discrete inputs.
    pub discrete_inputs: &'a [bool],
    /// Holding registers.
    pub holding_registers: &'a mut [u16],
    /// Input registers.
    pub input_registers: &'a [u16],
}

fn at<T: Copy>(table: &[T], address: u16) -> Result<T, Exception> {
    table.get(usize::from(address)).copied().ok_or(Exception::IllegalDataAddress)
}

/// The `count` writable values from an address on.
fn part<T>(table: &mut [T], first: u16, count: usize) -> Result<&mut [T], Exception> {
    let first = usize::from(first);
    table.get_mut(first..first.saturating_add(count)).ok_or(Exception::IllegalDataAddress)
}

impl Tables for Memory<'_> {
    fn coil(&mut self, address: u16) -> Result<bool, Exception> {
        at(self.coils, address)
    }

    fn discrete_input(&mut self, address: u16) -> Result<bool, Exception> {
        at(self.discrete_inputs, address)
    }

    fn holding_register(&mut self, address: u16) -> Result<u16, Exception> {
        at(self.holding_registers, address)
    }

    fn input_register(&mut self, address: u16) -> Result<u16, Exception> {
        at(self.input_registers, address)
    }

    fn write_coils(&mut self, first: u16, bits: Bits<'_>) -> Result<(), Exception> {
        let place = part(self.coils, first, bits.len())?;
        for (coil, bit) in place.iter_mut().zip(bits.iter()) {
            *coil = bit;
        }
        Ok(())
    }

    fn write_registers(&mut self, first: u16, words: Words<'_>) -> Result<(), Exception> {
        words.copy_to(part(self.holding_registers, first, words.len())?);
        Ok(())
    }
}
