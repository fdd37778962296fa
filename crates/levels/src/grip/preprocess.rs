//! The bands allow for valves that act one to two samples after a reading, at the flows of
//! [`interfaces::device::valve`]: per tick, a coarse flow moves 0.16 in, a medium one 0.04 in or 4 lb, a fine one
//! 0.01 in or 1 lb. Each band is wider than two ticks of its flow, so no flow overshoots the next finer band.

use interfaces::{
    GripOutputs,
    device::{GripSensors, GroupHealth},
    grip::{Felt, GripCommand},
    process::Inputs,
};
use rcs_core::{
    handshake::Arrival,
    tick::{TICK_S, Tick},
};

use super::{
    calibration::{Steady, is_plausible, value},
    goal::{CLOSED_END, GripGoal},
    presence::{self, CONTACT, MISSED_AT_END},
    servoed::Servoed,
    state::{Sensed, State, Touch, WINDOW},
    tables::{
        Addressee, AirFlow, Attachment, Calibrating, Clock, Grasp, GripActivity, GripMotion, GripOpening,
        GripPhase, GripReach, GripRest, Measured, Request, Sensors, Situation, StateVariables, Step,
        command::{Adoption, GripBeginning, StartBuffer, Started, Written, start},
    },
};
use crate::execution::{Asked, Outcome};

const FAR: f64 = 0.40; // in: least distance for a coarse flow
const MIDDLE: f64 = 0.10; // in: least distance for a medium flow
const DEAD_BAND: f64 = 0.010; // in
const REST_BAND: f64 = 0.016; // in: the dead band and twice the noise

const LEAST_FORCE: f64 = 3.0; // lb: contact is not reliable below it
const FORCE_MIDDLE: f64 = 12.0; // lb: least difference for a medium flow
const FORCE_DEAD_BAND: f64 = 1.0; // lb
const FORCE_REST_BAND: f64 = 2.0; // lb
/// Fingers without force this far below the grasp size have missed the object, in. Reported openings are rounded to
/// 0.01 in, and "nothing held" must read at or below the grasp size.
const MISSED_BELOW: f64 = 0.02;
const MISSED_TICKS: u8 = 3; // for the force of an object to build up

const SETTLE_TICKS: u8 = 6; // two until the last flow has ended, and a window
const STILL_TICKS: u8 = 5; // valves act two ticks late
/// Time limit of a command by its greatest flow, ticks: fine, medium, coarse (26, 12 and 6 s). The whole travel
/// takes 490, 125 and 55 ticks, a grasp 30 more.
const LIMIT_TICKS: [u64; 3] = [650, 300, 150];
const CALIBRATION_LIMIT_TICKS: u64 = 400; // 16 s; UP-INIT takes about 100
const STEADY_TICKS: u32 = 12; // longer than valves take to act

