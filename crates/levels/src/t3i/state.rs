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

pub const GRACE_TICKS: u8 = 25; // 1 s for the resolvers to come near a reported position

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub receiver: Receiver,
    pub command: T3iVerb,
    pub step: Step,
    pub receive: ReceiveStep, // step of RECEIVE
    pub host: Host,
    pub limits: Limits,
    pub position: Position,      // the position sent or reported last
    pub sent: Option<SentWords>, // words with which a report is compared; `None` before the first position
    /// Step of REPORT: whether the robot is at its commanded position.
    pub check: ReportCheck,
    pub before: Before,                   // the output of the previous tick
    pub following: Following,             // step of FOLLOW
    pub track: Track,                     // the path that was sent
    pub reported: u8,                     // ticks since the last report, up to GRACE_TICKS
    pub deviation: i32,                   // 0.01 in, distance of the resolvers from the path
    pub left: Option<PathLeft>,           // where the robot left its path
    pub queue: [WireFrame; QUEUE_POINTS], // the first `queued` are valid, the oldest first
    pub queued: u8,
    pub rows: Rows,
}

impl State {
    pub(super) fn new(limits: Limits, answer_ticks: u16) -> Self {
        Self { limits, host: Host::new(answer_ticks), ..Self::default() }
    }

    pub(super) fn nbs() -> Self {
        Self::new(Limits::NBS, ANSWER_TICKS)
    }

    pub(super) fn first(&self) -> Option<&WireFrame> {
        self.queue.first().filter(|_| self.queued > 0)
    }

    pub(super) fn has_room(&self) -> bool {
        usize::from(self.queued) < QUEUE_POINTS
    }

    /// A full queue drops the point.
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
