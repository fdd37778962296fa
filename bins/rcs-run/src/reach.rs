//! `rcs-run check --robot NAME`: checks whether the arm of another robot follows the T3's tool through all jobs, and
//! reaches every taught pose. Under EGM a robot keeps its configuration, so the check reports the best start.

use std::{fmt, panic::resume_unwind, path::Path, thread};

use diagnostics::{JOBS, ROBOTS};
use executive::egm::{
    Placement, RobotFile,
    arm::{Arm, Axes, Track},
    placement::PlacementError,
};
use geometry::{frame::Frame, kinematics::T3};
use paths::{
    flight::Robot,
    job::{WalkedJob, walk_job},
    known::Known,
};
use plant::{CellDescription, description::Actuators, room::Room};
use rcs_core::tick::TICK_S;
use runtime::{StartError, setup::CELL};
use serde::Serialize;
use taskdata::load::{Job, Store};

use crate::rcs_run::error::Error;

#[derive(Debug, Serialize)]
pub struct Reach {
    robot: String,
    arm: String,
    /// Angles of the axes at which EGM must begin, at the start of the jobs, degrees.
    start_deg: Option<Axes>,
    poses: usize, // number of taught poses and location points that the T3 reaches
    poses_out_of_reach: Vec<String>, // names of the poses that the arm does not reach
    jobs: Vec<JobReach>,
}

#[derive(Clone, Debug, Serialize)]
struct JobReach {
    job: String,
    ways: usize, // number of motions from point to point that the arm follows
    /// The axis, from 1, that is nearest to a limit, and its distance from the limit, degrees.
    axis: usize,
    margin_deg: f64,
    wrist_deg: f64,     // smallest angle of the wrist from the straight position, degrees
    speeds_deg_s: Axes, // greatest speed of each axis, degrees/s
    trouble: Option<RouteProblem>,
}

#[derive(Clone, Debug, Serialize)]
struct RouteProblem {
    line: u32,
    way: String,
    at_mm: [f64; 3], // position of the tool in the work object, mm
    why: String,
}

struct Bench<'a> {
    placement: Placement,
    arm: Arm,
    room: &'a Room,
}

impl Reach {
    /// Check all jobs and poses of a data directory that have no errors.
    pub fn of(data: &Path, robot: &str) -> Result<Self, Error> {
        let path =
            ROBOTS.find(Path::new(robot), data).map_err(PlacementError::from).map_err(StartError::from)?;
        let RobotFile { placement, arm, .. } = RobotFile::load(&path).map_err(StartError::from)?;
        let Some(arm) = arm else {
            return Err(Error::Reach(format!(
                "{robot} has no [arm]: add its lengths, limits and speeds, as in data/robots/irb6700.toml"
            )));
        };
        let (store, _) = Store::load(data).map_err(|report| StartError::Data {
            what: format!("the task data under {}", data.display()),
            report,
        })?;
        let cell = CellDescription::load(&data.join(CELL))
            .map_err(|error| Error::Reach(format!("{}: {error}", data.join(CELL).display())))?;
        let room = &Room::new(&cell);
        let bench = Bench { placement, arm, room };
        let starts = bench.arm.solutions(&bench.pose(&T3.forward_plate(&cell.robot.start_joints())));
        let (poses, poses_out_of_reach) = bench.poses(&store);
        let all = bench.jobs(data, &store, &starts);
        let best = (0..starts.len()).max_by(|a, b| score(&all, *a).total_cmp(&score(&all, *b)));
        let jobs = best.map_or_else(Vec::new, |best| {
            all.into_iter().filter_map(|of_starts| of_starts.into_iter().nth(best)).collect()
        });
        Ok(Self {
            robot: robot.to_owned(),
            arm: bench.arm.name().to_owned(),
            start_deg: best.and_then(|best| starts.get(best)).map(|axes| axes.map(f64::to_degrees)),
            poses,
            poses_out_of_reach,
            jobs,
        })
    }

    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.start_deg.is_some()
            && self.poses_out_of_reach.is_empty()
            && self.jobs.iter().all(|job| job.trouble.is_none())
    }
}

/// Rating of a start by its finished jobs, then its motions, then its margin.
fn score(all: &[Vec<JobReach>], start: usize) -> f64 {
    let jobs = || all.iter().filter_map(|of_starts| of_starts.get(start));
    let done = jobs().filter(|job| job.trouble.is_none()).count();
    let ways: usize = jobs().map(|job| job.ways).sum();
    let margin = jobs().map(|job| job.margin_deg.min(job.wrist_deg)).fold(180.0, f64::min);
    done as f64 * 1e9 + ways as f64 * 1e3 + margin
}

