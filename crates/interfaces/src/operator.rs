//! Inputs of operators at the terminals of the boards (IV.2.6, IV.3.2, IV.3.3) that belong to no device.
//!
//! | at a terminal | here |
//! |---|---|
//! | `^C` on board 2, 4, 6 or 8; `GO` | the bit of the board in `stopped`; its processes are not stepped |
//! | `^C` on board 0; `SSGO` | bit 0 of `stopped`: there is no pulse, and no process is stepped |
//! | `PRIM-LEVEL` and the like on a stopped board | the bit of the process in `executed`, for one tick |
//! | `.R` on board 2 | `robot_init` changes: E-move gives Prim ROBOT-INIT (SPECNOTES.md, contradiction 13) |
//! | DB-DONE in block 903 | `db_done` |
//! | `<= VALUE` of a variable of a suspended process | an entry of `writes`, for one tick |
//!
//! Two inputs have no word in the manual (SPECNOTES.md): `pedestal`, an order to the Active Pedestal, and `confirmed`,
//! a statement that the held object will not fall. Both are present for one tick.

use rcs_core::{Plain, name::Name16};

use crate::{CommonMemory, ProcessId, pedestal::PedestalVerb};

/// Numbers of the boards in use (IV.2.2), in the order of their bits.
pub const BOARDS: [u8; 5] = [0, 2, 4, 6, 8];

/// Inputs of operators at the terminals of the boards.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct OperatorInputs {
    /// Stopped boards, one bit per board in the order of [`BOARDS`].
    pub stopped: u8,
    /// Processes to step once in this tick although their board is stopped or their switch suspends them: one bit per
    /// process in the order of [`ProcessId::ALL`].
    pub executed: u16,
    /// Changes with each `.R`; 0 before the first.
    pub robot_init: u32,
    /// DB-DONE (Figure IV.1): Task treats each command to the Data System as done.
    pub db_done: bool,
    /// Values to write in this tick, in this order.
    pub writes: [Option<Write>; WRITES],
    /// Order to the Active Pedestal, for Subtask to send in this tick.
    pub pedestal: Option<HandOrder>,
    /// Statement about the held object, for Task to store in this tick.
    pub confirmed: Option<Support>,
}

/// An operator's order to the Active Pedestal, which Subtask sends unless an interlock forbids it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct HandOrder {
    /// The command.
    pub command: PedestalVerb,
    /// PRE-GRIP, GRIP: the object, whose PED-PARA record (VII.7.4) has opening, force and angle.
    pub object: Option<Name16>,
    /// FLIP: relative angle, 0.1 degree.
    pub table_angle: i32,
    /// RELEASE: the operator holds the part by hand.
    pub by_hand: bool,
}

/// Support of the object when the gripper opens, as confirmed by an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Support {
    /// The vise at which the robot stands clamps it.
    #[text = "clamped"]
    Clamped,
    /// The operator holds it, or has taken it out.
    #[text = "by hand"]
    ByHand,
}

/// Maximum number of values written in a tick.
pub const WRITES: usize = 4;

/// The variables that an operator may write (IV.2.6; SPECNOTES.md): facts that no sensor measures. A write does not
/// move robot, fingers or air, and is valid as long as no sensor contradicts it. The text is the variable's path in
/// common memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Variable {
    /// Task: the unfinished command. Without it the same command starts from the beginning.
    #[text = "task.ledger"]
    Ledger,
    /// Task: updates that the Data System has not accepted. If they are deleted, its database lacks these moves.
    #[text = "task.updates.pending"]
    Pending,
    /// Subtask: the part in the pedestal's hand.
    #[text = "subtask.regrip"]
    Regrip,
    /// E-move: the held object. Without it a sensed object has no name.
    #[text = "emove.estimates.held"]
    Held,
    /// E-move: the last released object and its place. Without it an interrupted command places the object again.
    #[text = "emove.estimates.placed"]
    Placed,
    /// E-move: the object located by vision. Without it a new picture is taken.
    #[text = "emove.estimates.located"]
    Located,
    /// Grip: scale and offset of the sensors. If they are deleted, the next motion to an opening calibrates first.
    #[text = "grip.calibration"]
    Calibration,
}

