//! Preprocess: read the command and the sensors, and set the state variables that the tables look at.

use rcs_core::{
    interface::{
        Reason,
        device::{PedestalSensors, TABLE_STEPS_PER_TENTH},
        pedestal::{TableCommand, TableVerb},
    },
    tick::Tick,
};

use super::{
    state::{Phase, State},
    tables::{Clock, Motor, Place},
};
use crate::old_execution::Course;

/// Angle at the + limit, 0.1 degree (IV.1 step 3: the counter is set to -20.00 there).
pub const LIMIT_PLUS: i32 = -200;
/// Least angle that can be commanded, 0.1 degree: a little short of the - limit. ASSUMED.
pub const LIMIT_MINUS: i32 = -3400;

/// So far from the goal the counter is still there, steps: the switch stops the motor a few steps late.
const ON_GOAL: i32 = 5;
/// Counts of the potentiometer for a tenth of a degree on the counter. A counted turn of 183.5 degrees turns the table by 180
/// (VII.7.4); 10 counts a degree of the table are ASSUMED.
const COUNTS_PER_TENTH: f64 = 180.0 / 183.5;
/// So far counter and potentiometer may be apart, counts: 1.2 degrees, and some times the noise.
const AGREEMENT: f64 = 12.0;

/// Ticks without motion after which the motor stands: a ramp begins and ends slowly.
const STANDING_TICKS: u8 = 3;
/// Ticks in which the controller must take an order (1 s).
const SILENCE_TICKS: u8 = 25;
/// Ticks that a turn, a stop or a calibration may take (60 s): a whole turn takes a quarter of it.
pub(super) const LIMIT_TICKS: u64 = 1500;

/// State variables of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// What the upper table says.
    pub course: Course,
    /// CALIBRATE has the duty, commanded or not.
    pub calibrate: bool,
    /// What the motor does.
    pub motor: Motor,
    /// Is the table where it should be?
    pub place: Place,
    /// Time of what has the duty.
    pub clock: Clock,
}

impl Seen {
    /// Read the inputs of a tick.
    pub fn preprocess(
        state: &mut State,
        command: &TableCommand,
        sensors: &PedestalSensors,
        tick: Tick,
    ) -> Self {
        let starting = !state.execution.receiver.started;
        let course = state.execution.consult(command.number, || fault(command));
        if course == Course::Begin {
            (state.command, state.since) = (*command, tick);
        }
        if starting && state.execution.receiver.adopted {
            state.phase = Phase::Deferred;
        }
        let motor = motor(state, sensors);
        let calibrate = calibration_due(state, course);
        if calibrate && !state.calibrating() {
            state.since = tick;
        }
        let late = tick.since(state.since) > LIMIT_TICKS;
        Self {
            course,
            calibrate,
            motor,
            place: if is_there(state, sensors) { Place::There } else { Place::Elsewhere },
            clock: if late { Clock::Expired } else { Clock::Running },
        }
    }
}

/// Why a command cannot be executed, if so.
fn fault(command: &TableCommand) -> Option<Reason> {
    match command.command {
        TableVerb::None => Some(Reason::UnknownCommand),
        TableVerb::Pause | TableVerb::Calibrate => None,
        TableVerb::Turn => (!within_limits(command.angle)).then_some(Reason::TableLimit),
    }
}

/// Can the table turn to an angle, 0.1 degree?
pub(in crate::pedestal) fn within_limits(angle: i32) -> bool {
    (LIMIT_MINUS..=LIMIT_PLUS).contains(&angle)
}

/// Steps of the counter at an angle, 0.1 degree.
pub(super) const fn steps(angle: i32) -> i32 {
    angle.saturating_mul(TABLE_STEPS_PER_TENTH)
}

fn motor(state: &mut State, sensors: &PedestalSensors) -> Motor {
    state.motor.start(sensors.motor_echo);
    let taken = state.motor.number == sensors.motor_echo;
    state.unanswered = if taken { 0 } else { state.unanswered.saturating_add(1) };
    let still = taken && !sensors.motor_moving;
    state.standing = if still { state.standing.saturating_add(1) } else { 0 };
    if !taken {
        if state.unanswered > SILENCE_TICKS { Motor::Silent } else { Motor::Pending }
    } else if state.standing < STANDING_TICKS {
        Motor::Turning
    } else {
        Motor::Standing
    }
}

/// Has CALIBRATE the duty: is it running, commanded, needed by the command, or due because the table was booted?
fn calibration_due(state: &State, course: Course) -> bool {
    state.calibrating()
        || match course {
            Course::Begin | Course::Continue => match state.command.command {
                TableVerb::Calibrate => true,
                TableVerb::Turn => state.phase != Phase::Valid,
                TableVerb::Pause | TableVerb::None => false,
            },
            Course::Rest => state.phase == Phase::Missing,
            Course::Refuse => false,
        }
}

fn is_there(state: &State, sensors: &PedestalSensors) -> bool {
    let on = |angle: i32| sensors.motor_counter.abs_diff(steps(angle)) <= ON_GOAL.unsigned_abs();
    match state.phase {
        Phase::Seeking => sensors.limit_plus && !sensors.limit_minus,
        Phase::Setting => on(LIMIT_PLUS),
        Phase::Missing | Phase::Deferred | Phase::Valid | Phase::Failed => {
            let angle = state.command.angle;
            let turned = f64::from(angle.saturating_sub(LIMIT_PLUS)) * COUNTS_PER_TENTH;
            let read = f64::from(sensors.table_potentiometer) - f64::from(state.at_limit);
            on(angle) && (read - turned).abs() <= AGREEMENT
        }
    }
}
