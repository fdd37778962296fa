//! A host in 60 lines: moves the tool once along a circle of 50 mm in its x-y plane, within 10 s. Run `cargo run
//! --release -p egm --example circle -- 6510`, then start the robot, with reduced speed and room around the tool: see
//! docs/egm.md.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example says what it does")]

use std::{
    error::Error,
    f64::consts::TAU,
    net::UdpSocket,
    time::{Duration, Instant},
};

use egm::{Host, Limits, LinkState, Pose, Twist, host::Settings, message::MOST_BYTES};

const POINTS: u32 = 250; // one every 40 ms
const RADIUS_MM: f64 = 50.0;
const PERIOD: Duration = Duration::from_millis(40);

fn point(start: &Pose, number: u32) -> Pose {
    let part = f64::from(number.min(POINTS)) / f64::from(POINTS);
    let angle = TAU * part - (TAU * part).sin();
    let linear = [RADIUS_MM * (angle.cos() - 1.0), RADIUS_MM * angle.sin(), 0.0];
    start.moved(&Twist { linear, angular: [0.0; 3] })
}

fn main() -> Result<(), Box<dyn Error>> {
    let port: u16 =
        std::env::args().nth(1).ok_or("name the port that the robot sends to, such as 6510")?.parse()?;
    let socket = UdpSocket::bind(("0.0.0.0", port))?;
    socket.set_read_timeout(Some(Duration::from_millis(4)))?;
    let clock = Instant::now();
    let mut host = Host::new(Settings::new(Limits::of_speed(100.0, 0.5)));
    let (mut datagram, mut buffer) = ([0; 2048], [0; MOST_BYTES]);
    // Time and pose of the start, and the number of points so far.
    let mut path: Option<(Duration, Pose, u32)> = None;
    loop {
        let received = socket.recv_from(&mut datagram);
        let now = clock.elapsed();
        let at = u64::try_from(now.as_nanos())?;
        match received {
            Ok((length, robot)) => match host.receive(at, &datagram[..length], &mut buffer) {
                Ok(Some(answer)) => drop(socket.send_to(answer, robot)?),
                Ok(None) => {}
                Err(error) => eprintln!("{robot}: {error}"),
            },
            Err(_) => host.poll(at),
        }
        let sample = host.sample();
        match (&mut path, sample.start) {
            (None, Some(start)) if sample.link == LinkState::Running => {
                host.begin(at, &start)?;
                path = Some((now, start, 0));
            }
            (Some((begun, start, sent)), _) if now >= *begun + PERIOD * (*sent + 1) => {
                *sent += 1;
                host.push(at, &point(start, *sent))?;
                if *sent > POINTS + 10 {
                    println!("{:?}", sample.counters);
                    return Ok(());
                }
            }
            _ => {}
        }
    }
}
