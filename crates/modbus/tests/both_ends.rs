//! Client and server against each other, and against damaged frames.

use modbus::{
    Bits, Client, Error, Exception, Header, MOST_FRAME_BYTES, Request, Response, Words, mbap,
    request::Range,
    server::{self, Memory},
};
use proptest::prelude::*;

const SIZE: u16 = 2100;

/// Each table has [`SIZE`] values.
#[derive(Clone, Debug, PartialEq)]
struct Device {
    coils: Vec<bool>,
    discrete: Vec<bool>,
    holding: Vec<u16>,
    input: Vec<u16>,
}

impl Device {
    fn new() -> Self {
        let words = |factor: u16| (0..SIZE).map(move |index| index.wrapping_mul(factor)).collect::<Vec<_>>();
        let bits = |factor| words(factor).into_iter().map(|word| word & 0x40 != 0).collect();
        Self { coils: bits(37), discrete: bits(41), holding: words(31), input: words(43) }
    }

    fn memory(&mut self) -> Memory<'_> {
        Memory {
            coils: &mut self.coils,
            discrete_inputs: &self.discrete,
            holding_registers: &mut self.holding,
            input_registers: &self.input,
        }
    }
}

#[derive(Clone, Debug)]
struct Owned {
    function: u8,
    read: Range,
    first: u16,
    words: Vec<u16>,
    bytes: Vec<u8>,
    count: usize,
}

impl Owned {
    fn request(&self) -> Request<'_> {
        let words = Words::new(&self.words);
        match self.function {
            1 => Request::ReadCoils(self.read),
            2 => Request::ReadDiscreteInputs(self.read),
            3 => Request::ReadHoldingRegisters(self.read),
            4 => Request::ReadInputRegisters(self.read),
            5 => Request::WriteCoil { address: self.first, on: self.words[0] & 1 == 1 },
            6 => Request::WriteRegister { address: self.first, value: self.words[0] },
            15 => {
                let bits = Bits::new(&self.bytes, self.count).expect("enough bytes");
                Request::WriteCoils { first: self.first, bits }
            }
            16 => Request::WriteRegisters { first: self.first, words },
            _ => Request::ReadWriteRegisters { read: self.read, first: self.first, words },
        }
    }
}

fn requests() -> impl Strategy<Value = Owned> {
    let function = prop::sample::select(vec![1, 2, 3, 4, 5, 6, 15, 16, 23]);
    function.prop_flat_map(|function| {
        let most: u16 = if function <= 2 { 2000 } else { 125 };
        let words = match function {
            16 => 1..=123,
            23 => 1..=121,
            _ => 1..=1,
        };
        // Some ranges end beyond the device.
        let read = (0..SIZE, 1..=most).prop_map(|(first, count)| Range { first, count });
        let bytes = prop::collection::vec(any::<u8>(), 246);
        (read, 0..SIZE, prop::collection::vec(any::<u16>(), words), bytes, 1..=1968_usize).prop_map(
            move |(read, first, words, bytes, count)| Owned { function, read, first, words, bytes, count },
        )
    })
}

fn read<T: Copy>(table: &[T], range: Range) -> Option<Vec<T>> {
    let first = usize::from(range.first);
    table.get(first..first + usize::from(range.count)).map(<[T]>::to_vec)
}

fn write<T: Copy>(table: &mut [T], first: u16, values: &[T]) -> Option<()> {
    let first = usize::from(first);
    table.get_mut(first..first + values.len()).map(|place| place.copy_from_slice(values))
}

/// Bits as words; `None` if the device lacks an address.
fn expected(request: &Owned, device: &mut Device) -> Option<Vec<u16>> {
    let of_bits = |bits: Vec<bool>| bits.into_iter().map(u16::from).collect();
    match request.function {
        1 => read(&device.coils, request.read).map(of_bits),
        2 => read(&device.discrete, request.read).map(of_bits),
        3 => read(&device.holding, request.read),
        4 => read(&device.input, request.read),
        5 => write(&mut device.coils, request.first, &[request.words[0] & 1 == 1]).map(|()| Vec::new()),
        6 | 16 => write(&mut device.holding, request.first, &request.words).map(|()| Vec::new()),
        15 => {
            let bits: Vec<bool> =
                (0..request.count).map(|index| request.bytes[index / 8] >> (index % 8) & 1 == 1).collect();
            write(&mut device.coils, request.first, &bits).map(|()| Vec::new())
        }
        _ => {
            write(&mut device.holding, request.first, &request.words)?;
            read(&device.holding, request.read)
        }
    }
}

