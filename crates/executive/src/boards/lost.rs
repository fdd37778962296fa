//! Errors of starting the boards together, and the loss of a board during a run.

use std::{fmt, process::ExitStatus, time::Duration};

use interfaces::{CommonMemory, HwsCommand};
use rcs_core::{
    plain::DecodeError,
    tick::{TICK_MS, Tick},
};

use super::Board;
use crate::memory::SharedMemoryError;
use closed_loop::failure;

/// Time without a stamp after which a board is lost (docs/design/handshake.md "Lost board").
pub const LOST_AFTER: Duration = Duration::from_millis(25 * TICK_MS);

#[derive(Debug, thiserror::Error)]
pub enum SplitError {
    #[error("boards exchange their data in shared memory, which is not available: {0}")]
    SharedMemory(#[from] SharedMemoryError),
    #[error("{board} cannot be started: {source}")]
    Start {
        board: Board,
        source: std::io::Error, // the error of the operating system
    },
    #[error("{board} ended before the first tick ({status}); its reason is printed above")]
    Ended { board: Board, status: ExitStatus },
    #[error("{board} (process {pid}) cannot take part: {difference}")]
    Different { board: Board, pid: u32, difference: &'static str },
    #[error("{} did not start within {} s", list(.missing), .wait_limit.as_secs())]
    Missing {
        missing: Vec<Board>,
        wait_limit: Duration, // time for which board 0 waited for them
    },
    #[error("interrupted while waiting for {}", list(.0))]
    Interrupted(Vec<Board>),
}

/// `board 2, board 8`.
fn list(boards: &[Board]) -> String {
    boards.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossReason {
    Ended(ExitStatus),
    Left,
    Silent,
    Garbled(DecodeError),
    /// It stamped a tick without having written its outputs.
    Unwritten,
}

/// A board that was lost. Small and without heap, because it is made within a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Lost {
    pub board: Board,
    pub pid: u32,
    pub tick: Tick,
    pub how: LossReason,
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { board, pid, tick, how } = self;
        write!(f, "{board} ({}; process {pid}) ", board.process_names())?;
        match how {
            LossReason::Ended(status) => write!(f, "ended ({status})")?,
            LossReason::Left => f.write_str("left the run")?,
            LossReason::Silent => write!(f, "has not answered for {:.1} s", LOST_AFTER.as_secs_f64())?,
            LossReason::Garbled(error) => write!(f, "wrote an invalid record ({error})")?,
            LossReason::Unwritten => f.write_str("marked its outputs as written without writing them")?,
        }
        write!(f, " in tick {tick}")
    }
}

impl Lost {
    /// The loss in one sentence: what the board's processes were doing at the start of the tick, and the consequence.
    #[must_use]
    pub fn explain(&self, hws: &HwsCommand, memory: &CommonMemory) -> String {
        let doing = failure::unfinished_commands(self.board.processes(), hws, memory);
        let doing = if doing.is_empty() {
            "without a command in progress".to_owned()
        } else {
            format!("while {doing}")
        };
        format!(
            "{self}, {doing}; without it there is no pulse: the robot gets no further point, grippers keep what they hold"
        )
    }
}
