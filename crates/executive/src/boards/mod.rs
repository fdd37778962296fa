//! `--boards split`: the control processes are distributed over operating system processes, one per board (IV.2.2).
//!
//! | board | runs                                                                                        |
//! |-------|---------------------------------------------------------------------------------------------|
//! | 0     | the pulse, diagnostics (the log, the watch for failures), and everything outside: the cell or the robot's port, the workstation controller, the Data System |
//! | 2     | E-move, Prim                                                                                |
//! | 4     | T3 Interface                                                                                |
//! | 6     | Task, Subtask                                                                               |
//! | 8     | Quick Change, the grippers; the Active Pedestal with its hand and table                     |
//!
//! In the original (III.2) the pedestal has its own rack, on the other side of the factory network.
//!
//! A tick of board 0 ([`coordinator`]) and of another board ([`member`]):
//!
//! ```text
//!   board 0                                     board n
//!   writes what came from outside and the
//!   number of the tick, gives the pulse -------> wakes, reads the number: k
//!   waits for all boards                         reads what the others wrote in tick k-1
//!                                                steps its processes
//!                                                writes into the half of k's parity
//!   the last stamp is there <------------------- stamps k
//!   gathers the halves of tick k: common memory
//! ```
//!
//! No board can be ahead of another by more than one tick, so two halves are enough ([`exchange`]). The pulse only
//! wakes; the number that a board reads determines its action, so a lost or repeated pulse has no effect.
//!
//! Board 0 publishes common memory for other programs ([`crate::memory`]) as on one board: an observer finds the same
//! services for every distribution of the processes, and cannot delay a board.

pub mod coordinator;
pub mod exchange;
pub mod lost;
pub mod member;
pub mod pulse;

use std::{fmt, str::FromStr};

use levels::ladder::ProcessId;

use crate::memory::{self, RunName};

pub use coordinator::Coordinator;
pub use lost::{Lost, SplitError};
pub use member::{BoardData, Member, MemberError};
pub use pulse::{Checked, Epochs, Fingerprint};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Board {
    Two,
    Four,
    Six,
    Eight,
}

/// The boards that a run waits for; true if the board has joined. `None` if the run does not exist or has begun.
#[must_use]
pub fn coming_up(name: &RunName) -> Option<Vec<(Board, bool)>> {
    let is_there = |role| memory::is_there(name, role);
    let waits = is_there(coordinator::BOARD_0) && !is_there(memory::PUBLISHER);
    waits.then(|| Board::ALL.iter().map(|board| (*board, is_there(board.name()))).collect())
}

/// Number of boards without board 0.
pub const BOARDS: usize = Board::ALL.len();

impl Board {
    pub const ALL: &'static [Self] = &[Self::Two, Self::Four, Self::Six, Self::Eight];

    /// Number of the board (IV.2.2).
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Two => 2,
            Self::Four => 4,
            Self::Six => 6,
            Self::Eight => 8,
        }
    }

    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Two => 0,
            Self::Four => 1,
            Self::Six => 2,
            Self::Eight => 3,
        }
    }

    pub fn processes(self) -> impl Iterator<Item = ProcessId> {
        ProcessId::ALL.iter().copied().filter(move |process| process.board() == self.number())
    }

    /// Its name among the nodes and services of a run.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Two => "board-2",
            Self::Four => "board-4",
            Self::Six => "board-6",
            Self::Eight => "board-8",
        }
    }

    pub(super) fn others(self) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |board| *board != self)
    }

    #[must_use]
    pub fn process_names(self) -> String {
        self.processes().map(ProcessId::text).collect::<Vec<_>>().join(", ")
    }
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "board {}", self.number())
    }
}

impl FromStr for Board {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.iter().copied().find(|board| board.number().to_string() == text);
        found.ok_or_else(|| {
            if text == "0" {
                "board 0 is rcs-run itself, with --boards split or manual".to_owned()
            } else {
                "a board with control processes was expected: 2, 4, 6 or 8".to_owned()
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_process_runs_on_one_board() {
        let mut all: Vec<ProcessId> = Board::ALL.iter().flat_map(|board| board.processes()).collect();
        all.sort_unstable();
        assert_eq!(all, ProcessId::ALL);
        for (index, board) in Board::ALL.iter().enumerate() {
            assert_eq!(board.index(), index);
            assert_eq!(board.number().to_string().parse(), Ok(*board));
            assert_eq!(board.name(), format!("board-{}", board.number()));
        }
        assert!("0".parse::<Board>().is_err_and(|text| text.contains("rcs-run itself")));
    }
}
