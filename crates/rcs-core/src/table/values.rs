//! The values with which a table was consulted, for logs, screens and explanations.
//!
//! [`Variables::code`](super::Variables::code) packs the values into one number for the header. Here the number
//! becomes names again, and the text of the rows is evaluated a second time; a test of the levels compares text and
//! `match`.

use core::{fmt, slice};

use super::{Condition, Row, Table, Variable, conditions};
use crate::{Plain, plain::VariantSchema};

/// The step and the values with which a table was consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Values {
    /// Code of the step; 0 in a table without steps.
    pub step: u8,
    /// The values of the state variables: [`Variables::code`](super::Variables::code).
    pub variables: u64,
}

/// A row that would have fired with another value of one state variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearMiss {
    /// The variable.
    pub variable: &'static Variable,
    /// The other value.
    pub value: &'static VariantSchema,
    /// The row that this value would have fired.
    pub row: &'static Row,
}

/// A row that has fired, with actual values: `CLOSE-DOOR row 2: Start, door Stuck, lamp Dark => Close -> Closing`.
#[derive(Clone, Copy, Debug)]
pub struct Fired {
    /// Its table.
    pub table: &'static Table,
    /// The row.
    pub row: &'static Row,
    /// The values; `None` if another system consulted the table. The text then shows the row unchanged.
    pub values: Option<Values>,
}

impl Fired {
    /// The step in which it fired; empty if the row fires in any.
    #[must_use]
    pub fn steps(&self) -> &'static [&'static str] {
        let step = self.values.and_then(|values| self.table.step(values));
        narrowed(self.row.steps, step.map(|step| step.name))
    }

    /// The conditions of the row with the actual values.
    pub fn conditions(&self) -> impl Iterator<Item = Condition> {
        let Self { table, row, values } = *self;
        row.when.iter().map(move |condition| {
            let value = values.and_then(|values| table.value_of(condition.variable, values));
            Condition { values: narrowed(condition.values, value.map(|value| value.name)), ..*condition }
        })
    }

    /// The row without its table and number.
    pub fn text(&self) -> impl fmt::Display {
        fmt::from_fn(move |f| {
            conditions(f, self.steps(), self.conditions())?;
            write!(f, " => {}", self.row.effect())
        })
    }
}

impl fmt::Display for Fired {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} row {}: {}", self.table.name, self.row.number, self.text())
    }
}

/// The known name if it is among several; otherwise all.
fn narrowed(names: &'static [&'static str], known: Option<&str>) -> &'static [&'static str] {
    names.iter().find(|name| Some(**name) == known).map_or(names, slice::from_ref)
}

impl Variable {
    /// Number of combinations of the variables' values; `None` if it exceeds a `u64`.
    #[must_use]
    pub const fn combinations(mut variables: &[Self]) -> Option<u64> {
        let mut product = 1_u64;
        while let Some((variable, rest)) = variables.split_first() {
            match product.checked_mul(variable.base()) {
                Some(more) => product = more,
                None => return None,
            }
            variables = rest;
        }
        Some(product)
    }

    /// Number of values, at most 256.
    #[expect(clippy::as_conversions, reason = "a constant function cannot convert otherwise")]
    const fn base(&self) -> u64 {
        self.values.variants.len() as u64
    }
}

