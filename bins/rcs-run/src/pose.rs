//! `rcs-run pose`: the nine numbers of a pose, whether the arm can reach it, and its form in a file of task data.

mod form;

use std::{
    path::Path,
    process::ExitCode,
    thread,
    time::{Duration, Instant},
};

use diagnostics::alternatives;
use executive::memory::{Attached, OnTimeout, SET_UP_LIMIT, within_limit};
use geometry::{
    frame::{Frame, Vector, rotation_from_x_y},
    pose::Pose,
    units::Length,
};
use interfaces::CommonMemory;
use os_io::console;
use paths::stand::{self, Standing};
use plant::{CellDescription, room::Room};
use rcs_core::name::{Name, Name10};
use runtime::{StartError, setup::CELL};
use taskdata::{files::PoseRecord, load::Store};

use self::form::Kind;
use crate::rcs_run::{
    answer::answer,
    arguments::PoseArguments,
    error::{Error, UNUSABLE},
    memory_fault::stuck,
    status::only_run,
};

/// Limit of coordinates in inches and of angles in degrees, far beyond every arm.
const FARTHEST: f64 = 1000.0;
const RECORD_TICKS: u64 = 3; // ticks until a pressed record button has recorded the pose
const RECORD_LIMIT: Duration = Duration::from_millis(500); // longest wait for these ticks

/// Print a pose, and write its form on request. Exit status 2 if the robot cannot reach the pose, which is then not
/// written.
pub fn pose(arguments: &PoseArguments) -> Result<ExitCode, Error> {
    let store = store(&arguments.data)?;
    let pose = asked(arguments, &store)?;
    if !show(&pose, &store, &arguments.data, arguments.json)? {
        return Ok(ExitCode::from(UNUSABLE));
    }
    if let (Some(file), Some(name)) = (&arguments.write, arguments.name) {
        write(arguments, file, name, &pose, &store)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `check --where NAME`: the same as `pose --of NAME`.
pub fn place(data: &Path, name: &str, json: bool) -> Result<ExitCode, Error> {
    let store = store(data)?;
    let is_usable = show(&named(name, &store)?.pose, &store, data, json)?;
    Ok(ExitCode::from(if is_usable { 0 } else { UNUSABLE }))
}

fn store(data: &Path) -> Result<Store, Error> {
    let what = || format!("the task data under {}", data.display());
    let loaded = Store::load(data).map_err(|report| StartError::Data { what: what(), report });
    Ok(loaded?.0)
}

/// Print the pose and the arm's joints in it. Returns true if the robot can reach it.
fn show(pose: &Pose, store: &Store, data: &Path, json: bool) -> Result<bool, Error> {
    let path = data.join(CELL);
    let cell =
        CellDescription::load(&path).map_err(|error| Error::Pose(format!("{}: {error}", path.display())))?;
    let answered = Standing::of(pose, &store.view(), &Room::new(&cell)).map_err(Error::Pose)?;
    answer(&answered, json)?;
    if !answered.is_usable() {
        os_io::stderr_line!("rcs-run: the robot cannot stand there");
    }
    Ok(answered.is_usable())
}

fn asked(arguments: &PoseArguments, store: &Store) -> Result<Pose, Error> {
    if let [x, y, z] = *arguments.point {
        let frame = standing([x, y, z], arguments.azimuth, arguments.tilt, arguments.roll);
        return frame.map(|frame| Pose::from_frame(&frame)).map_err(Error::Pose);
    }
    if let Some(name) = &arguments.of {
        return named(name, store).map(|record| record.pose);
    }
    let run = arguments.run.clone().map_or_else(only_run, Ok)?;
    let attached = within_limit(SET_UP_LIMIT, Some(stuck as OnTimeout), || Attached::open(&run))?;
    let memory = settled(&attached)?;
    let recorded = memory.prim.status.recorded_pose.and_then(|number| memory.changing_pose(number).copied());
    recorded.ok_or_else(|| {
        let how = "press the button of the joystick box, or ask for `joystick record`";
        Error::Pose(format!("no pose has been recorded in the run {run}: {how}"))
    })
}

/// Common memory some ticks later, because `joystick record` is executed in the tick after its answer.
fn settled(attached: &Attached) -> Result<CommonMemory, Error> {
    let first = attached.memory()?;
    let begun = Instant::now();
    loop {
        let memory = attached.memory()?;
        let tick = |memory: &CommonMemory| memory.prim.header.stamp;
        if tick(&memory).0.saturating_sub(tick(&first).0) >= RECORD_TICKS || begun.elapsed() > RECORD_LIMIT {
            return Ok(memory);
        }
        thread::sleep(Duration::from_millis(5));
    }
}

fn named<'a>(name: &str, store: &'a Store) -> Result<&'a PoseRecord, Error> {
    let data = store.view();
    let unknown = || {
        let known: Vec<_> = data.poses.iter().map(|record| record.name.to_string()).collect();
        let others = alternatives(name, known.iter().map(String::as_str), "there are");
        Error::Pose(format!("no pose is named {name}: {others}"))
    };
    let name: Name10 = Name::new(name).map_err(|_| unknown())?;
    data.pose_named(&name).and_then(|id| data.pose(id)).ok_or_else(unknown)
}

