//! The header of output buffers.

use crate::{Plain, name::Name16, table::Values, tick::Tick};

/// Most tables that a process consults beside the one that decides about its command: those of Prim.
pub const BESIDE: usize = 3;

/// What every set of output buffers starts with.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Header {
    /// Tick that wrote the buffers. A stamp other than the last tick means that the process is lost.
    pub stamp: Tick,
    /// The process was not stepped in that tick (dormant or held); its last outputs were republished for it.
    pub republished: bool,
    /// The row that decided last, if any has.
    pub decided: Option<Decided>,
    /// When that row fired, and the values with which its table was consulted. None for a row of another system, whose
    /// mailbox does not say it.
    pub basis: Option<Basis>,
    /// Rows of other tables that fired when the process was stepped last: in the tick of the stamp, unless the
    /// outputs are republished.
    pub beside: [Option<Consulted>; BESIDE],
    /// Step of the current command after that row: its reference action (V.1.1).
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

/// When a row fired, and the values with which its table was consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Basis {
    /// The tick.
    pub tick: Tick,
    /// The step and the state variables.
    pub values: Values,
}

/// A row that fired, and the values with which its table was consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Consulted {
    /// The row.
    pub decided: Decided,
    /// The step and the state variables.
    pub values: Values,
}

impl Header {
    /// Ticks between the row that decided last and the stamp: 0 if it fired in the tick of the stamp. None if
    /// no row has decided yet, or if another system does not say when.
    #[must_use]
    pub fn age(&self) -> Option<u64> {
        self.basis.map(|basis| self.stamp.since(basis.tick))
    }

    /// The row that decided, if it fired in the tick of the stamp.
    #[must_use]
    pub fn fired(&self) -> Option<Decided> {
        self.decided.filter(|_| self.age() == Some(0))
    }

    /// The row that decided last, with what its table was consulted with.
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
