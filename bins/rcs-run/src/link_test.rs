//! `rcs-run link-test`: measures round trips on a DEPC link, and prints a verdict.
//!
//! The host of [`depc::host`] sends, every 40 ms, the position that the robot has reported, so that it does not move. A
//! frame is in time if its ACK arrives within a tick: the next frame then follows without a gap.

mod dump;
mod tally;

use std::{
    process::ExitCode,
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use depc::{
    host::{ANSWER_TICKS, Host, HostEvent, Intent},
    wire::{DataCommand, FRAME_BYTES, NO_FUNCTION},
};
use executive::serial::{SerialLine, SerialSettings};
use interfaces::device::LinkBytes;
use os_io::stderr_line;
use rcs_core::tick::TICK_MS;
use runtime::RobotKind;

use self::{
    dump::{Dump, FrameDirection},
    tally::{Observed, Tally, Verdict},
};
use crate::rcs_run::{
    answer::answer,
    arguments::LinkTestArguments,
    error::{Error, FAILED, STOPPED},
    interrupt::interruption,
};

const PERIOD: Duration = Duration::from_millis(TICK_MS); // length of a tick

/// Test the link and print the result. Exit status 0 if the link is usable, 1 if not, 3 if it never came up.
pub fn link_test(arguments: &LinkTestArguments) -> Result<ExitCode, Error> {
    let RobotKind::Serial(settings) = &arguments.robot.kind else { return Err(Error::NoLinkToTest) };
    let interrupted = interruption()?;
    let line = match SerialLine::open(settings.clone()) {
        Ok(line) => line,
        Err(error) => {
            stderr_line!("rcs-run: no link: {error}");
            return Ok(ExitCode::from(STOPPED));
        }
    };
    let mut test = Test::new(line, Dump::new(arguments.dump, arguments.json));
    let ticks = u64::from(arguments.seconds) * 1000 / TICK_MS;
    test.run(ticks, || interrupted.load(Ordering::Relaxed));
    let tally = test.finish(settings);
    answer(&tally, arguments.json)?;
    Ok(match tally.failure() {
        Some(reason) => {
            stderr_line!("rcs-run: {reason}");
            ExitCode::from(if tally.verdict == Verdict::NoLink { STOPPED } else { FAILED })
        }
        None => ExitCode::SUCCESS,
    })
}

#[derive(Clone, Copy)]
struct Outstanding {
    sent: Instant,
    answered: Option<Instant>, // time when a byte that can be its ACK was readable
}

struct Test {
    line: SerialLine,
    host: Host,
    dump: Dump,
    outstanding: Option<Outstanding>,
    modem_lines: bool,
    starts: u32,
    latencies: Vec<Duration>,
}

impl Test {
    fn new(line: SerialLine, dump: Dump) -> Self {
        let host = Host::new(ANSWER_TICKS);
        let modem_lines = line.has_modem_lines();
        Self { line, host, dump, outstanding: None, modem_lines, starts: 0, latencies: Vec::new() }
    }

    /// Run a number of ticks. The last ones send nothing new, so that every frame can be answered in time.
    fn run(&mut self, ticks: u64, interrupted: impl Fn() -> bool) {
        let quiet = ticks.saturating_sub(u64::from(ANSWER_TICKS) + 1);
        let (mut rx, mut held) = (LinkBytes::default(), true);
        let mut due = Instant::now();
        for tick in 0..ticks {
            let ready = self.line.receive(&mut rx) && held;
            self.receive(&rx, ready);
            self.transmit(tick < quiet);
            // Late ticks are not caught up, because the robot would get more than one command per tick.
            due = (due + PERIOD).max(Instant::now());
            (rx, held) = self.collect(due);
            if interrupted() {
                break;
            }
        }
    }

    /// Read until `due`. The flag is false if the line was not ready all the time.
    fn collect(&mut self, due: Instant) -> (LinkBytes, bool) {
        let mut rx = LinkBytes::default();
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return (rx, true);
            }
            let full = rx.as_slice().len() == rx.bytes.len();
            if full || !self.line.is_there() {
                std::thread::sleep(left);
                continue;
            }
            self.line.wait(left);
            let before = rx.as_slice().len();
            if !self.line.receive(&mut rx) {
                // The host detects the loss of the line at the end of the tick.
                std::thread::sleep(due.saturating_duration_since(Instant::now()));
                return (LinkBytes::default(), false);
            }
            let now = Instant::now();
            let fresh = rx.as_slice().get(before..).unwrap_or_default();
            self.dump.show(now, FrameDirection::Received, fresh);
            if let Some(outstanding) = &mut self.outstanding
                && !fresh.is_empty()
            {
                outstanding.answered.get_or_insert(now);
            }
        }
    }

    fn receive(&mut self, rx: &LinkBytes, ready: bool) {
        let naks = self.host.counters().naks;
        let event = self.host.receive(rx, ready);
        match event {
            HostEvent::Acknowledged => {
                if let Some(Outstanding { sent, answered: Some(at) }) = self.outstanding.take() {
                    self.latencies.push(at.saturating_duration_since(sent));
                }
            }
            HostEvent::Started => self.starts += 1,
            HostEvent::Lost => self.outstanding = None,
            HostEvent::None => {}
        }
        if self.host.counters().naks > naks {
            self.outstanding = None;
        }
    }

    fn transmit(&mut self, wanted: bool) {
        let intent = if wanted {
            Intent::Position(DataCommand { function: NO_FUNCTION, plate: self.host.position() })
        } else {
            Intent::Idle
        };
        let mut tx = LinkBytes::default();
        self.host.transmit(&intent, &mut tx);
        if tx.length == 0 {
            return;
        }
        let now = Instant::now();
        self.line.send(&tx);
        self.dump.show(now, FrameDirection::Sent, tx.as_slice());
        if tx.as_slice().len() == FRAME_BYTES {
            self.outstanding = Some(Outstanding { sent: now, answered: None });
        }
    }

    fn finish(mut self, settings: &SerialSettings) -> Tally {
        self.dump.flush();
        let observed = Observed {
            modem_lines: self.modem_lines,
            connected: self.host.is_running(),
            starts: self.starts,
        };
        let (counters, serial) = (self.host.counters(), self.line.counts());
        Tally::new(settings, observed, counters, serial, &mut self.latencies)
    }
}