fn values(response: Response<'_>) -> Vec<u16> {
    match response {
        Response::Bits(bits) => bits.iter().map(u16::from).collect(),
        Response::Words(words) => words.iter().collect(),
        Response::Written => Vec::new(),
    }
}

proptest! {
    #[test]
    fn server_answers_from_its_tables(all in prop::collection::vec(requests(), 1..8)) {
        let (mut device, mut model) = (Device::new(), Device::new());
        let mut client = Client::new(1);
        for owned in &all {
            let request = owned.request();
            let (mut asked, mut answered) = ([0xA5; MOST_FRAME_BYTES], [0xA5; MOST_FRAME_BYTES]);
            let length = client.request(&request, &mut asked).expect("a request within the limits");
            prop_assert_eq!(mbap::needed(&asked[..length]), Ok(length));
            let length = server::answer(&asked[..length], &mut device.memory(), &mut answered).expect("an answer");
            let response = client.answer(&request, &answered[..length]);
            match expected(owned, &mut model) {
                Some(expected) => prop_assert_eq!(response.map(values), Ok(expected)),
                None => prop_assert_eq!(response, Err(Error::Refused(Exception::IllegalDataAddress))),
            }
            prop_assert_eq!(&device, &model);
        }
    }

    #[test]
    fn any_bytes_are_answered_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300), request in requests()) {
        let mut buffer = [0xA5; MOST_FRAME_BYTES];
        if let Ok(length) = server::answer(&bytes, &mut Device::new().memory(), &mut buffer) {
            prop_assert_eq!(mbap::needed(&buffer[..length]), Ok(length));
        }
        let _ = Client::new(1).answer(&request.request(), &bytes);
        let _ = Request::parse(&bytes);
        let _ = Response::parse(&request.request(), &bytes);
    }
}

fn one_of_each() -> Vec<Owned> {
    let one = |function| Owned {
        function,
        read: Range { first: 3, count: 11 },
        first: 5,
        words: if function == 6 { vec![7] } else { vec![7, 8, 9] },
        bytes: vec![0x5A, 0x05],
        count: 11,
    };
    [1, 2, 3, 4, 5, 6, 15, 16, 23].map(one).to_vec()
}

fn frames(request: &Request<'_>, client: &mut Client) -> [Vec<u8>; 2] {
    let (mut asked, mut answered) = ([0; MOST_FRAME_BYTES], [0; MOST_FRAME_BYTES]);
    let length = client.request(request, &mut asked).unwrap();
    let asked = asked[..length].to_vec();
    let length = server::answer(&asked, &mut Device::new().memory(), &mut answered).unwrap();
    [asked, answered[..length].to_vec()]
}

#[test]
fn shorter_and_longer_frames_are_refused() {
    for owned in one_of_each() {
        let request = owned.request();
        let mut client = Client::new(1);
        let [asked, answered] = frames(&request, &mut client);
        let mut buffer = [0; MOST_FRAME_BYTES];
        for length in 0..asked.len() {
            let refused = server::answer(&asked[..length], &mut Device::new().memory(), &mut buffer);
            assert!(matches!(refused, Err(Error::BadSize { .. })), "{refused:?}");
        }
        for length in 0..answered.len() {
            let refused = client.answer(&request, &answered[..length]);
            assert!(matches!(refused, Err(Error::BadSize { .. })), "{refused:?}");
        }
        let longer = |frame: &[u8]| [frame, &[0]].concat();
        let refused = server::answer(&longer(&asked), &mut Device::new().memory(), &mut buffer);
        assert!(matches!(refused, Err(Error::BadSize { .. })), "{refused:?}");
        assert!(matches!(client.answer(&request, &longer(&answered)), Err(Error::BadSize { .. })));
    }
}

