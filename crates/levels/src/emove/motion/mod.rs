//! The motion of the current command: its route, and the commands to Prim.
//!
//! * [`flight`]: execution of the motion from the robot's position;
//! * [`route`]: depart, trajectory, approach and stop as one list of points;
//! * [`relative`]: the short moves at holsters and tool drum.

pub mod flight;
pub mod relative;
pub mod route;

use geometry::pose::Pose;
use interfaces::{
    ChangingPose, CommonMemory, EmoveOutputs,
    emove::{EmoveCommand, RobotPlace, Way},
    pose_range,
    prim::{PrimCommand, PrimReport, PrimVerb},
    track::Track,
};
use rcs_core::{
    Plain,
    handshake::{Commander, Lower},
};
use taskdata::files::{MovtabId, TrajParaId};

use self::{flight::Flight, relative::Relative, route::LegGoal};
use super::{
    EmoveInputs,
    tables::{EmoveContact, Initialization, Pause},
};

/// A GO-UNTIL ends after 1 s of not-detected. The robot is then at rest, and no later contact is expected.
const DETECTION_TICKS: u32 = 25;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Departure,
    Goal,
    Between,
    Located,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveMotion {
    commander: Commander,
    flight: Flight,  // the motion, if the command is a motion command
    undetected: u32, // ticks of not-detected from Prim
    last_pose: u32,  // the last record number of a changing pose
    robot_init: u32, // the last `.R` that was executed
}

impl EmoveMotion {
    /// Ignore an `.R` entered before the first tick.
    pub(super) const fn start(&mut self, robot_init: u32) {
        self.robot_init = robot_init;
    }

    /// Follow the echo until the first command.
    pub(super) fn sense(&mut self, inputs: &EmoveInputs<'_>) {
        let (order, prim) = (&inputs.memory.emove.prim, &inputs.memory.prim.status);
        self.commander.start_from(inputs.tick, order.number, prim.echo);
        let undetected = prim.echo == self.commander.number && prim.report == PrimReport::NotDetected;
        self.undetected = if undetected { self.undetected.saturating_add(1) } else { 0 };
    }

    pub(super) const fn begin(&mut self, flight: Flight) {
        (self.flight, self.undetected) = (flight, 0);
    }

    pub(super) fn status(&self, inputs: &EmoveInputs<'_>) -> Lower {
        self.commander.status_of(inputs.tick, &inputs.memory.prim)
    }

    /// The status of the robot. At a through point it is executing, because it moves to the next point.
    pub(super) fn robot(&self, inputs: &EmoveInputs<'_>) -> Lower {
        match self.status(inputs) {
            Lower::Done if inputs.memory.emove.prim.command == PrimVerb::GoThru => Lower::Executing,
            lower => lower,
        }
    }

    pub(super) fn contact(&self, memory: &CommonMemory) -> EmoveContact {
        match memory.prim.status.report {
            PrimReport::DetectedErr => EmoveContact::Met,
            _ if self.undetected > DETECTION_TICKS => EmoveContact::Missed,
            _ => EmoveContact::Awaited,
        }
    }

    /// Progress of `.R`, which waits until the pause is done.
    pub(super) fn initialization(&self, pause: Pause, inputs: &EmoveInputs<'_>) -> Initialization {
        let is_over = || matches!(self.status(inputs), Lower::Done | Lower::Error);
        if pause != Pause::Standing {
            Initialization::None
        } else if inputs.external.operator.robot_init != self.robot_init {
            Initialization::Asked
        } else if inputs.memory.emove.prim.command == PrimVerb::RobotInit && is_over() {
            Initialization::Over
        } else {
            Initialization::None
        }
    }

    pub(super) const fn flight(&self) -> &Flight {
        &self.flight
    }

    /// The opening at the goal, 0.01 in, and whether it has been commanded; `None` if no opening is required.
    pub(super) fn opening(&self) -> Option<(i32, bool)> {
        let route = self.flight.route.as_ref()?;
        Some((route.opening?, route.opening_sent))
    }

