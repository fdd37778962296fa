//! `rcs-run io-release`: switches off outputs that an earlier controller has left on.

use std::{process::ExitCode, time::Duration};

use couplers::{Mode, State};
use os_io::{console, stderr_line};

use super::{Bench, Obstacle, Person};
use crate::rcs_run::{
    arguments::IoReleaseArguments,
    error::{Error, FAILED},
};

/// Time for which the safe outputs are written before they are read back.
const WRITTEN_FOR: Duration = Duration::from_millis(200);

/// Asks for each device that has outputs on. Exit status 0 if all have confirmed the safe outputs, 1 if not.
pub fn release(arguments: &IoReleaseArguments) -> Result<ExitCode, Error> {
    let (bench, person) = (Bench::open(&arguments.mapping)?, Person::new());
    let mut is_done = true;
    for (index, device) in bench.mapping.devices.iter().enumerate() {
        let name = &device.name;
        let on = match outputs_on(&bench, index) {
            Ok(on) if on.is_empty() => {
                console::answer(&format!("{name}: no output is on that may not be on at rest\n"))?;
                continue;
            }
            Ok(on) => on.join(", "),
            Err(why) => {
                stderr_line!("rcs-run: {why}");
                is_done = false;
                continue;
            }
        };
        stderr_line!("{name}: {on} on. A part that is held by them may fall, and air may be released.");
        if !person.ask(&format!("Is the robot switched off, and shall the outputs of {name} become safe?"))? {
            console::answer(&format!("{name}: unchanged\n"))?;
            is_done = false;
            continue;
        }
        let confirmed = make_safe(&bench, index);
        is_done &= confirmed == Ok(true);
        let text = match confirmed {
            Ok(true) => "safe, and confirmed".to_owned(),
            Ok(false) => "NOT confirmed: look at the device".to_owned(),
            Err(why) => why,
        };
        console::answer(&format!("{name}: {text}\n"))?;
    }
    Ok(if is_done { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

/// The outputs of a device that are on although they must be off at rest.
fn outputs_on(bench: &Bench, index: usize) -> Result<Vec<String>, String> {
    match bench.probe(index, Mode::Watch) {
        Ok(probe) => {
            probe.end();
            Ok(Vec::new())
        }
        Err(Obstacle { on: Some(outputs), .. }) => {
            let named = bench.mapping.outputs_on(index, &outputs).map(|point| point.name.clone());
            let names: Vec<String> = named.collect();
            Ok(if names.is_empty() { vec!["outputs without a name".to_owned()] } else { names })
        }
        Err(Obstacle { text, on: None }) => Err(text),
    }
}

fn make_safe(bench: &Bench, index: usize) -> Result<bool, String> {
    let mut probe = bench.probe(index, Mode::Safe).map_err(|hindrance| hindrance.text)?;
    probe.exchange_for(WRITTEN_FOR);
    let is_written = matches!(probe.report().state, State::Tripped(_));
    Ok(probe.end() && is_written)
}
