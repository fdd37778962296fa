use core::mem;

use depc::track;
use geometry::{
    frame::Frame,
    units::{inches, rounded},
};
use interfaces::{
    PrimOutputs, ProcessId,
    device::{DeviceInputs, JoystickBox, single_step},
    prim::{PrimCommand, PrimVerb},
    process::Inputs,
    t3i::{Following, LinkFault, ReportCheck, T3iCommand, T3iReport, T3iStatus, T3iVerb},
};
use rcs_core::handshake::{Lower, successor};
use taskdata::files::{SensorPara, TaskData};

use super::{
    manual::{Coordinates, PrimManual, is_moved},
    motion::{limits::Limits, segment::FrameData},
    sensors::GuardReading,
    state::{PrimGoal, PrimTarget, Standstill, State},
    tables::{
        Button, CommandKind, Devices, Guard, Interface, Passage, Position, Posture, PrimLink, PrimMissing,
        PrimOperator, PrimPath, PrimRest, Request, Samples, Situation, StateVariables, Switches,
    },
};
use crate::{execution::Asked, halt::Above, places::pose_of};

/// Consecutive ticks at the goal until the robot is at rest (docs/design/motion.md "Rest").
const SETTLED: u32 = 3;
/// 2 s, in which the robot must rest after the last point (docs/design/motion.md "Rest").
const REST_TICKS: u32 = 50;
const AT_GOAL_INCHES: f64 = 0.02; // tolerance of the goal; greatest motion per tick at rest
const AT_GOAL_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0; // 0.1 degree

impl State {
    /// `outputs` are those of the previous tick.
    pub(super) fn sense(
        &mut self,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &PrimOutputs,
    ) -> StateVariables {
        let (t3i, devices) = (&inputs.memory.t3i.status, &inputs.external.devices);
        self.t3i.start_from(inputs.tick, inputs.memory.prim.t3i.number, t3i.echo);
        self.resume_from_rest(inputs);
        if !self.execution.receiver.started {
            self.calibration.bias = outputs.bias;
        }
        let command = &inputs.memory.emove.prim;
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        let request = if asked == Asked::Now { self.look_up(command, inputs) } else { Request::default() };
        let verb = if asked == Asked::Now { command.command } else { self.target.verb };
        let interface = self.interface(inputs, &outputs.t3i);
        let answered = matches!(interface, Interface::Ready | Interface::Finished);
        let feedback = Some(&t3i.frame_feedback).filter(|_| answered && t3i.link_running);
        let feedback = feedback.and_then(|frame| frame.to_frame().ok());
        let resolvers = t3i.resolver_frame.and_then(|frame| frame.to_frame().ok());
        let posture = self.posture(interface);
        let (goal, rest) = self.ends(inputs, posture, resolvers);
        let situation = Situation {
            t3i: interface,
            emove: Above::of(&inputs.memory.emove.header, inputs.tick),
            switches: switches(&devices.joystick),
            posture,
            position: position(verb),
            operator: operator(&devices.joystick),
            report: report(interface, t3i),
            restarts: self.restarts.so_far(inputs.tick),
            way: self.way,
            link: if feedback.is_some() { PrimLink::Running } else { PrimLink::Down },
            passage: match &self.motion {
                Some(motion) if motion.is_passing() => Passage::Passing,
                Some(_) | None => Passage::UnderWay,
            },
            goal,
            rest,
            guard: self.guard(inputs),
            samples: self.samples(inputs, rest),
        };
        let button = self.button(&devices.joystick);
        let lag_ms = devices.robot_lag.unwrap_or(track::LAG_MS);
        let proof = self.proof(verb, &situation, resolvers.as_ref(), lag_ms);
        let field = Devices { position: situation.position, connection: devices.field.any };
        StateVariables { arrival, verb, request, field, proof, situation, button, feedback, resolvers }
    }

    /// T3I has stopped the robot while Prim was held or suspended. A singly stepped Prim moves from point to point.
    fn resume_from_rest(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let stopped = inputs.external.operator.is_stopped(ProcessId::Prim.board());
        let held = stopped || inputs.external.devices.joystick.hold & single_step::PRIM != 0;
        let before = mem::replace(&mut self.single_step, held);
        if !held && (before || inputs.memory.prim.header.republished) {
            if let Some(motion) = &mut self.motion {
                motion.stand();
            }
            self.manual = PrimManual::default();
        }
    }

