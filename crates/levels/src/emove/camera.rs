//! LOCATE-OBJ's outputs (V.2.1): pictures and the moves of the camera between them.

use geometry::{frame::Frame, pose::Pose, units::inches};
use interfaces::{
    CommonMemory, EmoveOutputs,
    device::Picture,
    emove::{EmoveCommand, EmoveVerb, Located},
    prim::{PrimReport, PrimVerb},
    process::Inputs,
};
use taskdata::files::{MovtabId, TaskData, TrajParaId};

use super::{
    locate::{centred, looked_at, part_frame, request, stays_in_array, view_of},
    postprocess::Slot,
    robot_place::{gone_to, is_led, may_push, place_named, present_frame, robot_at},
    route::Goal,
    state::State,
    tables::{Action, Reach},
};

/// From where the camera is moved next, and how.
pub(super) struct Aim {
    /// Where the tool is.
    tool: Frame,
    /// View movetable of the object.
    view: MovtabId,
    /// Parameters of the motion: those with which the view is approached last.
    parameters: TrajParaId,
}

impl State {
    /// The pictures no longer count after a robot controller was switched off, because the arm has sunk, perhaps onto
    /// the located object; nor after a person has moved the robot near the object, because the fingers may have pushed
    /// it.
    pub(super) fn sense_pictures(&mut self, memory: &CommonMemory) {
        let may_touch = |located: &Located| may_push(&located.pose, memory);
        let is_pushed = is_led(memory) && self.beliefs.located.as_ref().is_some_and(may_touch);
        if is_pushed || memory.prim.status.report == PrimReport::T3LinkOff {
            self.beliefs.located = None;
        }
    }

    /// From where LOCATE-OBJ moves the camera next, and how; `None` if the resolvers or the task data do not say.
    pub(super) fn aim(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Option<Aim> {
        if command.command != EmoveVerb::LocateObj {
            return None;
        }
        let data = inputs.data;
        let approach = data.view_approach(&command.object?, command.grip, &place_named(command))?;
        Some(Aim {
            tool: present_frame(inputs.memory)?,
            view: view_of(command, data)?.movetable,
            parameters: data.path(approach).last()?.para,
        })
    }

    /// Would the open fingers at the object that the second picture shows stay within its array? A place that is in
    /// none has no edge, and what the task data lack is named by the motion to the object.
    pub(super) fn reach(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Reach {
        let data = inputs.data;
        let inside = || {
            let Aim { tool, view, .. } = self.aim(command, inputs)?;
            let place = place_named(command);
            let array = data.array(place.array)?;
            let corner = data.locpt(place.locpt).map(|corner| corner.frame);
            let base = corner.or_else(|| Some(data.pose(array.pose)?.frame))?;
            let sector = self.base_frame(command, inputs).ok()?;
            let out = data.steps_out(array, &base, &sector);
            let part = part_frame(&looked_at(&tool, view, data), &inputs.external.devices.vision);
            let command = EmoveCommand { command: EmoveVerb::MovToObj, ..*command };
            let goal = Goal::new(&command, &part, data).ok()?;
            Some(stays_in_array(&sector, &goal.frame, inches(goal.opening?), &out))
        };
        if inside() == Some(false) { Reach::Outside } else { Reach::Inside }
    }

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
        self.tries = if again { self.tries.saturating_add(1) } else { 0 };
        match action {
            Action::Flood => self.beliefs.located = None,
            Action::Precise => self.settle(command, gone_to(command), outputs),
            _ => {}
        }
        if let Some(view) = view_of(command, inputs.data) {
            outputs.vision = request(self.vision.send(inputs.tick), picture, self.tries, view);
        }
    }

    /// Move the camera over the centroid, and for [`Action::Align`] turn it with the part.
    pub(super) fn move_camera(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let (Some(object), Some(Aim { tool, view, parameters })) =
            (command.object, self.aim(command, inputs))
        else {
            return;
        };
        let seen = &inputs.external.devices.vision;
        let middle = looked_at(&tool, view, inputs.data);
        let target = if action == Action::Align {
            let part = part_frame(&middle, seen);
            let pose = Pose::from_frame(&part);
            self.publish(Slot::Located, pose, outputs);
            self.beliefs.located = Some(Located {
                object,
                record: command.location_record,
                array: command.location_array,
                sector: command.location_sector,
                pose,
            });
            part
        } else {
            centred(&middle, seen)
        };
        let goal = Pose::from_frame(&inputs.data.moved(&target, view));
        let record = self.publish(Slot::Goal, goal, outputs);
        self.leave_view(robot_at(command, gone_to(command), goal), inputs.memory);
        self.send_prim(PrimVerb::GotoPt, inputs, outputs);
        outputs.prim.pose = record;
        outputs.prim.trajectory_parameters = parameters.number();
    }
}
