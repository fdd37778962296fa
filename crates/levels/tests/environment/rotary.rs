use interfaces::device::{MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH};
use levels::pedestal::table::{LIMIT_MINUS, preprocess::AT_LIMIT};

#[derive(Clone, Debug)]
pub struct Rotary {
    pub position: i32, // steps; 0 where the calibrated counter is 0
    pub goal: i32,
    pub offset: i32, // counter at position 0
    pub echo: u32,
    pub speed: i32,                  // steps per tick
    pub delay: u8,                   // ticks that an order takes on the line
    pub waiting: (MotorCommand, u8), // the last order, and ticks until it arrives
    pub slip: i32,                   // steps lost per tick of a turn
    pub blocked: bool,
    pub off: bool,
    pub runs_on: bool, // no order stops the motor
    pub wrong: f64,    // error of the potentiometer, counts
}

impl Rotary {
    /// `angle` is in 0.1 degree.
    pub fn new(angle: i32) -> Self {
        let position = angle * TABLE_STEPS_PER_TENTH;
        Self {
            position,
            goal: position,
            offset: -position,
            echo: 57,
            speed: 120,
            delay: 0,
            waiting: (MotorCommand::default(), 0),
            slip: 0,
            blocked: false,
            off: false,
            runs_on: false,
            wrong: 0.0,
        }
    }

    pub fn advance(&mut self, command: &MotorCommand) {
        if command.number != self.waiting.0.number {
            self.waiting = (*command, self.delay);
        } else {
            self.waiting.1 = self.waiting.1.saturating_sub(1);
        }
        let (order, wait) = self.waiting;
        if wait == 0 && order.number != 0 && order.number != self.echo && !self.off {
            self.echo = order.number;
            match order.order {
                MotorOrder::None => {}
                MotorOrder::Turn => self.goal = self.position + order.steps,
                MotorOrder::SetCounter => self.offset = order.steps - self.position,
                MotorOrder::Stop => self.goal = self.position,
            }
        }
        if self.blocked {
            return;
        }
        let way = (self.goal - self.position).clamp(-self.speed, self.speed);
        self.position += way;
        if way != 0 {
            self.position -= self.slip;
            self.offset += self.slip;
            self.goal -= self.slip;
        }
        // A switch stops the motor a few steps late; the motor can run away from it.
        if way > 0 && self.at_plus() {
            self.position = AT_LIMIT * TABLE_STEPS_PER_TENTH + 2;
            self.goal = self.position;
        }
        if way < 0 && self.at_minus() {
            self.goal = self.position;
        }
    }

    fn at_plus(&self) -> bool {
        self.position >= AT_LIMIT * TABLE_STEPS_PER_TENTH
    }

    fn at_minus(&self) -> bool {
        self.position <= (LIMIT_MINUS - 50) * TABLE_STEPS_PER_TENTH
    }

    pub fn angle(&self) -> f64 {
        f64::from(self.position) / f64::from(10 * TABLE_STEPS_PER_TENTH)
    }

    /// Does not write the words of the hand.
    pub fn sense(&self, sensors: &mut PedestalSensors) {
        let counts = 3950.0 + self.angle() * 10.0 * 180.0 / 183.5 + self.wrong;
        sensors.table_potentiometer = counts.round().clamp(0.0, 4095.0) as u16;
        (sensors.limit_plus, sensors.limit_minus) = (self.at_plus(), self.at_minus());
        (sensors.motor_echo, sensors.motor_moving) = (self.echo, self.runs_on || self.goal != self.position);
        sensors.motor_counter = self.position + self.offset;
    }
}
