//! Checks a phase: its motion forward, and back as after an interruption (docs/design/recovery.md "On the way").

use std::sync::Arc;

use depc::controller::{JointProblem, Warning};
use geometry::{
    frame::Frame,
    kinematics::{JOINT_NAMES, T3},
};
use interfaces::emove::EmoveVerb;
use rcs_core::name::Name10;
use taskdata::files::{Target, TaskData};

use crate::{
    finding::{Finding, Segment, Walked},
    flight::MotionError,
    known::{FlightInputs, Outcome, Points},
    plan::{Datum, Leg, Phase},
    state::State,
    steps::Step,
};

pub const LEAST_MARGIN: f64 = 0.5; // degrees; below it, a warning

/// A part in the closed vise slips if the fingers are farther than this from it, in (ASSUMED).
const SLIP_INCHES: f64 = 0.015;

impl State<'_> {
    /// `commands` are those of E-move and Subtask. Contacts are checked only if `clear`, when all positions are known.
    pub fn fly(&mut self, phase: Phase, commands: [&'static str; 2], clear: bool) -> (Walked, Vec<Finding>) {
        if phase.legs.is_empty() || phase.missing.is_some() {
            return (Walked::of(phase), Vec::new());
        }
        let opens = phase.legs.iter().take_while(|leg| leg.part == "depart").count();
        let list = phase.legs.iter().map(|leg| (leg.frame, leg.parameters())).collect();
        let forth = Points { list, opens };
        let opening = self.opening(&phase);
        let there = self.try_points(&forth, opening, commands, clear, false);
        let mut findings = self.findings(&phase, &there, &names(&phase), "", clear);
        let segments = segments(&phase, &there);
        let is_route = phase.legs.len() > 1 && !commands.contains(&">POSITION");
        self.stranded = there.trouble.is_some();
        self.robot.clone_from(&there.robot);
        self.layout.opening = opening;
        self.before = vec![commands];
        if is_route && findings.iter().all(|finding| !finding.error) {
            let (back, names) = backwards(&phase, opens);
            let returned = self.try_points(&back, opening, commands, clear, false);
            findings.extend(self.findings(
                &phase,
                &returned,
                &names,
                "followed back after an interruption, ",
                clear,
            ));
        }
        (Walked { plan: phase, segments }, findings)
    }

    pub(crate) fn beside(&self, step: &Step, phase: &Phase) -> Option<Finding> {
        let Step::Fingers { verb: EmoveVerb::GraspObj, object: Some(object), .. } = step else { return None };
        let tool = self.robot.tool();
        let index = self.nearest(object, &tool)?;
        let part = self.layout.parts.get(index).filter(|_| self.room.in_vise(&self.layout) == Some(index))?;
        let (_, closed) = self.room.vise_seat(self.layout.program, part)?;
        let beside = tool.inverse().compose(&part.frame).position.y;
        (self.layout.jaws <= closed && beside.abs() > SLIP_INCHES).then(|| Finding {
            code: "path.grip",
            error: true,
            line: 0,
            message: format!(
                "{}: the fingers close {:.2} in beside the middle of {object}, which the jaws of the vise hold; {SLIP_INCHES} in at \
                 most expected",
                phase.what,
                beside.abs()
            ),
            help: Some(format!("move the movetable of this grip by {beside:.2} in along tool Y")),
            data: Vec::new(),
            key: format!("path.grip {}", phase.what),
            depth: beside.abs(),
        })
    }

    fn opening(&self, phase: &Phase) -> f64 {
        let gripper = self.room.worn(&self.layout);
        match (phase.opening_in, gripper) {
            (Some(opening), Some(gripper)) => opening.clamp(gripper.opening[0], gripper.opening[1]),
            _ => self.layout.opening,
        }
    }

    fn try_points(
        &self,
        points: &Points,
        opening: f64,
        commands: [&'static str; 2],
        clear: bool,
        tries: bool,
    ) -> Arc<Outcome> {
        let asked = FlightInputs {
            robot: self.robot.clone(),
            gripper: self.layout.gripper,
            held: self.layout.held.clone(),
            points: points.clone(),
            openings: [self.layout.opening, opening],
            commands,
            before: self.before.clone(),
            clear,
            tries,
        };
        self.known.outcome(asked, self.room, &self.layout)
    }

    fn findings(
        &self,
        phase: &Phase,
        outcome: &Outcome,
        names: &[Ends],
        prefix: &str,
        clear: bool,
    ) -> Vec<Finding> {
        let mut findings = Vec::new();
        let last = outcome.flown.len().saturating_sub(1);
        for (leg, (flown, seen)) in outcome.flown.iter().zip(&outcome.seen).enumerate() {
            let Some(Ends { from, to, entry, data }) = names.get(leg) else { continue };
            let place =
                entry.as_ref().map_or(String::new(), |entry| format!(" ({to} is entered in {entry})"));
            let way = format!("{prefix}{}, from {from} to {to}", phase.what);
            let mut add = |code, error, what: String, key: String, depth| {
                findings.push(Finding {
                    code,
                    error,
                    line: 0,
                    message: format!("{way}: {what}{place}"),
                    help: None,
                    data: data.iter().flatten().cloned().collect(),
                    key: format!("{code} {prefix}{} {from} {to} {key}", phase.what),
                    depth,
                });
            };
            if let Some(touched) = &seen.touched {
                // After half a turn the other finger touches, so the key omits the side.
                let mover = touched.mover.trim_start_matches("left_").trim_start_matches("right_");
                let key = format!("{mover} {}", touched.obstacle);
                add("path.contact", true, touched.to_string(), key, -touched.clearance_in);
            }
            if let Some(trouble) = outcome.trouble.filter(|_| leg == last) {
                let (what, key, depth) = in_words(trouble);
                add("path.joint", true, what, key, depth);
            } else if flown.margin.radians.to_degrees() < LEAST_MARGIN && leg > 0 {
                let degrees = flown.margin.radians.to_degrees();
                let joint = JOINT_NAMES.get(flown.margin.joint).copied().unwrap_or("joint");
                let what = format!("{joint} comes within {degrees:.2} degrees of its limit");
                add("path.margin", false, what, joint.to_owned(), -degrees);
            }
        }
        if self.advises && prefix.is_empty() && findings.iter().any(|finding| finding.error) {
            let help = self.help(phase, outcome, clear);
            findings.iter_mut().filter(|finding| finding.error).for_each(|one| one.help = Some(help.clone()));
        }
        findings
    }

    fn help(&self, phase: &Phase, failed: &Outcome, clear: bool) -> String {
        let worst = failed.seen.iter().position(|seen| seen.touched.is_some());
        let at = worst.unwrap_or(failed.flown.len().saturating_sub(1));
        let Some(leg) = phase.legs.get(at) else { return String::new() };
        let before = at.checked_sub(1).and_then(|at| phase.legs.get(at)).map_or(phase.from, |leg| leg.frame);
        let opens = phase.legs.iter().take_while(|leg| leg.part == "depart").count();
        if at < opens {
            return "change the depart points, or the place itself".to_owned();
        }
        let helps = |via: Frame| {
            let mut list: Vec<_> = phase.legs.iter().map(|leg| (leg.frame, leg.parameters())).collect();
            list.insert(at, (via, leg.parameters()));
            let points = Points { list, opens };
            self.try_points(&points, self.opening(phase), ["", ""], clear, true).is_clear()
        };
        let others = vias(self.walk.data()).filter(|(_, via)| *via != before && *via != leg.frame);
        let detour = |via: &Frame| before.distance(via).path() + via.distance(&leg.frame).path();
        let mut nearest: Vec<_> = others.map(|(name, via)| (detour(&via), name, via)).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        match nearest.into_iter().find(|(_, _, via)| helps(*via)) {
            Some((_, name, _)) => format!("a via point at {name} between the two would help"),
            None => "no via point of the stored trajectories is enough: give this path its own via points, or change its ends"
                .to_owned(),
        }
    }
}

fn vias<'a>(data: &TaskData<'a>) -> impl Iterator<Item = (Name10, Frame)> + use<'a> {
    let data = *data;
    let points = data.trajectories.iter().flat_map(move |record| data.path(record.path));
    let mut poses: Vec<_> = points
        .filter_map(|point| match point.target {
            Target::Pose(id) => data.pose(id).map(|pose| (pose.name, pose.frame)),
            _ => None,
        })
        .collect();
    poses.sort_by_key(|pose| pose.0.as_str().to_owned());
    poses.dedup_by_key(|pose| pose.0);
    poses.into_iter()
}

