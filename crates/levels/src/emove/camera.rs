//! LOCATE-OBJ's outputs (V.2.1): pictures and the moves of the camera between them.

use rcs_core::{
    frame::Frame,
    interface::{EmoveOutputs, Reason, device::Picture, emove::EmoveCommand, prim::PrimVerb},
    pose::Pose,
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    Emove, Slot,
    locate::{centred, looked_at, part_frame, request, view_of},
    sensing::present_frame,
    state::{Located, Sort},
    tables::Action,
};
use crate::places::place_of;

impl Emove {
    /// Ask vision for a picture.
    pub(super) fn take_picture(
        &mut self,
        picture: Picture,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let again = matches!(action, Action::FloodAgain | Action::PreciseAgain);
        self.state.tries = if again { self.state.tries.saturating_add(1) } else { 0 };
        match action {
            Action::Flood => self.state.located = Located::default(),
            Action::Precise => self.settle(command, Sort::View, outputs),
            _ => {}
        }
        let Some(view) = view_of(command, inputs.data) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        outputs.vision = request(self.state.vision.send(inputs.tick), picture, self.state.tries, view);
    }

    /// Move the camera over the centroid, and for [`Action::Align`] turn it with the part.
    pub(super) fn move_camera(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let found = view_of(command, inputs.data).zip(present_frame(inputs.memory));
        let approach = inputs.data.view_approach(&command.object, command.grip, &place);
        let parameters = approach.and_then(|path| Some(inputs.data.path(path).last()?.para));
        let (Some((view, tool)), Some(parameters)) = (found, parameters) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        let seen = &inputs.external.devices.vision;
        let middle = looked_at(&tool, view.movetable, inputs.data);
        let target: Frame = if action == Action::Align {
            let part = part_frame(&middle, seen);
            let pose = Pose::from_frame(&part);
            self.publish(Slot::Located, pose, outputs);
            self.state.located = Located {
                object: command.object,
                record: command.location_record,
                array: command.location_array,
                pose,
            };
            part
        } else {
            centred(&middle, seen)
        };
        let goal = Pose::from_frame(&inputs.data.moved(&target, view.movetable));
        let record = self.publish(Slot::Goal, goal, outputs);
        self.send_prim(PrimVerb::GotoPt, inputs, outputs);
        outputs.prim.pose = record;
        outputs.prim.trajectory_parameters = parameters.number();
    }
}