impl State {
    /// Read the inputs of a tick. If the outputs were republished, the process was dormant in the previous tick.
    pub(super) fn sense<S: Servoed, Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &GripOutputs,
    ) -> StateVariables {
        let command = S::command(inputs.memory);
        let (gripper, sensors) = S::sensors(&inputs.external.devices);
        let connection = S::connection(&inputs.external.devices);
        let (arrival, asked) = self.observe((inputs.tick, command.number), gripper, outputs);
        let goal = GripGoal::from(command);
        if arrival == Arrival::New {
            self.goal = goal;
        }
        let before = self.sensed.map(|sensed| sensed.last);
        self.sample(gripper, &sensors);
        let measured = self.measure();
        if connection.is_old() {
            self.await_readings();
        } else {
            self.detect(before.as_ref(), &measured);
        }
        let step = if arrival == Arrival::New { Step::Start } else { self.step };
        self.count(arrival, step, &measured, inputs.tick);
        StateVariables {
            arrival,
            request: Request {
                asked,
                verb: command.command,
                addressee: addressee::<S>(command),
                gripper,
                reach: if goal.is_attainable() { GripReach::Within } else { GripReach::Beyond },
            },
            situation: Situation {
                command: GripActivity::Nothing,
                gripper,
                readings: self.readings(inputs.tick, connection),
                clock: self.clock(inputs.tick),
                motion: if self.still_ticks >= STILL_TICKS { GripMotion::Still } else { GripMotion::Moving },
                felt: self.felt,
                sensors: self.sensors(connection, &measured),
                rest: if self.settled >= SETTLE_TICKS { GripRest::Rested } else { GripRest::Waiting },
                opening: self.opening(step, &measured),
                grasp: self.grasp(step, &measured),
            },
            measured,
        }
    }

    /// When the process starts or wakes, consult START.
    fn observe(
        &mut self,
        (tick, number): (Tick, u32),
        gripper: Attachment,
        outputs: &GripOutputs,
    ) -> (Arrival, Asked) {
        let woken = outputs.header.republished;
        if woken {
            self.execution.wake();
            (self.valves, self.sensed) = (0, None);
        }
        let starting = !self.execution.receiver.started;
        let (arrival, asked) = self.execution.observe(tick, number);
        if starting {
            let started = Started {
                beginning: if woken { GripBeginning::Wake } else { GripBeginning::Start },
                written: if outputs.calibration.is_some() { Written::Calibration } else { Written::Nothing },
                gripper,
                buffer: if self.execution.receiver.adopted {
                    StartBuffer::Command
                } else {
                    StartBuffer::Empty
                },
            };
            let decision = start(self.phase, &started);
            self.phase = decision.next;
            match decision.action {
                Adoption::Keep => {}
                Adoption::Adopt => self.calibration = outputs.calibration,
            }
        }
        (arrival, asked)
    }

    fn sample(&mut self, gripper: Attachment, now: &GripSensors) {
        self.sensed = match (gripper, self.sensed) {
            (Attachment::Detached, _) => {
                self.steady = Steady::default();
                None
            }
            (Attachment::Attached, None) => {
                self.steady = Steady::default();
                Some(Sensed { last: *now, window: [now.potentiometer; WINDOW] })
            }
            (Attachment::Attached, Some(Sensed { last, window: [newest, second, third, _] })) => {
                self.steady.note(now, &last);
                Some(Sensed { last: *now, window: [now.potentiometer, newest, second, third] })
            }
        };
    }

    fn measure(&self) -> Measured {
        let (Some(scale), Some(Sensed { last, window })) = (&self.calibration, &self.sensed) else {
            return Measured::default();
        };
        let [newest, second, third, oldest] = window.map(f64::from);
        Measured {
            opening: value(&scale.potentiometer, newest),
            mean_opening: value(&scale.potentiometer, (newest + second + third + oldest) / 4.0),
            velocity: (newest - oldest) * scale.potentiometer.gain / (3.0 * TICK_S),
            left: value(&scale.left, f64::from(last.strain_left)),
            right: value(&scale.right, f64::from(last.strain_right)),
        }
    }

    fn count(&mut self, arrival: Arrival, step: Step, measured: &Measured, tick: Tick) {
        if step == Step::Start && !self.is_calibrating() {
            self.since = tick;
        }
        self.settled = if step == Step::Settle { self.settled.saturating_add(1) } else { 0 };
        let executing = match arrival {
            Arrival::New => true,
            Arrival::Same => self.execution.outcome == Outcome::Executing,
            Arrival::Nothing | Arrival::Restarted => false,
        };
        let gone_by = (self.goal.opening - MISSED_BELOW).max(CLOSED_END + MISSED_AT_END);
        let touching = measured.left > CONTACT || measured.right > CONTACT;
        let missing = executing && !self.is_calibrating() && !touching && measured.opening <= gone_by;
        self.missed = if missing { self.missed.saturating_add(1) } else { 0 };
    }

    fn await_readings(&mut self) {
        (self.felt, self.touch, self.touch_ticks) = (Felt::NotKnown, Touch::Unclear, 0);
        (self.still_ticks, self.settled, self.missed) = (0, 0, 0);
        self.steady = Steady::default();
    }

    fn sensors(&self, connection: GroupHealth, measured: &Measured) -> Sensors {
        match (&self.calibration, &self.sensed) {
            _ if connection == GroupHealth::Stale => Sensors::Stale,
            _ if connection == GroupHealth::Lost => Sensors::Lost,
            _ if connection == GroupHealth::Tripped => Sensors::Tripped,
            (Some(_), Some(sensed)) if presence::is_plausible(&sensed.last, measured) => Sensors::Plausible,
            _ => Sensors::Implausible,
        }
    }

    fn readings(&self, tick: Tick, connection: GroupHealth) -> Calibrating {
        let plausible = || is_plausible(&self.closed, &self.open, &self.steady.mean());
        // Fingers without air stop anywhere, and their readings are steady.
        if connection == GroupHealth::Tripped || tick.since(self.since) > CALIBRATION_LIMIT_TICKS {
            Calibrating::Late
        } else if self.steady.ticks < STEADY_TICKS {
            Calibrating::Unsteady
        } else if self.phase == GripPhase::Venting && !plausible() {
            Calibrating::Implausible
        } else {
            Calibrating::Steady
        }
    }

    fn clock(&self, tick: Tick) -> Clock {
        let [fine, medium, coarse] = LIMIT_TICKS;
        let limit = match self.goal.greatest_flow() {
            AirFlow::Fine => fine,
            AirFlow::Medium => medium,
            AirFlow::Coarse => coarse,
        };
        if tick.since(self.since) > limit { Clock::Expired } else { Clock::Running }
    }

    fn opening(&self, step: Step, measured: &Measured) -> GripOpening {
        let (opening, dead_band) = match step {
            Step::Start | Step::Move => (measured.opening, DEAD_BAND),
            Step::Settle => (measured.mean_opening, REST_BAND),
        };
        match opening - self.goal.opening {
            e if e > FAR => GripOpening::VeryWide,
            e if e > MIDDLE => GripOpening::Wide,
            e if e > dead_band => GripOpening::BitWide,
            e if e >= -dead_band => GripOpening::Right,
            e if e >= -MIDDLE => GripOpening::BitNarrow,
            e if e >= -FAR => GripOpening::Narrow,
            _ => GripOpening::VeryNarrow,
        }
    }

    fn grasp(&self, step: Step, measured: &Measured) -> Grasp {
        let Measured { opening, left, right, .. } = *measured;
        let dead_band = match step {
            Step::Start | Step::Move => FORCE_DEAD_BAND,
            Step::Settle => FORCE_REST_BAND,
        };
        match (left > CONTACT, right > CONTACT) {
            (false, false) if self.missed >= MISSED_TICKS => Grasp::Missed,
            (false, false) if opening > self.goal.opening + FAR => Grasp::Far,
            (false, false) => Grasp::Near,
            (true, false) | (false, true) => Grasp::OneFinger,
            (true, true) => match f64::midpoint(left, right) - self.goal.force.max(LEAST_FORCE) {
                e if e > FORCE_MIDDLE => Grasp::Crushing,
                e if e > dead_band => Grasp::Strong,
                e if e >= -dead_band => Grasp::Firm,
                e if e >= -FORCE_MIDDLE => Grasp::Weak,
                _ => Grasp::Loose,
            },
        }
    }
}

fn addressee<S: Servoed>(command: &GripCommand) -> Addressee {
    if command.end_effector_id.is_none_or(|id| id == S::END_EFFECTOR_ID) {
        Addressee::This
    } else {
        Addressee::Other
    }
}
