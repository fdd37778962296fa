//! The header of output buffers.

use crate::{Plain, name::Name16, table::Values, tick::Tick};

/// A process consults at most this many tables in addition to the one that decides, as Prim does.
pub const MAX_OTHER_ROWS: usize = 3;

/// The first part of every set of output buffers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Header {
    /// Tick that wrote the buffers. If it is not the last tick, the process is lost.
    pub stamp: Tick,
    /// The process was not stepped in that tick (dormant or held), and its last outputs were republished.
    pub republished: bool,
    /// The row that decided last.
    pub decided: Option<Decided>,
    /// Tick of that decision and the values of its table. None for a row of another system, whose mailbox omits them.
    pub basis: Option<Basis>,
    /// Rows of other tables that fired at the last step of the process. It was in the tick of the stamp, unless the
    /// outputs are republished.
    pub beside: [Option<Consulted>; MAX_OTHER_ROWS],
    /// Step of the current command after the decision: its reference action (V.1.1).
    pub step: Option<Name16>,
}

/// A row of a decision table, by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Plain)]
pub struct Decided {
    /// The table, from 1 in the order of the process's tables.
    pub table: u8,
    /// The row, from 1.
    pub row: u8,
}

/// Tick of a decision and the values of its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Basis {
    /// The tick.
    pub tick: Tick,
    /// The step and the state variables.
    pub values: Values,
}

/// A row that fired and the values of its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Consulted {
    /// The row.
    pub decided: Decided,
    /// The step and the state variables.
    pub values: Values,
}

impl Header {
    /// Ticks between the last decision and the stamp. None without a decision, or if another system omits the tick.
    #[must_use]
    pub fn age(&self) -> Option<u64> {
        self.basis.map(|basis| self.stamp.since(basis.tick))
    }

    /// The row that decided in the tick of the stamp.
    #[must_use]
    pub fn fired(&self) -> Option<Decided> {
        self.decided.filter(|_| self.age() == Some(0))
    }

    /// The row that decided last and the values of its table.
    #[must_use]
    pub fn consulted(&self) -> Option<Consulted> {
        Some(Consulted { decided: self.decided?, values: self.basis?.values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_ages_while_the_stamp_advances() {
        let values = Values { step: 2, variables: 5 };
        let decided = Decided { table: 3, row: 4 };
        let header = Header {
            stamp: Tick(12),
            decided: Some(decided),
            basis: Some(Basis { tick: Tick(12), values }),
            ..Header::default()
        };
        assert_eq!((header.age(), header.fired()), (Some(0), Some(decided)));
        let later = Header { stamp: Tick(87), ..header };
        assert_eq!((later.age(), later.fired()), (Some(75), None));
        assert_eq!(later.consulted(), Some(Consulted { decided, values }));
        let elsewhere = Header { basis: None, ..header };
        assert_eq!((elsewhere.age(), elsewhere.fired(), elsewhere.consulted()), (None, None, None));
    }
}
