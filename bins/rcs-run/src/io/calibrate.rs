//! `rcs-run io-calibrate`: reads a point in two known states, and prints its line for the mapping.

use std::{process::ExitCode, time::Duration};

use couplers::Mode;
use os_io::console;

use super::{Bench, Person};
use crate::rcs_run::{
    arguments::IoCalibrateArguments,
    error::{Error, FAILED},
};

const READINGS: u32 = 50; // number of readings of a state: one second

/// Exit status 0 if the states differ, 1 if not. Fails if the mapping cannot be used, or has no such point.
pub fn calibrate(arguments: &IoCalibrateArguments) -> Result<ExitCode, Error> {
    let bench = Bench::open(&arguments.mapping)?;
    let name = &arguments.point;
    let point = bench.mapping.inputs.iter().find(|point| point.name == *name && point.line().is_some());
    let Some((point, device)) = point.and_then(|point| Some((point, point.device()?))) else {
        let analog = bench.mapping.inputs.iter().filter(|point| point.line().is_some());
        let names: Vec<&str> = analog.map(|point| point.name.as_str()).collect();
        return Err(Error::Field(format!(
            "{name} has no `raw` and `counts` in the mapping: expected one of {}",
            names.join(", ")
        )));
    };
    let counts = match arguments.counts[..] {
        [first, second] => [first, second],
        _ => point.line().map_or([0.0; 2], |line| line.counts),
    };
    let person = Person::new();
    let mut raw = [0.0; 2];
    for (value, counts) in raw.iter_mut().zip(counts) {
        if !person.wait_for_enter(&format!("Bring {name} to {counts} counts"))? {
            return Err(Error::Field("the input has ended before both states were read".to_owned()));
        }
        let mut probe = bench.probe(device, Mode::Watch).map_err(|hindrance| Error::Field(hindrance.text))?;
        let mut sum = 0;
        for _ in 0..READINGS {
            probe.exchange_for(Duration::from_millis(1));
            sum += point.raw(&probe.report().inputs).unwrap_or_default();
        }
        probe.end();
        *value = (sum as f64 / f64::from(READINGS)).round();
    }
    let [low, high] = raw;
    console::answer(&format!(
        "\"{name}\": raw = [{low}, {high}], counts = [{}, {}]\n",
        counts[0], counts[1]
    ))?;
    if low == high {
        os_io::stderr_line!(
            "rcs-run: {name} has the same raw value in both states: is the sensor connected?"
        );
        return Ok(ExitCode::from(FAILED));
    }
    Ok(ExitCode::SUCCESS)
}
