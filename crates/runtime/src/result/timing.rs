use executive::{boards::coordinator::BoardFigures, histogram};
use serde::Serialize;

/// Times of the controller, without the cell, in microseconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TickTimes {
    pub p50: f64,
    pub p99: f64, // 99th percentile
    pub max: f64,
}

impl From<histogram::Summary> for TickTimes {
    fn from(summary: histogram::Summary) -> Self {
        Self { p50: summary.p50, p99: summary.p99, max: summary.max }
    }
}

/// Result of a board with control processes.
#[derive(Clone, Debug, Serialize)]
pub struct BoardResult {
    pub board: u8,
    pub processes: String,
    pub pid: u32,
    /// Time from its wake-up to its stamp.
    pub tick_us: TickTimes,
    /// Heap allocations in its ticks.
    pub allocations: u64,
}

impl From<BoardFigures<'_>> for BoardResult {
    fn from(figures: BoardFigures<'_>) -> Self {
        Self {
            board: figures.board.number(),
            processes: figures.board.process_names(),
            pid: figures.pid,
            tick_us: figures.times.summary().into(),
            allocations: figures.allocations,
        }
    }
}
