use geometry::frame::Frame;
use interfaces::{
    CommonMemory, EmoveOutputs,
    emove::{EmoveCommand, EmoveVerb, Grasped, Holding},
    prim::PrimVerb,
    quick_change::QuickChangeVerb,
};
use rcs_core::handshake::Lower;

use super::{
    EmoveInputs, State,
    gripper::EmoveGripper,
    grippers::FingerVerb,
    robot_place::present_frame,
    senses::Senses,
    tables::{
        EmoveOpening, Pause, PlaceKnowledge, Records, Request, Situation, StateVariables, Step, Subordinates,
        Watch,
        e_pause::EPauseStep,
        known, number,
        search::{Look, search},
    },
};
use crate::{
    execution::Asked,
    halt::{Above, Advance, Below, BoxState, Intake, Kind, Replaced},
};

/// True if the fingers are at `opening`, 0.01 in, and no air moves them from there.
fn stands_at(opening: i32, memory: &CommonMemory) -> bool {
    let attached = EmoveGripper::attached(memory);
    let goes = attached.has_air(!attached.closes_for(opening), memory);
    attached != EmoveGripper::None && attached.stands_at(opening, memory) && !goes
}

impl State {
    pub(super) fn sense(&mut self, inputs: &EmoveInputs<'_>, outputs: &EmoveOutputs) -> StateVariables {
        let command = &inputs.memory.subtask.emove;
        if !self.execution.receiver.started {
            self.start(inputs, outputs);
        }
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        self.sense_neighbours(inputs);
        self.localization.sense_path(inputs.memory, inputs.data);
        self.vision.sense(inputs.memory);
        let present = present_frame(inputs.memory);
        self.sense_held(command, present.is_some(), inputs);
        let watch = self.sense_place(command, present.as_ref(), inputs);
        self.exchange.sense(inputs);
        self.sense_drum(inputs);
        let replaced = self.replaced(&watch, inputs);
        let at_rest = replaced.below == Below::AtRest || replaced.joystick == BoxState::On;
        let (request, records) = if asked == Asked::Now && (at_rest || replaced.kind == Kind::Pause) {
            self.look_up(command, (replaced.joystick, watch.pause), inputs)
        } else {
            (Request::default(), Records::default())
        };
        let subordinates = self.subordinates(command, inputs);
        let senses = Senses::new(self, command, inputs, &subordinates);
        let situation = Situation::sense(command.command, &senses);
        let proof = self.proof(&senses, present.as_ref(), command, inputs, outputs);
        let seen = StateVariables {
            arrival,
            verb: command.command,
            asked,
            replaced,
            advance: if self.motion.flight().progress() == self.ordered_at {
                Advance::None
            } else {
                Advance::Made
            },
            request,
            records,
            watch,
            subordinates,
            proof,
            situation,
        };
        self.grippers.note_button(inputs.memory);
        seen
    }

    /// Adopt the estimates from before a restart.
    fn start(&mut self, inputs: &EmoveInputs<'_>, outputs: &EmoveOutputs) {
        let memory = inputs.memory;
        self.motion.start(inputs.external.operator.robot_init);
        self.adopt(&outputs.estimates);
        // The gripper may have changed in the meantime; pins that read none may belong to an attached gripper.
        let (before, now) =
            (EmoveGripper::of(outputs.status.end_effector_id), EmoveGripper::attached(memory));
        let is_same = now == EmoveGripper::None || now == before;
        self.exchange.adopt_gripper(if is_same { before } else { EmoveGripper::None });
        self.grippers.adopt(memory);
        self.held.start(self.grippers.order());
    }

    fn replaced(&self, watch: &Watch, inputs: &EmoveInputs<'_>) -> Replaced {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let written = &memory.emove;
        let robot = self.motion.robot(inputs);
        let fingers = self.grippers.status(tick, memory);
        let ring = self.exchange.status(tick, memory);
        let below = Below::of(robot, written.prim.command == PrimVerb::Pause)
            .and(Below::of(fingers, self.grippers.order() == FingerVerb::Pause))
            .and(Below::of(ring, written.quick_change.command == QuickChangeVerb::Pause));
        Replaced {
            intake: Intake::Taken,
            kind: if watch.pause == Pause::Other { Kind::Other } else { Kind::Pause },
            above: Above::of(&memory.subtask.header, tick),
            joystick: if robot == Lower::Joystick { BoxState::On } else { BoxState::Off },
            below,
        }
    }

    fn sense_neighbours(&mut self, inputs: &EmoveInputs<'_>) {
        self.motion.sense(inputs);
        self.grippers.start(inputs.tick, inputs.memory);
        self.exchange.start(inputs.tick, inputs.memory);
        self.vision.start(&inputs.external.devices.vision);
    }

