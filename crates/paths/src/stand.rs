//! Checks a pose: joint angles, limits, and the nearest obstacle in the cell at the start of a run.

use std::fmt;

use geometry::{
    frame::{Frame, Vector},
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
    movetable::{MovetableLine, System},
    pose::Pose,
    units::{Length, Point, inches},
};
use plant::{
    clearance::Contact,
    description::Kind,
    room::{Layout, Room},
};
use serde::Serialize;
use taskdata::files::TaskData;

const NEAR: f64 = 12.0; // inches
const NAMED: usize = 3; // in the answer

/// Angles in degrees, lengths in inches.
#[derive(Clone, Debug, Serialize)]
pub struct Standing {
    pub points: [[i32; 3]; 3],    // wrist, tool and finger point, 0.01 in
    pub joints: Option<[f64; 6]>, // `None`: out of reach
    pub unreachable: Option<String>,
    pub margin: Option<(&'static str, f64)>, // joint nearest to a limit; negative beyond it
    /// Part of the robot, nearest obstacle and their distance; negative if they touch.
    pub clearance: Option<(String, String, f64)>,
    pub named: Vec<(String, f64)>, // the nearest poses, with the distances of their tool points
}

impl Standing {
    pub fn of(pose: &Pose, data: &TaskData<'_>, room: &Room) -> Result<Self, String> {
        let frame = pose.to_frame().map_err(|error| error.to_string())?;
        let (joints, unreachable) = match T3.inverse(&frame, &HOME_JOINTS) {
            Ok(joints) => (Some(T3.within_limits(&joints)), None),
            Err(error) => (None, Some(error.to_string())),
        };
        let margin = joints.map(|joints| T3.margin(&joints));
        let name = |joint: usize| JOINT_NAMES.get(joint).copied().unwrap_or("joint");
        let clearance = joints.and_then(|joints| {
            let layout: Layout = room.at_start();
            let contacts = room.look(&room.movers(&layout, &joints), &room.devices(&layout), NEAR);
            // The robot's own links are always near each other.
            let counts = |contact: &Contact| contact.touches() || contact.obstacle_kind != Kind::Arm;
            let nearest =
                contacts.into_iter().filter(counts).max_by(|one, other| one.depth.total_cmp(&other.depth))?;
            Some((nearest.mover, nearest.obstacle, -nearest.depth))
        });
        let mut named: Vec<_> = data
            .poses
            .iter()
            .map(|record| (record.name.to_string(), (record.frame.position - frame.position).norm()))
            .collect();
        named.sort_by(|(_, one), (_, other)| one.total_cmp(other));
        named.truncate(NAMED);
        Ok(Self {
            points: [pose.wrist, pose.tool, pose.finger],
            joints: joints.map(|joints| joints.map(f64::to_degrees)),
            unreachable,
            margin: margin.map(|margin| (name(margin.joint), margin.radians.to_degrees())),
            clearance,
            named,
        })
    }

    #[must_use]
    pub fn is_usable(&self) -> bool {
        let touches = |(_, _, inches): &(String, String, f64)| *inches < 0.0;
        self.margin.is_some_and(|(_, degrees)| degrees >= 0.0)
            && !self.clearance.as_ref().is_some_and(touches)
    }
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (point, [x, y, z]) in ["wrist ", "tool  ", "finger"].iter().zip(self.points) {
            writeln!(f, "{point} {x:>8} {y:>8} {z:>8}   0.01 in")?;
        }
        writeln!(f, "at      {}", Point(self.points[1].map(inches)))?;
        if let Some(why) = &self.unreachable {
            writeln!(f, "arm     {why}")?;
        }
        if let Some(joints) = self.joints {
            let words = JOINT_NAMES.iter().zip(joints).map(|(name, angle)| {
                // Adding zero removes the sign of a negative zero.
                format!("{name} {:.1}", (angle * 10.0).round() / 10.0 + 0.0)
            });
            writeln!(f, "joints  {} degrees", words.collect::<Vec<_>>().join(", "))?;
        }
        match self.margin {
            Some((joint, degrees)) if degrees < 0.0 => {
                writeln!(f, "limits  {joint} is {:.1} degrees beyond its limit", -degrees)?
            }
            Some((joint, degrees)) => {
                writeln!(f, "limits  {joint} is nearest to its limit, by {degrees:.1} degrees")?
            }
            None => {}
        }
        match &self.clearance {
            Some((mover, obstacle, inches)) if *inches < 0.0 => {
                writeln!(f, "cell    {mover} is {:.2} in deep in {obstacle}", -inches)?;
            }
            Some((mover, obstacle, inches)) => {
                writeln!(f, "cell    {mover} is {inches:.2} in from {obstacle}")?
            }
            None if self.joints.is_some() => writeln!(f, "cell    nothing within {}", Length(NEAR))?,
            None => {}
        }
        let named = self.named.iter().map(|(name, inches)| format!("{name} {inches:.2} in"));
        writeln!(f, "near    {}", named.collect::<Vec<_>>().join(", "))
    }
}

