//! `rcs-run pose`: the nine numbers of a pose, whether the arm can take it, and the form with it in a file of task data.

mod form;

use std::{fmt, path::PathBuf, process::ExitCode};

use executive::memory::{Attached, OnStuck, SET_UP_LIMIT, within_limit};
use geometry::{
    frame::{Frame, Vector, rotation_from_x_y},
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
    pose::Pose,
};
use os_io::console;
use plant::{
    CellDescription,
    clearance::Contact,
    description::Kind,
    room::{Layout, Room},
};
use rcs_core::name::{Name, Name10};
use runtime::{StartError, setup::CELL};
use serde::Serialize;
use taskdata::load::Store;

use crate::{
    answer,
    cli::PoseArguments,
    error::{Error, UNUSABLE},
    memory_fault::stuck,
    status::only_run,
};

/// How far around the arm is looked for obstacles, inches.
const NEAR: f64 = 12.0;
/// Greatest coordinate, inches, and greatest angle, degrees: far beyond every arm.
const FARTHEST: f64 = 1000.0;
/// So many named poses are shown.
const NAMED: usize = 3;

/// A pose, and what the arm makes of it. Angles are in degrees, lengths in inches.
#[derive(Serialize)]
struct Answer {
    /// Wrist, tool and finger point, 0.01 in.
    points: [[i32; 3]; 3],
    /// Of the six joints; missing if the arm cannot reach it.
    joints: Option<[f64; 6]>,
    /// Why not.
    unreachable: Option<String>,
    /// The joint nearest to a limit, and how far it is from it; negative beyond it.
    margin: Option<(&'static str, f64)>,
    /// What is nearest to the robot as it stands at the start of a run, and how near.
    clearance: Option<(String, String, f64)>,
    /// The nearest poses with a name, and how far their tool points are.
    named: Vec<(String, f64)>,
}

impl Answer {
    fn of(frame: &Frame, points: [[i32; 3]; 3], store: &Store, room: &Room) -> Self {
        let (joints, unreachable) = match T3.inverse(frame, &HOME_JOINTS) {
            Ok(joints) => (Some(T3.within_limits(&joints)), None),
            Err(error) => (None, Some(error.to_string())),
        };
        let margin = joints.map(|joints| T3.margin(&joints));
        let name = |joint: usize| JOINT_NAMES.get(joint).copied().unwrap_or("joint");
        let clearance = joints.and_then(|joints| {
            let layout: Layout = room.at_start();
            let contacts = room.look(&room.movers(&layout, &joints), &room.devices(&layout), NEAR);
            // Its own links are always near; they count where they touch.
            let counts = |contact: &Contact| contact.touches() || contact.obstacle_kind != Kind::Arm;
            let nearest =
                contacts.into_iter().filter(counts).max_by(|one, other| one.depth.total_cmp(&other.depth))?;
            Some((nearest.mover, nearest.obstacle, -nearest.depth))
        });
        let mut named: Vec<_> = store
            .view()
            .poses
            .iter()
            .map(|record| (record.name.to_string(), (record.frame.position - frame.position).norm()))
            .collect();
        named.sort_by(|(_, one), (_, other)| one.total_cmp(other));
        named.truncate(NAMED);
        Self {
            points,
            joints: joints.map(|joints| joints.map(f64::to_degrees)),
            unreachable,
            margin: margin.map(|margin| (name(margin.joint), margin.radians.to_degrees())),
            clearance,
            named,
        }
    }

