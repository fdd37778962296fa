//! The part in the pedestal's hand: what Subtask believes of it, and what the opening of the hand says.

use rcs_core::interface::{
    pedestal::PedestalStatus,
    subtask::{Regrip, SubtaskCommand},
};
use taskdata::files::PedPara;

use super::{
    state::State,
    tables::{Hand, Held, Part, Pedestal, PedestalHand, Turn},
};

/// A hand that stands so much wider than when it had gripped has let go, 0.01 in (as E-move decides for the parts
/// gripper; ASSUMED).
const LET_GO: i32 = 25;
/// The hand is open if it stands within this of its opening to receive the object, 0.01 in (ASSUMED).
const OPEN_WITHIN: i32 = 10;
/// The table is at an angle if it stands within this of it, 0.1 degree: several steps of its motor (ASSUMED).
const AT_ANGLE: u32 = 10;

impl State {
    /// Once a tick: does the opening of the hand agree with what Subtask believes is in it? A hand that is closing is
    /// believed until it rests.
    pub(super) fn sense_hand(&mut self, status: &PedestalStatus, pedestal: Pedestal) {
        let Some(regrip) = &mut self.regrip else { return };
        let closed = status.grip_size <= regrip.grasp_size;
        let open = regrip.opening.is_some_and(|opening| status.grip_size > opening.saturating_add(LET_GO));
        match pedestal {
            Pedestal::Moving => {}
            _ if closed || open => self.regrip = None,
            _ => regrip.opening = regrip.opening.or(Some(status.grip_size)),
        }
    }

    /// The pedestal is told to close its hand on the object of the command.
    pub(super) fn give(&mut self, command: &SubtaskCommand) {
        let grasp_size = self.ped_para.grasp_size;
        self.regrip = Some(Regrip { object: command.object, grasp_size, opening: None });
    }

    /// Is a part in the hand?
    pub(super) const fn pedestal_hand(&self) -> PedestalHand {
        if self.regrip.is_some() { PedestalHand::HoldsPart } else { PedestalHand::Free }
    }

    /// Who has the object of the command.
    pub(super) fn part(&self, held: Held, command: &SubtaskCommand) -> Part {
        match (held, &self.regrip) {
            (Held::NotKnown, _) => Part::NotKnown,
            (_, Some(regrip)) if regrip.object != command.object => Part::Other,
            (Held::Right, Some(_)) => Part::Both,
            (Held::Something, Some(_)) => Part::Touched,
            (Held::Nothing | Held::Other, Some(_)) => Part::Hand,
            (Held::Right, None) => Part::Robot,
            (Held::Something, None) => Part::Unknown,
            (Held::Nothing | Held::Other, None) => Part::Nobody,
        }
    }
}

/// Where the table stands for an object; an angle that is not known is neither of the two.
pub(super) fn turn(status: &PedestalStatus, para: &PedPara) -> Turn {
    match status.table_position {
        Some(position) if position.abs_diff(para.table_pos) <= AT_ANGLE => Turn::Receive,
        Some(position) if position.abs_diff(turned(para)) <= AT_ANGLE => Turn::Turned,
        _ => Turn::Between,
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
