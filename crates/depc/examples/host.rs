//! A minimal DEPC host: it moves the robot 2 in up and back over a serial port. Run `cargo run --release --bin
//! rcs-cell -- --link /tmp/t3 --auto` in one terminal, and `cargo run --release -p depc --example host /tmp/t3` in
//! another. With a real robot, connect the host's DSR with the controller's DTR; a pseudo-terminal has no modem lines.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use std::{
    env,
    error::Error,
    io::{self, Read as _, Write as _},
    thread,
    time::Duration,
};

use depc::{
    Limits,
    host::{ANSWER_TICKS, Host, HostEvent, Intent},
    link::LinkBytes,
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION},
};
use geometry::{frame::Vector, kinematics::T3};
use serialport::SerialPort as _;

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).ok_or("a serial port was expected: host /tmp/t3")?;
    let mut port = serialport::new(path, 9600).timeout(Duration::from_millis(1)).open_native()?;
    let mut host = Host::new(ANSWER_TICKS);
    let mut at: Option<Position> = None;
    let mut goals = Vec::new();
    while at.is_none() || !goals.is_empty() || !host.can_send() {
        let mut rx = LinkBytes::default();
        let mut bytes = [0; 64];
        match port.read(&mut bytes) {
            Ok(count) => _ = rx.extend(&bytes[..count]),
            Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
            Err(error) => return Err(error.into()),
        }
        let ready = port.read_data_set_ready().unwrap_or(true);
        if host.receive(&rx, ready) == HostEvent::Started {
            let start = Position::reported(host.position(), &T3);
            println!("the robot is at {:.2?} in", start.tool().position.as_slice());
            let mut above = start.tool();
            above.position += Vector::new(0.0, 0.0, 2.0);
            goals = vec![start.tool(), above];
            at = Some(start);
        }
        let mut intent = Intent::Idle;
        if let (Some(from), Some(goal), true) = (&mut at, goals.last(), host.can_send()) {
            let next = step(from, goal, &T3, &Limits::NBS)?;
            intent = Intent::Position(DataCommand { function: NO_FUNCTION, plate: next.position.plate });
            *from = next.position;
            if next.reached {
                println!("commanded: {:.2?} in", from.tool().position.as_slice());
                goals.pop();
            }
        }
        let mut tx = LinkBytes::default();
        host.transmit(&intent, &mut tx);
        port.write_all(tx.as_slice())?;
        thread::sleep(Duration::from_millis(40));
    }
    println!("{} frames, {} retries", host.counters().frames, host.counters().retries);
    Ok(())
}
