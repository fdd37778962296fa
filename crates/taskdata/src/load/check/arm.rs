use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
};

const VERTICAL: f64 = 2.0; // degrees: warning

pub(super) fn from_vertical(frame: &Frame) -> f64 {
    let axis = frame.x();
    axis.x.hypot(axis.y).atan2(axis.z.abs()).to_degrees()
}

pub(super) fn is_vertical(frame: &Frame) -> bool {
    // Most frames are far from vertical, so the angle need not be calculated.
    frame.x().z.abs() > 0.99 && from_vertical(frame) < VERTICAL
}

pub(super) struct Fault {
    pub code: &'static str,
    pub message: String,
    pub help: String,
}

/// Names the joint beyond its limit and the excess, or the distance out of reach.
pub(super) fn fault(frame: &Frame) -> Option<Fault> {
    let joints = match T3.inverse(frame, &HOME_JOINTS) {
        Ok(joints) => T3.within_limits(&joints),
        Err(error) => {
            let p = frame.position;
            let help = format!("its tool point is at ({:.2}, {:.2}, {:.2} in)", p.x, p.y, p.z);
            return Some(Fault { code: "reach", message: error.to_string(), help });
        }
    };
    let margin = T3.margin(&joints);
    if margin.radians >= 0.0 {
        return None;
    }
    let name = JOINT_NAMES.get(margin.joint).copied().unwrap_or("joint");
    let angle = joints.get(margin.joint).copied().unwrap_or_default().to_degrees();
    let (low, high) = T3.limits.get(margin.joint).copied().unwrap_or_default();
    let message =
        format!("{name} at {angle:.1} degrees, {:.1} beyond its limit", -margin.radians.to_degrees());
    let help =
        format!("the limits of {name} are {:.0} and {:.0} degrees", low.to_degrees(), high.to_degrees());
    Some(Fault { code: "limit", message, help })
}
