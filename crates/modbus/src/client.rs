//! The client: writes requests, and accepts an answer only if it belongs to the request.

use crate::{
    Bits, Error, Exception, Header, Request, Words,
    bytes::Reader,
    request::{bits_range, coil, counted, function, words_range},
    values::bytes_of_bits,
};

/// The answer of a server that carried out the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response<'a> {
    /// The bits that were read.
    Bits(Bits<'a>),
    /// The registers that were read.
    Words(Words<'a>),
    /// The values were written.
    Written,
}

impl<'a> Response<'a> {
    /// Reads an answer after its header. [`Error::Refused`] if the server refused, another error for an invalid answer.
    pub fn parse(request: &Request<'_>, body: &'a [u8]) -> Result<Self, Error> {
        let mut reader = Reader::new(body);
        let (expected, found) = (request.function(), reader.byte()?);
        if found == expected | function::REFUSED {
            let code = reader.byte()?;
            reader.finish()?;
            return Err(Error::Refused(Exception::from_code(code)));
        }
        if found != expected {
            return Err(Error::BadFunction { expected, found });
        }
        let response = match *request {
            Request::ReadCoils(read) | Request::ReadDiscreteInputs(read) => {
                let count = usize::from(read.count);
                Self::Bits(Bits::new(counted(&mut reader, bytes_of_bits(count))?, count)?)
            }
            Request::ReadHoldingRegisters(read)
            | Request::ReadInputRegisters(read)
            | Request::ReadWriteRegisters { read, .. } => {
                let bytes = counted(&mut reader, usize::from(read.count).saturating_mul(2))?;
                Self::Words(Words::in_frame(bytes))
            }
            Request::WriteCoil { address, on } => echo(&mut reader, address, coil(on))?,
            Request::WriteRegister { address, value } => echo(&mut reader, address, value)?,
            Request::WriteCoils { first, bits } => echo(&mut reader, first, bits_range(first, bits).count)?,
            Request::WriteRegisters { first, words } => {
                echo(&mut reader, first, words_range(first, words).count)?
            }
        };
        reader.finish()?;
        Ok(response)
    }

    /// The registers of the answer.
    #[must_use]
    pub const fn words(self) -> Option<Words<'a>> {
        if let Self::Words(words) = self { Some(words) } else { None }
    }

    /// The bits of the answer.
    #[must_use]
    pub const fn bits(self) -> Option<Bits<'a>> {
        if let Self::Bits(bits) = self { Some(bits) } else { None }
    }
}

/// The first two words of a write request (AP 6.5, 6.6, 6.11, 6.12).
fn echo<'a>(reader: &mut Reader<'_>, first: u16, second: u16) -> Result<Response<'a>, Error> {
    for expected in [first, second] {
        let found = reader.word()?;
        if found != expected {
            return Err(Error::BadEcho { expected, found });
        }
    }
    Ok(Response::Written)
}

/// The client's end of a connection, with one request at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Client {
    unit: u8,
    transaction: u16,
}

impl Client {
    /// A client of a unit, whose first request has the transaction identifier 1.
    #[must_use]
    pub const fn new(unit: u8) -> Self {
        Self { unit, transaction: 0 }
    }

    /// The transaction identifier of the last request; 0 before the first one.
    #[must_use]
    pub const fn transaction(&self) -> u16 {
        self.transaction
    }

    /// Writes a request with the next transaction identifier; returns its length.
    /// [`MOST_FRAME_BYTES`](crate::MOST_FRAME_BYTES) are enough for every request.
    pub fn request(&mut self, request: &Request<'_>, buffer: &mut [u8]) -> Result<usize, Error> {
        self.transaction = self.transaction.wrapping_add(1);
        self.header().emit(buffer, |data| request.emit(data))
    }

    /// Reads the answer from a whole frame. [`Error::Refused`] if the server refused; after other errors the
    /// connection must be closed: see [`Error::ends_connection`].
    pub fn answer<'a>(&self, request: &Request<'_>, frame: &'a [u8]) -> Result<Response<'a>, Error> {
        let (header, body) = Header::split(frame)?;
        let expected = self.header();
        if header.transaction != expected.transaction {
            return Err(Error::BadTransaction { expected: expected.transaction, found: header.transaction });
        }
        if header.unit != expected.unit {
            return Err(Error::BadUnit { expected: expected.unit, found: header.unit });
        }
        Response::parse(request, body)
    }