struct Ends {
    from: String,
    to: String,
    entry: Option<String>,
    data: [Option<Datum>; 2], // of the end and the start
}

fn names(phase: &Phase) -> Vec<Ends> {
    let starts = [(&phase.start, None)].into_iter();
    let starts = starts.chain(phase.legs.iter().map(|leg| (&leg.point, leg.datum.as_ref())));
    let ends = starts.zip(&phase.legs).map(|((from, start), leg)| Ends {
        from: from.clone(),
        to: end(leg),
        entry: leg.entry.clone(),
        data: [leg.datum.clone(), start.cloned()],
    });
    ends.collect()
}

fn end(leg: &Leg) -> String {
    if leg.part == "goal" { "the goal".to_owned() } else { leg.point.clone() }
}

fn segments(phase: &Phase, outcome: &Outcome) -> Vec<Segment> {
    let all = names(phase).into_iter().zip(&phase.legs).zip(outcome.flown.iter().zip(&outcome.seen));
    all.map(|((Ends { from, to, .. }, leg), (flown, seen))| Segment {
        from,
        to,
        part: leg.part,
        joint: JOINT_NAMES.get(flown.margin.joint).copied().unwrap_or("joint"),
        margin_deg: flown.margin.radians.to_degrees(),
        nearest: seen.nearest.clone(),
    })
    .collect()
}

