//! The motions that end with a session, as text for answer and log.

use std::fmt;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ended {
    pub joystick: bool, // stick, buttons, single steps or frame
    pub passes: bool,
    pub turns_table: bool, // by the keys of its panel
    pub knob: bool,        // it has gone to 0
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            (self.joystick, "stick and buttons are released, and the frame is off"),
            (self.passes, "the passes that were left are dropped"),
            (self.turns_table, "the keys of the rotary table are released"),
            (self.knob, "the velocity knob is at 0 until `go`"),
        ];
        let said: Vec<&str> = parts.into_iter().filter(|(is_so, _)| *is_so).map(|(_, text)| text).collect();
        f.write_str(&said.join("; "))
    }
}