    pub(super) const fn note_opening(&mut self) {
        if let Some(route) = &mut self.flight.route {
            route.opening_sent = true;
        }
    }

    /// Searches renumber the commands (docs/evidence.md).
    pub const fn commander(&mut self) -> &mut Commander {
        &mut self.commander
    }

    /// The route, and the last record number, which searches renumber.
    pub const fn pose_numbers(&mut self) -> (Option<&mut route::Route>, &mut u32) {
        (self.flight.route.as_mut(), &mut self.last_pose)
    }

    pub fn forget_flight(&mut self) {
        self.flight = Flight::default();
    }

    #[must_use]
    pub const fn goal(&self) -> Option<&RobotPlace> {
        match &self.flight.route {
            Some(route) => Some(&route.to),
            None => None,
        }
    }

    pub(super) const fn publish(&mut self, slot: Slot, pose: Pose, outputs: &mut EmoveOutputs) -> u32 {
        self.last_pose = pose_range::next(pose_range::EMOVE, self.last_pose);
        let [departure, goal, between, located] = &mut outputs.poses;
        let record = match slot {
            Slot::Departure => departure,
            Slot::Goal => goal,
            Slot::Between => between,
            Slot::Located => located,
        };
        *record = ChangingPose { number: Some(self.last_pose), pose };
        self.last_pose
    }

    pub(super) fn publish_route(&mut self, outputs: &mut EmoveOutputs) {
        if let Some(mut route) = self.flight.route {
            route.departure = self.publish(Slot::Departure, route.from.pose, outputs);
            route.goal = self.publish(Slot::Goal, route.to.pose, outputs);
            self.flight.route = Some(route);
        }
    }

    pub(super) fn send(&mut self, verb: PrimVerb, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        outputs.prim = PrimCommand {
            number: self.commander.send(inputs.tick),
            command: verb,
            sensor: None,
            pose: 0,
            movetable: MovtabId::NULL,
            trajectory_parameters: TrajParaId::NULL,
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
        };
    }

    pub(super) fn initialize(&mut self, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        self.robot_init = inputs.external.operator.robot_init;
        self.send(PrimVerb::RobotInit, inputs, outputs);
    }

    /// Sends GO-THRU or GOTO-PT with the next point of the route, or back along `track`. Returns the robot's path;
    /// `None` on its return to one. `is_straight` belongs to the retraced path; `rest` is the last commanded pose.
    pub(super) fn send_leg(
        &mut self,
        verb: PrimVerb,
        (track, is_straight, rest): (&Track, bool, Pose),
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) -> Option<Way> {
        let (leg, path) = self.flight.next_leg(track, is_straight, rest, inputs.data);
        let Some(leg) = leg else { return path };
        let (pose, movetable) = match leg.at {
            LegGoal::Record { pose, movetable } => (pose, movetable),
            LegGoal::Computed(frame) => {
                (self.publish(Slot::Between, Pose::from_frame(&frame), outputs), MovtabId::NULL)
            }
        };
        self.send(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = movetable;
        outputs.prim.trajectory_parameters = leg.parameters;
        path
    }

    pub(super) fn send_goal(
        &mut self,
        goal: Pose,
        parameters: TrajParaId,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let record = self.publish(Slot::Goal, goal, outputs);
        self.send(PrimVerb::GotoPt, inputs, outputs);
        outputs.prim.pose = record;
        outputs.prim.trajectory_parameters = parameters;
    }

    /// Send a relative move from a record of POSE. False if the task data lack the move.
    pub(super) fn send_relative(
        &mut self,
        verb: PrimVerb,
        relative: Relative,
        pose: u32,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) -> bool {
        let Some(found) = relative.record(&command.site, inputs.data) else { return false };
        self.send(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = found.movetable;
        outputs.prim.trajectory_parameters = found.para;
        if relative.is_guarded() {
            outputs.prim.sensor = Some(found.sensor);
        }
        self.undetected = 0;
        true
    }
}
