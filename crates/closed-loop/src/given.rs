//! External inputs of a run.

use interfaces::{
    DataBaseStatus, OperatorInputs, OutsidePedestal,
    device::{JoystickBox, KNOB_FULL, LinkBytes, Resolvers},
};

/// External inputs before a tick. The default is a run without operators, external robot and external neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Given {
    /// Inputs from an external robot; `None` for the simulated one.
    pub robot: Option<RobotInputs>,
    /// Answer timeout of the host, ticks; `None` for the manual's.
    pub silence_limit: Option<u16>,
    /// Expected lag of the robot behind the sent positions, ms; `None` for that of the T3.
    pub lag: Option<u16>,
    pub joystick: JoystickBox, // combined with that of the cell
    pub terminals: OperatorInputs,
    /// Status of an external Data System; ignored if the loop has its own.
    pub data_base: DataBaseStatus,
    pub pedestal: OutsidePedestal,
}

impl Default for Given {
    fn default() -> Self {
        Self {
            robot: None,
            silence_limit: None,
            lag: None,
            joystick: JoystickBox { velocity: KNOB_FULL, ..JoystickBox::default() },
            terminals: OperatorInputs::default(),
            data_base: DataBaseStatus::default(),
            pedestal: OutsidePedestal::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct RobotInputs {
    pub rx: LinkBytes,
    pub ready: bool,
    /// True if bytes of an earlier tick are still unsent.
    pub unsent: bool,
    /// Resolver readings of a robot that reports its position; otherwise those of the cell, which follows the robot.
    pub resolvers: Option<Resolvers>,
}

/// The lower velocity applies, a moved stick and an enabled frame of `own` take precedence, switches and buttons are
/// combined by OR.
pub(crate) fn combined(own: &JoystickBox, other: JoystickBox) -> JoystickBox {
    let stick = if (own.x, own.y) == (0, 0) { (other.x, other.y) } else { (own.x, own.y) };
    JoystickBox {
        velocity: own.velocity.min(other.velocity),
        x: stick.0,
        y: stick.1,
        up: own.up || other.up,
        down: own.down || other.down,
        roll_plus: own.roll_plus || other.roll_plus,
        roll_minus: own.roll_minus || other.roll_minus,
        open: own.open || other.open,
        close: own.close || other.close,
        frame: if own.frame == 0 { other.frame } else { own.frame },
        record: own.record || other.record,
        resume: own.resume || other.resume,
        hold: own.hold | other.hold,
        single_step: own.single_step | other.single_step,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::device::joystick_frame;

    #[test]
    fn combined_boxes_use_lower_knob_moved_stick_and_all_switches() {
        let job =
            JoystickBox { velocity: 700, hold: 1, frame: joystick_frame::WORLD, x: 5, ..Default::default() };
        assert_eq!(combined(&Given::default().joystick, job), job, "nobody has done anything");
        let own = JoystickBox { velocity: 800, hold: 2, y: -30, ..Default::default() };
        let both = JoystickBox { hold: 3, x: 0, y: -30, ..job };
        assert_eq!(combined(&own, job), both);
        let slow = JoystickBox { velocity: 100, ..Default::default() };
        assert_eq!(combined(&slow, job), JoystickBox { velocity: 100, ..job });
    }
}
