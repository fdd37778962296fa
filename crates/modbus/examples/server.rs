//! A device with 64 values in each table, for clients one after the other: `cargo run --release -p modbus --example
//! server -- 127.0.0.1:1502`; then, for example, `mbpoll -m tcp -p 1502 -0 -r 0 -c 4 -1 127.0.0.1`.

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::{
    error::Error,
    io::{Read, Write},
    net::{TcpListener, TcpStream},
};

use modbus::{
    MOST_FRAME_BYTES, mbap,
    server::{self, Memory},
};

fn serve(stream: &mut TcpStream, memory: &mut Memory<'_>) -> Result<(), Box<dyn Error>> {
    let (mut received, mut filled) = ([0; MOST_FRAME_BYTES], 0);
    let mut answer = [0; MOST_FRAME_BYTES];
    loop {
        while let Some(frame) = mbap::first_frame(&received[..filled])? {
            let used = frame.len();
            let length = server::answer(frame, memory, &mut answer)?;
            stream.write_all(&answer[..length])?;
            received.copy_within(used..filled, 0);
            filled -= used;
        }
        match stream.read(&mut received[filled..])? {
            0 => return Ok(()),
            read => filled += read,
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let address = std::env::args().nth(1).ok_or("name the address, such as 127.0.0.1:1502")?;
    let (mut coils, mut holding) = ([false; 64], [0; 64]);
    let mut memory = Memory {
        coils: &mut coils,
        discrete_inputs: &std::array::from_fn::<_, 64, _>(|number| number % 3 == 0),
        holding_registers: &mut holding,
        input_registers: &std::array::from_fn::<u16, 64, _>(|number| {
            1000 + u16::try_from(number).unwrap_or(0)
        }),
    };
    for stream in TcpListener::bind(address)?.incoming() {
        if let Err(error) = stream.map_err(Into::into).and_then(|mut stream| serve(&mut stream, &mut memory))
        {
            println!("{error}");
        }
    }
    Ok(())
}
