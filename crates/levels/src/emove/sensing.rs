//! Preprocess of E-move: what is held, where the robot is, and the state variables of the tables.

use rcs_core::{
    frame::Frame,
    handshake::Lower,
    interface::{
        CommonMemory,
        device::VisionStatus,
        emove::{EmoveCommand, EmoveVerb},
        prim::{JoystickGrip, PrimReport},
        quick_change::QuickChangeReport,
        subtask::LocationKind,
    },
    name::Name16,
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{LocptId, TaskData};

use super::{
    Emove,
    gripper::Gripper,
    locate::{is_another, is_plausible},
    route::{near, same_location},
    state::{Sort, Stance},
    tables::{
        Held, Holster, Link, Load, Mate, Motion, Readiness, Ring, Sight, Situation, Station, Tooling, Travel,
        Tries, Whereabouts,
    },
};
use crate::{old_execution::Outcome, places::place_of};

/// The robot is no longer where its last move ended if it is more than this many inches …
/// (docs/design/motion.md "Where the robot is")
const LOST_INCHES: f64 = 0.5;
/// … or radians (2 degrees) off.
const LOST_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// Location points that are looked at in a tick to find out where the robot is.
const SEARCH_PER_TICK: u32 = 64;
/// Ticks after which vision counts as silent (4 s).
const VISION_LIMIT: u64 = 100;
/// Pictures of a kind that are taken in vain before LOCATE-OBJ gives up.
const MAX_TRIES: u8 = 3;
/// Ticks for which a GO-UNTIL may stay not-detected (1 s): the robot stands, and what has not come by then
/// does not come.
const PATIENCE: u32 = 25;
/// Bits of the four sensors of a holster (V.1.2).
const HOLSTER_SENSORS: u8 = 0x0F;

/// Where the resolvers say that the robot is.
#[must_use]
pub fn present_frame(memory: &CommonMemory) -> Option<Frame> {
    memory.changing_pose(memory.prim.status.sensor_pose)?.to_frame().ok()
}

/// What the sensors of a gripper's own holster see: parts gripper right, v-gripper left, tool gripper
/// centre (ASSUMED).
fn holster(gripper: u8, memory: &CommonMemory) -> Holster {
    let status = &memory.prim.status;
    let bits = match Gripper::of(gripper) {
        Gripper::None => return Holster::Empty,
        Gripper::Parts => status.holster_right,
        Gripper::V => status.holster_left,
        Gripper::Tool => status.holster_centre,
    };
    match bits & HOLSTER_SENSORS {
        0 => Holster::Empty,
        HOLSTER_SENSORS => Holster::Full,
        _ => Holster::Partial,
    }
}

impl Emove {
    /// What is true whatever the command: neighbours, what is held, where the robot is.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        self.state.prim.start(memory.prim.status.echo);
        self.state.grippers.start(memory);
        self.state.quick_change.start(memory.quick_change.status.echo);
        self.state.vision.start(inputs.external.devices.vision.echo);

        self.sense_held(inputs);
        let prim = &memory.prim.status;
        let answers = prim.echo == self.state.prim.number;
        self.state.undetected = if answers && prim.report == PrimReport::NotDetected {
            self.state.undetected.saturating_add(1)
        } else {
            0
        };
        let Some(present) = present_frame(memory) else { return };
        let stance = &mut self.state.stance;
        let there = |pose: &Pose| {
            pose.to_frame().is_ok_and(|frame| near(&frame, &present, LOST_INCHES, LOST_RADIANS))
        };
        stance.known &= there(&stance.pose);
        let pausing = memory.subtask.emove.command == EmoveVerb::Pause
            && matches!(self.state.execution.outcome, Outcome::Executing | Outcome::Done | Outcome::Joystick);
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
        let gripper = state.grippers.status(inputs.tick, memory);
        let ring = self.ring(inputs);
        Situation {
            ahead: state.route.ahead(inputs.data),
            prim: if starting { Lower::Done } else { commanded_prim },
            travel: match commanded_prim {
                Lower::Pending | Lower::Executing if state.undetected > PATIENCE => Travel::Missed,
                Lower::Pending | Lower::Executing => Travel::UnderWay,
                Lower::Done => Travel::Over,
                Lower::Error | Lower::Joystick | Lower::Lost => Travel::Failed,
            },
            gripper,
            readiness: match gripper {
                Lower::Pending | Lower::Executing => Readiness::Busy,
                Lower::Done if Gripper::attached(memory).is_raw(memory) => Readiness::Raw,
                Lower::Done => Readiness::Ready,
                Lower::Error | Lower::Joystick | Lower::Lost => Readiness::Faulty,
            },
            opening: self.opening(gripper, inputs),
            held: if state.held.object.is_empty() {
                Held::Nothing
            } else if state.held.object == command.object {
                Held::Right
            } else {
                Held::Other
            },
            load: if state.carrying && state.held.object.is_empty() { Load::Lost } else { Load::Kept },
            fingers: self.fingers(command, inputs),
            spread: self.spread(gripper, command, inputs),
            button: match prim.status.joystick_grip {
                pressed if pressed == state.button => JoystickGrip::None,
                pressed => pressed,
            },
            link: if prim.status.link_running { Link::Up } else { Link::Down },
            tooling: self.tooling(ring, gripper, memory),
            mate: match memory.quick_change.status.end_effector_id {
                0 => Mate::None,
                id if id == command.end_effector_id => Mate::Right,
                _ => Mate::Wrong,
            },
            ring,
            holster: holster(command.end_effector_id, memory),
            whereabouts: if state.stance.known {
                Whereabouts::Known
            } else if inputs.data.locpt(LocptId::new(state.searched.saturating_add(1))).is_some() {
                Whereabouts::Searching
            } else {
                Whereabouts::Unknown
            },
            station: self.station(command),
            sight: self.sight(inputs),
            tries: if state.tries.saturating_add(1) < MAX_TRIES { Tries::Left } else { Tries::Spent },
        }
    }

    /// Where the robot is, seen from the command's location.
    fn station(&self, command: &EmoveCommand) -> Station {
        let stance = &self.state.stance;
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        match stance.sort {
            _ if !stance.known || !same_location(&stance.place(), &place) => Station::Elsewhere,
            Sort::Drum => Station::InDrum,
            Sort::Location | Sort::Object | Sort::View => Station::There,
        }
    }

    /// What Quick Change says of its ring to the last command.
    fn ring(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Ring {
        let ring = &inputs.memory.quick_change;
        let report = ring.status.report;
        match self.state.quick_change.read(inputs.tick, &ring.header, ring.status.echo, report.lower()) {
            Lower::Pending | Lower::Executing => Ring::Busy,
            Lower::Error | Lower::Joystick | Lower::Lost => Ring::Faulty,
            Lower::Done => match report {
                QuickChangeReport::Locked => Ring::Locked,
                QuickChangeReport::Unlocked => Ring::Unlocked,
                QuickChangeReport::Idle
                | QuickChangeReport::Executing
                | QuickChangeReport::SensorMalfunction
                | QuickChangeReport::Stuck => Ring::Busy,
            },
        }
    }

    /// Quick change and gripper while pausing. Grip's PAUSE is done only when a calibration at the start is
    /// (VI.3.1 UP-INIT); with no gripper, or one that has come since, there is nothing to wait for.
    fn tooling(&self, ring: Ring, gripper: Lower, memory: &CommonMemory) -> Tooling {
        let asked = self.state.grippers.to == Gripper::attached(memory);
        match (ring, gripper) {
            (Ring::Faulty, _) => Tooling::RingFaulty,
            (Ring::Busy, _) => Tooling::Busy,
            (Ring::Locked | Ring::Unlocked, Lower::Error | Lower::Joystick | Lower::Lost) if asked => {
                Tooling::GripFaulty
            }
            (Ring::Locked | Ring::Unlocked, Lower::Pending | Lower::Executing) => Tooling::Busy,
            (Ring::Locked | Ring::Unlocked, _) => Tooling::Ready,
        }
    }

    fn sight(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Sight {
        let answer = &inputs.external.devices.vision;
        let request = &inputs.memory.emove.vision;
        let answered = answer.echo == self.state.vision.number;
        match answer.status {
            VisionStatus::Done if answered && !is_plausible(request, answer) => Sight::Implausible,
            VisionStatus::Done if answered && is_another(request, answer) => Sight::Unrecognised,
            VisionStatus::Done if answered => Sight::Seen,
            VisionStatus::NothingSeen if answered => Sight::Missing,
            VisionStatus::NotRecognised if answered => Sight::Unrecognised,
            _ if inputs.tick.since(self.state.vision.sent) > VISION_LIMIT => Sight::Silent,
            _ => Sight::Waiting,
        }
    }
}
