//! Preprocess: read the command and the sensors, and set the state variables that the tables look at.
//!
//! Bands are chosen for valves that act between one and two samples after the reading that they answer, at the flows of
//! [`rcs_core::interface::device::valve`]: a coarse flow moves 0.16 in a tick, a medium one 0.04 in or 4 lb, a fine one
//! 0.01 in or 1 lb. Each band is wider than two ticks of the flow used in it, so no flow overshoots the next finer band.

use rcs_core::{
    interface::{
        Reason,
        device::{ADC_FULL_SCALE, GripSensors},
        grip::{GripCommand, GripVerb},
    },
    tick::{TICK_S, Tick},
};

use super::{
    state::{CLOSED_END, Command, OPEN_END, Phase, Readings, SUPPLY_FORCE, State, Steady, Step, WINDOW},
    tables::{Calibrating, Clock, Flow, Grasp, Gripper, Opening, Rest},
};
use crate::old_execution::Course;

/// Farther than this from the goal a coarse flow is used, in.
const FAR: f64 = 0.40;
/// Farther than this a medium flow is used, in.
const MIDDLE: f64 = 0.10;
/// Closer than this the fingers are stopped, in.
const DEAD_BAND: f64 = 0.010;
/// Fingers that came to rest within this are where they should be, in: above the dead band by twice the noise.
const REST_BAND: f64 = 0.016;

/// A finger that feels more than this touches something, lb.
const CONTACT: f64 = 1.0;
/// The least force that the servo aims at, lb: below it contact comes and goes.
const LEAST_FORCE: f64 = 3.0;
/// Farther than this from the commanded force a medium flow is used, lb.
const FORCE_MIDDLE: f64 = 12.0;
/// Closer than this the flow is stopped, lb.
const FORCE_DEAD_BAND: f64 = 1.0;
/// A force that came to rest within this is as commanded, lb.
const FORCE_REST_BAND: f64 = 2.0;
/// So far below the grasp size fingers without force have missed the object, in: reported openings are rounded to 0.01 in,
/// and "nothing held" must read at or below the grasp size.
const MISSED_BELOW: f64 = 0.02;
/// The same near the closed end, where no opening is below: in above the closed end.
const MISSED_AT_END: f64 = 0.02;
/// Ticks in which force must build up if there is anything between the fingers.
const MISSED_TICKS: u8 = 3;

/// Ticks with the valves off after which readings count as settled: two until the last flow has ended, and a window.
const SETTLE_TICKS: u8 = 6;
/// Ticks that a command may take, by its greatest flow: fine, medium, coarse (26, 12 and 6 s). The whole travel takes 490,
/// 125 and 55 ticks, a grasp 30 more.
const LIMIT_TICKS: [u64; 3] = [650, 300, 150];
/// Ticks that UP-INIT may take (16 s); it takes about 100.
const CALIBRATION_LIMIT_TICKS: u64 = 400;

/// Steady ticks that make a calibration reading; longer than valves take to act.
const STEADY_TICKS: u32 = 12;
/// Readings that differ by more than this from the last ones are not steady, counts: the noise, and less than a fine flow.
const STEADY_COUNTS: u16 = 6;
/// Least difference of the potentiometer between the ends of travel, counts.
const LEAST_TRAVEL: f64 = 1000.0;
/// Least difference of a strain gage between the supply force and none, counts.
const LEAST_STRAIN: f64 = 400.0;

/// What the sensors say in inches and pounds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measured {
    /// Opening by the newest reading, in.
    pub opening: f64,
    /// Opening by the mean of the last readings, in.
    pub mean_opening: f64,
    /// Opening velocity, in/s.
    pub velocity: f64,
    /// Force of the left finger, lb.
    pub left: f64,
    /// Force of the right finger, lb.
    pub right: f64,
}

/// State variables of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// What the upper table says.
    pub course: Course,
    /// UP-INIT has the duty, commanded or not.
    pub calibrate: bool,
    /// Is the parts gripper there?
    pub gripper: Gripper,
    /// Time of what has the duty.
    pub clock: Clock,
    /// Have the readings settled?
    pub rest: Rest,
    /// Opening and forces.
    pub measured: Measured,
}

/// What the servo finds at its site in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving<'a> {
    /// The command buffer.
    pub command: &'a GripCommand,
    /// `endeff-id#` of the gripper.
    pub end_effector_id: u8,
    /// The process was dormant in the tick before.
    pub woken: bool,
    /// Is the gripper there?
    pub gripper: Gripper,
    /// Its sensor words.
    pub sensors: GripSensors,
    /// This tick.
    pub tick: Tick,
}

