//! The rows in the header of a process: which rows fired, when, and for which state variables.

use interfaces::{Basis, Consulted, Decided, Header};
use rcs_core::{Plain, header::MAX_OTHER_ROWS, name::Name16, table::Choice, tick::Tick};

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Rows {
    pub tick: Tick, // the last tick in which the process was stepped
    pub decided: Option<Decided>,
    pub basis: Option<Basis>, // the tick and the state variables of `decided`
    pub beside: [Option<Consulted>; MAX_OTHER_ROWS], // rows of other tables in that tick
}

impl Rows {
    /// Start a tick: rows of other tables belong to an earlier one.
    pub fn begin(&mut self, tick: Tick) {
        (self.tick, self.beside) = (tick, [None; MAX_OTHER_ROWS]);
    }

    /// Record a row that has decided about the command. An earlier one of the same tick moves to the other rows.
    pub fn decide<Action, Step>(&mut self, choice: &Choice<Action, Step>) {
        let &Choice { table, row, values, .. } = choice;
        if let (Some(decided), Some(basis)) = (self.decided, self.basis)
            && basis.tick == self.tick
        {
            self.add(Consulted { decided, values: basis.values });
        }
        self.decided = Some(Decided { table, row });
        self.basis = Some(Basis { tick: self.tick, values });
    }

    pub fn beside<Action, Step>(&mut self, choice: &Choice<Action, Step>) {
        let decided = Decided { table: choice.table, row: choice.row };
        self.add(Consulted { decided, values: choice.values });
    }

    #[must_use]
    pub fn row_of(&self, table: u8) -> Option<u8> {
        let mut rows = self.beside.iter().flatten().map(|consulted| consulted.decided);
        rows.find(|decided| decided.table == table).map(|decided| decided.row)
    }

    fn add(&mut self, consulted: Consulted) {
        if let Some(free) = self.beside.iter_mut().find(|place| place.is_none()) {
            *free = Some(consulted);
        }
    }

    /// The header of the outputs of this tick; `step` is the text of the command's step.
    #[must_use]
    pub fn header(&self, tick: Tick, step: &str) -> Header {
        Header {
            stamp: tick,
            republished: false,
            decided: self.decided,
            basis: self.basis,
            beside: self.beside,
            step: Some(Name16::clipped(step)).filter(|step| !step.is_empty()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::table::Values;

    const fn values(variables: u64) -> Values {
        Values { step: 1, variables }
    }

    const fn choice(table: u8, row: u8, variables: u64) -> Choice<(), ()> {
        Choice { table, row, action: (), next: (), values: values(variables) }
    }

    #[test]
    fn deciding_row_keeps_its_tick_and_other_rows_are_cleared() {
        let mut rows = Rows::default();
        rows.begin(Tick(4));
        rows.beside(&choice(7, 2, 9));
        rows.decide(&choice(3, 5, 1));
        let header = rows.header(Tick(4), "moving");
        assert_eq!(header.fired(), Some(Decided { table: 3, row: 5 }));
        assert_eq!(
            header.beside,
            [Some(Consulted { decided: Decided { table: 7, row: 2 }, values: values(9) }), None, None]
        );
        assert_eq!((rows.row_of(7), rows.row_of(3)), (Some(2), None));
        rows.begin(Tick(5));
        let header = rows.header(Tick(5), "");
        assert_eq!((header.age(), header.fired(), header.step), (Some(1), None, None));
        assert_eq!(header.beside, [None; MAX_OTHER_ROWS]);
    }

    #[test]
    fn last_row_of_a_tick_is_the_deciding_one() {
        let mut rows = Rows::default();
        rows.begin(Tick(4));
        rows.decide(&choice(3, 5, 1));
        rows.begin(Tick(6));
        rows.decide(&choice(4, 1, 2));
        assert_eq!(rows.beside, [None; MAX_OTHER_ROWS], "rows of an earlier tick are not reported");
        rows.decide(&choice(9, 8, 3));
        let header = rows.header(Tick(6), "");
        assert_eq!(
            header.consulted(),
            Some(Consulted { decided: Decided { table: 9, row: 8 }, values: values(3) })
        );
        assert_eq!(rows.row_of(4), Some(1));
    }

    #[test]
    fn header_has_room_for_the_tables_of_prim() {
        let mut rows = Rows::default();
        rows.begin(Tick(1));
        for table in 1..=4 {
            rows.beside(&choice(table, table, 0));
        }
        assert_eq!((rows.row_of(3), rows.row_of(4)), (Some(3), None));
    }
}
