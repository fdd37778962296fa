//! The host's end of the link, with which the T3 Interface process talks to the robot controller (A 2.3, VI.1).
//!
//! Each tick has two halves: [`Host::receive`] processes the received bytes, [`Host::transmit`] sends at most one
//! frame. Only one frame is outstanding. An answer has no number, so the host never repeats a frame without an answer:
//! the controller may have executed it. It sends a restart, discards all bytes until a valid report, and continues
//! from there. Only a NAK proves that the command was not executed; then the host repeats it.
//!
//! A controller with DTR on and without answers may be in Hold, show a warning D1 to D6, have a dead receiver, or the
//! wire may be cut: the host cannot distinguish these. It sends a restart once per second, and reports the link as
//! failed after the time of [`Host::set_silence_limit`].
//!
//! A report has no number either. If more than one was requested, only the last is valid, and only after an answer
//! time without another one: on a slow line the robot may have moved since the first.

mod start;

use rcs_core::Plain;

use crate::link::{LinkBytes, LinkCounters, LinkFault};
use crate::{
    Plate,
    receive::{Reply, ReplyReceiver},
    wire::{Control, DataCommand, FRAME_BYTES, Response},
};

/// Ticks until an unanswered frame is lost (docs/design/link.md "Time-out"). Hold only delays the answer.
pub const ANSWER_TICKS: u16 = 3;
const ANSWER_BYTES: usize = 4; // per tick with a valid answer; more may be noise
/// Maximum repetitions of a data command after NAKs; then the host restarts the link.
pub const MOST_RETRIES: u8 = 3;
/// Ticks between two unanswered restarts: 1 s (docs/design/link.md "Silence").
pub const RESTART_TICKS: u16 = 25;
/// Default number of ticks with DTR on and without a report after which the link is treated as failed: 60 s.
pub const SILENCE_LIMIT_TICKS: u16 = 60 * RESTART_TICKS;
/// Number of attempts without DTR, each lasting an answer time, after which the link is treated as not responding.
pub const START_ATTEMPTS: u8 = 3;

/// State of the host's end.
///
/// ```text
///         DTR on             report             position
///   Down ────────► Starting ────────► Ready ───────────────► Waiting ─┐ NAK: same bytes
///    ▲               ▲  └─ 05 ─┘        ▲         ACK           │  ▲  │
///    │ DTR off       │ no answer,       └───────────────────────┤  └──┘
///   (any)            └──────────────────────────────────────────┘
///                      unasked report            18: Cancelling ──ACK or DTR off──► Ended
///                                                         report, or 05: as from Down ◄──┘
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HostState {
    /// The controller's DTR is off: the DEPC function does not run.
    Down,
    /// Waiting for a report.
    Starting,
    /// The position is known and no frame is outstanding.
    Ready,
    /// A data command is outstanding.
    Waiting,
    /// A cancel is outstanding.
    Cancelling,
    /// The function was cancelled. A report restarts the link when the program reaches the function again. If none
    /// arrives within an answer time with DTR on, the host sends a restart.
    Ended,
}

/// Event of a tick that the user of the link must know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum HostEvent {
    /// No event.
    #[text = "nothing"]
    None,
    /// The outstanding data command is acknowledged.
    Acknowledged,
    /// A report has arrived; the robot is at [`Host::position`].
    Started,
    /// The running link was lost: the last command may or may not have been executed.
    Lost,
}

/// Request from the user of the link for this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Intent {
    /// No request.
    Idle,
    /// Move to the position and run the function there.
    Position(DataCommand),
    /// Restart the link.
    Restart,
    /// End the DEPC function.
    Cancel,
}

/// The host's end of the link.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Host {
    state: HostState,
    receiver: ReplyReceiver,
    /// The last reported or acknowledged position.
    position: Plate,
    /// The outstanding data command, to be repeated after a NAK.
    frame: [u8; FRAME_BYTES],
    restart_due: bool,
    resend_due: bool,
    /// Ticks since the last frame, or since the start of the wait.
    waited: u16,
    answer_ticks: u16,
    /// Time limit of a start or a cancel with DTR on, ticks.
    silence_limit: u16,
    /// Ticks with DTR on in the present start or cancel.
    starting: u16,
    /// True after [`RESTART_TICKS`] with DTR on and without a report. Only a report resets it, not [`Host::clear_fault`].
    silent: bool,
    /// A restart was sent, and its report has not arrived yet.
    restarted: bool,
    /// Fault of the last attempt of this start; none if no byte was received.
    attempt: LinkFault,
    retries: u8,
    attempts: u8,
    /// Number of reports in transit: restarts sent since the last start, and an unrequested report.
    asked: u8,
    /// A report that may not be the last one, as more than one was requested.
    candidate: Plate,
    has_candidate: bool,
    fault: LinkFault,
    lost_function: [u8; 2],
    counters: LinkCounters,
}

fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

impl Host {
    /// A host with an answer time of `answer_ticks` ticks (at least 1); usually [`ANSWER_TICKS`].
    #[must_use]
    pub fn new(answer_ticks: u16) -> Self {
        Self { answer_ticks: answer_ticks.max(1), silence_limit: SILENCE_LIMIT_TICKS, ..Self::default() }
    }

    /// Resets the counters and discards an outdated candidate report; the behaviour does not change.
    pub fn forget_past(&mut self) {
        self.counters = LinkCounters::default();
        if !self.has_candidate {
            self.candidate = Plate::default();
        }
    }

    /// Time limit, in ticks with DTR on, for a report or the answer to a cancel. Then the link has failed.
    pub const fn set_silence_limit(&mut self, ticks: u16) {
        self.silence_limit = ticks;
    }

    /// True if the controller's DTR was on in this tick.
    #[must_use]
    pub const fn has_dtr(&self) -> bool {
        !matches!(self.state, HostState::Down)
    }

    /// True if DTR is on and no report has arrived for [`RESTART_TICKS`] or longer.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        matches!(self.state, HostState::Starting) && self.silent
    }

    /// State of this end.
    #[must_use]
    pub const fn state(&self) -> HostState {
        self.state
    }

    /// The last reported or acknowledged position. Meaningless before the first report.
    #[must_use]
    pub const fn position(&self) -> Plate {
        self.position
    }

    /// True if the position is known and the controller answers commands.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        matches!(self.state, HostState::Ready | HostState::Waiting)
    }

    /// True if [`Host::transmit`] can send a position now.
    #[must_use]
    pub const fn can_send(&self) -> bool {
        matches!(self.state, HostState::Ready)
    }

    /// `status-arg-out` (VI.1.2): the first fault since [`Host::clear_fault`].
    #[must_use]
    pub const fn fault(&self) -> LinkFault {
        self.fault
    }

    /// Clear the fault.
    pub const fn clear_fault(&mut self) {
        self.fault = LinkFault::None;
        (self.attempts, self.starting, self.attempt) = (0, 0, LinkFault::None);
    }

    /// Function of the last lost data command, which may have run; [`crate::wire::NO_FUNCTION`] for none.
    #[must_use]
    pub const fn lost_function(&self) -> [u8; 2] {
        self.lost_function
    }

    /// Counters since the start.
    #[must_use]
    pub const fn counters(&self) -> &LinkCounters {
        &self.counters
    }

    /// Count a point that was scaled back to the limits.
    pub fn count_limited(&mut self) {
        count(&mut self.counters.limited);
    }

    /// Call before the first half of a tick if the port has not sent all bytes (`status-arg-out` 4, VI.1.2). The frame
    /// is lost: the port may have been blocked for longer than the controller waits.
    pub fn unsent(&mut self) -> HostEvent {
        match self.state {
            HostState::Waiting => self.lost(LinkFault::NotTransmitted),
            HostState::Starting => {
                // The restart itself was cut off, so no report will answer it.
                self.asked = self.asked.saturating_sub(1);
                self.restart_due = true;
                self.attempt = LinkFault::NotTransmitted;
                HostEvent::None
            }
            HostState::Cancelling => {
                self.resend_due = true;
                HostEvent::None
            }
            HostState::Down | HostState::Ready | HostState::Ended => HostEvent::None,
        }
    }

    /// First half of a tick: the received bytes, and the controller's DTR (`ready`).
    pub fn receive(&mut self, rx: &LinkBytes, ready: bool) -> HostEvent {
        self.waited = self.waited.saturating_add(1);
        if !ready {
            return self.without_dtr();
        }
        if self.state == HostState::Down {
            self.begin_start();
            self.waited = 0;
            self.asked = 1; // the controller sends an unrequested report when its function starts
        }
        let bytes = rx.as_slice();
        if bytes.is_empty() {
            self.receiver.idle();
        }
        let mut event = HostEvent::None;
        let mut behind = bytes.len();
        let few = bytes.len() <= ANSWER_BYTES;
        for byte in bytes {
            behind = behind.saturating_sub(1);
            match self.receiver.push(*byte) {
                Some(Reply::Response(_)) if !few => {}
                Some(reply) => event = event.max(self.take(reply, behind == 0)),
                None => {}
            }
        }
        self.count_silence();
        if self.waited >= self.answer_ticks { event.max(self.without_answer()) } else { event }
    }

    /// Second half of a tick: send a due frame or `intent`. Returns true if `intent` was sent.
    pub fn transmit(&mut self, intent: &Intent, tx: &mut LinkBytes) -> bool {
        match intent {
            // The report to the previous restart also answers this one.
            Intent::Restart if self.state == HostState::Starting && self.restarted => {}
            Intent::Restart => self.restart(),
            Intent::Cancel if self.is_running() => {
                self.state = HostState::Cancelling;
                self.resend_due = true;
            }
            _ => {}
        }
        if self.state == HostState::Down {
            return false;
        }
        if self.restart_due {
            self.restart_due = false;
            self.restarted = true;
            count(&mut self.counters.restarts);
            self.asked = self.asked.saturating_add(1);
            self.send(&[Control::Restart.byte()], tx);
            return *intent == Intent::Restart;
        }
        if self.resend_due {
            return self.resend(tx) && *intent == Intent::Cancel;
        }
        match intent {
            Intent::Position(command) if self.state == HostState::Ready => {
                command.emit(&mut self.frame);
                self.retries = 0;
                self.state = HostState::Waiting;
                count(&mut self.counters.frames);
                let frame = self.frame;
                self.send(&frame, tx)
            }
            _ => false,
        }
    }

    fn resend(&mut self, tx: &mut LinkBytes) -> bool {
        self.resend_due = false;
        if self.state == HostState::Cancelling {
            return self.send(&[Control::Cancel.byte()], tx);
        }
        count(&mut self.counters.frames);
        count(&mut self.counters.retries);
        let frame = self.frame;
        self.send(&frame, tx)
    }

    fn send(&mut self, bytes: &[u8], tx: &mut LinkBytes) -> bool {
        self.waited = 0;
        let sent = tx.extend(bytes) == bytes.len();
        if !sent {
            self.note_fault(LinkFault::NotTransmitted);
            self.restart();
        }
        sent
    }

    /// Processes one reply; one without meaning is ignored as noise. A report is valid only as the `last` reply of its
    /// tick: the checksum cannot detect a report that lost an FF and was completed by the first FF of the next. An
    /// answer is valid only in a tick with few bytes: it has no checksum, and may be a byte of a damaged report.
    fn take(&mut self, reply: Reply, last: bool) -> HostEvent {
        if reply == Reply::BadChecksum {
            count(&mut self.counters.checksum_errors);
        }
        if reply == Reply::Response(Response::Nak) {
            count(&mut self.counters.naks);
        }
        match (self.state, reply) {
            (HostState::Starting | HostState::Ended, Reply::Report(plate))
                if last && !self.restart_due && plate.is_canonical() =>
            {
                if self.asked <= 1 {
                    return self.start(plate);
                }
                (self.candidate, self.has_candidate) = (plate, true);
                self.waited = 0;
                HostEvent::None
            }
            (HostState::Waiting, Reply::Response(Response::Ack)) => {
                if let Ok(command) = DataCommand::parse(&self.frame) {
                    self.position = command.plate;
                }
                count(&mut self.counters.acknowledged);
                self.resend_due = false;
                self.state = HostState::Ready;
                HostEvent::Acknowledged
            }
            (HostState::Waiting, Reply::Response(Response::Nak)) => self.refused(),
            (HostState::Cancelling, Reply::Response(Response::Ack)) => {
                (self.resend_due, self.waited) = (false, 0);
                self.state = HostState::Ended;
                HostEvent::None
            }
            (HostState::Cancelling, Reply::Response(Response::Nak)) => {
                self.resend_due = true;
                HostEvent::None
            }
            // The controller has stopped with a warning and restarted (A 2.4), or more reports follow on a slow line.
            (HostState::Ready | HostState::Waiting, Reply::Report(_)) => {
                self.asked = 1;
                self.lost(LinkFault::DepcError)
            }
            (HostState::Ready | HostState::Waiting, Reply::BadChecksum) => self.lost(LinkFault::Checksum),
            (HostState::Starting, Reply::BadChecksum) => {
                self.asked = self.asked.saturating_sub(1); // one of the reports in transit
                self.restart_due = true;
                self.has_candidate = false;
                self.attempt = LinkFault::Checksum;
                HostEvent::None
            }
            _ => HostEvent::None,
        }
    }
}

#[cfg(test)]
mod tests;