    const fn header(&self) -> Header {
        Header { transaction: self.transaction, unit: self.unit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::Range;

    const READ: Request<'static> = Request::ReadHoldingRegisters(Range { first: 0x6B, count: 3 });
    const ANSWER: [u8; 15] = [0, 1, 0, 0, 0, 9, 17, 0x03, 6, 0x02, 0x2B, 0x00, 0x00, 0x00, 0x64];

    fn client() -> Client {
        let mut client = Client::new(17);
        client.request(&READ, &mut [0; 12]).unwrap();
        client
    }

    fn changed(index: usize, value: u8) -> Result<Response<'static>, Error> {
        let mut frame = ANSWER;
        frame[index] = value;
        client().answer(&READ, &frame).map(|_| Response::Written)
    }

    #[test]
    fn answer_of_the_request_is_accepted() {
        let words = client().answer(&READ, &ANSWER).unwrap().words().unwrap();
        assert_eq!(words, Words::new(&[0x022B, 0, 0x64]));
    }

    #[test]
    fn answer_of_another_request_is_refused() {
        assert_eq!(changed(1, 2), Err(Error::BadTransaction { expected: 1, found: 2 }));
        assert_eq!(changed(6, 1), Err(Error::BadUnit { expected: 17, found: 1 }));
        assert_eq!(changed(7, 4), Err(Error::BadFunction { expected: 3, found: 4 }));
        assert_eq!(changed(8, 4), Err(Error::BadByteCount { expected: 6, found: 4 }));
        assert_eq!(changed(3, 1), Err(Error::BadProtocol { found: 1 }));
        for error in [changed(1, 2), changed(6, 1), changed(7, 4), changed(8, 4), changed(3, 1)] {
            assert!(error.unwrap_err().ends_connection());
        }
    }

    #[test]
    fn exception_keeps_the_connection() {
        let frame = [0, 1, 0, 0, 0, 3, 17, 0x83, 2];
        let refused = client().answer(&READ, &frame).unwrap_err();
        assert_eq!(refused, Error::Refused(Exception::IllegalDataAddress));
        assert!(!refused.ends_connection());
        let longer = [0, 1, 0, 0, 0, 4, 17, 0x83, 2, 0];
        assert_eq!(client().answer(&READ, &longer), Err(Error::BadSize { expected: 2, found: 3 }));
    }

    #[test]
    fn other_echo_is_refused() {
        let request = Request::WriteRegister { address: 1, value: 3 };
        let error = |body: &[u8]| Response::parse(&request, body).map(|_| ());
        assert_eq!(error(&[6, 0, 1, 0, 3]), Ok(()));
        assert_eq!(error(&[6, 0, 2, 0, 3]), Err(Error::BadEcho { expected: 1, found: 2 }));
        assert_eq!(error(&[6, 0, 1, 0, 4]), Err(Error::BadEcho { expected: 3, found: 4 }));
        assert_eq!(error(&[6, 0, 1, 0, 3, 0]), Err(Error::BadSize { expected: 5, found: 6 }));
    }

    #[test]
    fn impossible_requests_are_refused() {
        let error = |request: Request<'_>| Client::new(1).request(&request, &mut [0; 260]);
        let read = |first, count| error(Request::ReadInputRegisters(Range { first, count }));
        assert_eq!(read(0, 0), Err(Error::BadQuantity { most: 125, found: 0 }));
        assert_eq!(read(0, 126), Err(Error::BadQuantity { most: 125, found: 126 }));
        assert_eq!(read(0xFFFF, 2), Err(Error::BadAddress { first: 0xFFFF, count: 2 }));
        assert_eq!(read(0xFFFF, 1), Ok(12));
        let write =
            |count| error(Request::WriteRegisters { first: 0, words: Words::new(&[7; 124][..count]) });
        assert_eq!(write(123), Ok(259));
        assert_eq!(write(124), Err(Error::BadQuantity { most: 123, found: 124 }));
        let read = Range { first: 0, count: 125 };
        let both = |count| {
            error(Request::ReadWriteRegisters { read, first: 0, words: Words::new(&[7; 122][..count]) })
        };
        assert_eq!(both(121), Ok(259));
        assert_eq!(both(122), Err(Error::BadQuantity { most: 121, found: 122 }));
    }
}
