use geometry::units::rounded;
use interfaces::{
    TableOutputs,
    device::{MotorCommand, PedestalSensors, TABLE_STEPS_PER_TENTH},
    pedestal::{TableCommand, TableVerb},
    process::Inputs,
};
use rcs_core::{
    handshake::{Arrival, Commander},
    tick::Tick,
};

use super::{
    state::State,
    tables::{
        Clock, Counter, Motor, Request, Situation, StateVariables, TableActivity, TableAngle, TablePhase,
        Turned,
    },
};

/// Angle at the + limit, 0.1 degree (IV.1 step 3: the counter is set to zero there).
pub const AT_LIMIT: i32 = 0;
/// Greatest angle that can be commanded, 0.1 degree: the parking angle, clear of the switch (IV.1 step 3: -20.00).
pub const LIMIT_PLUS: i32 = -200;
/// Least angle that can be commanded, 0.1 degree: slightly before the - limit. ASSUMED.
pub const LIMIT_MINUS: i32 = -3400;

const ON_GOAL: i32 = 5; // steps: the switch stops the motor a few steps late
/// Counts of the potentiometer per tenth of a degree on the counter. A counted turn of 183.5 degrees turns the
/// table by 180 (VII.7.4); 10 counts per degree of the table are ASSUMED.
const COUNTS_PER_TENTH: f64 = 180.0 / 183.5;
const AGREEMENT: f64 = 12.0; // counts, 1.2 degrees: several times the noise

const STANDING_TICKS: u8 = 3; // a ramp begins and ends slowly
const SILENCE_TICKS: u8 = 25; // 1 s for the controller to take an order
pub(super) const LIMIT_TICKS: u64 = 1500; // 60 s: four times a whole turn

impl State {
    /// A process that starts in the middle of a job adopts the calibration in its outputs.
    pub(super) fn sense<Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &TableOutputs,
    ) -> StateVariables {
        let command = &inputs.memory.pedestal.table;
        let sensors = &inputs.external.devices.pedestal;
        let starting = !self.execution.receiver.started;
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        if arrival == Arrival::New {
            self.command = *command;
        }
        if starting && self.execution.receiver.adopted {
            self.phase = TablePhase::Adopting;
            (self.at_limit, self.since) = (outputs.at_limit.or(self.at_limit), inputs.tick);
            self.adopt(&outputs.motor, inputs.tick);
        }
        let (motor, counter) = if inputs.external.devices.field.table.is_old() {
            // The table's controller finishes a turn by itself.
            self.standing = 0;
            (Motor::Settling, self.counter(sensors))
        } else {
            (self.motor(sensors), self.counter(sensors))
        };
        let known = motor != Motor::Standing || counter == Counter::Agrees;
        let late = arrival != Arrival::New && inputs.tick.since(self.since) > LIMIT_TICKS;
        StateVariables {
            arrival,
            request: Request { asked, verb: command.command, angle: angle(command) },
            situation: Situation {
                command: TableActivity::Nothing,
                motor,
                counter,
                place: if self.is_there(sensors) { Turned::There } else { Turned::Elsewhere },
                clock: if late { Clock::Expired } else { Clock::Running },
            },
            angle: known
                .then(|| rounded(f64::from(sensors.motor_counter) / f64::from(TABLE_STEPS_PER_TENTH))),
        }
    }

    /// Adopt the last order, so that its number is not used again.
    fn adopt(&mut self, order: &MotorCommand, tick: Tick) {
        if order.number != 0 {
            self.order = *order;
            self.motor = Commander { number: order.number, sent: tick, started: true };
        }
    }

    fn motor(&mut self, sensors: &PedestalSensors) -> Motor {
        self.motor.start(sensors.motor_echo);
        let taken = self.motor.number == sensors.motor_echo;
        self.unanswered = if taken { 0 } else { self.unanswered.saturating_add(1) };
        let still = taken && !sensors.motor_moving;
        self.standing = if still { self.standing.saturating_add(1) } else { 0 };
        if !taken {
            if self.unanswered > SILENCE_TICKS { Motor::Silent } else { Motor::Pending }
        } else if sensors.motor_moving {
            Motor::Turning
        } else if self.standing < STANDING_TICKS {
            Motor::Settling
        } else {
            Motor::Standing
        }
    }

    fn is_there(&self, sensors: &PedestalSensors) -> bool {
        let on = |angle: i32| sensors.motor_counter.abs_diff(steps(angle)) <= ON_GOAL.unsigned_abs();
        match self.phase {
            TablePhase::Seeking => sensors.limit_plus && !sensors.limit_minus,
            TablePhase::Setting => on(AT_LIMIT),
            TablePhase::Parking => on(LIMIT_PLUS) && self.reads(LIMIT_PLUS, sensors),
            TablePhase::Missing
            | TablePhase::Deferred
            | TablePhase::Adopting
            | TablePhase::Valid
            | TablePhase::Failed => on(self.command.angle) && self.reads(self.command.angle, sensors),
        }
    }

    fn counter(&self, sensors: &PedestalSensors) -> Counter {
        let agrees = self.reads(sensors.motor_counter / TABLE_STEPS_PER_TENTH, sensors);
        if agrees { Counter::Agrees } else { Counter::Disagrees }
    }

    /// True if the potentiometer reads an angle, 0.1 degree. It is false before the reading at the + limit.
    fn reads(&self, angle: i32, sensors: &PedestalSensors) -> bool {
        self.at_limit.is_some_and(|at_limit| {
            let turned = f64::from(angle.saturating_sub(AT_LIMIT)) * COUNTS_PER_TENTH;
            let read = f64::from(sensors.table_potentiometer) - f64::from(at_limit);
            (read - turned).abs() <= AGREEMENT
        })
    }
}

fn angle(command: &TableCommand) -> TableAngle {
    match command.command {
        TableVerb::Turn if !is_within_limits(command.angle) => TableAngle::Beyond,
        TableVerb::Turn | TableVerb::Pause | TableVerb::Calibrate | TableVerb::None => TableAngle::Within,
    }
}

/// True if the table can turn to an angle, 0.1 degree.
pub(in crate::pedestal) fn is_within_limits(angle: i32) -> bool {
    (LIMIT_MINUS..=LIMIT_PLUS).contains(&angle)
}

/// Steps of the counter at an angle, 0.1 degree.
pub(super) const fn steps(angle: i32) -> i32 {
    angle.saturating_mul(TABLE_STEPS_PER_TENTH)
}
