//! The host's end of the link, with which the T3 Interface process talks to the robot controller (A 2.3, VI.1).
//!
//! Each tick has two halves: [`Host::receive`] processes the received bytes and changes the state, [`Host::transmit`]
//! sends at most one frame. Only one frame is outstanding at a time. An answer has no number, so the host never repeats
//! a frame without an answer: the controller may have executed it. The host then sends a restart, discards everything
//! until a report with a correct checksum comes, and continues from there. Only after a NAK, which means that nothing
//! was executed, it sends the same bytes again.
//!
//! A controller whose DTR is on and that does not answer may be in Hold, show a warning D1 to D6, have a dead receiver,
//! or the wire may be cut: the host cannot distinguish these. It sends a restart once a second, and after the time of
//! [`Host::set_patience`] it reports the link as failed.
//!
//! A report has no number either. On a slow line several may be on their way, and the robot may have moved since the
//! first: if more than one was requested, the last one is valid, and only when no other has followed for longer than
//! the time for an answer.

mod start;

use rcs_core::Plain;

use crate::link::{LinkBytes, LinkCounters, LinkFault};
use crate::{
    Plate,
    receive::{Reply, ReplyReceiver},
    wire::{Control, DataCommand, FRAME_BYTES, Response},
};

/// Ticks without an answer after which a frame counts as lost (docs/design/link.md "Time-out"). Hold on the
/// controller's panel only delays the answer, and looks the same.
pub const ANSWER_TICKS: u16 = 3;
/// Greatest number of bytes in a tick in which an answer is valid; more bytes may be noise.
const ANSWER_BYTES: usize = 4;
/// Repetitions of one data command after NAKs, after which the host restarts the link.
pub const MOST_RETRIES: u8 = 3;
/// Ticks between two unanswered restarts: 1 s (docs/design/link.md "Silence").
pub const RESTART_TICKS: u16 = 25;
/// Default number of ticks without a report, with DTR on, after which the link counts as failed: 60 s.
pub const PATIENCE_TICKS: u16 = 60 * RESTART_TICKS;
/// Number of attempts without DTR, each as long as the time for an answer, after which the link counts as not
/// responding.
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
    /// The function was cancelled. A report, when the program comes to the function again, begins again; so does a
    /// restart, when DTR is on for as long as an answer may take and no report comes.
    Ended,
}

