//! The session: whether the robot is connected and follows, and which of its messages are new.
//!
//! EGM has no connections and does not detect lost messages: the state follows from messages and their times.

use crate::message::{MciState, MotorState, RapidState, Robot};

/// A sequence number lower by at most this is old; a still lower one means that the robot counts from the start again.
const WINDOW: u32 = 250;

/// State of the link.
///
/// ```text
///              message              motors on, MCI and RAPID running
///   Waiting ────────────► Standby ◄─────────────────────────────────► Running
///                          ▲    │ silence                                │ silence
///                          │    ▼                                        │
///                  message └── Lost ◄────────────────────────────────────┘
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkState {
    /// No message has arrived yet.
    #[default]
    Waiting,
    /// Messages arrive, but the robot does not follow.
    Standby(NotFollowing),
    /// The robot follows its targets.
    Running,
    /// No message has arrived for too long.
    Lost,
}

/// Why the robot does not follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFollowing {
    /// The motion correction has stopped with an error: a singularity, a joint limit, a time-out.
    MciError,
    /// The motors are off: an emergency stop, or a stop of the enabling device.
    MotorsOff,
    /// The RAPID program is stopped.
    RapidStopped,
    /// No EGM instruction runs.
    MciStopped,
    /// The controller does not send its state.
    Unknown,
}

impl NotFollowing {
    /// As text for messages.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::MciError => "EGM has stopped with an error (see the controller's event log)",
            Self::MotorsOff => "the motors are off (emergency stop or enabling device)",
            Self::RapidStopped => "the RAPID program is stopped",
            Self::MciStopped => "no EGM instruction runs",
            Self::Unknown => "the controller does not send its states",
        }
    }
}

/// Age of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// New.
    New,
    /// A duplicate, or older than the last message; it gets no answer.
    Old,
}

/// The session with one robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Session {
    state: LinkState,
    last: Option<u32>,
    heard: u64,
}

impl Session {
    /// State of the link.
    #[must_use]
    pub const fn state(&self) -> LinkState {
        self.state
    }

    /// Arrival time of the last new message, ns.
    #[must_use]
    pub const fn heard(&self) -> u64 {
        self.heard
    }

    /// Takes a message with its sequence number, which arrived at `now`, ns.
    pub fn accept(&mut self, now: u64, seqno: u32, message: &Robot) -> Arrival {
        // After the robot was lost, only a repetition of its last message is old.
        let window = if self.state == LinkState::Lost { 0 } else { WINDOW };
        if self.last.is_some_and(|last| last.wrapping_sub(seqno) <= window) {
            return Arrival::Old;
        }
        (self.last, self.heard) = (Some(seqno), now);
        self.state = not_following(message).map_or(LinkState::Running, LinkState::Standby);
        Arrival::New
    }

    /// Changes to `Lost` after `silence` ns without a new message.
    pub fn poll(&mut self, now: u64, silence: u64) {
        let waits = matches!(self.state, LinkState::Waiting | LinkState::Lost);
        if !waits && now.saturating_sub(self.heard) >= silence {
            self.state = LinkState::Lost;
        }
    }
}

/// The most serious reason first.
fn not_following(message: &Robot) -> Option<NotFollowing> {
    let (motors, mci, rapid) = (message.motor_state, message.mci_state, message.rapid_state);
    match (motors, mci, rapid) {
        (_, Some(MciState::Error), _) => Some(NotFollowing::MciError),
        (Some(MotorState::Off), ..) => Some(NotFollowing::MotorsOff),
        (_, _, Some(RapidState::Stopped)) => Some(NotFollowing::RapidStopped),
        (_, Some(MciState::Stopped), _) => Some(NotFollowing::MciStopped),
        (Some(MotorState::On), Some(MciState::Running), Some(RapidState::Running)) => None,
        _ => Some(NotFollowing::Unknown),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(motors: MotorState, mci: MciState, rapid: RapidState) -> Robot {
        let (motor_state, mci_state, rapid_state) = (Some(motors), Some(mci), Some(rapid));
        Robot { motor_state, mci_state, rapid_state, ..Robot::default() }
    }

    fn well() -> Robot {
        message(MotorState::On, MciState::Running, RapidState::Running)
    }

    #[test]
    fn every_state_of_the_robot_has_its_reason() {
        for (message, expected) in [
            (well(), LinkState::Running),
            (
                message(MotorState::Off, MciState::Error, RapidState::Stopped),
                LinkState::Standby(NotFollowing::MciError),
            ),
            (
                message(MotorState::Off, MciState::Stopped, RapidState::Stopped),
                LinkState::Standby(NotFollowing::MotorsOff),
            ),
            (
                message(MotorState::On, MciState::Running, RapidState::Stopped),
                LinkState::Standby(NotFollowing::RapidStopped),
            ),
            (
                message(MotorState::On, MciState::Stopped, RapidState::Running),
                LinkState::Standby(NotFollowing::MciStopped),
            ),
            (Robot::default(), LinkState::Standby(NotFollowing::Unknown)),
        ] {
            let mut session = Session::default();
            session.accept(0, 1, &message);
            assert_eq!(session.state(), expected);
        }
    }

    #[test]
    fn old_messages_are_distinguished_from_a_robot_that_restarts_its_count() {
        let mut session = Session::default();
        for (seqno, arrival) in [
            (0, Arrival::New),
            (2, Arrival::New),
            (2, Arrival::Old),
            (1, Arrival::Old),
            (40, Arrival::New),
            (5, Arrival::Old),
            (1000, Arrival::New),
            (1, Arrival::New),
            (u32::MAX, Arrival::Old),
        ] {
            assert_eq!(session.accept(0, seqno, &well()), arrival, "{seqno}");
        }
    }

    #[test]
    fn silence_loses_the_robot_and_any_number_brings_it_back() {
        let mut session = Session::default();
        session.poll(10_000, 120);
        assert_eq!(session.state(), LinkState::Waiting);
        session.accept(0, 100, &well());
        session.poll(119, 120);
        assert_eq!(session.state(), LinkState::Running);
        session.poll(120, 120);
        assert_eq!(session.state(), LinkState::Lost);
        assert_eq!(session.accept(200, 100, &well()), Arrival::Old);
        assert_eq!(session.accept(200, 7, &well()), Arrival::New);
        assert_eq!(session.state(), LinkState::Running);
    }

    #[test]
    fn numbers_may_wrap_around() {
        let mut session = Session::default();
        session.accept(0, u32::MAX, &well());
        assert_eq!(session.accept(0, 0, &well()), Arrival::New);
    }
}
