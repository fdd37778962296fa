//! Start and end of the host's data phase: reports, refusals, silence, DTR, restarts.

use super::{Host, HostEvent, HostState, MOST_RETRIES, RESTART_TICKS, START_ATTEMPTS, count};
use crate::link::LinkFault;
use crate::{
    Plate,
    wire::{DataCommand, NO_FUNCTION},
};

impl Host {
    pub(super) fn start(&mut self, plate: Plate) -> HostEvent {
        self.position = plate;
        self.state = HostState::Ready;
        (self.attempts, self.starting, self.asked) = (0, 0, 0);
        (self.has_candidate, self.silent) = (false, false);
        HostEvent::Started
    }

    /// After a lost ACK, a late NAK may answer noise. A position may then be repeated, but a function may not.
    pub(super) fn refused(&mut self) -> HostEvent {
        let ambiguous = self.waited > 1 && self.function() != NO_FUNCTION;
        if self.retries >= MOST_RETRIES || ambiguous {
            return self.lost(LinkFault::NotTransmitted);
        }
        self.retries = self.retries.saturating_add(1);
        self.resend_due = true;
        self.waited = 0;
        HostEvent::None
    }

    pub(super) fn without_answer(&mut self) -> HostEvent {
        match self.state {
            HostState::Waiting => {
                count(&mut self.counters.timeouts);
                self.lost(LinkFault::NotResponding)
            }
            // On a slow line the reports to all restarts arrive one by one, the first outdated: one is valid only if
            // no other follows for longer than the time between two restarts.
            HostState::Starting if self.has_candidate => {
                if self.waited > self.answer_ticks {
                    self.start(self.candidate)
                } else {
                    HostEvent::None
                }
            }
            HostState::Starting if self.restarted && self.waited < RESTART_TICKS => HostEvent::None,
            HostState::Starting => {
                count(&mut self.counters.timeouts);
                self.restart_due = true;
                HostEvent::None
            }
            HostState::Cancelling => {
                count(&mut self.counters.timeouts);
                self.resend_due = true;
                HostEvent::None
            }
            // DTR is on again, and the report of the starting function is missing.
            HostState::Ended => {
                self.begin_start();
                (self.starting, self.attempt) = (0, LinkFault::None);
                (self.asked, self.restart_due) = (1, true);
                HostEvent::None
            }
            HostState::Down | HostState::Ready => HostEvent::None,
        }
    }

    pub(super) fn without_dtr(&mut self) -> HostEvent {
        if matches!(self.state, HostState::Cancelling | HostState::Ended) {
            self.receiver.clear(); // do not wait for the ACK that accompanies the loss of DTR
            self.state = HostState::Ended;
            (self.resend_due, self.waited) = (false, 0);
            return HostEvent::None;
        }
        let was_running = self.is_running();
        if was_running {
            (self.starting, self.attempt) = (0, LinkFault::None);
            self.note_lost_function();
            self.note_fault(LinkFault::NotResponding);
        } else if self.state == HostState::Starting || self.waited >= self.answer_ticks {
            self.waited = 0;
            self.attempts = self.attempts.saturating_add(1);
            if self.attempts >= START_ATTEMPTS {
                self.note_fault(LinkFault::NotResponding);
            }
        }
        self.receiver.clear();
        self.state = HostState::Down;
        (self.restart_due, self.resend_due, self.has_candidate) = (false, false, false);
        self.asked = 0;
        if was_running { HostEvent::Lost } else { HostEvent::None }
    }

    pub(super) fn lost(&mut self, fault: LinkFault) -> HostEvent {
        self.note_fault(fault);
        self.restart();
        HostEvent::Lost
    }

    pub(super) fn restart(&mut self) {
        self.note_lost_function();
        self.resend_due = false;
        if self.state != HostState::Down {
            self.receiver.clear();
            if self.state != HostState::Starting {
                self.begin_start();
            }
            self.has_candidate = false;
            self.restart_due = true;
        }
    }

    /// DTR is on, or the link was lost. An intermittent DTR does not reset the time limit.
    pub(super) fn begin_start(&mut self) {
        if self.is_running() {
            (self.starting, self.attempt) = (0, LinkFault::None);
        }
        self.state = HostState::Starting;
        self.restarted = false;
    }

    /// Counts a tick with DTR on in a start or an unanswered cancel.
    pub(super) fn count_silence(&mut self) {
        if !matches!(self.state, HostState::Starting | HostState::Cancelling) {
            return;
        }
        self.starting = self.starting.saturating_add(1);
        self.silent |= self.starting >= RESTART_TICKS;
        if self.starting >= self.silence_limit && !self.has_candidate {
            let silent = self.attempt == LinkFault::None;
            self.note_fault(if silent { LinkFault::NotResponding } else { self.attempt });
        }
    }

    pub(super) fn note_lost_function(&mut self) {
        if self.state == HostState::Waiting && self.function() != NO_FUNCTION {
            self.lost_function = self.function();
        }
    }

    pub(super) fn function(&self) -> [u8; 2] {
        DataCommand::parse(&self.frame).map_or(NO_FUNCTION, |command| command.function)
    }

    pub(super) fn note_fault(&mut self, fault: LinkFault) {
        if self.fault == LinkFault::None {
            self.fault = fault;
        }
    }
}
