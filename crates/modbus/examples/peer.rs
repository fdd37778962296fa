//! Drives any server with random requests of all nine functions, and compares its answers with tables of its own.
//! `cargo run --release -p modbus --example peer -- 127.0.0.1:1502 1 10000`: 10,000 requests to unit 1, whose coils
//! and holding registers 0 to 63 it overwrites. Inputs that can differ are compared in number only.

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::{
    error::Error,
    io::{Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use modbus::{Bits, Client, MOST_FRAME_BYTES, Request, Response, Words, mbap, request::Range};

const SIZE: u16 = 64; // coils and holding registers
const ENTRIES: usize = 64; // as the length of an array

/// Numbers that look random (xorshift).
struct Dice(u32);

impl Dice {
    fn below(&mut self, limit: u16) -> u16 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        u16::try_from(self.0 % u32::from(limit)).unwrap_or(0)
    }

    fn range(&mut self) -> Range {
        let first = self.below(SIZE);
        Range { first, count: 1 + self.below(SIZE - first) }
    }
}

struct Peer {
    stream: TcpStream,
    client: Client,
    received: [u8; MOST_FRAME_BYTES],
}

impl Peer {
    fn ask(&mut self, request: &Request<'_>) -> Result<Response<'_>, Box<dyn Error>> {
        let mut frame = [0; MOST_FRAME_BYTES];
        let length = self.client.request(request, &mut frame)?;
        self.stream.write_all(&frame[..length])?;
        let mut filled = 0;
        while mbap::first_frame(&self.received[..filled])?.is_none() {
            match self.stream.read(&mut self.received[filled..])? {
                0 => return Err("the server closed the connection".into()),
                read => filled += read,
            }
        }
        Ok(self.client.answer(request, &self.received[..filled])?)
    }
}

/// `expected`: written before.
fn check(response: Response<'_>, expected: Option<Vec<u16>>, read: Range) -> Result<(), Box<dyn Error>> {
    let found: Vec<u16> = match response {
        Response::Bits(bits) => bits.iter().map(u16::from).collect(),
        Response::Words(words) => words.iter().collect(),
        Response::Written => return Ok(()),
    };
    if found.len() == usize::from(read.count) && expected.as_ref().is_none_or(|expected| *expected == found) {
        return Ok(());
    }
    Err(format!("{read:?}: expected {expected:?}, found {found:?}").into())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [address, unit, count] = arguments.as_slice() else {
        return Err("expected ADDRESS:PORT UNIT COUNT".into());
    };
    let stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_secs(2)))?;
    stream.set_nodelay(true)?;
    let mut peer = Peer { stream, client: Client::new(unit.parse()?), received: [0; MOST_FRAME_BYTES] };
    let (mut coils, mut holding) = ([0; ENTRIES], [0; ENTRIES]);
    peer.ask(&Request::WriteCoils { first: 0, bits: Bits::new(&[0; 8], 64)? })?;
    peer.ask(&Request::WriteRegisters { first: 0, words: Words::new(&holding) })?;
    let (mut dice, begun) = (Dice(1), Instant::now());
    let count: u32 = count.parse()?;
    for number in 0..count {
        let (read, written) = (dice.range(), dice.range());
        let (from, to) = (usize::from(written.first), usize::from(written.first + written.count));
        let values: Vec<u16> = (0..written.count).map(|_| dice.below(u16::MAX)).collect();
        let mut packed = [0; 8];
        let bits = Bits::pack(values.iter().map(|value| value % 2 == 1), &mut packed)?;
        let (first, words) = (written.first, Words::new(&values));
        let request = match number % 9 {
            0 => Request::ReadCoils(read),
            1 => Request::ReadDiscreteInputs(read),
            2 => Request::ReadHoldingRegisters(read),
            3 => Request::ReadInputRegisters(read),
            4 => Request::WriteCoil { address: first, on: values[0] % 2 == 1 },
            5 => Request::WriteRegister { address: first, value: values[0] },
            6 => Request::WriteCoils { first, bits },
            7 => Request::WriteRegisters { first, words },
            _ => Request::ReadWriteRegisters { read, first, words },
        };
        match request {
            Request::WriteCoil { on, .. } => coils[from] = u16::from(on),
            Request::WriteRegister { value, .. } => holding[from] = value,
            Request::WriteCoils { bits, .. } => {
                coils[from..to].iter_mut().zip(bits.iter()).for_each(|(coil, bit)| *coil = u16::from(bit));
            }
            _ if request.writes() => holding[from..to].copy_from_slice(&values),
            _ => {}
        }
        let table = match request {
            Request::ReadCoils(_) => Some(&coils),
            Request::ReadHoldingRegisters(_) | Request::ReadWriteRegisters { .. } => Some(&holding),
            _ => None,
        };
        let expected =
            table.map(|table| table[usize::from(read.first)..][..usize::from(read.count)].to_vec());
        check(peer.ask(&request)?, expected, read).map_err(|error| format!("request {number}: {error}"))?;
    }
    println!("{count} requests answered as expected, {:?} each", begun.elapsed() / count.max(1));
    Ok(())
}
