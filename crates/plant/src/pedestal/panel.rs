//! The panel of the rotary table's controller (IV.1 step 3): power, mode switch, RUN, STEP and RESET.
//!
//! ```text
//!   on, PROG, obeys its line ──mode MANUAL──► on, MANUAL: obeys RUN, STEP and RESET
//!            ▲                                     │ mode PROG
//!            └──power off, then on, at PROG─── on, PROG, obeys nothing
//! ```
//!
//! A controller that was at MANUAL, or was turned on there, ignores its serial line (CHOSEN).

use interfaces::station::TableKey;
use serde::{Deserialize, Serialize};

use super::Table;

const FAR: f64 = 1e6; // more steps than between the two limit switches

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableRefusal {
    #[error("the rotary table controller has no power: table power on comes first")]
    NoPower,
    #[error("the mode switch of the rotary table controller is at PROG: table mode manual comes first")]
    NotManual,
    #[error("the rotary table turns: ask again when it has stopped")]
    Turns,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct TablePanel {
    pub power: bool,
    pub manual: bool,
    /// The controller obeys the orders of its serial line.
    pub obeys: bool,
    run: u32,    // ticks for which RUN is held down, including one for its release
    missed: u32, // number of the last ignored order, which is not executed later
}

impl TablePanel {
    /// On, at PROG: IV.1 step 3 is done.
    pub(super) const READY: Self = Self { power: true, manual: false, obeys: true, run: 0, missed: 0 };
}

impl Table {
    #[must_use]
    pub const fn panel(&self) -> TablePanel {
        self.panel
    }

    /// True while the table executes the action of a key.
    #[must_use]
    pub fn is_led_by_hand(&self) -> bool {
        self.panel.manual && self.moving()
    }

    /// Press a key, or turn a switch. On error, the state is unchanged.
    pub fn press(&mut self, key: TableKey) -> Result<(), TableRefusal> {
        match key {
            TableKey::Power(on) => self.set_power(on),
            TableKey::Manual(on) => {
                if on != self.panel.manual {
                    self.panel = TablePanel { manual: on, obeys: false, run: 0, ..self.panel };
                    self.ramp_down();
                }
            }
            TableKey::Run { plus, ticks } => {
                self.stands_at_manual()?;
                self.panel.run = ticks.saturating_add(1);
                self.goal = libm::round(self.position) + if plus { FAR } else { -FAR };
            }
            TableKey::Step { plus, count } => {
                self.stands_at_manual()?;
                let way = f64::from(count);
                self.goal = libm::round(self.position) + if plus { way } else { -way };
            }
            TableKey::Reset => {
                self.stands_at_manual()?;
                self.offset = -libm::round(self.position);
            }
        }
        Ok(())
    }

    pub fn release_keys(&mut self) {
        if self.is_led_by_hand() {
            self.panel.run = 0;
            self.ramp_down();
        }
    }

    fn stands_at_manual(&self) -> Result<(), TableRefusal> {
        match self.panel {
            TablePanel { power: false, .. } => Err(TableRefusal::NoPower),
            TablePanel { manual: false, .. } => Err(TableRefusal::NotManual),
            _ if self.moving() => Err(TableRefusal::Turns),
            _ => Ok(()),
        }
    }

    /// Switch the power. Without power the motor stops at once.
    fn set_power(&mut self, on: bool) {
        if on && !self.panel.power {
            self.panel = TablePanel { power: true, obeys: !self.panel.manual, ..self.panel };
        } else if !on {
            self.panel = TablePanel { power: false, obeys: false, run: 0, ..self.panel };
            self.position = libm::round(self.position);
            (self.goal, self.speed) = (self.position, 0.0);
        }
    }

    /// Once per tick: release RUN after its time. Returns true if the order with this number must be obeyed.
    pub(super) fn attend(&mut self, number: u32) -> bool {
        if self.panel.run > 0 {
            self.panel.run -= 1;
            if self.panel.run == 0 {
                self.ramp_down();
            }
        }
        if !self.panel.obeys {
            self.panel.missed = number;
        }
        self.panel.obeys && number != self.panel.missed
    }
}

#[cfg(test)]
mod tests {
    use interfaces::device::{MotorCommand, MotorOrder};

    use super::*;
    use crate::description::CellDescription;

    fn table() -> Table {
        let cell = CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap();
        Table::new(&cell.pedestal.table)
    }

    /// Number of ticks until the table stops.
    fn wait(table: &mut Table, command: &MotorCommand) -> u32 {
        for tick in 0..10_000 {
            if !table.moving() {
                return tick;
            }
            table.order(command);
            (0..16).for_each(|_| table.advance(0.0025));
        }
        panic!("the table does not stop: {table:?}");
    }

    fn wait_ticks(table: &mut Table, ticks: u32) {
        for _ in 0..ticks {
            table.order(&NONE);
            (0..16).for_each(|_| table.advance(0.0025));
        }
    }

    const NONE: MotorCommand = MotorCommand { number: 0, order: MotorOrder::None, steps: 0 };

    #[test]
    fn table_is_started_up_by_hand() {
        let mut table = table();
        table.press(TableKey::Power(false)).unwrap();
        assert_eq!(table.press(TableKey::Reset), Err(TableRefusal::NoPower));
        table.press(TableKey::Power(true)).unwrap();
        assert_eq!(table.press(TableKey::Reset), Err(TableRefusal::NotManual));
        table.press(TableKey::Manual(true)).unwrap();
        table.press(TableKey::Run { plus: true, ticks: 10_000 }).unwrap();
        assert_eq!(table.press(TableKey::Reset), Err(TableRefusal::Turns));
        wait(&mut table, &NONE);
        assert!(table.at_plus());
        table.press(TableKey::Reset).unwrap();
        assert_eq!(table.counter(), 0);
        table.press(TableKey::Run { plus: false, ticks: 25 }).unwrap();
        assert!(wait(&mut table, &NONE) >= 25);
        let rest = table.counter() + 2000;
        table.press(TableKey::Step { plus: rest < 0, count: rest.unsigned_abs() }).unwrap();
        wait(&mut table, &NONE);
        assert_eq!(table.counter(), -2000, "the display reads -20.00");
    }

    #[test]
    fn released_keys_end_only_motions_by_hand() {
        let mut table = table();
        let far = MotorCommand { number: 1, order: MotorOrder::Turn, steps: 2000 };
        table.order(&far);
        table.release_keys();
        assert!(wait(&mut table, &far) > 25, "an order of the line continues");
        table.press(TableKey::Manual(true)).unwrap();
        for key in [TableKey::Run { plus: true, ticks: 1000 }, TableKey::Step { plus: false, count: 2000 }] {
            table.press(key).unwrap();
            wait_ticks(&mut table, 5);
            table.release_keys();
            assert!(wait(&mut table, &far) < 25, "{key:?}");
        }
    }

    #[test]
    fn table_controller_turned_on_at_prog_obeys_its_line() {
        let mut table = table();
        let turn = |number| MotorCommand { number, order: MotorOrder::Turn, steps: 100 };
        table.press(TableKey::Manual(true)).unwrap();
        table.order(&turn(1));
        table.press(TableKey::Manual(false)).unwrap();
        table.order(&turn(2));
        assert!(!table.moving() && table.echo == 0, "its power was not turned off");
        table.press(TableKey::Power(false)).unwrap();
        table.press(TableKey::Power(true)).unwrap();
        table.order(&turn(2));
        assert!(!table.moving() && table.echo == 0, "an order of the time before is not carried out");
        table.order(&turn(3));
        assert!(table.moving() && table.echo == 3);
        table.press(TableKey::Power(false)).unwrap();
        assert!(!table.moving(), "without power it stands");
        table.press(TableKey::Manual(true)).unwrap();
        table.press(TableKey::Power(true)).unwrap();
        assert!(!table.panel().obeys, "it was turned on at MANUAL");
    }
}