    /// The records of a new command are kept if they are complete.
    fn look_up(&mut self, command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Request {
        let missing = match target(command, inputs) {
            Ok(target) => {
                self.target = target;
                self.way = PrimPath::Kept;
                self.standstill = Standstill::default();
                PrimMissing::Nothing
            }
            Err(missing) => missing,
        };
        Request { asked: Asked::Now, missing }
    }

    pub(super) fn posture(&self, t3i: Interface) -> Posture {
        match &self.motion {
            None => Posture::Unpositioned,
            Some(motion) if !motion.is_at_rest() || self.manual.is_moving() => Posture::Moving,
            Some(_) if t3i != Interface::Finished => Posture::Ending,
            Some(_) => Posture::Standing,
        }
    }

    /// A point is sent in each tick and echoed two ticks later, so the echo of the previous point is accepted while
    /// points are sent. Any other command must be echoed itself: an error from before a RESTART does not answer it.
    fn interface(&self, inputs: &Inputs<'_, TaskData<'_>>, sent: &T3iCommand) -> Interface {
        let t3i = &inputs.memory.t3i;
        let (number, echo) = (self.t3i.number, t3i.status.echo);
        let flowing = sent.command == T3iVerb::Point
            && successor(echo) == number
            && self.t3i.sent == inputs.tick.previous();
        let heard = if flowing { number } else { echo };
        match self.t3i.read(inputs.tick, &t3i.header, heard, Lower::Executing) {
            Lower::Lost => return Interface::Silent,
            Lower::Pending => return Interface::Busy,
            Lower::Executing | Lower::Done | Lower::Error | Lower::Joystick => {}
        }
        match t3i.status.report {
            T3iReport::Error => fault(&t3i.status),
            _ if self.motion.is_some() && !t3i.status.link_running => silence(&t3i.status),
            // A held T3I reads no commands, so a new one would be lost.
            _ if t3i.header.republished => Interface::Busy,
            T3iReport::Executing => Interface::Busy,
            T3iReport::Finished if echo == number => Interface::Finished,
            T3iReport::Finished | T3iReport::Ready => Interface::Ready,
        }
    }

    /// Watch for rest after the last point, at the goal or anywhere: by the resolvers, else by the report of T3I.
    fn ends(
        &mut self,
        inputs: &Inputs<'_, TaskData<'_>>,
        posture: Posture,
        resolvers: Option<Frame>,
    ) -> (PrimRest, PrimRest) {
        let before = mem::replace(&mut self.resolver_frame, inputs.memory.t3i.status.resolver_frame);
        let ended = &mut self.standstill;
        if posture != Posture::Standing {
            *ended = Standstill::default();
            return (PrimRest::UnderWay, PrimRest::UnderWay);
        }
        let near = |other: Option<Frame>| match (resolvers, other) {
            (Some(here), Some(other)) => {
                let off = here.distance(&other);
                off.inches <= AT_GOAL_INCHES && off.radians <= AT_GOAL_RADIANS
            }
            (None, _) => true,
            (Some(_), None) => false,
        };
        let at_goal = near(self.target.goal.map(|goal| goal.frame.frame()));
        let unmoved = near(before.and_then(|frame| frame.to_frame().ok()));
        ended.finished = ended.finished.saturating_add(1);
        ended.settled = if at_goal { ended.settled.saturating_add(1) } else { 0 };
        ended.still = if unmoved { ended.still.saturating_add(1) } else { 0 };
        (ended.rest(ended.settled), ended.rest(ended.still))
    }

    fn guard(&mut self, inputs: &Inputs<'_, TaskData<'_>>) -> Guard {
        let (devices, end_effector) = (&inputs.external.devices, self.target.end_effector_id);
        let read = |sensor: SensorPara| self.calibration.read(&sensor, devices, end_effector);
        let GuardReading { guard, value } = self.target.sensor.map(read).unwrap_or_default();
        self.sensed = rounded(value);
        guard
    }

    /// All readings of CAL-SENSOR must be from the same rest.
    fn samples(&mut self, inputs: &Inputs<'_, TaskData<'_>>, rest: PrimRest) -> Samples {
        let DeviceInputs { force, field, .. } = &inputs.external.devices;
        self.calibration.watch_power(force);
        if field.force.is_old() {
            // The sensor kept its power, so the bias stays valid.
            return Samples::Faulty;
        }
        if rest != PrimRest::Arrived {
            self.calibration.begin();
        }
        self.calibration.progress(force)
    }

    fn button(&mut self, joystick: &JoystickBox) -> Button {
        let before = mem::replace(&mut self.record_button, joystick.record);
        if joystick.record && !before { Button::Pressed } else { Button::Idle }
    }
}

impl Standstill {
    const fn rest(&self, ticks: u32) -> PrimRest {
        if ticks >= SETTLED {
            PrimRest::Arrived
        } else if self.finished >= REST_TICKS {
            PrimRest::Late
        } else {
            PrimRest::Settling
        }
    }
}

impl CommandKind {
    pub(super) const fn of(verb: PrimVerb) -> Self {
        match verb {
            PrimVerb::Pause => Self::Lasting,
            PrimVerb::GoThru
            | PrimVerb::GotoPt
            | PrimVerb::GoUntil
            | PrimVerb::GoWhile
            | PrimVerb::DeltaMove => Self::Motion,
            PrimVerb::None | PrimVerb::RobotInit | PrimVerb::CalSensor => Self::Single,
        }
    }
}

/// The error is the first missing record.
fn target(command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<PrimTarget, PrimMissing> {
    let verb = command.command;
    let sensor = match verb {
        PrimVerb::None => return Err(PrimMissing::Command),
        PrimVerb::GoUntil | PrimVerb::GoWhile => {
            Some(*command.sensor.and_then(|sensor| inputs.data.sensor(&sensor)).ok_or(PrimMissing::Sensor)?)
        }
        _ => None,
    };
    let goal = if CommandKind::of(verb) == CommandKind::Motion { Some(goal(command, inputs)?) } else { None };
    Ok(PrimTarget { verb, goal, sensor, end_effector_id: command.end_effector_id })
}

fn goal(command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<PrimGoal, PrimMissing> {
    let pose = pose_of(command.pose, inputs.memory, inputs.data).ok_or(PrimMissing::Pose)?;
    let by = command.movetable;
    if !by.is_null() && inputs.data.movetable(by).is_none() {
        return Err(PrimMissing::Movetable);
    }
    let id = command.trajectory_parameters;
    let para = inputs.data.traj_para(id).ok_or(PrimMissing::Parameters)?;
    let limits = Limits::from_counts(para.acc_fac, para.vel_max, para.smooth).ok_or(PrimMissing::Limits)?;
    Ok(PrimGoal {
        frame: FrameData::from(&inputs.data.moved(&pose, by)),
        limits,
        through: (command.command == PrimVerb::GoThru).then(|| inches(para.brk_dst)),
    })
}

fn switches(joystick: &JoystickBox) -> Switches {
    match joystick.frame.count_ones() {
        0 => Switches::Off,
        1 if Coordinates::of(joystick) != Coordinates::None => Switches::One,
        _ => Switches::Several,
    }
}

const fn position(verb: PrimVerb) -> Position {
    match verb {
        PrimVerb::None | PrimVerb::Pause | PrimVerb::RobotInit => Position::NotNeeded,
        PrimVerb::GoThru
        | PrimVerb::GotoPt
        | PrimVerb::GoUntil
        | PrimVerb::GoWhile
        | PrimVerb::DeltaMove
        | PrimVerb::CalSensor => Position::Needed,
    }
}

fn operator(joystick: &JoystickBox) -> PrimOperator {
    let on = switches(joystick) != Switches::Off && joystick.velocity > 0;
    if on && is_moved(joystick) { PrimOperator::Moves } else { PrimOperator::Idle }
}

/// The check after the last RESTART; not available before T3I has echoed it, or while T3I starts the link.
const fn report(interface: Interface, status: &T3iStatus) -> ReportCheck {
    match interface {
        Interface::Busy | Interface::Silent => ReportCheck::NoReport,
        Interface::Ready | Interface::Finished if !status.link_running => ReportCheck::NoReport,
        _ => status.check,
    }
}

const fn fault(status: &T3iStatus) -> Interface {
    match status.fault {
        _ if matches!(status.following, Following::OffPath) => Interface::OffPath,
        LinkFault::NotResponding => silence(status),
        LinkFault::InvalidCommand => Interface::Refused,
        LinkFault::None | LinkFault::DepcError | LinkFault::Checksum | LinkFault::NotTransmitted => {
            Interface::LinkError
        }
    }
}

const fn silence(status: &T3iStatus) -> Interface {
    if status.controller_ready { Interface::LinkSilent } else { Interface::LinkOff }
}
