use depc::{
    Limits,
    host::{ANSWER_TICKS, Host},
    step::Position,
    track::Track,
};
use geometry::pose::WireFrame;
use interfaces::t3i::{Following, PathLeft, ReportCheck, SentWords, T3iVerb};
use rcs_core::{Plain, handshake::Receiver};

use super::tables::{Before, Step, receive::ReceiveStep};
use crate::rows::Rows;

/// Points in the queue (docs/design/link.md "Queue"): one that is being sent, one that was permitted, one in
/// transit, and one spare.
pub const QUEUE_POINTS: usize = 4;

/// Ticks in which the resolvers must come near a reported position: 1 s.
pub const GRACE_TICKS: u8 = 25;

/// State of T3I.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command number and its adoption.
    pub receiver: Receiver,
    /// The current command.
    pub command: T3iVerb,
    /// Step of its table.
    pub step: Step,
    /// Step of RECEIVE.
    pub receive: ReceiveStep,
    /// The host's end of the link.
    pub host: Host,
    /// The velocity limits.
    pub limits: Limits,
    /// The position sent or reported last.
    pub position: Position,
    /// The words with which a report is compared; none before the first position.
    pub sent: Option<SentWords>,
    /// Step of REPORT: is the robot where it was sent?
    pub check: ReportCheck,
    /// The output of the previous tick.
    pub before: Before,
    /// Step of FOLLOW.
    pub following: Following,
    /// The path that was sent.
    pub track: Track,
    /// Ticks since the last report of the robot controller, up to [`GRACE_TICKS`].
    pub reported: u8,
    /// Distance of the resolvers from the path, 0.01 in.
    pub deviation: i32,
    /// Where the robot left its path.
    pub left: Option<PathLeft>,
    /// Waiting points; the first `queued` are valid, the oldest first.
    pub queue: [WireFrame; QUEUE_POINTS],
    /// How many.
    pub queued: u8,
    /// The rows for the header.
    pub rows: Rows,
}

impl State {
    /// The state before the first tick.
    pub(super) fn new(limits: Limits, answer_ticks: u16) -> Self {
        Self { limits, host: Host::new(answer_ticks), ..Self::default() }
    }

    pub(super) fn nbs() -> Self {
        Self::new(Limits::NBS, ANSWER_TICKS)
    }

    pub(super) fn first(&self) -> Option<&WireFrame> {
        self.queue.first().filter(|_| self.queued > 0)
    }

    /// True if the queue has room for another point.
    pub(super) fn has_room(&self) -> bool {
        usize::from(self.queued) < QUEUE_POINTS
    }

    /// Append a point; a full queue drops it.
    pub(super) fn append(&mut self, point: WireFrame) {
        if let Some(slot) = self.queue.get_mut(usize::from(self.queued)) {
            *slot = point;
            self.queued = self.queued.saturating_add(1);
        }
    }

    pub(super) fn remove_first(&mut self) {
        if self.queued > 0 {
            self.queue.rotate_left(1);
            self.queued = self.queued.saturating_sub(1);
            self.clear_from(usize::from(self.queued));
        }
    }

    pub(super) fn empty(&mut self) {
        self.queued = 0;
        self.clear_from(0);
    }

    /// Zero the unused places, so that equal states have equal bytes.
    fn clear_from(&mut self, place: usize) {
        self.queue.iter_mut().skip(place).for_each(|point| *point = WireFrame::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queue_keeps_order_and_bound() {
        let point = |x| WireFrame { tool: [x, 0, 0], ..WireFrame::default() };
        let mut state = State::nbs();
        assert_eq!(state.first(), None);
        for x in 1..=5 {
            assert_eq!(state.has_room(), x <= 4);
            state.append(point(x));
        }
        for x in 1..=4 {
            assert_eq!(state.first(), Some(&point(x)));
            state.remove_first();
        }
        state.remove_first();
        assert_eq!(state, State::nbs());
    }
}
