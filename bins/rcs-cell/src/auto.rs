//! The automatic operator of `--auto`: presses the keys of IV.3.3 up to the DEPC function, so that a link can be tested
//! without a person. Then it answers the warnings that a host can cause (WD1, WD3, WD4), and restarts the program after
//! a cancel. It stops for good when a person presses a key.

use depc::controller::{ControllerState, Warning};
use plant::{
    Key,
    t3::{Stage, T3Controller},
};

#[derive(Debug)]
pub struct Operator {
    on_duty: bool,
}

impl Operator {
    /// An active operator, or one that does nothing.
    #[must_use]
    pub const fn new(on_duty: bool) -> Self {
        Self { on_duty }
    }

    /// Stops the operator because a person has pressed a key. Returns true if it was active.
    pub fn step_back(&mut self) -> bool {
        std::mem::replace(&mut self.on_duty, false)
    }

    /// The next key to press, if any. `cts` is true if a host has the line open.
    #[must_use]
    pub fn next(&self, t3: &T3Controller, cts: bool) -> Option<Key> {
        if !self.on_duty {
            return None;
        }
        match t3.stage() {
            Stage::Dark => Some(Key::ControlPower(true)),
            Stage::Faulted => Some(Key::FaultReset),
            Stage::Ready => Some(Key::Hydraulics(true)),
            Stage::Enabled => Some(Key::Manual(true)),
            Stage::Manual if !t3.at_rest() => None,
            Stage::Manual if t3.aligned() == [true; 6] => Some(Key::Auto),
            Stage::Manual => Some(Key::Align(None)),
            Stage::Auto => Some(Key::CycleStart),
            Stage::Depc if t3.depc().state() == ControllerState::Warning => match t3.depc().warning() {
                Warning::CtsLow if cts => Some(Key::Enter),
                Warning::Translation | Warning::Orientation => Some(Key::Enter),
                _ => None,
            },
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use depc::Limits;
    use plant::{EStop, description::Actuators, t3::StepInputs};

    fn t3() -> T3Controller {
        T3Controller::dark(Limits::NBS, &Actuators::default(), 5)
    }

    fn run(t3: &mut T3Controller, operator: &Operator, seconds: f64, host: bool) -> Vec<Key> {
        let mut keys = Vec::new();
        for _ in 0..(seconds / 0.04) as u32 {
            if let Some(key) = operator.next(t3, host) {
                t3.press(key).unwrap();
                keys.push(key);
            }
            t3.advance(0.04, &[t3.arm().tool_weight()]);
            t3.step(&StepInputs { cts: host, ..StepInputs::default() });
        }
        keys
    }

    #[test]
    fn automatic_operator_starts_up_once_and_answers_warnings() {
        let (mut t3, operator) = (t3(), Operator::new(true));
        let keys = run(&mut t3, &operator, 30.0, false);
        let order = [
            Key::ControlPower(true),
            Key::FaultReset,
            Key::Hydraulics(true),
            Key::Manual(true),
            Key::Align(None),
            Key::Auto,
            Key::CycleStart,
        ];
        assert_eq!(keys, order);
        assert_eq!(t3.depc().warning(), Warning::CtsLow);
        assert_eq!(run(&mut t3, &operator, 1.0, true), [Key::Enter]);
        assert_eq!(t3.depc().state(), ControllerState::Running);
        run(&mut t3, &operator, 1.0, false);
        assert_eq!(t3.depc().warning(), Warning::CtsLow);
        assert_eq!(run(&mut t3, &operator, 1.0, true), [Key::Enter]);
    }

    #[test]
    fn automatic_operator_keeps_a_persons_settings() {
        let (mut t3, mut operator) = (t3(), Operator::new(true));
        run(&mut t3, &operator, 30.0, true);
        assert!(operator.step_back() && !operator.step_back());
        t3.press(Key::Press(EStop::Pedestal)).unwrap();
        assert_eq!(run(&mut t3, &operator, 5.0, true), []);
    }
}
