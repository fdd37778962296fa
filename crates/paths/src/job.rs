//! Walks the lines of a job in order: checks each path, then updates the cell and the held part.

use geometry::kinematics::T3;
use interfaces::HwsCommand;
use plant::{
    description::Actuators,
    room::{Placed, Room},
};
use rcs_core::name::Name16;
use serde::Serialize;
use taskdata::{
    files::{Location, LocptId},
    load::{
        Job, Step as Line, Store,
        job::{Drum, Workstation},
    },
};

use crate::{
    finding::{Finding, Walked},
    flight::Robot,
    holster::{finding, lacking, wanted},
    known::Known,
    plan::{Datum, Phase},
    state::State,
    steps::{Step, exchange, steps},
    survey::Passing,
    walk::Walk,
};

pub const NOT_CHECKED: [&str; 6] = [
    "where a guarded move ends: joints are checked over its whole length, clearances are not",
    "slip of a part in the fingers, and the position of a part that is dropped or pushed",
    "commands of another workstation controller",
    "a start after the joystick, an emergency stop, a retry or PAUSE away from the points of a route",
    "faults of sensors, valves and the link",
    "the lag of the resolvers; the lag of the servos is included",
];
const STANDS: f64 = 0.5; // in: the robot is at the location point
/// Places of a part to try: x and y as shares of the greatest offset, and degrees. Half a turn changes nothing.
const TRIED: [[f64; 3]; 12] = [
    [0.0, 0.0, 22.5],
    [0.0, 0.0, 45.0],
    [0.0, 0.0, 67.5],
    [0.0, 0.0, 85.0],
    [0.0, 0.0, 95.0],
    [0.0, 0.0, 112.5],
    [0.0, 0.0, 135.0],
    [0.0, 0.0, 157.5],
    [-1.0, -1.0, 85.0],
    [-1.0, 1.0, 85.0],
    [1.0, -1.0, 95.0],
    [1.0, 1.0, 95.0],
];

#[derive(Clone, Debug, Serialize)]
pub struct JobLine {
    pub line: u32, // from 1
    pub text: String,
    pub phases: Vec<Walked>,
    pub holds: Option<String>,
    pub tried: usize, // positions of the part
}

impl JobLine {
    /// Ticks of motion, without waiting times.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        self.phases.iter().map(|phase| phase.plan.ticks()).sum()
    }
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct WalkedJob {
    pub job: String,
    pub lines: Vec<JobLine>,
    pub findings: Vec<Finding>,
    pub not_checked: Vec<String>,
}

impl WalkedJob {
    #[must_use]
    pub fn nearest(&self) -> Option<&Passing> {
        let segments = self.lines.iter().flat_map(|line| &line.phases).flat_map(|phase| &phase.segments);
        segments
            .filter_map(|segment| segment.nearest.as_ref())
            .min_by(|a, b| a.clearance_in.total_cmp(&b.clearance_in))
    }
}

/// The job must be valid for the task data. `known` caches flights in the same cell.
#[must_use]
pub fn walk_job(job: &Job, store: &Store, room: &Room, known: &Known) -> WalkedJob {
    walk(job, store, room, known, true)
}

/// Tries only the middle of each sector: four times faster than [`walk_job`].
#[must_use]
pub fn walk_job_once(job: &Job, store: &Store, room: &Room) -> WalkedJob {
    walk(job, store, room, &Known::default(), false)
}

