//! Preprocess: input buffers become state variables.

use rcs_core::{
    frame::Frame,
    handshake::{Lower, successor},
    interface::{
        Reason,
        device::JoystickBox,
        pose_range,
        prim::{PrimCommand, PrimVerb},
        t3i::{LinkFault, T3iCommand, T3iReport, T3iVerb},
    },
    process::Inputs,
    units::{inches, rounded},
};
use taskdata::files::{MovtabId, PoseId, TaskData, TrajParaId};

use super::{
    manual::Coordinates,
    motion::{limits::Limits, segment::FrameData},
    sensors::Reading,
    state::{State, Target},
    tables::{Arrival, Guard, Health, Link, Pace, Passage, Posture, Samples, Situation, attend::Switches},
};

/// Ticks in a row that the robot must rest at the goal (docs/design/motion.md "Rest").
const SETTLED: u32 = 3;
/// Ticks after the last point in which it must have come to rest: 2 s (docs/design/motion.md "Rest").
const PATIENCE: u32 = 50;
/// Inches that count as at the goal, and as no motion from a tick to the next.
const AT_GOAL_INCHES: f64 = 0.02;
/// Radians that count as at the goal, and as no motion: 0.1 degree.
const AT_GOAL_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0;

/// Look the records of a command up.
///
/// # Errors
/// The reason why the command cannot be executed.
pub fn look_up(command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Target, Reason> {
    let plain =
        Target { verb: command.command, end_effector_id: command.end_effector_id, ..Target::default() };
    match command.command {
        PrimVerb::None => Err(Reason::UnknownCommand),
        PrimVerb::Pause | PrimVerb::RobotInit | PrimVerb::CalSensor => Ok(plain),
        PrimVerb::GoThru | PrimVerb::GotoPt | PrimVerb::DeltaMove => motion(plain, command, inputs),
        PrimVerb::GoUntil | PrimVerb::GoWhile => {
            let sensor = *inputs.data.sensor(&command.sensor).ok_or(Reason::UnknownSensor)?;
            motion(Target { sensor, ..plain }, command, inputs)
        }
    }
}

/// Goal and limits of a motion.
fn motion(plain: Target, command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Target, Reason> {
    let goal = goal(command, inputs).ok_or(Reason::BadRecord)?;
    let id = TrajParaId::new(command.trajectory_parameters);
    let para = inputs.data.traj_para(id).ok_or(Reason::BadRecord)?;
    let limits = Limits::from_counts(para.acc_fac, para.vel_max, para.smooth);
    Ok(Target {
        goal: FrameData::from(&goal),
        limits: limits.ok_or(Reason::BadParameters)?,
        brake_distance: inches(para.brk_dst),
        ..plain
    })
}

/// The pose of a command, static or changing, with its movetable applied; `None` if a record is missing.
fn goal(command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Option<Frame> {
    let pose = if command.pose >= pose_range::CHANGING {
        inputs.memory.changing_pose(command.pose)?.to_frame().ok()?
    } else {
        inputs.data.pose(PoseId::new(command.pose))?.frame
    };
    let by = MovtabId::new(command.movetable);
    if by.is_null() { Some(pose) } else { Some(inputs.data.movetable(by)?.apply(&pose)) }
}

/// The state variables of a tick. `sent` is the command to T3I as it was left in the tick before.
pub fn situation(state: &mut State, inputs: &Inputs<'_, TaskData<'_>>, sent: &T3iCommand) -> Situation {
    let (health, pace) = interface(state, inputs, sent);
    let switches = switches(&inputs.external.devices.joystick);
    let posture = posture(state, pace);
    let status = &inputs.memory.t3i.status;
    let running = status.link_running && pace != Pace::Busy && status.frame_feedback.to_frame().is_ok();
    let (arrival, rest) = ends(state, inputs, posture);
    Situation {
        health: if health == Health::Good && switches != Switches::Off { Health::Operator } else { health },
        pace,
        posture,
        link: if running { Link::Running } else { Link::Down },
        passage: if state.motion.is_passing() { Passage::Passing } else { Passage::UnderWay },
        arrival,
        rest,
        guard: guard(state, inputs),
        samples: samples(state, inputs, rest),
        switches,
    }
}

/// How many frame switches of the joystick box are on.
fn switches(joystick: &JoystickBox) -> Switches {
    match joystick.frame.count_ones() {
        0 => Switches::Off,
        1 if Coordinates::of(joystick) != Coordinates::None => Switches::One,
        _ => Switches::Several,
    }
}

/// The sensor of a guarded move.
fn guard(state: &mut State, inputs: &Inputs<'_, TaskData<'_>>) -> Guard {
    let Target { sensor, end_effector_id, .. } = &state.target;
    let reading = if state.target.is_guarded() {
        state.calibration.read(sensor, &inputs.external.devices, *end_effector_id)
    } else {
        Reading::default()
    };
    state.sensed = rounded(reading.value);
    reading.guard
}

/// The readings of CAL-SENSOR: only those of one rest count together.
fn samples(state: &mut State, inputs: &Inputs<'_, TaskData<'_>>, rest: Arrival) -> Samples {
    let force = &inputs.external.devices.force;
    state.calibration.watch_power(force);
    if rest != Arrival::Arrived {
        state.calibration.begin();
    }
    state.calibration.progress(force)
}

/// What the robot was told to do.
pub fn posture(state: &State, pace: Pace) -> Posture {
    if !state.positioned {
        Posture::Unpositioned
    } else if !state.motion.is_at_rest() || state.manual.is_moving() {
        Posture::Moving
    } else if pace != Pace::Finished {
        Posture::Ending
    } else {
        Posture::Standing
    }
}

/// What T3I says, as far as it answers what was sent.
///
/// A point is sent each tick, and its echo comes back two ticks later: while points flow, the echo of the
/// point before counts as well. Any other command must be echoed itself, so that an error from before a
/// RESTART is not taken for one of it.
fn interface(state: &State, inputs: &Inputs<'_, TaskData<'_>>, sent: &T3iCommand) -> (Health, Pace) {
    let t3i = &inputs.memory.t3i;
    let (number, echo) = (state.t3i.number, t3i.status.echo);
    let flowing = sent.command == T3iVerb::Point
        && successor(echo) == number
        && state.t3i.sent == inputs.tick.previous();
    let heard = if flowing { number } else { echo };
    match state.t3i.read(inputs.tick, &t3i.header, heard, Lower::Executing) {
        Lower::Lost => return (Health::Silent, Pace::Busy),
        Lower::Pending => return (orphaned(inputs), Pace::Busy),
        Lower::Executing | Lower::Done | Lower::Error | Lower::Joystick => {}
    }
    let pace = match t3i.status.report {
        T3iReport::Error => return (fault(t3i.status.fault), Pace::Busy),
        // A T3I that is held reads nothing: what is sent to it would be lost.
        _ if t3i.header.republished => Pace::Busy,
        T3iReport::Executing => Pace::Busy,
        T3iReport::Finished if echo == number => Pace::Finished,
        T3iReport::Finished | T3iReport::Ready => Pace::Wanted,
    };
    if state.positioned && !t3i.status.link_running {
        return (Health::LinkOff, Pace::Busy);
    }
    (orphaned(inputs), pace)
}

/// The health that a fault of T3I stands for.
const fn fault(fault: LinkFault) -> Health {
    match fault {
        LinkFault::NotResponding => Health::LinkOff,
        LinkFault::InvalidCommand => Health::Refused,
        LinkFault::None | LinkFault::DepcError | LinkFault::Checksum | LinkFault::NotTransmitted => {
            Health::LinkError
        }
    }
}

/// Good, unless nobody commands Prim any more.
fn orphaned(inputs: &Inputs<'_, TaskData<'_>>) -> Health {
    if inputs.memory.emove.header.stamp == inputs.tick.previous() { Health::Good } else { Health::Orphaned }
}

/// Watch the resolvers after the last point: does the robot rest at the goal, and does it rest at all?
/// Without them the word of T3I must do.
fn ends(state: &mut State, inputs: &Inputs<'_, TaskData<'_>>, posture: Posture) -> (Arrival, Arrival) {
    let status = &inputs.memory.t3i.status;
    let before = core::mem::replace(&mut state.seen, status.resolver_frame);
    if posture != Posture::Standing {
        state.forget_rest();
        return (Arrival::UnderWay, Arrival::UnderWay);
    }
    let seen = status.resolver_frame.to_frame().ok().filter(|_| status.resolver_valid);
    let near = |other: Option<Frame>| match (seen, other) {
        (Some(seen), Some(other)) => {
            let off = seen.distance(&other);
            off.inches <= AT_GOAL_INCHES && off.radians <= AT_GOAL_RADIANS
        }
        (None, _) => true,
        (Some(_), None) => false,
    };
    let at_goal = near(Some(state.target.goal.frame()));
    let unmoved = near(before.to_frame().ok());
    state.finished = state.finished.saturating_add(1);
    state.settled = if at_goal { state.settled.saturating_add(1) } else { 0 };
    state.still = if unmoved { state.still.saturating_add(1) } else { 0 };
    let end = |ticks: u32| {
        if ticks >= SETTLED {
            Arrival::Arrived
        } else if state.finished >= PATIENCE {
            Arrival::Late
        } else {
            Arrival::Settling
        }
    };
    (end(state.settled), end(state.still))
}
