//! Preprocess of E-move: what is held, where the robot is, and the state variables of the tables.

use rcs_core::{
    frame::Frame,
    handshake::Lower,
    interface::{
        CommonMemory, device::VisionStatus, emove::EmoveCommand, emove::EmoveVerb, subtask::LocationKind,
    },
    name::Name16,
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{EndEffId, LocptId, TaskData};

use super::{
    Emove,
    route::near,
    state::{Held as HeldObject, Sort, Stance},
    tables::{Fingers, Held, Link, Motion, Opening, Sight, Situation, Tooling, Tries, Whereabouts},
};
use crate::execution::Outcome;

/// The robot is no longer where its last move ended if it is more than this many inches … (DESIGN 16 "Where the robot is")
const LOST_INCHES: f64 = 0.5;
/// … or radians (2 degrees) off.
const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// Location points that are looked at in a tick to find out where the robot is.
const SEARCH_PER_TICK: u32 = 64;
/// Ticks after which vision counts as silent (4 s).
const VISION_LIMIT: u64 = 100;
/// Pictures of a kind that are taken in vain before LOCATE-OBJ gives up.
const MAX_TRIES: u8 = 3;
/// Id of the parts gripper (III.3.6).
const PARTS_GRIPPER: u8 = 1;

/// Where the resolvers say that the robot is.
#[must_use]
pub fn present_frame(memory: &CommonMemory) -> Option<Frame> {
    memory.changing_pose(memory.prim.status.sensor_pose)?.to_frame().ok()
}

impl Emove {
    /// What is true whatever the command: neighbours, what is held, where the robot is.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        self.state.prim.start(memory.prim.status.echo);
        self.state.grip.start(memory.grip.status.echo);
        self.state.quick_change.start(memory.quick_change.status.echo);
        self.state.vision.start(inputs.external.devices.vision.echo);

        let held = &mut self.state.held;
        // A gripper that was restarted knows no opening: what was held is not lost for that.
        let grip = &memory.grip.status;
        if !held.object.is_empty() && grip.initialized && grip.position <= held.grasp_size {
            *held = HeldObject::default();
        }
        let Some(present) = present_frame(memory) else { return };
        let stance = &mut self.state.stance;
        let there = |pose: &Pose| {
            pose.to_frame().is_ok_and(|frame| near(&frame, &present, LOST_INCHES, LOST_RADIANS))
        };
        stance.known &= there(&stance.pose);
        let pausing = memory.subtask.emove.command == EmoveVerb::Pause
            && self.state.execution.outcome == Outcome::Executing;
        if pausing && !stance.known {
            self.search(&present, inputs.data);
        }
    }

    /// Look through some more location points for the one at which the robot stands.
    fn search(&mut self, present: &Frame, data: &TaskData<'_>) {
        for _ in 0..SEARCH_PER_TICK {
            let next = LocptId::new(self.state.searched.saturating_add(1));
            let Some(locpt) = data.locpt(next) else { return };
            self.state.searched = next.number();
            if near(&locpt.frame, present, LOST_INCHES, LOST_RADIANS) {
                self.state.stance = Stance {
                    known: true,
                    sort: Sort::Location,
                    location: locpt.name,
                    kind: LocationKind::Point,
                    record: next.number(),
                    array: 0,
                    object: Name16::EMPTY,
                    grip: 0,
                    pose: Pose::from_frame(present),
                };
                return;
            }
        }
    }

    /// Set the state variables.
    pub(super) fn situation(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let memory = inputs.memory;
        let state = &self.state;
        let starting = state.execution.step == Motion::Start.code();
        let prim = &memory.prim;
        let commanded_prim =
            state.prim.read(inputs.tick, &prim.header, prim.status.echo, prim.status.report.lower());
        let grip = self.grip(inputs);
        Situation {
            ahead: state.route.ahead(inputs.data),
            prim: if starting { Lower::Done } else { commanded_prim },
            grip,
            opening: self.opening(grip, inputs.data),
            held: if state.held.object.is_empty() {
                Held::Nothing
            } else if state.held.object == command.object {
                Held::Right
            } else {
                Held::Other
            },
            fingers: self.fingers(command, inputs),
            link: if prim.status.link_running { Link::Up } else { Link::Down },
            tooling: self.tooling(inputs),
            whereabouts: if state.stance.known {
                Whereabouts::Known
            } else if inputs.data.locpt(LocptId::new(state.searched.saturating_add(1))).is_some() {
                Whereabouts::Searching
            } else {
                Whereabouts::Unknown
            },
            sight: self.sight(inputs),
            tries: if state.tries.saturating_add(1) < MAX_TRIES { Tries::Left } else { Tries::Spent },
        }
    }

    fn grip(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        let grip = &inputs.memory.grip;
        self.state.grip.read(inputs.tick, &grip.header, grip.status.echo, grip.status.report.lower())
    }

    fn opening(&self, grip: Lower, data: &TaskData<'_>) -> Opening {
        let route = &self.state.route;
        if route.opening < 0 {
            Opening::Set
        } else if !route.opening_sent {
            if route.departing(data) { Opening::Departing } else { Opening::Due }
        } else {
            match grip {
                Lower::Pending | Lower::Executing => Opening::Moving,
                Lower::Done => Opening::Set,
                Lower::Error | Lower::Joystick | Lower::Lost => Opening::Failed,
            }
        }
    }

    fn fingers(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Fingers {
        let grasp_size =
            inputs.data.end_eff(EndEffId::new(command.object_parameters)).map_or(0, |p| p.grasp_size);
        if inputs.memory.grip.status.position > grasp_size { Fingers::Gripping } else { Fingers::Empty }
    }

    fn tooling(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Tooling {
        let ring = &inputs.memory.quick_change;
        let ring_lower = self.state.quick_change.read(
            inputs.tick,
            &ring.header,
            ring.status.echo,
            ring.status.report.lower(),
        );
        let grip = self.grip(inputs);
        match (ring_lower, grip) {
            (Lower::Error | Lower::Joystick | Lower::Lost, _) => Tooling::RingFaulty,
            (Lower::Pending | Lower::Executing, _) => Tooling::Busy,
            (Lower::Done, _) if ring.status.end_effector_id != PARTS_GRIPPER => Tooling::Ready,
            (Lower::Done, Lower::Error | Lower::Joystick | Lower::Lost) => Tooling::GripFaulty,
            (Lower::Done, Lower::Pending | Lower::Executing) => Tooling::Busy,
            // At the start Grip's PAUSE is done only when the calibration is (VI.3.1 UP-INIT).
            (Lower::Done, Lower::Done) => Tooling::Ready,
        }
    }

    fn sight(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Sight {
        let answer = &inputs.external.devices.vision;
        let answered = answer.echo == self.state.vision.number;
        match answer.status {
            VisionStatus::Done if answered => Sight::Seen,
            VisionStatus::NothingSeen if answered => Sight::Missing,
            VisionStatus::NotRecognised if answered => Sight::Unrecognised,
            _ if inputs.tick.since(self.state.vision.sent) > VISION_LIMIT => Sight::Silent,
            _ => Sight::Waiting,
        }
    }
}
