//! Goals of Prim's commands (V.1.1).

use interfaces::prim::{PrimCommand, PrimVerb};

use super::{
    Scene,
    claim::{Claim, at, pose},
};

pub fn claims(command: &PrimCommand, scene: &Scene<'_>) -> Vec<Claim> {
    let data = scene.data;
    let goal = || {
        let base = pose(Some(command.pose), scene)?;
        Some(data.moved(&base, command.movetable))
    };
    let claim = match command.command {
        // A sensor may be calibrated in contact, and nothing moves: no claim about the cell.
        PrimVerb::None | PrimVerb::CalSensor => None,
        PrimVerb::Pause => Some(Claim::RobotStops),
        PrimVerb::RobotInit => Some(Claim::Linked),
        PrimVerb::GotoPt | PrimVerb::DeltaMove | PrimVerb::GoWhile => at(goal(), "its goal"),
        PrimVerb::GoThru => {
            let para = data.traj_para(command.trajectory_parameters);
            let inches = para.map_or(0.0, |para| f64::from(para.brk_dst) / 100.0);
            goal().map(|goal| Claim::Near { goal, inches })
        }
        PrimVerb::GoUntil => {
            let sensor = command.sensor.and_then(|name| data.sensor(&name));
            sensor.filter(|sensor| sensor.source.is_force()).map(|_| Claim::Touches)
        }
    };
    claim.into_iter().collect()
}