fn walk(job: &Job, store: &Store, room: &Room, known: &Known, tries: bool) -> WalkedJob {
    let mut walked = WalkedJob { job: job.name.clone(), ..WalkedJob::default() };
    let Some(mut state) = start(store, room, known) else {
        walked.not_checked.push("the job: the robot does not start at a location point".to_owned());
        return walked;
    };
    // A command keeps the data that were loaded when it began (docs/design/ownership.md "Reload").
    let mut loaded = None;
    let mut interrupted = false;
    for line in &job.steps {
        let mut unknown = None;
        match &line.step {
            Line::Command(command) => {
                let (done, findings) = command_line(&mut state, command, line, tries);
                walked.lines.push(done);
                walked.findings.extend(findings);
                if let Some(store) = loaded.take() {
                    state.walk.load(store);
                }
                unknown = state.stranded.then_some("the robot does not reach this line");
            }
            Line::Workstation(Workstation::Load { .. })
            | Line::After { action: Workstation::Load { .. }, .. }
                if line.expects_error =>
            {
                unknown = Some("the loaded blocks do not fit the cell");
            }
            Line::Workstation(Workstation::Load { number }) => {
                if let Some(reload) = job.reload(*number) {
                    state.walk.load(&reload.store);
                }
            }
            Line::After { action: Workstation::Load { number }, .. } => {
                loaded = job.reload(*number).map(|reload| &reload.store);
            }
            Line::Workstation(action) => interrupted |= !act(&mut state, action),
            Line::After { action, .. } => interrupted |= !matches!(action, Workstation::Wait { .. }),
        }
        if interrupted && !matches!(line.step, Line::After { .. }) {
            unknown = unknown.or(Some("the position of the robot is not known after this line"));
        }
        if let Some(why) = unknown {
            walked.not_checked.push(format!("what comes after line {}: {why}", line.line));
            break;
        }
    }
    walked
}

/// `None` if the robot is not at a location point.
fn start<'a>(store: &'a Store, room: &'a Room, known: &'a Known) -> Option<State<'a>> {
    let joints = room.cell().robot.start_joints();
    let tool = T3.forward(&joints);
    let data = store.view();
    let away = |at: usize| data.locpt(LocptId::at(at)).map(|point| point.frame.distance(&tool).inches);
    let (_, nearest) = (0..data.locpts.len())
        .filter_map(|at| Some((away(at)?, data.locpts.get(at)?)))
        .filter(|(inches, _)| *inches < STANDS)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let location = data.resolve_location::<10, 16>(&nearest.name, None, None).ok()?;
    let robot = Robot::standing(&Actuators::from(&room.cell().robot), &joints)?;
    Some(State::new(room, known, Walk::new(store, &location), robot))
}

/// With `tries_all`, tries several positions of a part at random in its sector.
fn command_line(
    state: &mut State<'_>,
    command: &HwsCommand,
    of_job: &taskdata::load::job::JobLine,
    tries_all: bool,
) -> (JobLine, Vec<Finding>) {
    let line = of_job.line;
    let random = state.random.iter().position(|part| Some(part.object) == command.object);
    let random = random.map(|at| state.random.remove(at));
    let mut tries = vec![state.clone()];
    let (phases, findings) = run(state, command);
    let mut done = JobLine {
        line,
        text: of_job.text.clone(),
        phases,
        holds: state.held.map(|(object, grip)| format!("{object} with grip {grip:+}")),
        tried: 1,
    };
    let mut all: Vec<(usize, Finding)> = findings.into_iter().map(|one| (0, one)).collect();
    if let Some(part) = random.filter(|_| tries_all) {
        let greatest = state.room.cell().tray_shape.random_offset;
        for [x, y, angle] in TRIED {
            let Some(mut other) = tries.first().cloned() else { break };
            let placement = [x * greatest, y * greatest, angle];
            if !other.deliver(&part.object, &part.location, placement, true) {
                continue;
            }
            let number = tries.len();
            tries.push(other.clone());
            let (phases, more) = run(&mut other, command);
            let lies = format!(
                "with the part {:.2}, {:.2} in from the middle of its sector, turned by {angle:.1} degrees: ",
                placement[0], placement[1]
            );
            let often = x == 0.0 && y == 0.0; // a failure only in the outer corners is improbable: a warning
            all.extend(more.into_iter().map(|one| {
                let (message, error) = (lies.clone() + &one.message, one.error && often);
                (number, Finding { message, error, ..one })
            }));
            done.merge(&phases);
            done.tried += 1;
        }
    }
    let mut worst: Vec<(usize, Finding)> = Vec::new();
    for (number, finding) in all {
        let finding = Finding { line, ..finding };
        match worst.iter_mut().find(|(_, known)| known.key == finding.key) {
            Some(known) if (finding.error, finding.depth) > (known.1.error, known.1.depth) => {
                *known = (number, finding);
            }
            Some(_) => {}
            None => worst.push((number, finding)),
        }
    }
    // Walks the failures again to find via points. The cache supplies checked flights.
    for (number, mut one) in tries.into_iter().enumerate() {
        if !worst.iter().any(|(of, finding)| *of == number && finding.error) {
            continue;
        }
        one.advises = true;
        let (_, advised) = run(&mut one, command);
        for (_, finding) in worst.iter_mut().filter(|(of, _)| *of == number) {
            let same = advised.iter().find(|other| other.key == finding.key);
            finding.help = same.and_then(|same| same.help.clone());
        }
    }
    (done, worst.into_iter().map(|(_, finding)| finding).collect())
}