#[must_use]
pub fn pose_form(name: &str, movetable: &str, pose: &Pose) -> Vec<String> {
    let [wrist, tool, finger] =
        [pose.wrist, pose.tool, pose.finger].map(|[x, y, z]| format!("{x:>8} {y:>8} {z:>8}"));
    vec![wrist, tool, format!("{finger}   -pose-   {movetable:<11} {name}")]
}

/// A translation, a rotation about the tool point, a roll (VII.2). Omits lines without effect, except the first.
#[must_use]
pub fn movetable_between(from: &Frame, to: &Frame) -> Vec<MovetableLine> {
    let back = from.rotation.inverse();
    let shift = back * (to.position - from.position);
    let turn = back * to.rotation;
    let along = turn * x_axis(); // pitch about Y, yaw about the new Z, roll about the new X
    let (pitch, yaw) = ((-along.z).atan2(along.x), along.y.clamp(-1.0, 1.0).asin());
    let line = |system, values| MovetableLine { system, values };
    let tilted = line(System::ToolOrigin, [hundredths(pitch.to_degrees()), hundredths(yaw.to_degrees()), 0]);
    let rest = tilted.apply(from).rotation.inverse() * to.rotation;
    let side = rest * y_axis();
    let rolled = line(System::Roll, [hundredths(side.z.atan2(side.y).to_degrees()), 0, 0]);
    let moved = line(System::Tool, [shift.x, shift.y, shift.z].map(hundredths));
    let turns = [tilted, rolled].into_iter().filter(|line| line.values != [0; 3]);
    std::iter::once(moved).chain(turns).collect()
}

#[must_use]
pub fn movetable_form(name: &str, lines: &[MovetableLine]) -> Vec<String> {
    let last = lines.len().saturating_sub(1);
    let form = |(at, MovetableLine { system, values: [a, b, c] }): (usize, &MovetableLine)| {
        let number = at + 1;
        let system = system.text();
        let end = if at == last { format!("-mtb-   {name}") } else { "----".to_owned() };
        format!("    {number}    {system:<2} {a:>8} {b:>8} {c:>6}      {end}")
    };
    lines.iter().enumerate().map(form).collect()
}

fn hundredths(value: f64) -> i32 {
    (value * 100.0).round().clamp(f64::from(i32::MIN), f64::from(i32::MAX)) as i32
}

fn x_axis() -> Vector {
    Vector::new(1.0, 0.0, 0.0)
}

fn y_axis() -> Vector {
    Vector::new(0.0, 1.0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{frame::rotation_from_x_y, movetable::Movetable};

    fn frame(position: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Frame {
        let [x, y] = [x, y].map(|[a, b, c]| Vector::new(a, b, c));
        let [a, b, c] = position;
        Frame { position: Vector::new(a, b, c), rotation: rotation_from_x_y(&x, &y).expect("a rotation") }
    }

    #[test]
    fn the_movetable_leads_there() {
        let home = frame([0.0, -71.45, -14.83], [0.0, -0.7, -0.7], [1.0, 0.0, 0.0]);
        let there = [
            home,
            frame([-50.0, 10.0, -5.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]),
            frame([-5.0, -60.0, 3.0], [0.3, -0.2, -0.9], [0.9, 0.3, 0.2]),
            frame([-5.0, -60.0, 3.0], [-0.8, 0.2, -0.3], [0.1, 0.9, 0.4]),
        ];
        for to in there {
            let lines = movetable_between(&home, &to);
            let reached = Movetable::from_lines(&lines).expect("few lines").apply(&home);
            assert!((reached.position - to.position).norm() < 0.02, "{lines:?}");
            assert!((reached.rotation.inverse() * to.rotation).angle() < 3e-4, "{lines:?}");
        }
        assert_eq!(movetable_between(&home, &home).len(), 1, "nothing but a translation of nothing");
    }

    #[test]
    fn forms_are_lines_of_a_block() {
        let lines = [
            MovetableLine { system: System::Tool, values: [-265, 10, 4] },
            MovetableLine { system: System::Roll, values: [-9000, 0, 0] },
        ];
        let form = movetable_form("MY-MTB", &lines);
        assert_eq!(form.len(), 2);
        assert!(form[0].ends_with("----") && form[1].ends_with("-mtb-   MY-MTB"), "{form:?}");
        let pose = Pose { wrist: [1, -2, 3], tool: [40_000, 5, 6], finger: [7, 8, -9] };
        let form = pose_form("MY-POSE", "...", &pose);
        assert!(form.len() == 3 && form[2].ends_with("-pose-   ...         MY-POSE"), "{form:?}");
        assert!(form.iter().all(|line| line.len() <= 64));
    }
}
