//! `rcs-run check --explain COMMAND`: shows the complete motion of a command from the task data.
//!
//! E-move's own route ([`paths::walk`]) looks up places, grips, approaches and trajectories, so the output
//! shows the motion of a run. Times are those of Prim's motion with the knob at full speed. They exclude
//! fingers, camera and pedestal, and the lag of line and arm.

use std::{fmt, process::ExitCode};

use geometry::units::{Length, inches};
use interfaces::HwsCommand;
use os_io::console;
use paths::{
    plan::{Leg, Phase},
    steps,
    uses::Present,
    walk::{self, Walk},
};
use rcs_core::name::Name16;
use runtime::{StartError, judge};
use serde::Serialize;
use taskdata::load::{Diagnostics, Step, Store, job::reported_command};

use crate::rcs_run::{
    answer::answer_long_json,
    arguments::CheckArguments,
    error::{Error, UNUSABLE},
};

#[derive(Clone, Debug, Serialize)]
struct Explanation {
    command: String,
    from: String,
    gripper: Option<i32>, // `endeff-id#` of the object; `None` if any gripper will do
    phases: Vec<Phase>,
    motion_s: f64, // time of the motion alone, s
}

/// Explain a command of [`CheckArguments`]. Exit status 2 if a path is missing.
pub fn explain(arguments: &CheckArguments, text: &str) -> Result<ExitCode, Error> {
    let (store, _) = Store::load_with_faults(&arguments.data);
    let what = format!("the command {text}");
    let command = command_of(text, &store).map_err(|report| StartError::Data { what, report })?;
    let explanation = explained(&store, &command, text, &arguments.from)?;
    let complete = explanation.phases.iter().all(|phase| phase.missing.is_none());
    if arguments.json {
        answer_long_json(&explanation)?;
    } else {
        console::answer(&explanation.to_string())?;
    }
    if !complete {
        os_io::stderr_line!("rcs-run: a path is missing: see the lines with MISSING");
    }
    let wrong = judge::verdict(&command, &store, &present(&arguments.from, &store), false);
    if let Some(wrong) = &wrong {
        os_io::stderr_line!("rcs-run: a run refuses this command: {wrong}");
    }
    Ok(ExitCode::from(if complete && wrong.is_none() { 0 } else { UNUSABLE }))
}

/// Read the nine fields of a command, with or without `==`, and check it.
fn command_of(text: &str, store: &Store) -> Result<HwsCommand, Box<Diagnostics>> {
    match reported_command(text, store)?.step {
        Step::Command(command) => Ok(command),
        Step::Workstation(_) | Step::After { .. } => Err(Box::default()),
    }
}

fn present(from: &str, store: &Store) -> Present {
    let location = store.view().resolve_location::<16, 16>(&Name16::clipped(from), None, None);
    let place = location.map(|location| *Walk::new(store, &location).place()).unwrap_or_default();
    Present { place, ..Present::default() }
}

fn explained(store: &Store, command: &HwsCommand, text: &str, from: &str) -> Result<Explanation, Error> {
    let data = store.view();
    let start = data
        .resolve_location::<16, 16>(&Name16::clipped(from), None, None)
        .map_err(|error| Error::Explain(format!("--from {from}: {error}")))?;
    let steps = steps::steps(command, None, &data).map_err(|error| Error::Explain(error.to_string()))?;
    let mut walk = Walk::new(store, &start);
    let phases: Vec<Phase> = steps.iter().map(|step| walk.step(step)).collect();
    let grips = command.object.and_then(|object| data.obj_grips(&object));
    let ticks = phases.iter().map(Phase::ticks).sum();
    Ok(Explanation {
        command: text.to_owned(),
        from: from.to_owned(),
        gripper: grips.map(|grips| grips.endeff_id).filter(|id| *id != 0),
        phases,
        motion_s: walk::seconds(ticks),
    })
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\nfrom {}", self.command, self.from)?;
        match self.gripper {
            None => writeln!(f)?,
            Some(id) => writeln!(f, ", gripper {id} attached")?,
        }
        for (i, phase) in self.phases.iter().enumerate() {
            writeln!(f, "\n{}. {}", i + 1, phase.what)?;
            phase_lines(phase, f)?;
        }
        let counted =
            "motion alone, full speed; without fingers, camera, pedestal and the lag of line and arm";
        writeln!(f, "\n{:.1} s ({counted})", self.motion_s)
    }
}

fn phase_lines(phase: &Phase, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for entry in &phase.entries {
        writeln!(f, "     {:<11}{}", entry.what, entry.at)?;
    }
    if let Some(opening) = phase.opening_in {
        writeln!(f, "     fingers    {opening:.2} in open after the last depart point")?;
    }
    for leg in &phase.legs {
        leg_line(leg, f)?;
    }
    if let Some(missing) = &phase.missing {
        writeln!(f, "     MISSING    {missing}")?;
    }
    if !phase.legs.is_empty() {
        writeln!(f, "     {:.2} s", walk::seconds(phase.ticks()))?;
    }
    Ok(())
}

fn leg_line(leg: &Leg, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let [x, y, z] = leg.position_in;
    write!(
        f,
        "     {:<11}{:<10} ({x:7.2},{y:7.2},{z:7.2} in)  acc {:<3} vel {:<3} smooth {:<3} brk {}  {:5.2} s",
        leg.part,
        leg.point,
        leg.acc_fac,
        leg.vel_max,
        leg.smooth,
        Length(inches(leg.brk_dst)),
        walk::seconds(leg.ticks),
    )?;
    match (leg.joint, leg.margin_deg) {
        (Some(joint), Some(margin)) => write!(f, "  {joint} {margin:.1} deg from its limit")?,
        _ => write!(f, "  out of reach")?,
    }
    match &leg.entry {
        Some(entry) => writeln!(f, "  {entry}"),
        None => writeln!(f),
    }
}

#[cfg(test)]
mod tests;
