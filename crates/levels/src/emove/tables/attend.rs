//! Work that continues after a command has ended.

use rcs_core::decision_table;

decision_table! {
    /// ATTEND: E-PAUSE continues after it is done, until the next command. The joystick box may take the robot and
    /// give it back (V.1.1 PAUSE), and `.R` lets Prim initialize the link again (IV.3.3 steps 2 and 12). The
    /// table is consulted if EXECUTE does not decide. Headers do not name its rows.
    pub ATTEND: fn attend(super::Watch) -> super::Action or () {
        1: pause: Standing, outcome: Done | Joystick, initialization: None   => consult;
        2: pause: Standing, outcome: Idle | Executing | Error                => Wait;
        3: pause: Other | UnderWay                                           => Wait;
        4: pause: Standing, outcome: Done | Joystick, initialization: Asked  => RobotInit;
        5: pause: Standing, outcome: Done | Joystick, initialization: Over   => StopRobot;
    }
}