/// The frame of a tool at a point (in), tilted from straight down towards an azimuth and turned by a roll, degrees.
pub fn standing([x, y, z]: [f64; 3], azimuth: f64, tilt: f64, roll: f64) -> Result<Frame, String> {
    let wrong =
        |numbers: [f64; 3]| numbers.into_iter().find(|number| !(-FARTHEST..=FARTHEST).contains(number));
    if let Some(found) = wrong([x, y, z]) {
        return Err(format!("coordinates up to {} were expected, found {}", Length(FARTHEST), Length(found)));
    }
    if let Some(found) = wrong([azimuth, tilt, roll]) {
        return Err(format!("angles up to {FARTHEST} degrees were expected, found {found} degrees"));
    }
    let [azimuth, tilt, roll] = [azimuth, tilt, roll].map(f64::to_radians);
    let pointing = Vector::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), -tilt.cos());
    let level = Vector::new(-azimuth.sin(), azimuth.cos(), 0.0);
    let finger = level * roll.cos() + pointing.cross(&level) * roll.sin();
    let rotation = rotation_from_x_y(&pointing, &finger).ok_or("angles and coordinates must be numbers")?;
    Ok(Frame { position: Vector::new(x, y, z), rotation })
}

fn write(
    arguments: &PoseArguments,
    file: &Path,
    name: Name10,
    pose: &Pose,
    store: &Store,
) -> Result<(), Error> {
    let text =
        os_io::files::read_text(file).map_err(|source| StartError::Read { path: file.to_owned(), source })?;
    let name = name.to_string();
    let (kind, form) = match &arguments.relative {
        None => (Kind::Pose, stand::pose_form(&name, &arguments.movetable, pose)),
        Some(from) => {
            let to = pose.to_frame().map_err(|error| Error::Pose(error.to_string()))?;
            let lines = stand::movetable_between(&named(from, store)?.frame, &to);
            (Kind::Movetable, stand::movetable_form(&name, &lines))
        }
    };
    let changed = form::put(&text, arguments.block, kind, &name, form)
        .map_err(|why| Error::Pose(format!("{}: {why}", file.display())))?;
    os_io::replace::replace_text(file, &changed.text)
        .map_err(|source| Error::Write { path: file.to_owned(), source })?;
    let lines = changed.removed.iter().map(|line| format!("-{line}\n"));
    let lines = lines.chain(changed.added.iter().map(|line| format!("+{line}\n"))).collect::<String>();
    console::answer(&format!("{} line {}\n{lines}", file.display(), changed.line))?;
    Ok(())
}
