//! Preprocess: read the command and the sensors, and set the state variables that the tables look at.

use rcs_core::{
    interface::{
        Reason,
        device::{DeviceInputs, QuickChangeSensors},
        jaws::{JawsCommand, JawsVerb},
    },
    tick::{TICK_S, Tick},
    units::inches,
};

use super::{
    Parameters,
    state::{State, WINDOW},
    tables::{Gripper, Motion, Size, Stop},
};
use crate::old_execution::Course;

/// Counts of the potentiometer at opening 0. ASSUMED; all grippers use the same connections (III.3.7, III.3.8).
pub const POTENTIOMETER_OFFSET: f64 = 205.0;
/// Counts of the potentiometer an inch. ASSUMED.
pub const POTENTIOMETER_SCALE: f64 = 600.0;

/// Ticks after a change of the air in which fingers may not have begun to move.
pub(super) const START_TICKS: u8 = 6;
/// Ticks in which any way of the fingers must end (4 s).
pub(super) const LIMIT_TICKS: u64 = 100;
/// Readings of a window that differ by no more than this are those of fingers that stand still, counts.
const STILL_COUNTS: u16 = 4;
/// So near to an end of their way the fingers are at it, in.
const STOP_BAND: f64 = 0.05;
/// So far beyond an end of their way no fingers are: the potentiometer fails, in.
const BEYOND: f64 = 0.15;
/// So near to `commanded-size` the fingers are there, in.
const SIZE_BAND: f64 = 0.10;

/// State variables of a tick, and what the sensors say in inches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// What the upper table says.
    pub course: Course,
    /// Is the gripper of this process there?
    pub gripper: Gripper,
    /// What do the fingers do?
    pub motion: Motion,
    /// Where are they on their way?
    pub stop: Stop,
    /// Where are they seen from the commanded size?
    pub size: Size,
    /// Opening by the mean of the last readings, in.
    pub opening: f64,
    /// Opening velocity, in/s.
    pub velocity: f64,
}

impl Seen {
    /// Read the inputs of a tick. `woken`: the process was dormant in the tick before.
    pub fn preprocess(
        state: &mut State,
        parameters: &Parameters,
        command: &JawsCommand,
        devices: &DeviceInputs,
        woken: bool,
        tick: Tick,
    ) -> Self {
        let gripper = gripper(&devices.quick_change, parameters);
        if woken {
            state.execution.wake();
        }
        let course = state.execution.consult(command.number, || fault(command, gripper, parameters));
        if course == Course::Begin {
            (state.verb, state.since) = (command.command, tick);
            if command.size != 0 {
                state.size = command.size;
            }
        }
        sample(state, gripper, devices.grip.potentiometer);
        let [newest, second, third, oldest] = state.window.map(f64::from);
        let opening = opening_at((newest + second + third + oldest) / 4.0);
        Self {
            course,
            gripper,
            motion: motion(state, tick),
            stop: stop(opening, parameters),
            size: size(opening, state.size),
            opening,
            velocity: (newest - oldest) / POTENTIOMETER_SCALE / (3.0 * TICK_S),
        }
    }
}

fn opening_at(counts: f64) -> f64 {
    (counts - POTENTIOMETER_OFFSET) / POTENTIOMETER_SCALE
}

fn gripper(quick_change: &QuickChangeSensors, parameters: &Parameters) -> Gripper {
    let locked = quick_change.locked && !quick_change.unlocked;
    if locked && quick_change.end_effector_id == parameters.end_effector_id {
        Gripper::Attached
    } else {
        Gripper::Detached
    }
}

/// Why a command cannot be executed, if so.
fn fault(command: &JawsCommand, gripper: Gripper, parameters: &Parameters) -> Option<Reason> {
    let meant = command.end_effector_id == 0 || command.end_effector_id == parameters.end_effector_id;
    match command.command {
        JawsVerb::None => Some(Reason::UnknownCommand),
        JawsVerb::Pause => None,
        JawsVerb::Grasp | JawsVerb::Release | JawsVerb::Pose => {
            (!meant || gripper == Gripper::Detached).then_some(Reason::WrongGripper)
        }
    }
}

/// Take the reading of this tick.
fn sample(state: &mut State, gripper: Gripper, counts: u16) {
    state.window = match gripper {
        Gripper::Attached if state.attached => {
            let [newest, second, third, _] = state.window;
            [counts, newest, second, third]
        }
        Gripper::Attached => [counts; WINDOW],
        Gripper::Detached => [0; WINDOW],
    };
    state.attached = gripper == Gripper::Attached;
    state.air_ticks = state.air_ticks.saturating_add(1);
}

fn motion(state: &State, tick: Tick) -> Motion {
    let (least, most) =
        state.window.iter().fold((u16::MAX, 0), |(least, most), &c| (least.min(c), most.max(c)));
    let still = most.abs_diff(least) <= STILL_COUNTS && state.air_ticks >= START_TICKS;
    if still {
        Motion::Stopped
    } else if tick.since(state.since) > LIMIT_TICKS {
        Motion::Endless
    } else {
        Motion::Moving
    }
}

fn stop(opening: f64, parameters: &Parameters) -> Stop {
    let Parameters { closed, opened, .. } = *parameters;
    if (closed - BEYOND..=closed + STOP_BAND).contains(&opening) {
        Stop::Closed
    } else if (opened - STOP_BAND..=opened + BEYOND).contains(&opening) {
        Stop::Opened
    } else {
        Stop::Between
    }
}

fn size(opening: f64, commanded: i32) -> Size {
    let there = commanded != 0 && (opening - inches(commanded)).abs() <= SIZE_BAND;
    if there { Size::Commanded } else { Size::Other }
}
