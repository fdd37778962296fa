use geometry::units::inches;
use interfaces::{JawsOutputs, device::QuickChangeSensors, grip::Felt, jaws::JawsCommand, process::Inputs};
use rcs_core::{
    handshake::Arrival,
    tick::{TICK_S, Tick},
};

use super::{
    kind::{JawsKind, Parameters},
    state::{State, WINDOW},
    tables::{
        Addressee, Attachment, JawsMotion, Request, Situation, Size, StateVariables, Stop,
        presence::{Closing, JawReading, JawTravel, Settling, presence},
        valves::AttachedGripper,
    },
};

/// Counts of the potentiometer at opening 0. ASSUMED; all grippers use the same connections (III.3.7, III.3.8).
pub const POTENTIOMETER_OFFSET: f64 = 205.0;
/// Counts of the potentiometer per inch. ASSUMED.
pub const POTENTIOMETER_SCALE: f64 = 600.0;

pub(super) const START_TICKS: u8 = 6; // from a change of the air until the fingers move
/// Ticks until stopped fingers with closing air press (1 s, ASSUMED). The pressure must build up, also after a drop,
/// and no force sensor shows it (VI.4).
pub(super) const PRESSED_TICKS: u8 = 25;
const SETTLED_TICKS: u8 = 5; // until a newly attached gripper is read
pub(super) const LIMIT_TICKS: u64 = 100; // 4 s, for any travel
const STILL_COUNTS: u16 = 4; // greatest difference in a window at rest
const STOP_BAND: f64 = 0.05; // in
const BEYOND: f64 = 0.15; // in; an opening farther beyond an end of travel is a sensor failure
const SIZE_BAND: f64 = 0.10; // in

impl State {
    /// Read the inputs of a tick. If the outputs were republished, the process was dormant in the previous tick.
    pub(super) fn sense<K: JawsKind, Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &JawsOutputs,
    ) -> StateVariables {
        let command = K::command(inputs.memory);
        let devices = &inputs.external.devices;
        let gripper = gripper(&devices.quick_change, &K::PARAMETERS);
        if !self.execution.receiver.started {
            // A restarted process leaves the air on: the fingers may hold a part.
            self.valves = outputs.valves;
        }
        if outputs.header.republished {
            self.execution.wake();
            self.found = None;
        }
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        if arrival == Arrival::New {
            (self.verb, self.since, self.found) = (command.command, inputs.tick, None);
        }
        let named = (arrival == Arrival::New && command.size != 0).then_some(command.size);
        let size = named.or(self.size);
        let window = self.sample(gripper, devices.grip.potentiometer);
        let [newest, second, third, oldest] = window.map(f64::from);
        let opening = opening_at((newest + second + third + oldest) / 4.0);
        let stop = stop(opening, &K::PARAMETERS);
        let connection = devices.field.grip;
        let motion = if connection.is_old() {
            // The fingers may move, and their time limit is suspended.
            (self.since, self.gripping_ticks) = (self.since.next(), 0);
            JawsMotion::Moving
        } else {
            self.motion(&window, stop, inputs.tick)
        };
        StateVariables {
            arrival,
            verb: self.verb,
            request: Request {
                asked,
                verb: command.command,
                addressee: addressee(command, &K::PARAMETERS),
                gripper,
            },
            situation: Situation { gripper, motion, stop, size: self::size(opening, size), connection },
            mated: mated(&devices.quick_change, &K::PARAMETERS),
            felt: self.felt(motion, stop, opening, &K::PARAMETERS),
            size,
            opening,
            velocity: (newest - oldest) / POTENTIOMETER_SCALE / (3.0 * TICK_S),
        }
    }

    fn sample(&mut self, gripper: Attachment, counts: u16) -> [u16; WINDOW] {
        self.window = match (gripper, self.window) {
            (Attachment::Detached, _) => None,
            (Attachment::Attached, None) => Some([counts; WINDOW]),
            (Attachment::Attached, Some([newest, second, third, _])) => Some([counts, newest, second, third]),
        };
        self.air_ticks = self.air_ticks.saturating_add(1);
        self.attached_ticks = if self.window.is_some() { self.attached_ticks.saturating_add(1) } else { 0 };
        self.window.unwrap_or_default()
    }

    fn motion(&mut self, window: &[u16; WINDOW], stop: Stop, tick: Tick) -> JawsMotion {
        let (least, most) =
            window.iter().fold((u16::MAX, 0), |(least, most), &c| (least.min(c), most.max(c)));
        let still = most.abs_diff(least) <= STILL_COUNTS && self.air_ticks >= START_TICKS;
        let grips = still && self.valves.close && stop == Stop::Between;
        self.gripping_ticks =
            if grips { self.gripping_ticks.saturating_add(1).min(PRESSED_TICKS) } else { 0 };
        if still && (!grips || self.gripping_ticks == PRESSED_TICKS) {
            JawsMotion::Stopped
        } else if tick.since(self.since) > LIMIT_TICKS {
            JawsMotion::Endless
        } else {
            JawsMotion::Moving
        }
    }

    fn felt(&self, motion: JawsMotion, stop: Stop, opening: f64, parameters: &Parameters) -> Felt {
        let settled = motion == JawsMotion::Stopped && self.attached_ticks >= SETTLED_TICKS;
        let is_within = (parameters.closed..=parameters.opened).contains(&opening);
        let reading = JawReading {
            readings: if settled { Settling::Settled } else { Settling::Unsettled },
            stop,
            travel: if is_within { JawTravel::Within } else { JawTravel::Beyond },
            closing: Closing::from(self.valves),
        };
        presence((), &reading).action
    }
}

fn opening_at(counts: f64) -> f64 {
    (counts - POTENTIOMETER_OFFSET) / POTENTIOMETER_SCALE
}

fn gripper(quick_change: &QuickChangeSensors, parameters: &Parameters) -> Attachment {
    let locked = quick_change.locked && !quick_change.unlocked;
    if locked && quick_change.end_effector_id == parameters.end_effector_id {
        Attachment::Attached
    } else {
        Attachment::Detached
    }
}

fn mated(quick_change: &QuickChangeSensors, parameters: &Parameters) -> AttachedGripper {
    let id = quick_change.end_effector_id;
    let is_other = matches!(id, 1..=3) && id != parameters.end_effector_id;
    if !quick_change.locked || quick_change.unlocked || is_other {
        AttachedGripper::Gone
    } else {
        AttachedGripper::Possible
    }
}

fn addressee(command: &JawsCommand, parameters: &Parameters) -> Addressee {
    if command.end_effector_id.is_none_or(|id| id == parameters.end_effector_id) {
        Addressee::This
    } else {
        Addressee::Other
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

fn size(opening: f64, commanded: Option<i32>) -> Size {
    let there = commanded.is_some_and(|size| (opening - inches(size)).abs() <= SIZE_BAND);
    if there { Size::Commanded } else { Size::Other }
}