    /// Whether a robot can stand there.
    fn is_usable(&self) -> bool {
        let touches = |(_, _, inches): &(String, String, f64)| *inches < 0.0;
        self.margin.is_some_and(|(_, degrees)| degrees >= 0.0)
            && !self.clearance.as_ref().is_some_and(touches)
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (point, [x, y, z]) in ["wrist ", "tool  ", "finger"].iter().zip(self.points) {
            writeln!(f, "{point} {x:>8} {y:>8} {z:>8}   0.01 in")?;
        }
        if let Some(why) = &self.unreachable {
            writeln!(f, "arm     {why}")?;
        }
        if let Some(joints) = self.joints {
            let words = JOINT_NAMES.iter().zip(joints).map(|(name, angle)| {
                // Adding zero makes a zero of a negative one.
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
            None if self.joints.is_some() => writeln!(f, "cell    nothing within {NEAR:.0} in")?,
            None => {}
        }
        let named = self.named.iter().map(|(name, inches)| format!("{name} {inches:.2} in"));
        writeln!(f, "near    {}", named.collect::<Vec<_>>().join(", "))
    }
}

/// Print a pose, and write its form if that was asked for. Exit status 2 if the robot cannot stand there; then nothing is
/// written.
///
/// # Errors
/// [`Error`] if the data or the run cannot be read, or the file cannot be written.
pub fn pose(arguments: &PoseArguments) -> Result<ExitCode, Error> {
    let data = &arguments.data;
    let (store, _) = Store::load(data).map_err(|report| StartError::Data {
        what: format!("the task data under {}", data.display()),
        report,
    })?;
    let path = data.join(CELL);
    let cell =
        CellDescription::load(&path).map_err(|error| Error::Pose(format!("{}: {error}", path.display())))?;
    let pose = asked(arguments, &store)?;
    let frame = pose.to_frame().map_err(|error| Error::Pose(error.to_string()))?;
    let answered = Answer::of(&frame, [pose.wrist, pose.tool, pose.finger], &store, &Room::new(&cell));
    answer(&answered, arguments.json)?;
    if !answered.is_usable() {
        os_io::stderr_line!("rcs-run: the robot cannot stand there");
        return Ok(ExitCode::from(UNUSABLE));
    }
    if let (Some(file), Some(name)) = (&arguments.write, arguments.name) {
        write(arguments, file, name, &pose)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The pose that is asked about.
fn asked(arguments: &PoseArguments, store: &Store) -> Result<Pose, Error> {
    if let [x, y, z] = *arguments.point {
        let frame = standing([x, y, z], arguments.azimuth, arguments.tilt, arguments.roll);
        return frame.map(|frame| Pose::from_frame(&frame)).map_err(Error::Pose);
    }
    if let Some(name) = &arguments.of {
        let unknown = || {
            let known: Vec<_> = store.view().poses.iter().map(|record| record.name.to_string()).collect();
            Error::Pose(format!("no pose is named {name}; there are {}", known.join(", ")))
        };
        let name: Name10 = Name::new(name).map_err(|_| unknown())?;
        let data = store.view();
        let record = data.pose_named(&name).and_then(|id| data.pose(id)).ok_or_else(unknown)?;
        return Ok(record.pose);
    }
    let run = arguments.run.clone().map_or_else(only_run, Ok)?;
    let attached = within_limit(SET_UP_LIMIT, Some(stuck as OnStuck), || Attached::open(&run))?;
    let memory = attached.memory()?;
    let recorded = memory.prim.status.recorded_pose.and_then(|number| memory.changing_pose(number).copied());
    recorded.ok_or_else(|| {
        let how = "press the button of the joystick box, or ask for `joystick record`";
        Error::Pose(format!("no pose has been recorded in the run {run}: {how}"))
    })
}

/// The frame of a tool that stands at a point (in), leans from straight down by a tilt towards an azimuth, and is turned by a
/// roll, degrees.
///
/// # Errors
/// Which number is no place for a robot.
pub fn standing([x, y, z]: [f64; 3], azimuth: f64, tilt: f64, roll: f64) -> Result<Frame, String> {
    let given = [x, y, z, azimuth, tilt, roll];
    if let Some(found) = given.iter().find(|number| !(-FARTHEST..=FARTHEST).contains(*number)) {
        let expected = format!("numbers from -{FARTHEST} to {FARTHEST} were expected");
        return Err(format!("{expected}, inches and degrees; found {found}"));
    }
    let [azimuth, tilt, roll] = [azimuth, tilt, roll].map(f64::to_radians);
    let pointing = Vector::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), -tilt.cos());
    let level = Vector::new(-azimuth.sin(), azimuth.cos(), 0.0);
    let finger = level * roll.cos() + pointing.cross(&level) * roll.sin();
    let rotation = rotation_from_x_y(&pointing, &finger).ok_or("angles and coordinates must be numbers")?;
    Ok(Frame { position: Vector::new(x, y, z), rotation })
}

/// Put the form into the file, and say what has changed.
fn write(arguments: &PoseArguments, file: &PathBuf, name: Name10, pose: &Pose) -> Result<(), Error> {
    let text =
        os_io::files::read_text(file).map_err(|source| StartError::Read { path: file.clone(), source })?;
    let changed = form::put(&text, arguments.block, &name.to_string(), &arguments.movetable, pose)
        .map_err(|why| Error::Pose(format!("{}: {why}", file.display())))?;
    std::fs::write(file, &changed.text).map_err(|source| Error::Write { path: file.clone(), source })?;
    let lines = changed.removed.iter().map(|line| format!("-{line}\n"));
    let lines = lines.chain(changed.added.iter().map(|line| format!("+{line}\n"))).collect::<String>();
    console::answer(&format!("{} line {}\n{lines}", file.display(), changed.line))?;
    Ok(())
}
