//! The status to Subtask, and the estimates: outputs that a restarted E-move adopts.

use interfaces::{
    EmoveOutputs, Reason, StatusReport, Unconfirmed,
    emove::{EmoveStatus, EmoveVerb, Estimates, Offset, Pins},
    operator::{Variable, Write},
    prim::PrimReport,
};
use rcs_core::handshake::Lower;

use super::{
    EmoveInputs, State,
    grasp::named_grasp,
    gripper::EmoveGripper,
    localization::returning::offset_of_place,
    robot_place::{present_frame, standing},
};
use crate::execution::Outcome;

impl State {
    #[must_use]
    pub fn estimates(&self) -> Estimates {
        let mut estimates = Estimates::default();
        self.write_to(&mut estimates);
        estimates
    }

    fn write_to(&self, estimates: &mut Estimates) {
        self.held.write_to(estimates);
        self.exchange.write_to(estimates);
        self.drum.write_to(estimates);
        self.localization.write_to(estimates);
        self.vision.write_to(estimates);
    }

    pub fn adopt(&mut self, estimates: &Estimates) {
        self.held.adopt(estimates);
        self.exchange.adopt(estimates);
        self.drum.adopt(estimates);
        self.localization.adopt(estimates);
        self.vision.adopt(estimates);
    }

    /// `joystick-on` lasts as long as the box is active (V.2.2), and E-PAUSE keeps it until the processes below pause
    /// again. An interrupted command ends in an error and is not resumed (docs/design/ownership.md "Joystick box").
    fn outcome(&self, inputs: &EmoveInputs<'_>) -> (StatusReport, Reason, Unconfirmed) {
        let prim = &inputs.memory.prim;
        let taken =
            prim.status.report == PrimReport::JoystickOn && prim.header.stamp == inputs.tick.previous();
        let pauses = inputs.memory.subtask.emove.command == EmoveVerb::Pause;
        let has_failed = || self.motion.status(inputs) == Lower::Error;
        let below = || if has_failed() { prim.status.reason } else { Reason::None };
        let ended = self.execution.report(pauses.then(below));
        match (taken, ended.outcome) {
            (true, Outcome::Done | Outcome::Joystick) => {
                (StatusReport::JoystickOn, Reason::JoystickOn, Unconfirmed::None)
            }
            (false, Outcome::Joystick) if pauses => {
                (StatusReport::JoystickOn, Reason::JoystickOn, Unconfirmed::None)
            }
            (false, Outcome::Joystick) => (StatusReport::Error, Reason::JoystickOn, Unconfirmed::None),
            _ => (ended.outcome.report(), ended.reason, ended.unconfirmed),
        }
    }

    pub(super) fn report(&self, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        let memory = inputs.memory;
        let present = present_frame(memory);
        let (holding, place) = (self.holding(memory), self.localization.place());
        let (report, reason, unconfirmed) = self.outcome(inputs);
        outputs.header = self.execution.rows.header(inputs.tick, self.step.text());
        outputs.dormant = EmoveGripper::attached(memory).dormancy();
        self.write_to(&mut outputs.estimates);
        outputs.nearest = self.localization.surroundings().nearest;
        outputs.status = EmoveStatus {
            echo: self.execution.receiver.echo,
            report,
            reason,
            unconfirmed,
            reference_pose: memory.prim.status.sensor_pose,
            held: holding,
            seat: self.held.seat(),
            placed: self.held.placed(),
            located: self.vision.located(),
            end_effector_id: self.exchange.end_effector_id(memory),
            pins: if self.exchange.is_misread(memory) { Pins::Differ } else { Pins::Agree },
            at: place.map(standing),
            offset: place
                .map_or(Offset::None, |place| offset_of_place(place, present.as_ref(), holding, inputs)),
            exchange: self.exchange.changing(memory),
            drum: self.drum.is_around_tool(
                self.localization.last_place(),
                self.held.held().is_some(),
                inputs,
            ),
        };
    }

    /// E-move was not stepped in the previous tick. Its state and its outputs contain the same estimates, unless it was
    /// restarted and adopts those of the outputs.
    pub(super) fn write(&mut self, write: &Write, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        self.adopt(&outputs.estimates);
        match (write.variable, write.object) {
            (Variable::Placed, _) => self.held.forget_placed(),
            (Variable::Located, _) => self.vision.forget(),
            (Variable::Held, None) => self.held.name(None),
            (Variable::Held, Some(object)) => {
                if let Some(grasped) = named_grasp(object, write.grip, inputs) {
                    self.hold(grasped);
                    self.held.name(Some(grasped));
                }
            }
            _ => {}
        }
        self.write_to(&mut outputs.estimates);
    }
}
