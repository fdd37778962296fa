//! The support of an object when POSITION opens the gripper (V.4.1 POSITION): the robot's place, the task data, the
//! report of the vise, and a person's confirmation (docs/design/recovery.md "Unknown").

use interfaces::{
    ExternalInputs,
    emove::{Holding, ObjectGrip, Standing},
    hws::Confirmed,
    operator,
    subtask::SubtaskStatus,
};
use rcs_core::{Plain, name::Name10};
use taskdata::files::{LocptId, Place, Reference, TaskData};

use super::plan::Plan;
use crate::places::named;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskSupport {
    /// No support is known.
    None,
    /// The robot is with the object at a sector of a tray, or at a nest.
    Place,
    /// The robot is with the object at a fixture with jaws. Whether the jaws clamp it is not known.
    Jaws,
    /// The jaws of the fixture clamp the object, or a person holds it.
    Secured,
}

impl TaskSupport {
    #[must_use]
    pub fn sense(
        below: &SubtaskStatus,
        plan: &Plan,
        confirmed: Option<&Confirmed>,
        external: &ExternalInputs,
        data: &TaskData<'_>,
    ) -> Self {
        let by = confirmed.map(|confirmed| confirmed.by);
        if by == Some(operator::Support::ByHand) {
            return Self::Secured;
        }
        let support = Self::of_place(below, plan.object_at_position(), data);
        let clamping = external.devices.clamping;
        let reported = clamping.is_some() && clamping == below.at.map(|at| at.site.location);
        match (support, by) {
            (Self::Jaws, Some(operator::Support::Clamped)) => Self::Secured,
            (Self::Jaws, _) if reported => Self::Secured,
            (support, _) => support,
        }
    }

    /// The support at the place, ignoring jaws. If the gripper holds something unknown, the object that the command
    /// names is assumed.
    #[must_use]
    pub fn of_place(below: &SubtaskStatus, named: Option<ObjectGrip>, data: &TaskData<'_>) -> Self {
        // Only a robot that is at an object, or has brought one, has a grip.
        let Some((at, grip)) = below.at.and_then(|at| Some((at, at.grip?))) else { return Self::None };
        let object = match below.held {
            Holding::Object(held) if held.grip != grip => return Self::None,
            Holding::Object(held) => Some(held),
            Holding::Nothing | Holding::Something | Holding::NotKnown => named,
        };
        if [named::PEDESTAL, named::TOOL_TRNS].contains(&at.site.location.as_str()) {
            return Self::None;
        }
        let is_unknown = below.held.object().is_none();
        let is_fixture = object.is_some_and(|object| has_place(&object, &at, data));
        match (!at.site.array.is_null(), is_nest(&at, data), is_fixture) {
            (true, _, _) | (false, true, true) => Self::Place,
            (false, true, false) if is_unknown => Self::Place,
            (false, false, true) => Self::Jaws,
            (false, true | false, false) => Self::None,
        }
    }
}

/// True if the object has its own grip data at the location point. Grip data for `$$$` do not describe a fixture.
fn has_place(object: &ObjectGrip, at: &Standing, data: &TaskData<'_>) -> bool {
    let [here, anywhere] = [at.site.record, LocptId::NULL]
        .map(|point| data.grip_loc(&object.object, object.grip, &Place::point(point)));
    here.is_some() && here != anywhere
}

/// A part stays in a nest by its weight (VII.5: owner VFIXTURE).
fn is_nest(at: &Standing, data: &TaskData<'_>) -> bool {
    let owner = data.owner_named(&Name10::clipped(named::NESTS));
    let point = Reference::location_point(at.site.record);
    owner.is_some_and(|owner| data.is_member(owner, point))
}
