//! The part in the pedestal's hand: the sensors of the hand, and Subtask's belief which part it is.

use interfaces::{
    grip::Felt,
    pedestal::PedestalStatus,
    subtask::{Regrip, SubtaskCommand},
};
use taskdata::files::PedPara;

use super::{
    state::State,
    tables::{HandOpening, PedestalLoad, SubtaskPart, SubtaskPedestal, Turn},
};
use crate::held::Held;

/// The hand is open if it stands within this of its opening to receive the object, 0.01 in (ASSUMED).
const OPEN_WITHIN: i32 = 10;
/// The table is at an angle if it stands within this of it, 0.1 degree: several steps of its motor (ASSUMED).
const AT_ANGLE: u32 = 10;

impl State {
    /// Once a tick: compare the sensors of the hand with Subtask's belief. While the hand moves the belief is kept.
    pub(super) fn sense_hand(&mut self, status: &PedestalStatus, pedestal: SubtaskPedestal) {
        if pedestal != SubtaskPedestal::Moving && pedestal_hand(status) == PedestalLoad::Free {
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
    pub(super) fn part(&self, held: Held, status: &PedestalStatus, command: &SubtaskCommand) -> SubtaskPart {
        let right = self.regrip.is_some_and(|regrip| Some(regrip.object) == command.object);
        match (held, pedestal_hand(status)) {
            (Held::NotKnown, PedestalLoad::HoldsPart) if right => SubtaskPart::Touched,
            (Held::NotKnown, _) => SubtaskPart::NotKnown,
            (_, PedestalLoad::Unsure) => SubtaskPart::Unsure,
            (_, PedestalLoad::HoldsPart) if !right => SubtaskPart::Other,
            (Held::Right, PedestalLoad::HoldsPart) => SubtaskPart::Both,
            (Held::Something, PedestalLoad::HoldsPart) => SubtaskPart::Touched,
            (Held::Nothing | Held::Other, PedestalLoad::HoldsPart) => SubtaskPart::Hand,
            (Held::Right, PedestalLoad::Free) => SubtaskPart::Robot,
            (Held::Something, PedestalLoad::Free) => SubtaskPart::Unknown,
            (Held::Nothing | Held::Other, PedestalLoad::Free) => SubtaskPart::Neither,
        }
    }
}

/// Whether a part is in the hand. Contact before GRIP, or after an opening, does not count.
pub(super) const fn pedestal_hand(status: &PedestalStatus) -> PedestalLoad {
    match status.felt {
        Felt::Something if status.gripped => PedestalLoad::HoldsPart,
        Felt::NotKnown if status.gripped => PedestalLoad::Unsure,
        Felt::Nothing | Felt::Something | Felt::NotKnown => PedestalLoad::Free,
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
pub(super) const fn hand(status: &PedestalStatus, para: &PedPara) -> HandOpening {
    if status.grip_size.saturating_add(OPEN_WITHIN) >= para.appr {
        HandOpening::Open
    } else {
        HandOpening::Narrow
    }
}
