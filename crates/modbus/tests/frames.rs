//! The specification's examples, byte for byte, in both directions.

use modbus::{
    Bits, Client, Error, Exception, Header, MOST_FRAME_BYTES, Request, Response, Tables, Words,
    request::Range, server,
};

/// A device with the values of the examples.
#[derive(Default)]
struct Device {
    coils: Vec<(u16, bool)>,
    registers: Vec<(u16, u16)>,
}

/// The bits of an example are counted from `first`.
fn bit(bytes: &[u8], first: u16, address: u16) -> Result<bool, Exception> {
    let index = address.checked_sub(first).ok_or(Exception::IllegalDataAddress)?;
    let byte = bytes.get(usize::from(index / 8)).ok_or(Exception::IllegalDataAddress)?;
    Ok(byte >> (index % 8) & 1 == 1)
}

impl Tables for Device {
    fn coil(&mut self, address: u16) -> Result<bool, Exception> {
        bit(&[0xCD, 0x6B, 0x05], 0x13, address)
    }

    fn discrete_input(&mut self, address: u16) -> Result<bool, Exception> {
        bit(&[0xAC, 0xDB, 0x35], 0xC4, address)
    }

    fn holding_register(&mut self, address: u16) -> Result<u16, Exception> {
        match address {
            0x6B => Ok(0x022B),
            0x6C => Ok(0x0000),
            0x6D => Ok(0x0064),
            3..=8 => Ok([0x00FE, 0x0ACD, 0x0001, 0x0003, 0x000D, 0x00FF][usize::from(address) - 3]),
            _ => Err(Exception::IllegalDataAddress),
        }
    }

    fn input_register(&mut self, address: u16) -> Result<u16, Exception> {
        if address == 8 { Ok(10) } else { Err(Exception::IllegalDataAddress) }
    }

    fn write_coils(&mut self, first: u16, bits: Bits<'_>) -> Result<(), Exception> {
        self.coils.extend((first..).zip(bits.iter()));
        Ok(())
    }

    fn write_registers(&mut self, first: u16, words: Words<'_>) -> Result<(), Exception> {
        self.registers.extend((first..).zip(words.iter()));
        Ok(())
    }
}

/// A frame with the header of the first request to unit 17.
fn frame(body: &[u8]) -> Vec<u8> {
    let length = u8::try_from(body.len() + 1).unwrap();
    [&[0, 1, 0, 0, 0, length, 17], body].concat()
}

/// The client writes the request, the server reads it and answers, the client reads the answer.
fn check(
    request: Request<'_>,
    asked: &[u8],
    answered: &[u8],
    meaning: Result<Response<'_>, Error>,
) -> Device {
    let (asked, answered) = (frame(asked), frame(answered));
    let mut client = Client::new(17);
    let mut buffer = [0xA5; MOST_FRAME_BYTES];
    let length = client.request(&request, &mut buffer).unwrap();
    assert_eq!(buffer[..length], asked);
    assert!(buffer[length..].iter().all(|byte| *byte == 0xA5), "only the frame is written");
    let (header, body) = Header::split(&asked).unwrap();
    assert_eq!(header, Header { transaction: 1, unit: 17 });
    assert_eq!(Request::parse(body), Ok(request));
    let mut device = Device::default();
    let mut buffer = [0xA5; MOST_FRAME_BYTES];
    let length = server::answer(&asked, &mut device, &mut buffer).unwrap();
    assert_eq!(buffer[..length], answered);
    assert!(buffer[length..].iter().all(|byte| *byte == 0xA5), "only the frame is written");
    assert_eq!(client.answer(&request, &answered), meaning);
    device
}

#[test]
fn read_coils_has_the_bytes_of_6_1() {
    let bytes = [0xCD, 0x6B, 0x05];
    let bits = Bits::new(&bytes, 19).unwrap();
    let request = Request::ReadCoils(Range { first: 0x13, count: 19 });
    check(request, &[1, 0, 0x13, 0, 0x13], &[1, 3, 0xCD, 0x6B, 0x05], Ok(Response::Bits(bits)));
}

#[test]
fn read_discrete_inputs_has_the_bytes_of_6_2() {
    let bytes = [0xAC, 0xDB, 0x35];
    let bits = Bits::new(&bytes, 22).unwrap();
    let request = Request::ReadDiscreteInputs(Range { first: 0xC4, count: 22 });
    check(request, &[2, 0, 0xC4, 0, 0x16], &[2, 3, 0xAC, 0xDB, 0x35], Ok(Response::Bits(bits)));
}

#[test]
fn read_holding_registers_has_the_bytes_of_6_3() {
    let request = Request::ReadHoldingRegisters(Range { first: 0x6B, count: 3 });
    let words = Response::Words(Words::new(&[0x022B, 0, 0x64]));
    check(request, &[3, 0, 0x6B, 0, 3], &[3, 6, 0x02, 0x2B, 0, 0, 0, 0x64], Ok(words));
}

#[test]
fn read_input_registers_has_the_bytes_of_6_4() {
    let request = Request::ReadInputRegisters(Range { first: 8, count: 1 });
    check(request, &[4, 0, 8, 0, 1], &[4, 2, 0, 0x0A], Ok(Response::Words(Words::new(&[10]))));
}

#[test]
fn write_coil_has_the_bytes_of_6_5() {
    let bytes = [5, 0, 0xAC, 0xFF, 0];
    let request = Request::WriteCoil { address: 0xAC, on: true };
    assert_eq!(check(request, &bytes, &bytes, Ok(Response::Written)).coils, [(0xAC, true)]);
    let bytes = [5, 0, 0xAC, 0, 0];
    let request = Request::WriteCoil { address: 0xAC, on: false };
    assert_eq!(check(request, &bytes, &bytes, Ok(Response::Written)).coils, [(0xAC, false)]);
}