impl Seen {
    /// Read the inputs of a tick.
    pub fn preprocess(state: &mut State, arriving: &Arriving<'_>) -> Self {
        let &Arriving { gripper, tick, .. } = arriving;
        let course = observe(state, arriving);
        sample(state, gripper, &arriving.sensors);
        let calibrate = calibration_due(state, course, gripper);
        let measured = measure(state);
        count(state, course, calibrate, &measured, tick);
        let limit = if calibrate {
            CALIBRATION_LIMIT_TICKS
        } else {
            let [fine, medium, coarse] = LIMIT_TICKS;
            match greatest_flow(state.command.speed) {
                Flow::Fine => fine,
                Flow::Medium => medium,
                Flow::Coarse => coarse,
            }
        };
        let clock = if tick.since(state.since) > limit { Clock::Expired } else { Clock::Running };
        let rest = if state.settled >= SETTLE_TICKS { Rest::Rested } else { Rest::Waiting };
        Self { course, calibrate, gripper, clock, rest, measured }
    }

    /// The opening, seen from the commanded one.
    pub fn opening(&self, state: &State) -> Opening {
        let (opening, dead_band) = match state.step() {
            Step::Start | Step::Move => (self.measured.opening, DEAD_BAND),
            Step::Settle => (self.measured.mean_opening, REST_BAND),
        };
        match opening - state.command.opening {
            e if e > FAR => Opening::VeryWide,
            e if e > MIDDLE => Opening::Wide,
            e if e > dead_band => Opening::BitWide,
            e if e >= -dead_band => Opening::Right,
            e if e >= -MIDDLE => Opening::BitNarrow,
            e if e >= -FAR => Opening::Narrow,
            _ => Opening::VeryNarrow,
        }
    }

    /// What the fingers feel.
    pub fn grasp(&self, state: &State) -> Grasp {
        let Measured { opening, left, right, .. } = self.measured;
        let dead_band = match state.step() {
            Step::Start | Step::Move => FORCE_DEAD_BAND,
            Step::Settle => FORCE_REST_BAND,
        };
        match (left > CONTACT, right > CONTACT) {
            (false, false) if state.missed >= MISSED_TICKS => Grasp::Missed,
            (false, false) if opening > state.command.opening + FAR => Grasp::Far,
            (false, false) => Grasp::Near,
            (true, false) | (false, true) => Grasp::OneFinger,
            (true, true) => match f64::midpoint(left, right) - state.command.force.max(LEAST_FORCE) {
                e if e > FORCE_MIDDLE => Grasp::Crushing,
                e if e > dead_band => Grasp::Strong,
                e if e >= -dead_band => Grasp::Firm,
                e if e >= -FORCE_MIDDLE => Grasp::Weak,
                _ => Grasp::Loose,
            },
        }
    }

    /// What the sensors read while calibrating.
    pub fn readings(&self, state: &State) -> Calibrating {
        if state.steady.ticks < STEADY_TICKS {
            Calibrating::Unsteady
        } else if state.phase == Phase::Venting && !plausible(state) {
            Calibrating::Implausible
        } else {
            Calibrating::Steady
        }
    }
}

/// The greatest flow that is not faster than a commanded speed, in/s; 0 means full speed, and the fine flow is the slowest.
pub(super) fn greatest_flow(speed: f64) -> Flow {
    match speed {
        0.0 => Flow::Coarse,
        s if s >= 4.0 => Flow::Coarse,
        s if s >= 1.0 => Flow::Medium,
        _ => Flow::Fine,
    }
}

/// Read the command buffer and consult the upper table.
fn observe(state: &mut State, arriving: &Arriving<'_>) -> Course {
    let &Arriving { command, gripper, woken, .. } = arriving;
    if woken {
        state.execution.wake();
        state.valves = 0;
    }
    let starting = !state.execution.receiver.started;
    let course = state.execution.consult(command.number, || fault(arriving));
    if course == Course::Begin {
        state.command = Command::from(command);
    }
    if starting && state.phase != Phase::Valid {
        let attached = gripper == Gripper::Attached;
        state.phase = if woken && attached && state.calibrating() {
            // Put to sleep before E-move knew which gripper is on: begin again.
            Phase::Missing
        } else if woken || !attached || state.execution.receiver.adopted {
            Phase::Deferred
        } else {
            state.phase
        };
    }
    course
}

/// Why a command cannot be executed, if so.
fn fault(arriving: &Arriving<'_>) -> Option<Reason> {
    let to = arriving.command;
    match to.command {
        GripVerb::None => return Some(Reason::UnknownCommand),
        GripVerb::Pause => return None,
        GripVerb::UpInit | GripVerb::Position | GripVerb::OpenGrip | GripVerb::CloseGrip => {}
    }
    let meant = to.end_effector_id == 0 || to.end_effector_id == arriving.end_effector_id;
    if !meant || arriving.gripper == Gripper::Detached {
        Some(Reason::WrongGripper)
    } else if attainable(to) {
        None
    } else {
        Some(Reason::GripUnattainable)
    }
}

