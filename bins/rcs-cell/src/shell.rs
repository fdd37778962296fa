//! The input and output around the state machine. Its only thread sleeps until a byte arrives or is due. It never
//! blocks on a write: bytes that a host does not read are lost.

use std::{
    collections::VecDeque,
    io::{self, IsTerminal},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use depc::fault::{Direction, Injector, Plan};
use interfaces::device::LinkBytes;
use os_io::stdout_line;
use os_io::text::amount;
use plant::{
    Key,
    description::Actuators,
    t3::{Message, StepInputs, T3Controller},
};
use rcs_core::tick::Tick;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::{
    auto::Operator,
    cli::Cli,
    console::{self, Lines},
    host_line::HostLine,
    line::Cadence,
    pty::{Pty, PtyError},
};

const LONGEST_SLEEP: u64 = 50_000; // longest sleep, us: the program notices a signal within this time
/// After a stopped program resumes, its first step simulates at most this time, s.
const LONGEST_STEP_S: f64 = 2.0;

#[derive(Debug, thiserror::Error)]
pub enum ShellError {
    #[error(transparent)]
    Pty(#[from] PtyError),
    #[error("standard input failed: {0}")]
    Io(#[from] io::Error),
}

pub struct Shell {
    start: Instant,
    stop: Arc<AtomicBool>,
    host: HostLine,
    faults: Option<Injector>,
    tick: Tick, // number of the controller's steps: the ticks of the fault plan
    cadence: Cadence,
    t3: T3Controller,
    operator: Operator,
    lines: Lines,
    waiting: VecDeque<String>,
    wait_until: u64, // time until which no line of the console is executed, us
    pressed: bool,   // a key was pressed and its step has not run yet
    input_open: bool,
}

impl Shell {
    /// A controller that is switched off. `stop` ends [`Self::run`] when it becomes true.
    #[must_use]
    pub fn new(cli: &Cli, plan: Option<&Plan>, pty: Pty, stop: Arc<AtomicBool>) -> Self {
        Self {
            start: Instant::now(),
            stop,
            host: HostLine::new(pty),
            faults: plan.map(Injector::new),
            tick: Tick::BEFORE_START,
            cadence: Cadence::new(cli.period.period_us(), 0),
            t3: T3Controller::dark(cli.period, &Actuators::default(), cli.seed),
            operator: Operator::new(cli.auto),
            lines: Lines::default(),
            waiting: VecDeque::new(),
            wait_until: 0,
            pressed: false,
            input_open: true,
        }
    }

    /// Runs until `quit`, the end of a terminal's input, or a signal.
    pub fn run(&mut self) -> Result<(), ShellError> {
        stdout_line!("help lists the commands");
        while !self.stop.load(Ordering::Relaxed) {
            self.host.poll(self.now())?;
            self.take_input()?;
            if self.run_line() {
                break;
            }
            if self.cadence.next(self.host.line()) <= self.now() {
                self.step();
            }
            self.host.deliver(self.now())?;
            self.sleep()?;
        }
        Ok(())
    }

    /// Time since the start, us.
    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn take_input(&mut self) -> Result<(), ShellError> {
        let stdin = io::stdin();
        if !self.input_open || !is_ready(&stdin)? {
            return Ok(());
        }
        let mut bytes = [0; 256];
        match rustix::io::read(&stdin, &mut bytes) {
            Ok(0) => {
                self.input_open = false;
                if stdin.is_terminal() {
                    self.waiting.push_back("quit".into());
                }
            }
            Ok(count) => self.waiting.extend(self.lines.accept(&bytes[..count])),
            Err(rustix::io::Errno::INTR | rustix::io::Errno::AGAIN) => {}
            // The terminal has been closed.
            Err(_) => self.input_open = false,
        }
        Ok(())
    }

    /// Executes the lines that are due; returns true after `quit`.
    fn run_line(&mut self) -> bool {
        // A key takes effect in the next step, and the next key must see its effect.
        while self.wait_until <= self.now() && !self.pressed {
            let Some(text) = self.waiting.pop_front() else { break };
            match text.parse() {
                Err(error) => stdout_line!("error: {error}"),
                Ok(console::ConsoleCommand::Quit) => return true,
                Ok(console::ConsoleCommand::Help) => stdout_line!("{}", console::HELP),
                Ok(console::ConsoleCommand::Status) => self.status(),
                Ok(console::ConsoleCommand::Wait(milliseconds)) => {
                    self.wait_until = self.now() + milliseconds * 1000
                }
                Ok(console::ConsoleCommand::Key(key)) => {
                    if self.operator.step_back() {
                        stdout_line!("[auto] steps back: continue by hand");
                    }
                    self.press(key);
                    self.pressed = true;
                }
            }
        }
        false
    }

    fn press(&mut self, key: Key) {
        let before = self.t3.error();
        match self.t3.press(key) {
            Ok(()) => {
                self.show();
                if let Some(error) = self.t3.error().filter(|_| before.is_none()) {
                    stdout_line!("{error}");
                }
            }
            Err(refusal) => stdout_line!("refused: {refusal}"),
        }
    }

    fn show(&mut self) {
        for message in self.t3.messages() {
            stdout_line!("{message}");
        }
    }

    fn step(&mut self) {
        let now = self.now();
        let elapsed = Duration::from_micros(now - self.cadence.last()).as_secs_f64();
        self.tick = self.tick.next();
        let arrived = self.host.arrived(now);
        let (rx, cts) = self.carry(Direction::ToController, arrived, self.host.has_host());
        if let Some(key) = self.operator.next(&self.t3, cts) {
            stdout_line!("[auto] {}", key);
            self.press(key);
        }
        self.t3.advance(elapsed.min(LONGEST_STEP_S), &[self.t3.arm().tool_weight()]);
        let out = self.t3.step(&StepInputs { rx, cts });
        let (tx, _) = self.carry(Direction::ToHost, out.tx, true);
        self.host.send(now, tx.as_slice());
        self.pressed = false;
        self.cadence.stepped(now, out.busy);
        self.show();
    }

    /// Applies the faults of the plan to the bytes and the DTR of one direction.
    fn carry(&mut self, direction: Direction, sent: LinkBytes, ready: bool) -> (LinkBytes, bool) {
        match &mut self.faults {
            Some(injector) => injector.carry(direction, self.tick, &sent, ready),
            None => (sent, ready),
        }
    }

    fn status(&self) {
        let (t3, depc) = (&self.t3, self.t3.depc());
        let counts = t3.counts();
        let text = format!(
            "[status] {}; hold {}; host {}; DEPC {}; {} moves, {} NAKs, {} reports",
            t3.stage().text(),
            if t3.hold() { "on" } else { "off" },
            if self.host.has_host() { "there" } else { "not there" },
            depc.state(),
            counts.moves,
            counts.naks,
            counts.reports,
        );
        let mut lines = vec![text, Message::Aligned(t3.aligned()).to_string()];
        lines.extend(t3.error().map(str::to_owned));
        if t3.arm().on_shot_pin() {
            lines.push("[robot] the shoulder lies on the shot pin".to_owned());
        }
        if depc.warning() != depc::controller::Warning::None {
            lines.push(Message::Warning(depc.warning()).to_string());
        }
        if let Some(injector) = &self.faults {
            lines.push(format!("[status] {} on the line", amount(injector.total().faults(), "fault")));
        }
        lines.push(Message::Position(t3.position()).to_string());
        stdout_line!("{}", lines.join("\n"));
    }

    /// Sleeps until input arrives or an event is due.
    fn sleep(&self) -> Result<(), ShellError> {
        let now = self.now();
        let due = [Some(self.cadence.next(self.host.line())), self.host.line().next_delivery()]
            .into_iter()
            .flatten()
            .fold(now + LONGEST_SLEEP, u64::min);
        let left = Duration::from_micros(due.saturating_sub(now));
        let timeout = Timespec::try_from(left).map_err(io::Error::other)?;
        let stdin = io::stdin();
        let mut fds = Vec::with_capacity(2);
        if let Some(fd) = self.host.readable() {
            fds.push(PollFd::from_borrowed_fd(fd, PollFlags::IN));
        }
        if self.input_open {
            fds.push(PollFd::new(&stdin, PollFlags::IN));
        }
        match poll(&mut fds, Some(&timeout)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
            Err(error) => Err(io::Error::from(error).into()),
        }
    }
}

fn is_ready(stdin: &io::Stdin) -> io::Result<bool> {
    let mut fds = [PollFd::new(stdin, PollFlags::IN)];
    match poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })) {
        Ok(count) => Ok(count > 0),
        Err(rustix::io::Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}
