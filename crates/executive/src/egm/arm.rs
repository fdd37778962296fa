//! Kinematics of a robot with a spherical wrist, read from its file. While EGM runs, the robot itself computes this;
//! `rcs-run check --robot` computes it beforehand.
//!
//! Lengths are named as in Brandstötter, Angerer, Hofbaur, "An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist" (2014); the crate
//! `rs-opw-kinematics` computes the solution.

use std::{
    f64::consts::{PI, TAU},
    fmt,
};

use diagnostics::{Problem, toml::element};
use egm::{Pose, pose};
use rs_opw_kinematics::{
    glam::{DQuat, DVec3},
    kinematic_traits::Kinematics as _,
    kinematics_impl::OPWKinematics,
    parameters::opw_kinematics::Parameters,
    pose::Pose as OpwPose,
};
use serde::Deserialize;

use crate::egm::pose_entry::{KIND, PoseEntry};

pub type Axes = [f64; 6]; // radians

/// The table `[arm]` of the file: mm, degrees, degrees/s.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ArmText {
    name: String,
    a1: f64,
    a2: f64,
    b: f64,
    c1: f64,
    c2: f64,
    c3: f64,
    c4: f64,
    offsets: Axes,
    signs: [i8; 6],
    low: Axes,
    high: Axes,
    speeds: Axes,
    work_object: PoseEntry,
    tool: PoseEntry,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisProblem {
    OutOfReach,
    Limit {
        axis: usize, // index of the axis, from 0
        by: f64,
    },
    /// An axis would have to turn faster than it can: the wrist is near its singularity.
    Speed {
        axis: usize, // index of the axis, from 0
        needed: f64, // degrees/s
        most: f64,   // greatest speed of the axis, degrees/s
    },
}

impl fmt::Display for AxisProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach => f.write_str("out of reach"),
            Self::Limit { axis, by } => {
                write!(f, "axis {} would be {by:.1} degrees beyond its limit", axis + 1)
            }
            Self::Speed { axis, needed, most } => {
                write!(
                    f,
                    "axis {} would turn at {needed:.0} degrees/s, {most:.0} at most expected: the wrist is nearly straight",
                    axis + 1
                )
            }
        }
    }
}

#[derive(Clone, Debug)]
pub struct Arm {
    name: String,
    kinematics: OPWKinematics,
    straight: f64,         // angle of axis 5, rad, at which the kinematics has a straight wrist
    limits: [[f64; 2]; 6], // least and greatest angle of each axis, rad
    speeds: Axes,          // greatest speed of each axis, rad/s
    work_object: Pose,     // pose of the work object in the robot's base frame
    tool: Pose,            // pose of the tool in tool0, the frame of the flange
}

impl Arm {
    /// Converts the table of the file; adds its errors to `problems`.
    pub(crate) fn from_text(text: &ArmText, problems: &mut Vec<Problem>) -> Option<Self> {
        let lengths = [text.a1, text.a2, text.b, text.c1, text.c2, text.c3, text.c4];
        let [a1, a2, b, c1, c2, c3, c4] = lengths.map(|mm| mm / 1e3);
        let mut unlike = |list: &str, axis, expected: &str, found: &dyn fmt::Display| {
            problems.push(Problem::unlike(KIND.value, &element(list, axis), expected, found));
        };
        for axis in 0..6 {
            let (sign, speed) = (text.signs[axis], text.speeds[axis]);
            if sign.abs() != 1 {
                unlike("arm.signs", axis, "1 or -1", &sign);
            }
            if text.low[axis] >= text.high[axis] {
                let expected = format!("an angle below {} of arm.high, degrees", text.high[axis]);
                unlike("arm.low", axis, &expected, &text.low[axis]);
            }
            if speed <= 0.0 {
                unlike("arm.speeds", axis, "more than 0 degrees/s", &speed);
            }
        }
        let work_object = text.work_object.pose("arm.work_object", problems);
        let tool = text.tool.pose("arm.tool", problems);
        let offsets = text.offsets.map(f64::to_radians);
        let parameters =
            Parameters { a1, a2, b, c1, c2, c3, c4, offsets, sign_corrections: text.signs, dof: 6 };
        let limits = std::array::from_fn(|axis| [text.low[axis], text.high[axis]].map(f64::to_radians));
        Some(Self {
            name: text.name.clone(),
            kinematics: OPWKinematics::new(parameters),
            straight: offsets[4] * f64::from(text.signs[4]),
            limits,
            speeds: text.speeds.map(f64::to_radians),
            work_object: work_object?,
            tool: tool?,
        })
    }

    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All axis angles, rad, that bring the tool to a pose in the work object, within the limits of the axes.
    #[must_use]
    pub fn solutions(&self, tool: &Pose) -> Vec<Axes> {
        let mut solutions = self.kinematics.inverse(&self.flange(tool));
        for axes in &mut solutions {
            for (angle, [low, high]) in axes.iter_mut().zip(self.limits) {
                let turned = [*angle, *angle + TAU, *angle - TAU];
                *angle = turned.into_iter().find(|turned| (low..=high).contains(turned)).unwrap_or(*angle);
            }
        }
        solutions.retain(|axes| self.margin(axes).1 >= 0.0);
        solutions
    }