    fn sense_held(&mut self, command: &EmoveCommand, is_sensed: bool, inputs: &EmoveInputs<'_>) {
        let (memory, robot) = (inputs.memory, &self.localization);
        if self.exchange.is_misread(memory) {
            return;
        }
        self.held.sense_loss(robot.place(), &self.grippers, inputs);
        self.held.sense_seat((robot.origin(), robot.ends()), self.drum.half_way(), is_sensed, memory);
        if self.exchange.sense_gripper(memory) {
            self.held.note_gripper(memory);
            self.grippers.note_gripper(memory);
        }
        if let Some(grasped) = self.held.sense_grasp(command, &self.grippers, &self.execution, inputs) {
            self.hold(grasped);
        }
        if self.held.held().is_none() {
            self.localization.note_empty_fingers();
        }
    }

    /// An earlier release or located place of the object is no longer valid.
    pub(super) fn hold(&mut self, grasped: Grasped) {
        self.held.hold(grasped, self.localization.place());
        self.vision.forget();
    }

    pub(super) fn holding(&self, memory: &CommonMemory) -> Holding {
        self.held.holding(self.exchange.is_misread(memory), memory)
    }

    pub(super) fn is_releasing(&self) -> bool {
        self.held.is_releasing(self.localization.place().is_some())
    }

    pub(super) fn place_knowledge(&self, inputs: &EmoveInputs<'_>) -> PlaceKnowledge {
        let is_moving = matches!(self.motion.robot(inputs), Lower::Pending | Lower::Executing);
        let is_half_way = self.exchange.is_half_done() || self.drum.half_way().is_some();
        self.localization.knowledge(is_moving, is_half_way, inputs)
    }

    /// [`search`] decides whether to search for the robot's place.
    fn sense_place(
        &mut self,
        command: &EmoveCommand,
        present: Option<&Frame>,
        inputs: &EmoveInputs<'_>,
    ) -> Watch {
        if let Some(present) = present {
            self.localization.sense_place(present);
        }
        let pause = match (command.command, self.step) {
            (
                EmoveVerb::Pause,
                Step::EPause(EPauseStep::Standing | EPauseStep::Led | EPauseStep::Resting),
            ) => Pause::Standing,
            (EmoveVerb::Pause, _) => Pause::UnderWay,
            _ => Pause::Other,
        };
        let watch = Watch {
            initialization: self.motion.initialization(pause, inputs),
            pause,
            outcome: self.execution.outcome,
            place: self.place_knowledge(inputs),
            resolvers: known(present.is_some()),
        };
        self.localization.sense_track(watch.place, inputs.memory);
        self.localization.sense_surroundings(watch.place, present, inputs.data);
        let decision = search(self.step, &watch);
        self.execution.rows.beside(&decision.of(number::SEARCH));
        match (decision.action, present) {
            (Look::Look, Some(present)) => self.localization.search(present, inputs.data),
            (Look::Look, None) | (Look::Rest, _) => {}
        }
        watch
    }

    fn sense_drum(&mut self, inputs: &EmoveInputs<'_>) {
        if self.drum.sense_moved_tool(self.localization.last_place(), inputs) {
            self.localization.set_place(None);
        }
        let grasped_at = self.held.grasped_at();
        let stands = self.drum.sense(grasped_at, &mut self.execution, inputs);
        if stands.is_some() {
            self.localization.set_place(stands);
        }
    }

    fn subordinates(&self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> Subordinates {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let gripper = self.grippers.status(tick, memory);
        Subordinates {
            verb: command.command,
            load: self.held.load(self.exchange.is_misread(memory)),
            ordered: self.ordered,
            prim: if self.uses_prim { self.motion.status(inputs) } else { Lower::Done },
            contact: self.motion.contact(memory),
            opening: self.opening(gripper, inputs),
            gripper,
            ring: self.exchange.ring(tick, memory),
            vision: self.vision.answer(inputs),
        }
    }

    /// During a release no opening is ordered.
    fn opening(&self, gripper: Lower, inputs: &EmoveInputs<'_>) -> EmoveOpening {
        match self.motion.opening() {
            None => EmoveOpening::Free,
            Some(_) if self.is_releasing() => EmoveOpening::Free,
            Some((_, true)) => EmoveOpening::Sent,
            Some((opening, false)) if gripper == Lower::Done && stands_at(opening, inputs.memory) => {
                EmoveOpening::Reached
            }
            Some((_, false)) => EmoveOpening::Due,
        }
    }
}
