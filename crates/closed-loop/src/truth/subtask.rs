//! Goals of Subtask's commands (V.3.1).

use interfaces::subtask::{SubtaskCommand, SubtaskVerb};

use super::{
    Scene,
    claim::{Claim, at, grip_goal, holds, pose},
};

pub fn claims(command: &SubtaskCommand, scene: &Scene<'_>) -> Vec<Claim> {
    let data = scene.data;
    let place = command.site.place();
    let (object, base) = (command.object, pose(command.pose, scene));
    let goal = |grip: i32| grip_goal(data, base, object.as_ref(), grip, &place);
    let held = |grip: i32| holds(object, grip, Some(&place), scene);
    let (source, destination) = (command.source_grip, command.destination_grip);
    let found = match command.command {
        SubtaskVerb::None => vec![],
        SubtaskVerb::Pause => pause(scene),
        SubtaskVerb::GetEndeff => vec![command.end_effector_id.map(Claim::Wears)],
        SubtaskVerb::GetObject => vec![held(source)],
        SubtaskVerb::PlaceObj => {
            let placed = object.zip(goal(destination));
            vec![Some(Claim::HoldsNothing), placed.map(|(object, goal)| Claim::Placed { object, goal })]
        }
        SubtaskVerb::GotoEndpt | SubtaskVerb::GotoDest => vec![at(base, command.site.location)],
        SubtaskVerb::MoveObjToDest => vec![held(destination), at(goal(destination), command.site.location)],
        SubtaskVerb::Position if object.is_some() => vec![at(goal(source), command.site.location)],
        SubtaskVerb::Position => vec![at(base, command.site.location)],
        SubtaskVerb::Release => vec![Some(Claim::HoldsNothing)],
        SubtaskVerb::FixGrip => vec![held(destination), Some(Claim::HoldsAlone)],
        SubtaskVerb::InsertTool | SubtaskVerb::AcquireTool => {
            vec![held(destination), object.map(Claim::InDrum)]
        }
        SubtaskVerb::ReleaseTool => vec![Some(Claim::HoldsNothing), object.map(Claim::InDrum)],
        SubtaskVerb::RemoveTool => vec![held(destination), object.map(Claim::OutOfDrum)],
    };
    found.into_iter().flatten().collect()
}

/// Claims of a finished PAUSE or S-PAUSE. Before its first command the pedestal calibrates itself (VI.5).
pub fn pause(scene: &Scene<'_>) -> Vec<Option<Claim>> {
    let pedestal = (scene.memory.subtask.pedestal.number != 0).then_some(Claim::PedestalStill);
    vec![Some(Claim::RobotStops), Some(Claim::FingersStill), pedestal]
}
