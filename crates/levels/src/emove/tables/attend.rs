//! What goes on after a command has ended.

use rcs_core::decision_table;

decision_table! {
    /// ATTEND: of what EXECUTE leaves alone, E-PAUSE goes on after it is done, as long as it is the command:
    /// the joystick box may take the robot and give it back (V.1.1 PAUSE). No header names its rows.
    pub ATTEND: fn attend(super::Watch) -> super::Action or () {
        1: pause: Standing, outcome: Done | Joystick          => consult;
        2: pause: Standing, outcome: Idle | Executing | Error => Wait;
        3: pause: Other | UnderWay                            => Wait;
    }
}
