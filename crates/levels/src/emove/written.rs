//! Beliefs of E-move that a person writes (IV.2.6). E-move was not stepped in the tick before: its state and its
//! outputs have the same beliefs, or it has been restarted and adopts those of the outputs.

use interfaces::{
    EmoveOutputs,
    emove::{Grasped, ObjectGrip},
    grip::Felt,
    operator::{Variable, Write},
    process::Inputs,
};
use rcs_core::name::Name16;
use taskdata::files::TaskData;

use super::{gripper::Gripper, robot_place::commanded_pose, state::State};

impl State {
    /// Take over a value.
    pub(super) fn write(
        &mut self,
        write: &Write,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        self.beliefs = outputs.beliefs;
        match (write.variable, write.object) {
            (Variable::Placed, _) => self.beliefs.placed = None,
            (Variable::Located, _) => self.beliefs.located = None,
            (Variable::Held, None) => (self.beliefs.held, self.beliefs.grasping) = (None, None),
            (Variable::Held, Some(object)) => {
                if let Some(grasped) = named(object, write.grip, inputs) {
                    self.hold(grasped);
                    (self.beliefs.grasping, self.beliefs.empty) = (Some(grasped), false);
                }
            }
            _ => {}
        }
        outputs.beliefs = self.beliefs;
    }
}

/// What the fingers hold, by its name and grip; `None` if they feel nothing, or the task data do not have the object.
fn named(object: Name16, grip: i32, inputs: &Inputs<'_, TaskData<'_>>) -> Option<Grasped> {
    let (parameters, sizes) = inputs.data.object(&object, grip)?;
    let gripper = Gripper::attached(inputs.memory);
    if gripper.felt(inputs.memory) != Felt::Something {
        return None;
    }
    Some(Grasped {
        object: ObjectGrip { object, grip },
        parameters: parameters.to_option(),
        gripper: gripper.id(),
        grasp_size: sizes.grasp_size,
        opening: gripper.opening(inputs.memory)?,
        pose: commanded_pose(inputs.memory).unwrap_or_default(),
    })
}