    /// Pose of the tool in the work object, mm, at the given axis angles.
    #[must_use]
    pub fn pose(&self, axes: &Axes) -> Pose {
        let flange = self.kinematics.forward(axes);
        let [x, y, z, w] = flange.rotation.to_array();
        let flange = Pose { position: (flange.translation * 1e3).to_array(), orientation: [w, x, y, z] };
        self.work_object.inverse().compose(&flange).compose(&self.tool)
    }

    /// The axis, from 0, with the least margin to its limits, and that margin, degrees; negative beyond the limit.
    #[must_use]
    pub fn margin(&self, axes: &Axes) -> (usize, f64) {
        let margins =
            axes.iter().zip(self.limits).map(|(angle, [low, high])| (angle - low).min(high - angle));
        let (axis, least) =
            margins.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NEG_INFINITY));
        (axis, least.to_degrees())
    }

    fn flange(&self, tool: &Pose) -> OpwPose {
        let flange = self.work_object.compose(tool).compose(&self.tool.inverse());
        let [w, x, y, z] = flange.orientation;
        OpwPose::from_parts(DVec3::from(pose::scaled(&flange.position, 1e-3)), DQuat::from_xyzw(x, y, z, w))
    }
}

/// A motion of the arm that keeps the configuration of its start, as the robot does under EGM.
#[derive(Clone, Debug)]
pub struct Track {
    axes: Axes,
    pub margin: (usize, f64), // the axis, from 0, that came nearest to a limit, and the margin, degrees
    pub wrist: f64,           // least angle of axis 5 from the straight wrist, degrees
    pub speeds: Axes,         // greatest speed of each axis, degrees/s
}

impl Track {
    #[must_use]
    pub fn begin(arm: &Arm, axes: &Axes) -> Self {
        let mut track = Self { axes: *axes, margin: (0, f64::INFINITY), wrist: 180.0, speeds: [0.0; 6] };
        track.note(arm);
        track
    }

    /// Moves to the next pose within a time, s. On error, the arm keeps its axis angles.
    pub fn go(&mut self, arm: &Arm, tool: &Pose, seconds: f64) -> Result<(), AxisProblem> {
        let solutions = arm.kinematics.inverse_continuing(&arm.flange(tool), &self.axes);
        let axes = *solutions.first().ok_or(AxisProblem::OutOfReach)?;
        let (axis, margin) = arm.margin(&axes);
        if margin < 0.0 {
            return Err(AxisProblem::Limit { axis, by: -margin });
        }
        for (axis, (to, from)) in axes.iter().zip(self.axes).enumerate() {
            let (needed, most) = ((to - from).abs() / seconds, arm.speeds[axis]);
            if needed > most {
                return Err(AxisProblem::Speed {
                    axis,
                    needed: needed.to_degrees(),
                    most: most.to_degrees(),
                });
            }
            self.speeds[axis] = self.speeds[axis].max(needed.to_degrees());
        }
        self.axes = axes;
        self.note(arm);
        Ok(())
    }

