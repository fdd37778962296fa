//! The part of an interrupted way that is flown back (docs/design/recovery.md "On the way").

use rcs_core::Plain;
use taskdata::files::TaskData;

use super::route::{Leg, LegGoal, Route, slower};

/// The part of an interrupted way that is flown back.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Back {
    /// The way.
    pub route: Route,
    /// The point before which the robot is, in the direction of the goal: it goes to the one before that.
    pub next: u16,
    /// The end of the depart leg has been commanded.
    pub complete: bool,
}

impl Back {
    /// The next leg back. `None` if a record is missing.
    pub(super) fn leg(&self, data: &TaskData<'_>) -> Option<Leg> {
        let (_, from) = self.route.point(self.next, data)?;
        let (frame, to) = match self.next.checked_sub(1) {
            Some(point) => self.route.point(point, data)?,
            None => (self.route.from.pose.to_frame().ok()?, from),
        };
        Some(Leg { at: LegGoal::Computed(frame), parameters: slower(from, to, data) })
    }

    /// Note that it has been commanded.
    pub(super) fn advance(&mut self, data: &TaskData<'_>) {
        if self.next <= self.route.depart_points(data) {
            self.complete = true;
        } else {
            self.next = self.next.saturating_sub(1);
        }
    }
}