impl Bench<'_> {
    /// Pose of the tool in the work object for a pose of the T3's end plate.
    fn pose(&self, plate: &Frame) -> egm::Pose {
        self.placement.pose(plate)
    }

    /// Number of taught poses that the T3 reaches, and the names of those that the arm does not reach.
    fn poses(&self, store: &Store) -> (usize, Vec<String>) {
        let data = store.view();
        let poses = data.poses.iter().map(|pose| (pose.name, pose.frame));
        let points = data.locpts.iter().map(|point| (point.name, point.frame));
        let start = self.room.cell().robot.start_joints();
        let reached = poses.chain(points).filter_map(|(name, frame)| {
            let joints = T3.inverse(&frame, &start).ok().map(|joints| T3.within_limits(&joints))?;
            (T3.margin(&joints).radians >= 0.0).then(|| (name, T3.forward_plate(&joints)))
        });
        let mut count = 0;
        let mut out = Vec::new();
        for (name, plate) in reached {
            count += 1;
            if self.arm.solutions(&self.pose(&plate)).is_empty() {
                out.push(name.to_string());
            }
        }
        (count, out)
    }

    fn jobs(&self, data: &Path, store: &Store, starts: &[Axes]) -> Vec<Vec<JobReach>> {
        let known = &Known::default();
        let jobs: Vec<_> = JOBS.all(data).iter().filter_map(|path| Job::load(path, store).ok()).collect();
        let follow = |job| self.follow(&walk_job(job, store, self.room, known), starts);
        let follow = &follow;
        thread::scope(|scope| {
            let threads: Vec<_> = jobs.iter().map(|(job, _)| scope.spawn(move || follow(job))).collect();
            threads.into_iter().map(|one| one.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
        })
    }

    /// Follow the T3 through a job from each start.
    fn follow(&self, walked: &WalkedJob, starts: &[Axes]) -> Vec<JobReach> {
        let mut arms: Vec<_> = starts.iter().map(|axes| Follower::new(&self.arm, axes)).collect();
        let robot = &self.room.cell().robot;
        let mut robot = Robot::standing(&Actuators::from(robot), &robot.start_joints());
        for (line, walked) in
            walked.lines.iter().flat_map(|line| line.phases.iter().map(move |one| (line, one)))
        {
            let Some(robot) = robot.as_mut().filter(|_| walked.plan.missing.is_none()) else { continue };
            let legs = &walked.plan.legs;
            let points: Vec<_> = legs.iter().map(|leg| (leg.frame, leg.parameters())).collect();
            if points.is_empty() {
                continue;
            }
            robot.fly(&points, |leg, joints| {
                let tool = self.pose(&T3.forward_plate(joints));
                for arm in &mut arms {
                    arm.go(&self.arm, &tool, || {
                        let name = |at: usize| legs.get(at).map(|leg| leg.point.as_str());
                        let from = leg.checked_sub(1).map_or(Some(walked.plan.start.as_str()), name);
                        let (from, to) = (from.unwrap_or_default(), name(leg).unwrap_or_default());
                        (line.line, format!("{}, from {from} to {to}", walked.plan.what))
                    });
                }
            });
            arms.iter_mut().for_each(|arm| arm.arrive(points.len()));
        }
        arms.into_iter().map(|arm| arm.end(&walked.job)).collect()
    }
}

struct Follower {
    track: Track,
    ways: usize,
    trouble: Option<RouteProblem>,
}

impl Follower {
    fn new(arm: &Arm, axes: &Axes) -> Self {
        Self { track: Track::begin(arm, axes), ways: 0, trouble: None }
    }

    /// Advance by a tick; `place` gives the line of the job and the name of the motion, for messages.
    fn go(&mut self, arm: &Arm, tool: &egm::Pose, place: impl Fn() -> (u32, String)) {
        if self.trouble.is_some() {
            return;
        }
        if let Err(hindrance) = self.track.go(arm, tool, TICK_S) {
            let (line, way) = place();
            self.trouble = Some(RouteProblem { line, way, at_mm: tool.position, why: hindrance.to_string() });
        }
    }

    fn arrive(&mut self, ways: usize) {
        if self.trouble.is_none() {
            self.ways += ways;
        }
    }

    fn end(self, job: &str) -> JobReach {
        let (axis, margin_deg) = self.track.margin;
        JobReach {
            job: job.to_owned(),
            ways: self.ways,
            axis: axis + 1,
            margin_deg,
            wrist_deg: self.track.wrist,
            speeds_deg_s: self.track.speeds,
            trouble: self.trouble,
        }
    }
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reached = self.poses - self.poses_out_of_reach.len();
        writeln!(f, "robot {} ({}):", self.robot, self.arm)?;
        writeln!(f, "  {reached} of {} taught poses and location points are within reach", self.poses)?;
        for name in &self.poses_out_of_reach {
            writeln!(f, "  ERROR {name} is out of reach")?;
        }
        let Some(start) = self.start_deg else {
            return writeln!(f, "  ERROR the start of the jobs is out of reach: no job was followed");
        };
        for job in &self.jobs {
            write!(f, "  {:<16} ", job.job)?;
            match &job.trouble {
                None => writeln!(
                    f,
                    "{:>4} ways; axis {} comes within {:.1} degrees of its limit, the wrist within {:.1} of straight",
                    job.ways, job.axis, job.margin_deg, job.wrist_deg
                ),
                Some(RouteProblem { line, way, at_mm: [x, y, z], why }) => writeln!(
                    f,
                    "{:>4} ways, then ERROR line {line}: {way}: {why} at ({x:.0}, {y:.0}, {z:.0}) mm",
                    job.ways
                ),
            }?;
        }
        let speeds = self.jobs.iter().flat_map(|job| job.speeds_deg_s);
        let start = start.map(|degrees| format!("{:.1}", (degrees * 10.0).round() / 10.0 + 0.0)).join(", ");
        writeln!(f, "  jStart for the RAPID program: [{start}]")?;
        writeln!(
            f,
            "  fastest axis: {:.0} degrees/s; \\MaxSpeedDeviation must allow it",
            speeds.fold(0.0, f64::max)
        )
    }
}
