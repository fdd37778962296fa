//! Goals of E-move's commands (V.2.1).

use interfaces::emove::{EmoveCommand, EmoveVerb};

use super::{
    Scene,
    claim::{Claim, at, grip_goal, holds, pose},
    seen::Movement,
};

pub fn claims(command: &EmoveCommand, scene: &Scene<'_>) -> Vec<Claim> {
    let data = scene.data;
    let (place, object) = (command.site.place(), command.object);
    let base = pose(command.pose, scene);
    let held = || holds(object, command.grip, Some(&place), scene);
    let at_grip = || {
        let name = command.site.location;
        at(grip_goal(data, base, object.as_ref(), command.grip, &place), name)
    };
    let view = data.vision_para(command.object_vision);
    let open = || {
        let sizes = data.end_eff(command.object_parameters)?;
        Some(Claim::Open(f64::from(sizes.appr_size) / 100.0))
    };
    let found = match command.command {
        // No process sends WITHDRAW (V.2.1 "not currently used").
        EmoveVerb::None | EmoveVerb::Withdraw => vec![],
        EmoveVerb::Pause => vec![Some(Claim::RobotStops), Some(Claim::FingersStill)],
        EmoveVerb::MovToLoc => vec![at(base, command.site.location)],
        EmoveVerb::MovToObj if view.is_some_and(|view| view.enabled) => {
            let movetable = object.and_then(|object| data.grip_movetable(&object, command.grip, &place));
            let claim = base.zip(movetable).zip(object).map(|((near, movetable), object)| Claim::AtPart {
                object: object.to_string(),
                near,
                movetable: Movement(movetable),
            });
            vec![claim, open()]
        }
        EmoveVerb::MovToObj => vec![at_grip(), open()],
        EmoveVerb::MovObjTo => vec![held(), at_grip()],
        EmoveVerb::MovToHol => vec![at_grip()],
        EmoveVerb::MovToVu => {
            vec![at(base.zip(view).map(|(base, view)| data.moved(&base, view.movetable)), "the view point")]
        }
        EmoveVerb::LocateObj => {
            vec![object.zip(base).map(|(object, near)| Claim::Located { object, near })]
        }
        EmoveVerb::GraspObj => vec![held()],
        EmoveVerb::Release => vec![Some(Claim::HoldsNothing)],
        EmoveVerb::QcDetach => vec![Some(Claim::WearsNone(scene.cell.gripper()))],
        EmoveVerb::QcAttach => vec![command.end_effector_id.map(Claim::Wears)],
        EmoveVerb::InsertTool | EmoveVerb::AcquireTool => vec![held(), object.map(Claim::InDrum)],
        EmoveVerb::ReleaseTool => vec![Some(Claim::HoldsNothing), object.map(Claim::InDrum)],
        EmoveVerb::RemoveTool => vec![held(), object.map(Claim::OutOfDrum)],
    };
    found.into_iter().flatten().collect()
}
