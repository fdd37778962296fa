use interfaces::{
    StatusReport,
    emove::{
        EmoveCommand, EmoveStatus, EmoveVerb, Holding, LocatedObject, ObjectGrip, PlacedObject, Standing,
    },
};

pub const fn moves(verb: EmoveVerb) -> bool {
    matches!(
        verb,
        EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol
    )
}

pub const fn take(status: &mut EmoveStatus, number: u32) {
    (status.echo, status.report) = (number, StatusReport::Executing);
}

pub fn effect(status: &mut EmoveStatus, order: &EmoveCommand) {
    let EmoveCommand { object, grip, site, .. } = *order;
    match order.command {
        EmoveVerb::GraspObj | EmoveVerb::AcquireTool => {
            grasp(status, ObjectGrip { object: object.unwrap_or_default(), grip });
            status.drum |= order.command == EmoveVerb::AcquireTool;
        }
        EmoveVerb::InsertTool => status.drum = true,
        EmoveVerb::RemoveTool => status.drum = false,
        EmoveVerb::Release => release(status),
        EmoveVerb::ReleaseTool => (status.held, status.drum) = (Holding::Nothing, false),
        EmoveVerb::LocateObj => {
            status.located = object.map(|object| LocatedObject { object, site });
        }
        EmoveVerb::QcDetach => (status.end_effector_id, status.exchange) = (None, None),
        EmoveVerb::QcAttach => (status.end_effector_id, status.exchange) = (order.end_effector_id, None),
        verb if moves(verb) => {
            let grip = Some(grip).filter(|_| verb != EmoveVerb::MovToLoc);
            status.at = Some(Standing { site, grip });
        }
        _ => {}
    }
}

pub const fn grasp(status: &mut EmoveStatus, object: ObjectGrip) {
    (status.held, status.placed, status.located) = (Holding::Object(object), None, None);
}

pub fn release(status: &mut EmoveStatus) {
    if let Holding::Object(ObjectGrip { object, grip }) = status.held {
        let site = status.at.unwrap_or_default().site;
        status.placed = Some(PlacedObject { object, grip, site });
    }
    status.held = Holding::Nothing;
}