/// The path from the goal to the end of the depart leg, with the slower parameters of each segment's ends.
fn backwards(phase: &Phase, departs: usize) -> (Points, Vec<Ends>) {
    let legs = &phase.legs;
    let mut list = Vec::new();
    let mut names = Vec::new();
    for at in (departs.max(1)..legs.len()).rev() {
        let (Some(from), Some(to)) = (legs.get(at), legs.get(at - 1)) else { continue };
        let slower = if to.vel_max < from.vel_max { to } else { from };
        list.push((to.frame, slower.parameters()));
        names.push(Ends {
            from: end(from),
            to: to.point.clone(),
            entry: to.entry.clone(),
            data: [to.datum.clone(), from.datum.clone()],
        });
    }
    (Points { list, opens: 0 }, names)
}

pub(crate) fn in_words(trouble: MotionError) -> (String, String, f64) {
    match trouble {
        MotionError::Joints { problem, joint, at: [x, y, z] } => {
            let code = Warning::from(problem).text();
            let what = match joint {
                Some((joint, by)) => {
                    let name = JOINT_NAMES.get(joint).copied().unwrap_or("joint");
                    let (low, high) = T3.limits.get(joint).copied().unwrap_or_default();
                    let (low, high) = (low.to_degrees(), high.to_degrees());
                    format!("{name} leaves its limits of {low:.0} and {high:.0} degrees by {by:.2}")
                }
                None if problem == JointProblem::WristSingularity => {
                    "the gripper axis becomes parallel to the pitch axis".to_owned()
                }
                None => "the arm is too short, or too long".to_owned(),
            };
            let text = format!(
                "{what} at ({x:.2}, {y:.2}, {z:.2} in): the robot controller stops with warning {code}, and the link is lost"
            );
            (text, code.to_owned(), joint.map_or(0.0, |(_, by)| by))
        }
        MotionError::Words => {
            ("the link has no words for a position on it".to_owned(), "words".to_owned(), 0.0)
        }
        MotionError::Parameters => {
            ("acc-fac, vel-max and smooth-acc must be positive".to_owned(), "parameters".to_owned(), 0.0)
        }
        MotionError::Endless => ("it takes longer than ten minutes".to_owned(), "time".to_owned(), 0.0),
    }
}
