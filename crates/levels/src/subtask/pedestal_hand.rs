//! The part in the pedestal's hand: the sensors of the hand, and Subtask's belief which part it is.

use interfaces::{
    grip::Felt,
    pedestal::PedestalStatus,
    subtask::{Regrip, SubtaskCommand},
};
use taskdata::files::PedPara;

use super::{
    state::State,
    tables::{Hand, Part, Pedestal, PedestalHand, Turn},
};
use crate::held::Held;

/// The hand is open if it stands within this of its opening to receive the object, 0.01 in (ASSUMED).
const OPEN_WITHIN: i32 = 10;
/// The table is at an angle if it stands within this of it, 0.1 degree: several steps of its motor (ASSUMED).
const AT_ANGLE: u32 = 10;

impl State {
    /// Once a tick: compare the sensors of the hand with Subtask's belief. While the hand moves the belief is kept.
    pub(super) fn sense_hand(&mut self, status: &PedestalStatus, pedestal: Pedestal) {
        if pedestal != Pedestal::Moving && pedestal_hand(status) == PedestalHand::Free {
            self.regrip = None;
        }
    }

    /// The pedestal is commanded to close its hand on the object of the command.
    pub(super) const fn give(&mut self, command: &SubtaskCommand) {
        self.regrip = match command.object {
            Some(object) => Some(Regrip { object }),
            None => None,
        };
    }

    /// Who has the object of the command.
    pub(super) fn part(&self, held: Held, status: &PedestalStatus, command: &SubtaskCommand) -> Part {
        let right = self.regrip.is_some_and(|regrip| Some(regrip.object) == command.object);
        match (held, pedestal_hand(status)) {
            (Held::NotKnown, PedestalHand::HoldsPart) if right => Part::Touched,
            (Held::NotKnown, _) => Part::NotKnown,
            (_, PedestalHand::Unsure) => Part::Unsure,
            (_, PedestalHand::HoldsPart) if !right => Part::Other,
            (Held::Right, PedestalHand::HoldsPart) => Part::Both,
            (Held::Something, PedestalHand::HoldsPart) => Part::Touched,
            (Held::Nothing | Held::Other, PedestalHand::HoldsPart) => Part::Hand,
            (Held::Right, PedestalHand::Free) => Part::Robot,
            (Held::Something, PedestalHand::Free) => Part::Unknown,
            (Held::Nothing | Held::Other, PedestalHand::Free) => Part::Neither,
        }
    }
}

/// Whether a part is in the hand. Contact before GRIP, or after an opening, does not count.
pub(super) const fn pedestal_hand(status: &PedestalStatus) -> PedestalHand {
    match status.felt {
        Felt::Something if status.gripped => PedestalHand::HoldsPart,
        Felt::NotKnown if status.gripped => PedestalHand::Unsure,
        Felt::Nothing | Felt::Something | Felt::NotKnown => PedestalHand::Free,
    }
}

/// Where the table stands for an object.
pub(super) fn turn(status: &PedestalStatus, para: &PedPara) -> Turn {
    let is_at = |angle: i32, position: i32| position.abs_diff(angle) <= AT_ANGLE;
    match status.table_position {
        None => Turn::Unknown,
        Some(position) if is_at(para.table_pos, position) => Turn::Receive,
        Some(position) if is_at(turned(para), position) => Turn::Turned,
        Some(_) => Turn::Between,
    }
}

/// The absolute angle to which the table turns an object, 0.1 degree: FLIP itself is relative (VI.7.1).
pub(super) const fn turned(para: &PedPara) -> i32 {
    para.table_pos.saturating_add(para.flip_angle)
}

/// Is the hand open for an object?
pub(super) const fn hand(status: &PedestalStatus, para: &PedPara) -> Hand {
    if status.grip_size.saturating_add(OPEN_WITHIN) >= para.appr { Hand::Open } else { Hand::Narrow }
}