/// The values that a variable takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Form {
    /// NONE.
    #[text = "NONE"]
    Nothing,
    /// NONE, or an object.
    #[text = "NONE or OBJECT"]
    Object,
    /// NONE, or an object and its grip.
    #[text = "NONE or OBJECT GRIP"]
    ObjectGrip,
}

impl Variable {
    /// The process that owns it.
    #[must_use]
    pub const fn owner(self) -> ProcessId {
        match self {
            Self::Ledger | Self::Pending => ProcessId::Task,
            Self::Regrip => ProcessId::Subtask,
            Self::Held | Self::Placed | Self::Located => ProcessId::Emove,
            Self::Calibration => ProcessId::Grip,
        }
    }

    /// The permitted values.
    #[must_use]
    pub const fn form(self) -> Form {
        match self {
            Self::Regrip => Form::Object,
            Self::Held => Form::ObjectGrip,
            Self::Ledger | Self::Pending | Self::Placed | Self::Located | Self::Calibration => Form::Nothing,
        }
    }
}

/// A value that an operator writes into a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Write {
    /// The variable.
    pub variable: Variable,
    /// The object; `None` writes NONE.
    pub object: Option<Name16>,
    /// Grip number of the object, for values that contain one.
    pub grip: i32,
}

/// True if the variables of a process may be written in the tick after `before`, because it was not stepped.
#[must_use]
pub const fn may_be_written(process: ProcessId, before: &CommonMemory) -> bool {
    before.header(process).republished
}

/// The bit of a board; 0 for a number without a board.
#[must_use]
pub const fn board_bit(board: u8) -> u8 {
    match board {
        0 => 0x01,
        2 => 0x02,
        4 => 0x04,
        6 => 0x08,
        8 => 0x10,
        _ => 0,
    }
}

/// The bit of a process.
#[must_use]
pub fn process_bit(process: ProcessId) -> u16 {
    1_u16.checked_shl(u32::from(process.code())).unwrap_or(0)
}

impl OperatorInputs {
    /// True if the board is stopped or there is no pulse.
    #[must_use]
    pub const fn is_stopped(&self, board: u8) -> bool {
        self.stopped & (board_bit(board) | board_bit(0)) != 0
    }

    /// True if the process must be stepped in this tick despite a stop.
    #[must_use]
    pub fn executes(&self, process: ProcessId) -> bool {
        self.executed & process_bit(process) != 0
    }

    /// The values to write into the variables of a process in this tick.
    pub fn writes_to(&self, process: ProcessId) -> impl Iterator<Item = &Write> {
        self.writes.iter().flatten().filter(move |write| write.variable.owner() == process)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::plain::Schema;

    #[test]
    fn each_board_and_each_process_has_its_own_bit() {
        let boards = BOARDS.map(board_bit);
        assert_eq!(boards.iter().fold(0, |all, bit| all + u32::from(*bit)), 0x1F);
        assert!(ProcessId::ALL.iter().all(|process| BOARDS.contains(&process.board())));
        let all = ProcessId::ALL.iter().fold(0, |all, process| all + u32::from(process_bit(*process)));
        assert_eq!(all, (1 << ProcessId::ALL.len()) - 1);
    }

    #[test]
    fn a_variable_is_a_buffer_of_its_owner() {
        let memory = CommonMemory::STRUCT;
        for variable in Variable::ALL {
            let mut path = variable.text().split('.');
            assert_eq!(path.next(), Some(variable.owner().field()));
            let of_process = memory.fields.iter().find(|field| field.name == variable.owner().field());
            let Schema::Struct(outputs) = of_process.unwrap().schema else { panic!("{variable}") };
            let buffer = path.next().unwrap();
            assert!(outputs.fields.iter().any(|field| field.name == buffer), "{variable}");
        }
    }

    #[test]
    fn every_board_stops_without_the_pulse() {
        let stopped = |board| OperatorInputs { stopped: board_bit(board), ..OperatorInputs::default() };
        for board in BOARDS {
            assert!(stopped(board).is_stopped(board) && stopped(0).is_stopped(board));
            assert!(board == 4 || board == 0 || !stopped(4).is_stopped(board));
        }
    }
}