/// Event since the last tick that the user of the link must know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum HostEvent {
    /// Nothing.
    #[text = "nothing"]
    None,
    /// The outstanding data command is acknowledged.
    Acknowledged,
    /// A report has come; the robot holds [`Host::position`].
    Started,
    /// The link was lost while it ran: what was sent last may or may not have been executed.
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
    /// The position last reported or acknowledged.
    position: Plate,
    /// The outstanding data command, to be repeated after a NAK.
    frame: [u8; FRAME_BYTES],
    restart_due: bool,
    resend_due: bool,
    /// Ticks since the last frame was sent, or since the wait began.
    waited: u16,
    answer_ticks: u16,
    /// Greatest number of ticks of a start or a cancel with DTR on.
    patience: u16,
    /// Ticks with DTR on in the present start or cancel.
    starting: u16,
    /// No report has come for [`RESTART_TICKS`] with DTR on. Only a report ends this, not [`Host::forgive`].
    silent: bool,
    /// A restart was sent, and its report has not come yet.
    restarted: bool,
    /// Fault of the last attempt of this start; none if nothing was received.
    attempt: LinkFault,
    retries: u8,
    attempts: u8,
    /// Number of reports that may be on their way: restarts sent since the last start, and an unrequested report.
    asked: u8,
    /// A report that may not be the last one, because more than one was requested.
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
    /// A host that waits `answer_ticks` ticks (at least 1) for the answer to a frame; usually [`ANSWER_TICKS`].
    #[must_use]
    pub fn new(answer_ticks: u16) -> Self {
        Self { answer_ticks: answer_ticks.max(1), patience: PATIENCE_TICKS, ..Self::default() }
    }

    /// Forget the counters, and the report that is no candidate any more. It goes on as before.
    pub fn forget_past(&mut self) {
        self.counters = LinkCounters::default();
        if !self.has_candidate {
            self.candidate = Plate::default();
        }
    }

    /// Set the number of ticks with DTR on to wait for a report, or for the answer to a cancel, before the link counts
    /// as failed; initially [`PATIENCE_TICKS`].
    pub const fn set_patience(&mut self, ticks: u16) {
        self.patience = ticks;
    }

    /// True if the controller's DTR was on in this tick.
    #[must_use]
    pub const fn has_dtr(&self) -> bool {
        !matches!(self.state, HostState::Down)
    }

    /// True if DTR is on and no report has come for [`RESTART_TICKS`] or longer.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        matches!(self.state, HostState::Starting) && self.silent
    }

    /// State of this end.
    #[must_use]
    pub const fn state(&self) -> HostState {
        self.state
    }

    /// The position last reported or acknowledged. Meaningless before the first report.
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

    /// `status-arg-out` (VI.1.2): the first fault since [`Host::forgive`].
    #[must_use]
    pub const fn fault(&self) -> LinkFault {
        self.fault
    }

    /// Clear the fault.
    pub const fn forgive(&mut self) {
        self.fault = LinkFault::None;
        (self.attempts, self.starting, self.attempt) = (0, 0, LinkFault::None);
    }

    /// Function bytes of the last data command with a function that was lost: the function may or may not have run, and
    /// the command is not repeated. [`crate::wire::NO_FUNCTION`] if there was none.
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

    /// Call before the first half of a tick if the port has not sent all bytes of the last one (`status-arg-out` 4,
    /// VI.1.2). The frame on the line was cut, so it counts as lost; the port may have been blocked for longer than the
    /// controller waits.
    pub fn unsent(&mut self) -> HostEvent {
        match self.state {
            HostState::Waiting => self.lost(LinkFault::NotTransmitted),
            HostState::Starting => {
                // The restart itself was cut: no report will answer it.
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

    /// First half of a tick: the bytes that arrived, and the controller's DTR (`ready`).
    pub fn receive(&mut self, rx: &LinkBytes, ready: bool) -> HostEvent {
        self.waited = self.waited.saturating_add(1);
        if !ready {
            return self.without_dtr();
        }
        if self.state == HostState::Down {
            self.begin_start();
            self.waited = 0;
            // The controller sends a report without a request when its function begins.
            self.asked = 1;
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
        self.be_patient();
        if self.waited >= self.answer_ticks { event.max(self.without_answer()) } else { event }
    }

    /// Second half of a tick: send a frame that is due, or `intent`. Returns true if `intent` was sent.
    pub fn transmit(&mut self, intent: &Intent, tx: &mut LinkBytes) -> bool {
        match intent {
            // The report that answers the previous restart answers this one too.
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

    /// Process one reply in the present state. A reply without meaning is noise and is ignored: if it has replaced an
    /// answer, no answer comes.
    ///
    /// A report is valid only if it is the `last` reply of its tick: nothing is sent after it, and the checksum cannot
    /// distinguish a report that has lost an FF from one that is completed by the first FF of the next. An answer is
    /// valid only in a tick with few bytes: it has no checksum, and may be a byte of a damaged report.
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
            // It was not requested: the controller has stopped with a warning and begun again (A 2.4). Or the line is
            // slow, and more reports follow.
            (HostState::Ready | HostState::Waiting, Reply::Report(_)) => {
                self.asked = 1;
                self.lost(LinkFault::DepcError)
            }
            (HostState::Ready | HostState::Waiting, Reply::BadChecksum) => self.lost(LinkFault::Checksum),
            (HostState::Starting, Reply::BadChecksum) => {
                // This was one of the reports on their way.
                self.asked = self.asked.saturating_sub(1);
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
