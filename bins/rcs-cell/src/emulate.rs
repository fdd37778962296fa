//! `--emulate egm:[ADDRESS:]PORT[,OPTION...]`: an EGM robot that sends to a host over UDP.
//!
//! Its thread sleeps until the next cycle of 4.032 ms or until a datagram arrives. It can simulate random network
//! faults from a seed. Lines of standard input operate buttons and programs, as at the T3's console.

use std::{
    io::{self, BufRead as _},
    net::{Ipv4Addr, SocketAddr, UdpSocket},
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver},
    },
    thread,
    time::{Duration, Instant},
};

use egm::message::MOST_BYTES;
use executive::egm::{
    EgmOptions, Peer,
    emulator::{CYCLE_NS, EgmRobot},
    network::Network,
};
use os_io::stdout_line;
use os_io::text::amount;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::cli::EgmTarget;

const MOST_BEHIND: u64 = 100_000_000; // longest time for which missed cycles are executed afterwards, ns
const HELP: &str = "estop      motors off, as by the emergency stop\n\
                    motors     motors on\n\
                    start      start the RAPID program: EGM begins where the robot is\n\
                    stop       stop the RAPID program\n\
                    status     where the robot is, and what it does\n\
                    quit       end the program";

pub struct Emulation {
    robot: EgmRobot,
    socket: UdpSocket,
    host: SocketAddr,
    to_host: Network,
    to_robot: Network,
    start: Instant,
    received: u64,
    refused: u64,
    said: Option<&'static str>, // state reported last on standard output
}

impl Emulation {
    /// Fails with a sentence if the robot's file or a socket cannot be used.
    pub fn new(target: &EgmTarget, data: &std::path::Path) -> Result<Self, String> {
        let options: &EgmOptions = &target.0;
        let Peer::Udp(host) = options.peer else { return Err("--emulate needs a port to send to".into()) };
        let placement = options.placement(data).map_err(|error| error.to_string())?;
        let any = if host.is_ipv4() {
            SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0))
        } else {
            "[::]:0".parse().map_err(|_| "no address to send from")?
        };
        let socket = UdpSocket::bind(any).map_err(|error| format!("no socket to send from: {error}"))?;
        socket.set_nonblocking(true).map_err(|error| format!("the socket cannot be used: {error}"))?;
        let [to_host, to_robot] = options.networks();
        Ok(Self {
            robot: EgmRobot::new(options.tuning, placement),
            socket,
            host,
            to_host,
            to_robot,
            start: Instant::now(),
            received: 0,
            refused: 0,
            said: None,
        })
    }

    /// Runs until the command `quit` or a signal. `lines` are commands, and `observe` gets the robot after each cycle.
    pub fn run(
        &mut self,
        stop: &AtomicBool,
        lines: &Receiver<String>,
        mut observe: impl FnMut(&EgmRobot),
    ) -> io::Result<()> {
        stdout_line!("[egm] sends to {}; help lists the commands", self.host);
        let mut next = CYCLE_NS;
        while !stop.load(Ordering::Relaxed) {
            while let Ok(line) = lines.try_recv() {
                if self.run_line(line.trim()) {
                    return Ok(());
                }
            }
            let now = self.now();
            while let Some((_, datagram)) = self.to_robot.arrived(now) {
                self.received += 1;
                if let Err(error) = self.robot.receive(&datagram) {
                    self.refused += 1;
                    stdout_line!("[egm] refused: {error}");
                }
            }
            // Executes cycles that were missed while the system slept, but not more than `MOST_BEHIND`.
            next = next.max(now.saturating_sub(MOST_BEHIND));
            while now >= next {
                next += CYCLE_NS;
                self.cycle(now);
                observe(&self.robot);
            }
            while let Some((_, datagram)) = self.to_host.arrived(now) {
                self.send(&datagram)?;
            }
            self.wait(next)?;
        }
        Ok(())
    }

    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    fn cycle(&mut self, now: u64) {
        let mut buffer = [0; MOST_BYTES];
        // The buffer has room for the longest message.
        if let Ok(datagram) = self.robot.cycle().encode(&mut buffer) {
            self.to_host.send(now, datagram);
        }
        let state = self.robot.stopped().map_or("EGM runs", |stopped| stopped.text());
        if self.said.replace(state) != Some(state) {
            stdout_line!("[egm] {state}");
        }
    }

    /// Sends a datagram to the host. A host that is not running yet causes no error.
    fn send(&self, datagram: &[u8]) -> io::Result<()> {
        match self.socket.send_to(datagram, self.host) {
            Ok(_) => Ok(()),
            Err(error) if is_quiet(&error) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Waits for a datagram, at most until the next cycle or the next due datagram.
    fn wait(&mut self, next: u64) -> io::Result<()> {
        let due = [self.to_host.next(), self.to_robot.next()].into_iter().flatten().fold(next, u64::min);
        let left = Duration::from_nanos(due.saturating_sub(self.now()));
        // The receive timeout of a socket is rounded to the system's ticks, which can be longer than a cycle.
        let timeout = Timespec::try_from(left).map_err(io::Error::other)?;
        let mut fds = [PollFd::new(&self.socket, PollFlags::IN)];
        match poll(&mut fds, Some(&timeout)) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(()),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut datagram = [0; 2048];
        match self.socket.recv_from(&mut datagram) {
            Ok((length, sender)) if sender == self.host => {
                let now = self.now();
                self.to_robot.send(now, datagram.get(..length).unwrap_or_default());
                Ok(())
            }
            Ok(_) => Ok(()),
            Err(error) if is_quiet(&error) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Executes a command line; returns true for `quit`.
    fn run_line(&mut self, line: &str) -> bool {
        match line {
            "" => {}
            "estop" => self.robot.emergency_stop(),
            "motors" => self.robot.motors_on(),
            "start" => self.robot.start(),
            "stop" => self.robot.stop(),
            "status" => self.status(),
            "help" => stdout_line!("{HELP}"),
            "quit" => return true,
            other => stdout_line!("error: {other} is not a command; help lists them"),
        }
        false
    }

    fn status(&self) {
        let [x, y, z] = self.robot.pose().position;
        let joints = self.robot.joints().map(|joint| format!("{:.2}", joint.to_degrees())).join(" ");
        let state = self.robot.stopped().map_or("EGM runs", |stopped| stopped.text());
        stdout_line!("[status] {state}; {}, {} refused", amount(self.received, "message"), self.refused);
        stdout_line!("[status] tool at {x:.2} {y:.2} {z:.2} mm, joints {joints} degrees");
    }
}

fn is_quiet(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionRefused, Interrupted, WouldBlock};
    matches!(error.kind(), WouldBlock | Interrupted | ConnectionRefused)
}

/// Lines of standard input. The program keeps running when standard input ends.
pub fn typed() -> Receiver<String> {
    let (sender, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    lines
}
