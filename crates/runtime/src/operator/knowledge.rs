//! `resume` (docs/resume.md): knowledge of the controller that sensors do not give, and the name of the held object.

use geometry::{pose::Pose, units::inches};
use interfaces::{
    CommonMemory, StatusReport,
    emove::{Holding, Offset},
    grip::Felt,
    operator::{Variable, Write},
};
use levels::emove::{gripper::EmoveGripper, robot_place::present_frame};
use taskdata::files::TaskData;

use super::written;

/// Reads `held OBJECT GRIP` or `held nothing`. Errors: the expected and the found text.
pub fn read(words: &[&str]) -> Result<Write, String> {
    let held = Variable::Held.text();
    match words {
        ["held", "nothing"] => written::read(&[held, "NONE"]),
        ["held", object, grip] => written::read(&[held, object, grip]),
        _ => Err(format!(
            "resume, resume held OBJECT GRIP, resume held nothing or resume line NUMBER was expected; found resume {}",
            words.join(" ")
        )),
    }
}

/// Checks the name of the held object, or that nothing is held. Errors: reason and remedy.
pub fn check(write: &Write, memory: &CommonMemory, data: &TaskData<'_>) -> Result<String, String> {
    if memory.emove.status.report == StatusReport::Executing {
        return Err("E-move executes a command: send PAUSE and ask again".to_owned());
    }
    let felt = EmoveGripper::attached(memory).felt(memory);
    match (write.object, felt) {
        (Some(_), _) | (None, Felt::Nothing) => written::check_value(write, memory, data),
        (None, Felt::Something) => Err("something is between the fingers by their sensors: name it with \
             `resume held OBJECT GRIP`, or release it with POSITION where it is supported"
            .to_owned()),
        (None, Felt::NotKnown) => {
            Err("the sensors do not show that the gripper is empty: release it with POSITION \
             where a part would be supported, or `confirm by hand` and POSITION"
                .to_owned())
        }
    }
}

#[must_use]
pub fn state(memory: &CommonMemory) -> String {
    let (emove, gripper) = (&memory.emove, EmoveGripper::attached(memory));
    let felt = gripper.felt(memory);
    let held = match emove.status.held {
        Holding::Object(held) => format!("{} with grip {:+}", held.object, held.grip),
        Holding::Nothing => "nothing".to_owned(),
        Holding::Something => "something without a name".to_owned(),
        Holding::NotKnown => "not known".to_owned(),
    };
    let fingers = match gripper.opening(memory) {
        Some(opening) => format!("fingers at {:.2} in", inches(opening)),
        None => "opening not known".to_owned(),
    };
    let between = match felt {
        Felt::Something => "something between them",
        Felt::Nothing => "nothing between them",
        Felt::NotKnown => "no reading of what is between them",
    };
    let agrees = match (emove.status.held, felt) {
        (Holding::Object(_), Felt::Something) | (Holding::Nothing, Felt::Nothing) => "plausible",
        _ => "not confirmed: look, then `resume held OBJECT GRIP` or `resume held nothing`",
    };
    let place = place(memory);
    let pins = memory.quick_change.status.end_effector_id;
    let pins = pins.map_or_else(|| "none".to_owned(), |id| id.to_string());
    let attached = emove.status.end_effector_id.map_or_else(|| "none".to_owned(), |id| id.to_string());
    let regrip =
        memory.subtask.regrip.map_or_else(|| "nothing".to_owned(), |regrip| regrip.object.to_string());
    format!(
        "held: {held} | {fingers}, {between}: {agrees}; place: {place}; gripper: {attached} | id pins \
         {pins}; pedestal's hand: {regrip} | opening {:.2} in",
        inches(memory.pedestal.status.grip_size)
    )
}

/// The place of the robot beside its resolvers. A robot on its way is known as long as it is where it may have come to
/// rest; else E-move names the nearest places.
fn place(memory: &CommonMemory) -> String {
    let emove = &memory.emove;
    let sensed = present_frame(memory);
    let distance = |recorded: &Pose| {
        let inches = sensed.zip(recorded.to_frame().ok()).map(|(here, there)| here.distance(&there).inches);
        inches.map_or_else(
            || "resolvers give no position".to_owned(),
            |inches| format!("resolvers {inches:.2} in from the recorded pose"),
        )
    };
    if let Some(at) = emove.status.at {
        let offset = match emove.status.offset {
            Offset::None => "resolvers agree",
            Offset::Slight => "resolvers within 0.05 in",
            Offset::Off => "resolvers farther away: the robot was moved",
            Offset::NotSensed => "resolvers give no position",
        };
        return format!("{} | {offset}", at.site.location);
    }
    let way = emove.estimates.way.as_ref();
    let route = way.map(|way| {
        format!(
            "on the way from {} to {} | {}",
            way.from.site.location,
            way.to.site.location,
            distance(&way.rest)
        )
    });
    match (emove.nearest.first().copied().flatten(), route) {
        (None, Some(route)) => route,
        (None, None) => "not known".to_owned(),
        (Some(nearest), route) => {
            let route = route.map_or_else(String::new, |route| format!(", it was {route}"));
            format!("not known{route}; {nearest}: move it to a resting place with the joystick box")
        }
    }
}

#[cfg(test)]
mod tests {
    use interfaces::emove::ObjectGrip;
    use rcs_core::name::Name16;

    use super::*;

    #[test]
    fn names_are_read() {
        let write = read(&["held", "LINKBAR1", "2"]).unwrap();
        assert_eq!((write.object, write.grip), (Name16::new("LINKBAR1").ok(), 2));
        assert_eq!(read(&["held", "nothing"]).unwrap().object, None);
        for words in [&["held"][..], &[], &["held", "LINKBAR1"], &["held", "LINKBAR1", "many"]] {
            assert!(read(words).is_err(), "{words:?}");
        }
    }

    #[test]
    fn nothing_is_accepted_only_if_the_sensors_agree() {
        let mut memory = CommonMemory::default();
        let nothing = read(&["held", "nothing"]).unwrap();
        memory.quick_change.status.end_effector_id = Some(1);
        memory.grip.status.felt = Felt::Something;
        assert!(check(&nothing, &memory, &TaskData::default()).unwrap_err().contains("name it"));
        memory.grip.status.felt = Felt::NotKnown;
        assert!(check(&nothing, &memory, &TaskData::default()).unwrap_err().contains("by hand"));
        memory.grip.status.felt = Felt::Nothing;
        assert!(check(&nothing, &memory, &TaskData::default()).is_ok());
        memory.emove.status.report = StatusReport::Executing;
        assert!(check(&nothing, &memory, &TaskData::default()).unwrap_err().contains("PAUSE"));
    }

    #[test]
    fn estimate_is_shown_beside_its_sensor() {
        let mut memory = CommonMemory::default();
        let held = ObjectGrip { object: Name16::clipped("LINKBAR1"), grip: 2 };
        memory.emove.status.held = Holding::Object(held);
        memory.quick_change.status.end_effector_id = Some(1);
        (memory.grip.status.initialized, memory.grip.status.position) = (true, 62);
        memory.grip.status.felt = Felt::Something;
        let state = state(&memory);
        let expected = "held: LINKBAR1 with grip +2 | fingers at 0.62 in, something between them: plausible";
        assert!(state.starts_with(expected), "{state}");
        assert!(state.contains("id pins 1"), "{state}");
    }
}