    fn note(&mut self, arm: &Arm) {
        let margin = arm.margin(&self.axes);
        if margin.1 < self.margin.1 {
            self.margin = margin;
        }
        let bent = (self.axes[4] - arm.straight + PI).rem_euclid(TAU) - PI;
        self.wrist = self.wrist.min(bent.abs().to_degrees());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::egm::RobotFile;

    const TEXT: &str = include_str!("../../../../data/robots/irb6700.toml");

    fn arm(text: &str) -> Arm {
        RobotFile::from_toml(&crate::egm::placement::source(text)).unwrap().arm.unwrap()
    }

    /// From the drawing of the IRB 6700-200/2.60: all axes at 0, forearm level, tool0 1662.5 mm in front, 2105 mm high.
    #[test]
    fn arm_has_the_lengths_of_its_drawing() {
        let arm = arm(TEXT);
        let at_zero = arm.kinematics.forward(&[0.0; 6]);
        assert!((at_zero.translation * 1e3 - DVec3::new(1662.5, 0.0, 2105.0)).length() < 1e-9, "{at_zero:?}");
        assert!((at_zero.rotation * DVec3::Z - DVec3::X).length() < 1e-9);
        // Axis 2 leans the arm forward, axis 3 lowers the forearm.
        assert!(arm.kinematics.forward(&[0.0, 0.1, 0.0, 0.0, 0.0, 0.0]).translation.x > 1.7);
        assert!(arm.kinematics.forward(&[0.0, 0.0, 0.1, 0.0, 0.0, 0.0]).translation.z < 2.05);
    }

    #[test]
    fn each_solution_brings_the_tool_to_the_pose() {
        let arm = arm(TEXT);
        let axes = [0.3, 0.2, -0.1, 0.4, 0.5, 0.6];
        let pose = arm.pose(&axes);
        let solutions = arm.solutions(&pose);
        assert!(solutions.len() >= 2, "{solutions:?}");
        for solution in &solutions {
            let (way, turn) = arm.pose(solution).distance(&pose);
            assert!(way < 1e-6 && turn < 1e-9, "{way} mm, {turn} rad");
        }
        let is_same = |found: &Axes| found.iter().zip(axes).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(solutions.iter().any(is_same), "{solutions:?}");
    }

    #[test]
    fn obstacles_of_an_arm_are_named() {
        let arm = arm(TEXT);
        let axes = [0.3, 0.2, -0.1, 0.4, 0.5, 0.6];
        let mut track = Track::begin(&arm, &axes);
        let mut to = |axis: usize, by: f64, seconds: f64| {
            let mut next = track.axes;
            next[axis] += by;
            track.go(&arm, &arm.pose(&next), seconds)
        };
        assert_eq!(to(0, 0.05, 0.04), Ok(()));
        assert!(matches!(to(0, 0.1, 0.04), Err(AxisProblem::Speed { axis: 0, .. })));
        assert!(matches!(to(4, 2.5, 10.0), Err(AxisProblem::Limit { axis: 4, .. })));
        let far = Pose { position: [9e3; 3], ..Pose::IDENTITY };
        assert_eq!(track.go(&arm, &far, 1.0), Err(AxisProblem::OutOfReach));
        assert!((track.speeds[0] - 0.05_f64.to_degrees() / 0.04).abs() < 1e-6, "{:?}", track.speeds);
    }

    /// Axis 6 has a range of more than a turn; the motion does not jump by a turn at 180 degrees.
    #[test]
    fn motion_continues_beyond_180_degrees() {
        let arm = arm(TEXT);
        let mut track = Track::begin(&arm, &[0.3, 0.2, -0.1, 0.4, 0.5, 3.0]);
        for _ in 0..30 {
            let mut next = track.axes;
            next[5] += 0.05;
            track.go(&arm, &arm.pose(&next), 0.04).unwrap();
        }
        assert!((track.axes[5] - 4.5).abs() < 1e-6, "{:?}", track.axes);
    }

    #[test]
    fn error_in_a_robot_file_is_named() {
        for (from, to, word) in [
            ("signs = [1, 1", "signs = [1, 0", "arm.signs[1]: expected 1 or -1, found 0"),
            (
                "low = [-170.0",
                "low = [170.0",
                "arm.low[0]: expected an angle below 170 of arm.high, degrees, found 170",
            ),
            ("speeds = [110.0", "speeds = [0.0", "arm.speeds[0]: expected more than 0 degrees/s, found 0"),
            ("a1 = 320.0", "a1 = nan", "arm.a1: expected a number, found nan"),
            ("a1 = 320.0", "a9 = 320.0", "arm has no key a9; expected one of name, a1"),
        ] {
            let wrong = TEXT.replace(from, to);
            assert_ne!(wrong, TEXT);
            let said = RobotFile::from_toml(&crate::egm::placement::source(&wrong)).unwrap_err().in_line();
            assert!(said.contains(word), "{said}");
        }
    }

    #[test]
    fn all_mistakes_of_a_file_are_reported_at_once() {
        let wrong = TEXT.replace("signs = [1, 1", "signs = [1, 0").replace("low = [-170.0", "low = [170.0");
        let wrong = wrong.replace("a1 = 320.0", "a9 = 320.0");
        let report = RobotFile::from_toml(&crate::egm::placement::source(&wrong)).unwrap_err();
        let entries: Vec<_> = report.diagnostics().iter().filter_map(|one| one.entry()).collect();
        assert_eq!(entries, ["arm.a9", "arm.signs[1]", "arm.low[0]"], "{report}");
    }
}