/// Can a gripper of this sort reach the opening and the force of a command?
pub fn attainable(command: &GripCommand) -> bool {
    let to = Command::from(command);
    let reachable = (CLOSED_END..=OPEN_END).contains(&to.opening) && to.speed >= 0.0;
    match to.verb {
        GripVerb::Position | GripVerb::OpenGrip => reachable,
        GripVerb::CloseGrip => reachable && (0.0..=SUPPLY_FORCE).contains(&to.force),
        GripVerb::UpInit | GripVerb::Pause | GripVerb::None => true,
    }
}

/// Take the readings of this tick.
fn sample(state: &mut State, gripper: Gripper, now: &GripSensors) {
    match gripper {
        Gripper::Attached if state.attached => {
            let [newest, second, third, _] = state.window;
            state.window = [now.potentiometer, newest, second, third];
        }
        Gripper::Attached => {
            state.window = [now.potentiometer; WINDOW];
            state.last = *now;
        }
        Gripper::Detached => (state.window, state.last) = ([0; WINDOW], GripSensors::default()),
    }
    let still = |now: u16, before: u16| now.abs_diff(before) <= STEADY_COUNTS;
    let steady = still(now.potentiometer, state.last.potentiometer)
        && still(now.strain_left, state.last.strain_left)
        && still(now.strain_right, state.last.strain_right);
    let sums = if steady { state.steady } else { Steady::default() };
    state.steady = Steady {
        ticks: sums.ticks.saturating_add(1),
        potentiometer: sums.potentiometer.saturating_add(u32::from(now.potentiometer)),
        left: sums.left.saturating_add(u32::from(now.strain_left)),
        right: sums.right.saturating_add(u32::from(now.strain_right)),
    };
    state.last = *now;
    state.attached = gripper == Gripper::Attached;
}

/// Has UP-INIT the duty: is it running, commanded, needed by the command, or due because the gripper came?
fn calibration_due(state: &State, course: Course, gripper: Gripper) -> bool {
    if state.calibrating() {
        return true;
    }
    let due = match course {
        Course::Begin | Course::Continue => match state.command.verb {
            GripVerb::UpInit => true,
            GripVerb::Position | GripVerb::OpenGrip | GripVerb::CloseGrip => state.phase != Phase::Valid,
            GripVerb::Pause | GripVerb::None => false,
        },
        Course::Rest => state.phase == Phase::Missing,
        Course::Refuse => false,
    };
    due && gripper == Gripper::Attached
}

fn measure(state: &State) -> Measured {
    let scale = &state.calibration;
    let [newest, second, third, oldest] = state.window.map(f64::from);
    let mean = (newest + second + third + oldest) / 4.0;
    Measured {
        opening: scale.potentiometer.value(newest),
        mean_opening: scale.potentiometer.value(mean),
        velocity: (newest - oldest) * scale.potentiometer.gain / (3.0 * TICK_S),
        left: scale.left.value(f64::from(state.last.strain_left)),
        right: scale.right.value(f64::from(state.last.strain_right)),
    }
}

/// Count ticks: since the table was consulted first, since the valves went off, since the object should have been felt.
fn count(state: &mut State, course: Course, calibrate: bool, measured: &Measured, tick: Tick) {
    let commanded = !calibrate && matches!(course, Course::Begin | Course::Continue);
    if calibrate {
        if !state.calibrating() {
            state.since = tick;
            state.steady = Steady::default();
        }
    } else if state.step() == Step::Start {
        state.since = tick;
    }
    let settling = commanded && state.step() == Step::Settle;
    state.settled = if settling { state.settled.saturating_add(1) } else { 0 };
    let gone_by = (state.command.opening - MISSED_BELOW).max(CLOSED_END + MISSED_AT_END);
    let touching = measured.left > CONTACT || measured.right > CONTACT;
    let missing = commanded && !touching && measured.opening <= gone_by;
    state.missed = if missing { state.missed.saturating_add(1) } else { 0 };
}

/// Do the readings tell the ends of travel and the supply force from none, without a converter at its end?
fn plausible(state: &State) -> bool {
    let State { closed, open, .. } = state;
    let free = state.steady.mean();
    let full = f64::from(ADC_FULL_SCALE);
    let unsaturated = |r: &Readings| r.potentiometer < full && r.left < full && r.right < full;
    open.potentiometer - closed.potentiometer >= LEAST_TRAVEL
        && closed.left - free.left >= LEAST_STRAIN
        && closed.right - free.right >= LEAST_STRAIN
        && unsaturated(closed)
        && unsaturated(open)
}
