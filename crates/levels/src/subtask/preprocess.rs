//! Preprocess of Subtask: its state variables, from the statuses of E-move and of the Active Pedestal.

use rcs_core::{
    handshake::{Arrival, Lower},
    interface::{
        SubtaskOutputs,
        emove::{EmoveCommand, EmoveVerb},
        pedestal::PedestalReport,
        subtask::{SubtaskCommand, SubtaskVerb},
    },
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    aims::Aims,
    state::{Grasp, State},
    tables::{
        GripHeld, Gripper, Hand, Held, Named, Ordered, Orders, Pedestal, PedestalData, Request, Seen,
        Situation, Vision,
    },
};
use crate::{
    execution::{Asked, Work},
    places::{Missing, place_of},
};

impl State {
    /// Read the inputs of a tick.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &SubtaskOutputs) -> Seen {
        let command = &inputs.memory.task.subtask;
        self.emove.start(inputs.memory.emove.status.echo);
        self.pedestal.start(inputs.memory.pedestal.status.echo);
        self.sense_grasp(inputs, outputs);
        let arrival = self.execution.receiver.observe(command.number);
        let request =
            if arrival == Arrival::New { self.look_up(command, inputs) } else { Request::default() };
        Seen {
            arrival,
            verb: command.command,
            request,
            orders: Orders {
                ordered: self.ordered,
                emove: self.emove(inputs),
                pedestal: self.pedestal(inputs),
            },
            situation: self.situation(command, inputs),
        }
    }

    /// How the held object was taken.
    fn sense_grasp(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &SubtaskOutputs) {
        let emove = &inputs.memory.emove.status;
        let taken = matches!(outputs.emove.command, EmoveVerb::GraspObj | EmoveVerb::AcquireTool)
            && self.emove(inputs) == Lower::Done
            && emove.held == Some(outputs.emove.object);
        if emove.held.is_none() {
            self.grasp = None;
        } else if taken {
            let EmoveCommand { object, grip, .. } = outputs.emove;
            self.grasp = Some(Grasp { object, grip }).filter(|grasp| !grasp.object.is_empty());
        }
    }

    /// Look up what a new command needs beside the location that Task names: the locations that Subtask names itself, and for FIX-GRIP how
    /// the pedestal takes the object. What is complete is kept.
    fn look_up(&mut self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Request {
        self.ordered = Ordered::Nothing;
        let attached = inputs.memory.emove.status.end_effector_id;
        let aims = Aims::new(command, attached, inputs.data);
        let ped_para = match command.command {
            SubtaskVerb::FixGrip => inputs.data.ped_para(&command.object).map(|(_, para)| *para),
            _ => None,
        };
        if let Ok(aims) = aims {
            self.aims = aims;
            self.ped_para = ped_para.unwrap_or_default();
        }
        Request {
            asked: Asked::Now,
            verb: command.command,
            named: named(command),
            pedestal: if ped_para.is_some() { PedestalData::Found } else { PedestalData::Missing },
            missing: aims.err().unwrap_or(Missing::Nothing),
        }
    }

    /// Set the state variables.
    fn situation(&self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let emove = &inputs.memory.emove.status;
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let view = inputs.data.view(&command.object, &place).is_some_and(|(_, view)| view.enabled);
        Situation {
            work: Work::Busy,
            held: match emove.held {
                None => Held::Nothing,
                Some(held) if held == command.object => Held::Right,
                Some(_) => Held::Other,
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
            named: named(command),
            hand: if inputs.memory.pedestal.status.grip_size > self.ped_para.grasp_size {
                Hand::Gripping
            } else {
                Hand::Empty
            },
        }
    }

    /// Status of E-move.
    fn emove(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        let emove = &inputs.memory.emove;
        self.emove.read(inputs.tick, &emove.header, emove.status.echo, emove.status.report.lower())
    }

    fn grip_held(&self, command: &SubtaskCommand) -> GripHeld {
        match self.grasp {
            Some(Grasp { object, grip }) if object == command.object => {
                if grip == command.destination_grip {
                    GripHeld::Destination
                } else if grip == command.source_grip {
                    GripHeld::Source
                } else {
                    GripHeld::Neither
                }
            }
            _ => GripHeld::Unknown,
        }
    }

    fn pedestal(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Pedestal {
        let pedestal = &inputs.memory.pedestal;
        let status = &pedestal.status;
        match self.pedestal.read(inputs.tick, &pedestal.header, status.echo, status.report.lower()) {
            Lower::Pending | Lower::Executing => Pedestal::Moving,
            Lower::Done => Pedestal::Done,
            Lower::Error | Lower::Joystick if status.report == PedestalReport::CannotDo => Pedestal::Cannot,
            Lower::Error | Lower::Joystick => Pedestal::Faulty,
            Lower::Lost => Pedestal::Silent,
        }
    }
}

fn named(command: &SubtaskCommand) -> Named {
    if command.object.is_empty() { Named::Location } else { Named::Object }
}
