//! Inputs of a person at the terminals of the boards (IV.2.6, IV.3.2, IV.3.3) that come from no device: boards are
//! stopped and started, a level is executed once, the link is initialized.
//!
//! | at a terminal | here |
//! |---|---|
//! | `^C` on board 2, 4, 6 or 8; `GO` | the bit of the board in `stopped`; its processes are not stepped |
//! | `^C` on board 0; `SSGO` | bit 0 of `stopped`: there is no pulse, and no process is stepped |
//! | `PRIM-LEVEL` and the like on a board that is stopped | the bit of the process in `executed`, for a tick |
//! | `.R` on board 2 | `robot_init` changes: E-move gives Prim ROBOT-INIT (SPECNOTES.md, contradiction 13) |

use rcs_core::Plain;

use crate::ProcessId;

/// Numbers of the boards on which something runs (IV.2.2), in the order of their bits.
pub const BOARDS: [u8; 5] = [0, 2, 4, 6, 8];

/// Inputs of a person at the terminals of the boards.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct OperatorInputs {
    /// Stopped boards: one bit each, in the order of [`BOARDS`].
    pub stopped: u8,
    /// Processes that are stepped in this tick although their board is stopped or their switch holds them: a
    /// bit each, in the order of [`ProcessId::ALL`].
    pub executed: u16,
    /// Changes with each `.R`; 0 before the first.
    pub robot_init: u32,
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
    /// A board is stopped, or there is no pulse.
    #[must_use]
    pub const fn is_stopped(&self, board: u8) -> bool {
        self.stopped & (board_bit(board) | board_bit(0)) != 0
    }

    /// A process is to be stepped in this tick whatever stops it.
    #[must_use]
    pub fn executes(&self, process: ProcessId) -> bool {
        self.executed & process_bit(process) != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_board_and_each_process_has_a_bit_of_its_own() {
        let boards = BOARDS.map(board_bit);
        assert_eq!(boards.iter().fold(0, |all, bit| all + u32::from(*bit)), 0x1F);
        assert!(ProcessId::ALL.iter().all(|process| BOARDS.contains(&process.board())));
        let all = ProcessId::ALL.iter().fold(0, |all, process| all + u32::from(process_bit(*process)));
        assert_eq!(all, (1 << ProcessId::ALL.len()) - 1);
    }

    #[test]
    fn without_the_pulse_every_board_stands() {
        let stopped = |board| OperatorInputs { stopped: board_bit(board), ..OperatorInputs::default() };
        for board in BOARDS {
            assert!(stopped(board).is_stopped(board) && stopped(0).is_stopped(board));
            assert!(board == 4 || board == 0 || !stopped(4).is_stopped(board));
        }
    }
}