impl JobLine {
    fn merge(&mut self, others: &[Walked]) {
        for (phase, other) in self.phases.iter_mut().zip(others) {
            for (segment, other) in phase.segments.iter_mut().zip(&other.segments) {
                segment.merge(other);
            }
        }
    }
}

fn run(state: &mut State<'_>, command: &HwsCommand) -> (Vec<Walked>, Vec<Finding>) {
    let data = *state.walk.data();
    let worn = state.layout.gripper;
    let wanted = wanted(command, worn, &data);
    if let Some(lacking) = wanted.and_then(|wanted| lacking(worn, wanted, &data)) {
        let finding = lacking.finding(command, state.walk.store());
        let used = finding.data.iter().map(|datum| datum.at).collect();
        let missing = Some(lacking.to_string());
        let phase = Phase { missing, used, ..Phase::standing(command.command.to_string()) };
        return (vec![Walked::of(phase)], vec![finding]);
    }
    let change = wanted.map_or(Ok(Vec::new()), |wanted| exchange(worn, wanted, &data)).unwrap_or_default();
    let own = match steps(command, state.held, &data) {
        Ok(own) => own,
        Err(error) => {
            let missing =
                Phase { missing: Some(error.to_string()), ..Phase::standing(command.command.to_string()) };
            return (vec![Walked::of(missing)], Vec::new());
        }
    };
    let task = command.command.as_str();
    let mut phases = Vec::new();
    let mut findings = Vec::new();
    for (number, step) in change.iter().chain(&own).enumerate() {
        let (walked, more) = state.step(step, task);
        // The verdict reports missing data of the command's own steps.
        let missing = walked.plan.missing.as_ref().filter(|_| number < change.len());
        findings.extend(missing.map(|missing| no_way(missing, step, &walked.plan)));
        findings.extend(more);
        phases.push(walked);
        if state.stranded {
            break;
        }
    }
    (phases, findings)
}

fn no_way(missing: &str, step: &Step, phase: &Phase) -> Finding {
    let name = match step {
        Step::Go { location, .. } | Step::Relative { location, .. } => location.name.to_string(),
        _ => phase.what.clone(),
    };
    let datum = phase.used.first().map(|&at| Datum { name, at });
    finding(&format!("{}: {missing}", phase.what), None, datum)
}

/// Returns false if the robot's position is then unknown.
fn act(state: &mut State<'_>, action: &Workstation) -> bool {
    match action {
        Workstation::Tray { location, object, offset } => {
            let hundredths = |number: i32| f64::from(number) / 100.0;
            let placement = offset.as_ref().map(|at| [at.x, at.y, at.angle].map(hundredths));
            state.deliver(object, location, placement.unwrap_or_default(), false);
            let nested = state.room.cell().nest.iter().any(|nest| nest.parts.contains(&object.to_string()));
            if placement.is_none() && !nested {
                state.random.push(Random { object: *object, location: *location });
            }
        }
        Workstation::Vise { opening, program, .. } => state.move_vise(*opening, program.as_ref()),
        Workstation::Machine { blank, part, .. } => state.machine(blank, part),
        Workstation::Drum(Drum::Tool(tool)) => state.put_into_drum(tool),
        Workstation::Drum(drum @ (Drum::Grip | Drum::Release)) => state.drum_grips = *drum == Drum::Grip,
        Workstation::Wait { .. } | Workstation::Load { .. } => {}
        Workstation::Joystick(_)
        | Workstation::Press(_)
        | Workstation::Release(_)
        | Workstation::Panel(_)
        | Workstation::Table(_)
        | Workstation::Resolvers(_)
        | Workstation::HandOver => return false,
    }
    true
}

#[derive(Clone, Debug)]
pub struct Random {
    pub object: Name16,
    pub location: Location,
}

/// `None` if the cell has no such part.
#[must_use]
pub fn placed(room: &Room, object: &Name16, frame: geometry::frame::Frame) -> Option<Placed> {
    let kind = room.cell().part(object.as_str())?.clone();
    Some(Placed { kind, frame })
}
