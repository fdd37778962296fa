//! The part in the pedestal's hand: the sensors of the hand, and the estimate of the part's name.

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

const OPEN_WITHIN: i32 = 10; // 0.01 in (ASSUMED)
const AT_ANGLE: u32 = 10; // 0.1 degree: several steps of the motor (ASSUMED)

impl State {
    /// An empty hand clears the estimate; a moving hand keeps it.
    pub(super) fn sense_hand(&mut self, status: &PedestalStatus, pedestal: SubtaskPedestal) {
        if pedestal != SubtaskPedestal::Moving && pedestal_hand(status) == PedestalLoad::Free {
            self.regrip = None;
        }
    }

    pub(super) const fn give(&mut self, command: &SubtaskCommand) {
        self.regrip = match command.object {
            Some(object) => Some(Regrip { object }),
            None => None,
        };
    }
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

/// Contact before GRIP, or after an opening, is ignored.
pub(super) const fn pedestal_hand(status: &PedestalStatus) -> PedestalLoad {
    match status.felt {
        Felt::Something if status.gripped => PedestalLoad::HoldsPart,
        Felt::NotKnown if status.gripped => PedestalLoad::Unsure,
        Felt::Nothing | Felt::Something | Felt::NotKnown => PedestalLoad::Free,
    }
}
pub(super) fn turn(status: &PedestalStatus, para: &PedPara) -> Turn {
    let is_at = |angle: i32, position: i32| position.abs_diff(angle) <= AT_ANGLE;
    match status.table_position {
        None => Turn::Unknown,
        Some(position) if is_at(para.table_pos, position) => Turn::Receive,
        Some(position) if is_at(turned(para), position) => Turn::Turned,
        Some(_) => Turn::Between,
    }
}

/// The absolute angle of the turned object, 0.1 degree. FLIP itself is relative (VI.7.1).
pub(super) const fn turned(para: &PedPara) -> i32 {
    para.table_pos.saturating_add(para.flip_angle)
}
pub(super) const fn hand(status: &PedestalStatus, para: &PedPara) -> HandOpening {
    if status.grip_size.saturating_add(OPEN_WITHIN) >= para.appr {
        HandOpening::Open
    } else {
        HandOpening::Narrow
    }
}
