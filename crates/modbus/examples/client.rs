//! A client in 60 lines: reads holding registers, and writes some first if values are given.
//!
//! `cargo run --release -p modbus --example client -- 127.0.0.1:502 1 0 4` reads registers 0 to 3 of unit 1; `... 1 0
//! 4 8 17 18` also writes 17 and 18 to registers 8 and 9.

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::{
    error::Error,
    io::{Read, Write},
    net::TcpStream,
    time::Duration,
};

use modbus::{Client, MOST_FRAME_BYTES, Request, Words, mbap, request::Range};

fn exchange(stream: &mut TcpStream, frame: &[u8], buffer: &mut [u8]) -> Result<usize, Box<dyn Error>> {
    stream.write_all(frame)?;
    let mut filled = 0;
    loop {
        let needed = mbap::needed(&buffer[..filled])?;
        if filled > 6 && filled >= needed {
            return Ok(filled);
        }
        let read = stream.read(&mut buffer[filled..needed])?;
        if read == 0 {
            return Err("the server closed the connection".into());
        }
        filled += read;
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [address, numbers @ ..] = arguments.as_slice() else {
        return Err("expected ADDRESS:PORT UNIT FIRST COUNT [FIRST-TO-WRITE VALUE...]".into());
    };
    let numbers = numbers.iter().map(|text| text.parse()).collect::<Result<Vec<u16>, _>>()?;
    let (unit, read, written) = match numbers.as_slice() {
        [unit, first, count, written @ ..] => {
            (u8::try_from(*unit)?, Range { first: *first, count: *count }, written)
        }
        _ => return Err("expected UNIT FIRST COUNT after the address".into()),
    };
    let request = match written {
        [first, values @ ..] => {
            Request::ReadWriteRegisters { read, first: *first, words: Words::new(values) }
        }
        [] => Request::ReadHoldingRegisters(read),
    };
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_secs(1)))?;
    stream.set_nodelay(true)?;
    let mut client = Client::new(unit);
    let (mut asked, mut answered) = ([0; MOST_FRAME_BYTES], [0; MOST_FRAME_BYTES]);
    let length = client.request(&request, &mut asked)?;
    let length = exchange(&mut stream, &asked[..length], &mut answered)?;
    let response = client.answer(&request, &answered[..length])?;
    println!("{:?}", response.words().ok_or("no registers in the answer")?);
    Ok(())
}