/// The header agrees with the length, but the body is too short or too long.
#[test]
fn shorter_and_longer_bodies_are_refused() {
    for owned in one_of_each() {
        let request = owned.request();
        let mut client = Client::new(1);
        let [asked, answered] = frames(&request, &mut client);
        let of_length = |frame: &[u8], length: usize| {
            let mut frame: Vec<u8> = frame.iter().copied().chain(std::iter::repeat(0)).take(length).collect();
            frame[5] = u8::try_from(length - 6).unwrap();
            frame
        };
        for length in (8..asked.len() + 3).filter(|length| *length != asked.len()) {
            let mut buffer = [0; MOST_FRAME_BYTES];
            let mut device = Device::new();
            let length =
                server::answer(&of_length(&asked, length), &mut device.memory(), &mut buffer).unwrap();
            assert_eq!(buffer[7..length], [owned.function | 0x80, 3]);
            assert_eq!(device, Device::new(), "a refused request changes nothing");
        }
        for length in (8..answered.len() + 3).filter(|length| *length != answered.len()) {
            let error = client.answer(&request, &of_length(&answered, length)).unwrap_err();
            assert!(error.ends_connection(), "{error:?}");
        }
    }
}

/// A wrong byte changes values that were read, or the answer is refused.
#[test]
fn every_corrupted_byte_is_refused_or_is_data() {
    let mut accepted = 0;
    for owned in one_of_each() {
        let request = owned.request();
        let mut client = Client::new(1);
        let [asked, answered] = frames(&request, &mut client);
        // The fixed bytes are header, function and byte count, or a whole echo.
        let fixed = if request.writes() && owned.function != 23 { answered.len() } else { 9 };
        for (index, change) in
            (0..answered.len()).flat_map(|index| (1..=u8::MAX).map(move |flip| (index, flip)))
        {
            let mut frame = answered.clone();
            frame[index] ^= change;
            match client.answer(&request, &frame) {
                Ok(_) => {
                    assert!(index >= fixed, "byte {index} of function {}", owned.function);
                    accepted += 1;
                }
                Err(error) => assert!(index < fixed, "{error:?} for byte {index}"),
            }
        }
        for (index, change) in (0..asked.len()).flat_map(|index| (1..=u8::MAX).map(move |flip| (index, flip)))
        {
            let mut frame = asked.clone();
            frame[index] ^= change;
            let mut buffer = [0; MOST_FRAME_BYTES];
            match server::answer(&frame, &mut Device::new().memory(), &mut buffer) {
                Ok(length) => {
                    assert_eq!(Header::split(&buffer[..length]).unwrap().1[0] & 0x7F, frame[7] & 0x7F)
                }
                Err(error) => assert!((2..6).contains(&index) && error.ends_connection(), "{error:?}"),
            }
        }
    }
    // Two bytes of bits for functions 1 and 2, eleven registers for 3, 4 and 23.
    assert_eq!(accepted, 255 * (2 * 2 + 3 * 22));
}

#[test]
fn answers_fit_every_buffer_or_are_refused() {
    for owned in one_of_each() {
        let request = owned.request();
        let [asked, answered] = frames(&request, &mut Client::new(1));
        for length in 0..answered.len() + 1 {
            let result = server::answer(&asked, &mut Device::new().memory(), &mut vec![0; length]);
            assert_eq!(result.is_ok(), length >= answered.len(), "{result:?}");
        }
        for length in 0..asked.len() + 1 {
            let result = Client::new(1).request(&request, &mut vec![0; length]);
            assert_eq!(result.is_ok(), length >= asked.len(), "{result:?}");
        }
    }
}

#[test]
fn errors_say_what_was_expected() {
    assert_eq!(Error::BadUnit { expected: 1, found: 2 }.to_string(), "answer of unit 2, expected unit 1");
    assert_eq!(
        Error::Refused(Exception::IllegalDataAddress).to_string(),
        "exception 2: the server does not have these addresses"
    );
}
