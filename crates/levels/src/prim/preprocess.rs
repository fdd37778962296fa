//! Preprocess: input buffers become state variables.

use rcs_core::{
    frame::Frame,
    handshake::{Lower, successor},
    interface::{
        Reason, pose_range,
        prim::{PrimCommand, PrimVerb},
        t3i::{LinkFault, T3iCommand, T3iReport, T3iVerb},
    },
    process::Inputs,
    units::inches,
};
use taskdata::files::{MovtabId, PoseId, TaskData, TrajParaId};

use super::{
    motion::{limits::Limits, segment::FrameData},
    state::{State, Target},
    tables::{Arrival, Health, Link, Pace, Passage, Posture, Situation},
};

/// Ticks in a row that the robot must rest at the goal (DESIGN 16 "Done").
const SETTLED: u32 = 3;
/// Ticks after the last point in which it must have come to rest: 2 s (DESIGN 16 "Done").
const PATIENCE: u32 = 50;
/// Inches that count as at the goal.
const AT_GOAL_INCHES: f64 = 0.02;
/// Radians that count as at the goal: 0.1 degree.
const AT_GOAL_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0;

/// Look the records of a command up.
///
/// # Errors
/// The reason why the command cannot be executed.
pub fn look_up(command: &PrimCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Target, Reason> {
    match command.command {
        PrimVerb::None
        | PrimVerb::GoUntil
        | PrimVerb::GoWhile
        | PrimVerb::DeltaMove
        | PrimVerb::CalSensor => Err(Reason::UnknownCommand),
        PrimVerb::Pause | PrimVerb::RobotInit => Ok(Target { verb: command.command, ..Target::default() }),
        PrimVerb::GoThru | PrimVerb::GotoPt => {
            let goal = goal(command, inputs).ok_or(Reason::BadRecord)?;
            let id = TrajParaId::new(command.trajectory_parameters);
            let para = inputs.data.traj_para(id).ok_or(Reason::BadRecord)?;
            let limits = Limits::from_counts(para.acc_fac, para.vel_max, para.smooth);
            Ok(Target {
                verb: command.command,
                goal: FrameData::from(&goal),
                limits: limits.ok_or(Reason::BadParameters)?,
                brake_distance: inches(para.brk_dst),
            })
        }
    }
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
    let posture = posture(state, pace);
    let status = &inputs.memory.t3i.status;
    let running = status.link_running && pace != Pace::Busy && status.frame_feedback.to_frame().is_ok();
    Situation {
        health,
        pace,
        posture,
        link: if running { Link::Running } else { Link::Down },
        passage: if state.motion.is_passing() { Passage::Passing } else { Passage::UnderWay },
        arrival: arrival(state, inputs, posture),
    }
}

/// What the robot was told to do.
pub fn posture(state: &State, pace: Pace) -> Posture {
    if !state.positioned {
        Posture::Unpositioned
    } else if !state.motion.is_at_rest() {
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

/// Watch the resolvers after the last point. Without them the word of T3I must do.
fn arrival(state: &mut State, inputs: &Inputs<'_, TaskData<'_>>, posture: Posture) -> Arrival {
    if posture != Posture::Standing {
        (state.finished, state.settled) = (0, 0);
        return Arrival::UnderWay;
    }
    let status = &inputs.memory.t3i.status;
    let near = match status.resolver_frame.to_frame() {
        Ok(frame) if status.resolver_valid => {
            let off = frame.distance(&state.target.goal.frame());
            off.inches <= AT_GOAL_INCHES && off.radians <= AT_GOAL_RADIANS
        }
        _ => true,
    };
    state.finished = state.finished.saturating_add(1);
    state.settled = if near { state.settled.saturating_add(1) } else { 0 };
    if state.settled >= SETTLED {
        Arrival::Arrived
    } else if state.finished >= PATIENCE {
        Arrival::Late
    } else {
        Arrival::Settling
    }
}
