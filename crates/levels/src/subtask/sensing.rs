//! Preprocess of Subtask: its state variables, from the statuses of E-move and of the Active Pedestal.

use rcs_core::{
    handshake::Lower,
    interface::{SubtaskOutputs, emove::EmoveVerb, pedestal::PedestalReport, subtask::SubtaskCommand},
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    Subtask,
    state::Grasp,
    tables::{GripHeld, Gripper, Hand, Held, Named, Pedestal, Situation, Vision},
};
use crate::places::place_of;

impl Subtask {
    /// What is true whatever the command: the neighbours, and how the held object was taken.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &SubtaskOutputs) {
        let emove = &inputs.memory.emove.status;
        self.state.emove.start(emove.echo);
        self.state.pedestal.start(inputs.memory.pedestal.status.echo);
        let taken = matches!(outputs.emove.command, EmoveVerb::GraspObj | EmoveVerb::AcquireTool)
            && self.emove(inputs) == Lower::Done
            && emove.held_object == outputs.emove.object;
        if !emove.object_held {
            self.state.grasp = Grasp::default();
        } else if taken {
            self.state.grasp = Grasp { object: emove.held_object, grip: outputs.emove.grip };
        }
    }

    /// Set the state variables.
    pub(super) fn situation(&self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let emove = &inputs.memory.emove.status;
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let view = inputs.data.view(&command.object, &place).is_some_and(|(_, view)| view.enabled);
        Situation {
            emove: self.emove(inputs),
            held: if !emove.object_held {
                Held::Nothing
            } else if emove.held_object == command.object {
                Held::Right
            } else {
                Held::Other
            },
            grip: self.grip_held(command),
            vision: if view { Vision::Needed } else { Vision::NotNeeded },
            gripper: if emove.end_effector_id == 0 {
                Gripper::None
            } else if command.end_effector_id == 0 || command.end_effector_id == emove.end_effector_id {
                Gripper::Right
            } else {
                Gripper::Wrong
            },
            named: if command.object.is_empty() { Named::Location } else { Named::Object },
            pedestal: self.pedestal(inputs),
            hand: if inputs.memory.pedestal.status.grip_size > self.state.ped_para.grasp_size {
                Hand::Gripping
            } else {
                Hand::Empty
            },
        }
    }

    fn emove(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        let emove = &inputs.memory.emove;
        self.state.emove.read(inputs.tick, &emove.header, emove.status.echo, emove.status.report.lower())
    }

    fn grip_held(&self, command: &SubtaskCommand) -> GripHeld {
        let Grasp { object, grip } = self.state.grasp;
        if object.is_empty() || object != command.object {
            GripHeld::Unknown
        } else if grip == command.destination_grip {
            GripHeld::Destination
        } else if grip == command.source_grip {
            GripHeld::Source
        } else {
            GripHeld::Neither
        }
    }

    fn pedestal(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Pedestal {
        let pedestal = &inputs.memory.pedestal;
        let status = &pedestal.status;
        match self.state.pedestal.read(inputs.tick, &pedestal.header, status.echo, status.report.lower()) {
            Lower::Pending | Lower::Executing => Pedestal::Moving,
            Lower::Done => Pedestal::Done,
            Lower::Error | Lower::Joystick if status.report == PedestalReport::CannotDo => Pedestal::Cannot,
            Lower::Error | Lower::Joystick => Pedestal::Faulty,
            Lower::Lost => Pedestal::Silent,
        }
    }
}
