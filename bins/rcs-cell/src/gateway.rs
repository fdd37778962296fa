//! `--egm [ADDRESS:]PORT[,OPTION...]`: a gateway that connects any DEPC host to an EGM robot.
//!
//! Between the pseudo-terminal of `--link` and the UDP port runs the DEPC function of [`executive::egm::Bridge`]. The
//! host sees a T3 controller whose program begins when the robot follows.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use depc::Limits;
use executive::egm::{Bridge, EgmOptions, Line, Peer, udp::UdpLine};
use os_io::stdout_line;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::{host_line::HostLine, line::Cadence, pty::Pty, shell::ShellError};

const LONGEST_SLEEP: u64 = 20_000; // longest sleep, us: the program notices a signal within this time

pub struct Gateway {
    start: Instant,
    host: HostLine,
    cadence: Cadence,
    robot: Line,
    bridge: Bridge,
    said: Option<&'static str>, // state of the robot reported last on standard output
}

impl Gateway {
    /// Listens for the robot. Fails with a sentence if the port or the robot's file cannot be used.
    pub fn new(
        options: &EgmOptions,
        data: &std::path::Path,
        limits: Limits,
        pty: Pty,
    ) -> Result<Self, String> {
        let Peer::Udp(address) = options.peer else { return Err("--egm needs a port to listen at".into()) };
        let file = options.file(data).map_err(|error| error.to_string())?;
        let placement = file.placement;
        let mut settings = options.settings(&placement);
        settings.times.period = u64::from(limits.period_us()) * 1000;
        let line =
            UdpLine::open(address, options.from, settings, || ()).map_err(|error| error.to_string())?;
        stdout_line!("[egm] a robot can send to UDP {}", line.address());
        Ok(Self {
            start: Instant::now(),
            host: HostLine::new(pty),
            cadence: Cadence::new(limits.period_us(), 0),
            robot: Line::Udp(Box::new(line)),
            bridge: Bridge::new(limits, placement).supervised(file.lag_ms.unwrap_or(options.lag_ms())),
            said: None,
        })
    }

    pub fn run(&mut self, stop: &Arc<AtomicBool>) -> Result<(), ShellError> {
        while !stop.load(Ordering::Relaxed) {
            self.host.poll(self.now())?;
            if self.cadence.next(self.host.line()) <= self.now() {
                self.step();
            }
            self.host.deliver(self.now())?;
            self.sleep()?;
        }
        Ok(())
    }

    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn step(&mut self) {
        let now = self.now();
        let rx = self.host.arrived(now);
        self.robot.reports(|_| ());
        let out = self.bridge.step(&mut self.robot, &rx, self.host.has_host(), false);
        self.host.send(now, out.tx.as_slice());
        self.cadence.stepped(now, out.busy);
        let state = self.bridge.trouble().unwrap_or("the robot follows");
        if self.said.replace(state) != Some(state) {
            stdout_line!("[egm] {state}");
        }
    }

    fn sleep(&self) -> Result<(), ShellError> {
        let now = self.now();
        let due = [Some(self.cadence.next(self.host.line())), self.host.line().next_delivery()];
        let due = due.into_iter().flatten().fold(now + LONGEST_SLEEP, u64::min);
        let timeout =
            Timespec::try_from(Duration::from_micros(due.saturating_sub(now))).map_err(io::Error::other)?;
        let mut fds: Vec<PollFd<'_>> =
            self.host.readable().map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN)).into_iter().collect();
        match poll(&mut fds, Some(&timeout)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
            Err(error) => Err(io::Error::from(error).into()),
        }
    }
}