#[test]
fn write_register_has_the_bytes_of_6_6() {
    let bytes = [6, 0, 1, 0, 3];
    let request = Request::WriteRegister { address: 1, value: 3 };
    assert_eq!(check(request, &bytes, &bytes, Ok(Response::Written)).registers, [(1, 3)]);
}

#[test]
fn write_coils_has_the_bytes_of_6_11() {
    let bits = Bits::new(&[0xCD, 0x01], 10).unwrap();
    let request = Request::WriteCoils { first: 0x13, bits };
    let asked = [0x0F, 0, 0x13, 0, 0x0A, 2, 0xCD, 0x01];
    let device = check(request, &asked, &asked[..5], Ok(Response::Written));
    assert!(device.coils.iter().map(|(_, bit)| *bit).eq(bits.iter()));
    assert_eq!(device.coils[9], (0x1C, false));
}

#[test]
fn write_registers_has_the_bytes_of_6_12() {
    let request = Request::WriteRegisters { first: 1, words: Words::new(&[10, 0x0102]) };
    let asked = [0x10, 0, 1, 0, 2, 4, 0, 0x0A, 1, 2];
    let device = check(request, &asked, &asked[..5], Ok(Response::Written));
    assert_eq!(device.registers, [(1, 10), (2, 0x0102)]);
}

#[test]
fn read_write_registers_has_the_bytes_of_6_17() {
    let request = Request::ReadWriteRegisters {
        read: Range { first: 3, count: 6 },
        first: 0x0E,
        words: Words::new(&[0xFF; 3]),
    };
    let asked = [0x17, 0, 3, 0, 6, 0, 0x0E, 0, 3, 6, 0, 0xFF, 0, 0xFF, 0, 0xFF];
    let answered = [0x17, 12, 0, 0xFE, 0x0A, 0xCD, 0, 1, 0, 3, 0, 0x0D, 0, 0xFF];
    let words = Words::new(&[0xFE, 0x0ACD, 1, 3, 0x0D, 0xFF]);
    let device = check(request, &asked, &answered, Ok(Response::Words(words)));
    assert_eq!(device.registers, [(0x0E, 0xFF), (0x0F, 0xFF), (0x10, 0xFF)]);
}

#[test]
fn exception_has_the_bytes_of_7() {
    let request = Request::ReadCoils(Range { first: 0x04A1, count: 1 });
    let refused = Err(Error::Refused(Exception::IllegalDataAddress));
    check(request, &[1, 4, 0xA1, 0, 1], &[0x81, 2], refused);
}

/// The body of the answer to the body of a request.
fn answer_of(body: &[u8]) -> Vec<u8> {
    let mut buffer = [0xA5; MOST_FRAME_BYTES];
    let length = server::answer(&frame(body), &mut Device::default(), &mut buffer).unwrap();
    buffer[7..length].to_vec()
}

#[test]
fn wrong_requests_are_answered_with_the_exception_of_the_specification() {
    // Function, then quantity, then address (AP 6.1, figure 11).
    assert_eq!(answer_of(&[0x2B, 0x0E, 1, 0]), [0xAB, 1]);
    assert_eq!(answer_of(&[0]), [0x80, 1]);
    assert_eq!(answer_of(&[3, 0, 0, 0, 0]), [0x83, 3]);
    assert_eq!(answer_of(&[3, 0, 0, 0, 126]), [0x83, 3]);
    assert_eq!(answer_of(&[1, 0, 0, 0x07, 0xD1]), [0x81, 3]);
    assert_eq!(answer_of(&[3, 0xFF, 0xFF, 0, 2]), [0x83, 2]);
    assert_eq!(answer_of(&[3, 0, 0x6B, 0, 4]), [0x83, 2]);
    assert_eq!(answer_of(&[5, 0, 0xAC, 1, 0]), [0x85, 3]);
    // AP 7: an incorrect implied length is an illegal data value.
    assert_eq!(answer_of(&[3, 0, 0x6B, 0]), [0x83, 3]);
    assert_eq!(answer_of(&[3, 0, 0x6B, 0, 3, 0]), [0x83, 3]);
    assert_eq!(answer_of(&[16, 0, 1, 0, 2, 3, 0, 10, 1, 2]), [0x90, 3]);
    assert_eq!(answer_of(&[16, 0, 1, 0, 2, 4, 0, 10, 1]), [0x90, 3]);
    assert_eq!(answer_of(&[16, 0, 1]), [0x90, 3]);
    assert_eq!(answer_of(&[15, 0, 0x13, 0, 10, 1, 0xCD]), [0x8F, 3]);
    assert_eq!(answer_of(&[23, 0, 3, 0, 6, 0, 14, 0, 122, 244]), [0x97, 3]);
}

#[test]
fn table_that_a_device_lacks_is_an_illegal_function() {
    struct Nothing;
    impl Tables for Nothing {}
    for body in [
        &[1, 0, 0, 0, 1][..],
        &[2, 0, 0, 0, 1],
        &[3, 0, 0, 0, 1],
        &[4, 0, 0, 0, 1],
        &[5, 0, 0, 0, 0],
        &[6, 0, 0, 0, 0],
        &[15, 0, 0, 0, 1, 1, 0],
        &[16, 0, 0, 0, 1, 2, 0, 0],
        &[23, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0],
    ] {
        let mut buffer = [0xA5; MOST_FRAME_BYTES];
        let length = server::answer(&frame(body), &mut Nothing, &mut buffer).unwrap();
        assert_eq!(buffer[7..length], [body[0] | 0x80, 1]);
    }
}