impl Table {
    /// The step in which the table was consulted; `None` for a table without steps.
    #[must_use]
    pub fn step(&self, values: Values) -> Option<&'static VariantSchema> {
        self.steps?.variants.iter().find(|step| step.code == values.step)
    }

    /// The variables with their values, in the order of the table; empty for numbers that this table does not have.
    pub fn values(
        &self,
        values: Values,
    ) -> impl Iterator<Item = (&'static Variable, &'static VariantSchema)> {
        let variables = if self.is_known(values) { self.variables } else { &[] };
        variables
            .iter()
            .enumerate()
            .filter_map(move |(at, variable)| Some((variable, self.value(at, values)?)))
    }

    /// The row that fires with these values; `None` for numbers that are not values of this table.
    #[must_use]
    pub fn consult(&self, values: Values) -> Option<&'static Row> {
        if !self.is_known(values) {
            return None;
        }
        let step = self.step(values).map(|step| step.name);
        let fits = |row: &&Row| {
            let in_step = row.steps.is_empty() || step.is_some_and(|step| row.steps.contains(&step));
            in_step && row.when.iter().all(|condition| self.holds(condition, values))
        };
        self.rows.iter().find(fits)
    }

    /// The row that each other value of a variable would have fired, if different. The step stays the same.
    pub fn near_misses(&self, values: Values) -> impl Iterator<Item = NearMiss> {
        let fired = self.consult(values);
        let others = self.values(values).enumerate().flat_map(move |(at, (variable, now))| {
            let others = variable.values.variants.iter().filter(move |value| value.code != now.code);
            others.filter_map(move |value| {
                let row = self.consult(self.with(at, value, values)?)?;
                Some(NearMiss { variable, value, row })
            })
        });
        others.filter(move |miss| fired.is_some_and(|fired| fired.number != miss.row.number))
    }

    fn is_known(&self, values: Values) -> bool {
        let step = self.steps.is_none_or(|steps| steps.variants.iter().any(|step| step.code == values.step));
        step && Variable::combinations(self.variables).is_some_and(|all| values.variables < all)
    }

    /// Combinations of the variables after it.
    fn weight(&self, at: usize) -> Option<u64> {
        Variable::combinations(self.variables.get(at.checked_add(1)?..)?)
    }

    fn value(&self, at: usize, values: Values) -> Option<&'static VariantSchema> {
        let variable = self.variables.get(at)?;
        let digit = values.variables.checked_div(self.weight(at)?)?.checked_rem(variable.base())?;
        variable.values.variants.iter().find(|value| u64::from(value.code) == digit)
    }

    /// The values with one variable changed.
    fn with(&self, at: usize, value: &VariantSchema, values: Values) -> Option<Values> {
        let weight = self.weight(at)?;
        let part = |value: &VariantSchema| u64::from(value.code).checked_mul(weight);
        let without = values.variables.checked_sub(part(self.value(at, values)?)?)?;
        Some(Values { variables: without.checked_add(part(value)?)?, ..values })
    }

    fn holds(&self, condition: &Condition, values: Values) -> bool {
        let value = self.value_of(condition.variable, values);
        value.is_some_and(|value| condition.values.contains(&value.name))
    }

    fn value_of(&self, name: &str, values: Values) -> Option<&'static VariantSchema> {
        self.value(self.variables.iter().position(|variable| variable.name == name)?, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Actions, Variables, decision_table, table::Variables as _};

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    pub enum Door {
        /// The doorway is free.
        Open,
        /// Both switches detect the door.
        Shut,
        /// It stands between its switches.
        #[text = "half way"]
        Stuck,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    pub enum Lamp {
        Dark,
        Lit,
    }

    #[derive(Clone, Copy, Debug, Variables)]
    pub struct Situation {
        /// The door.
        pub door: Door,
        /// Its lamp.
        pub lamp: Lamp,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
    pub enum Action {
        /// No new output.
        Wait,
        /// Drive the door.
        Close,
        /// Report done.
        Finish,
    }

    decision_table! {
        /// CLOSE-DOOR: for the test.
        CLOSE_DOOR: fn close_door(enum CloseDoorStep, Situation) -> Action or () {
            any {
                1: lamp: Lit                       => consult;
            }
            /// The command has not started.
            Start {
                2: door: Open | Stuck, lamp: Dark  => Close  -> Closing;
                3: door: Shut,         lamp: Dark  => Finish;
            }
            /// The door is being driven.
            Closing {
                4: door: Shut,  lamp: Dark         => Finish;
                5: door: Open,  lamp: Dark         => Wait;
                6: door: Stuck, lamp: Dark         => Close;
            }
        }
    }

    fn all() -> impl Iterator<Item = (CloseDoorStep, Situation)> {
        let situations = Door::ALL
            .iter()
            .flat_map(|door| Lamp::ALL.iter().map(|lamp| Situation { door: *door, lamp: *lamp }));
        situations.flat_map(|situation| CloseDoorStep::ALL.iter().map(move |step| (*step, situation)))
    }

    #[test]
    fn text_of_the_table_gives_the_row_that_fired() {
        for (step, situation) in all() {
            let values = Values { step: step.code(), variables: situation.code() };
            let row = CLOSE_DOOR.consult(values).unwrap().number;
            match close_door(step, &situation) {
                crate::table::Verdict::Decided(decision) => {
                    assert_eq!((decision.row, decision.values), (row, values))
                }
                crate::table::Verdict::Passed(()) => assert_eq!(row, 1),
            }
        }
    }

    #[test]
    fn values_have_their_names() {
        let situation = Situation { door: Door::Stuck, lamp: Lamp::Lit };
        let values = Values { step: CloseDoorStep::Closing.code(), variables: situation.code() };
        assert_eq!(CLOSE_DOOR.step(values).unwrap().name, "Closing");
        let told: Vec<_> = CLOSE_DOOR
            .values(values)
            .map(|(variable, value)| (variable.name, value.name, value.text, value.doc))
            .collect();
        let expected =
            [("door", "Stuck", "half way", "It stands between its switches."), ("lamp", "Lit", "lit", "")];
        assert_eq!(told, expected);
    }

    #[test]
    fn fired_row_names_its_values() {
        let situation = Situation { door: Door::Stuck, lamp: Lamp::Dark };
        let values = Values { step: CloseDoorStep::Start.code(), variables: situation.code() };
        let row = CLOSE_DOOR.consult(values).unwrap();
        let fired = |values| Fired { table: &CLOSE_DOOR, row, values }.to_string();
        assert_eq!(fired(Some(values)), "CLOSE-DOOR row 2: Start, door Stuck, lamp Dark => Close -> Closing");
        // Another system omits the values.
        assert_eq!(fired(None), "CLOSE-DOOR row 2: Start, door Open or Stuck, lamp Dark => Close -> Closing");
    }

    #[test]
    fn each_other_value_that_fires_another_row_is_a_near_miss() {
        let misses = |step: CloseDoorStep, door, lamp| {
            let values = Values { step: step.code(), variables: Situation { door, lamp }.code() };
            let misses = CLOSE_DOOR.near_misses(values);
            misses.map(|miss| (miss.variable.name, miss.value.name, miss.row.number)).collect::<Vec<_>>()
        };
        // Stuck fires row 2 like Open.
        assert_eq!(
            misses(CloseDoorStep::Start, Door::Open, Lamp::Dark),
            [("door", "Shut", 3), ("lamp", "Lit", 1)]
        );
        assert_eq!(
            misses(CloseDoorStep::Closing, Door::Open, Lamp::Dark),
            [("door", "Shut", 4), ("door", "Stuck", 6), ("lamp", "Lit", 1)]
        );
        assert_eq!(misses(CloseDoorStep::Start, Door::Shut, Lamp::Lit), [("lamp", "Dark", 3)]);
    }

    #[test]
    fn invalid_numbers_have_no_values() {
        for values in [Values { step: 2, variables: 0 }, Values { step: 0, variables: 6 }] {
            assert_eq!(CLOSE_DOOR.consult(values), None);
            assert_eq!(CLOSE_DOOR.values(values).count(), 0);
            assert_eq!(CLOSE_DOOR.near_misses(values).count(), 0);
        }
    }

    #[test]
    fn more_combinations_than_a_number_holds_are_refused() {
        assert_eq!(Variable::combinations(Situation::VARIABLES), Some(6));
        assert_eq!(Variable::combinations(&[]), Some(1));
        const LAMP: Variable = Variable { name: "lamp", doc: "", values: Lamp::ENUM };
        assert_eq!(Variable::combinations(&[const { LAMP }; 63]), Some(1 << 63));
        assert_eq!(Variable::combinations(&[const { LAMP }; 64]), None);
    }
}
