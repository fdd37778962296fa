//! `rcs-cell`: the simulated T3 controller behind a pseudo-terminal, a gateway to an EGM robot, an emulated EGM robot,
//! or the whole simulated cell behind Modbus couplers, EGM and vision ([`mod@station`]).
//!
//! Any DEPC host can open the terminal like a T3's serial line: start-up at the console as in IV.3.3, the DEPC
//! function of appendix A, 9600 baud.
//!
//! ```text
//!   console (standard input) ──► plant::t3: start-up, program, DEPC, arm
//!   auto (the operator of --auto) ──►  │      ▲
//!                               line: bytes in time ◄──► pty ◄──► host
//! ```
//!
//! Controller and arm are [`plant::t3`]. They, [`mod@line`], [`auto`] and [`console`] neither read a clock nor do I/O;
//! [`shell`] and [`pty`] do.

mod auto;
mod cli;
mod console;
mod emulate;
mod gateway;
mod host_line;
mod line;
mod pty;
mod shell;
mod station;

use std::{
    path::Path,
    process::ExitCode,
    sync::{Arc, atomic::AtomicBool},
};

use depc::fault::{FaultKind, Plan, Rule};
use diagnostics::{FAULTS, Source};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::{cli::Cli, emulate::Emulation, gateway::Gateway, pty::Pty, shell::Shell, station::Station};

const FAILED: u8 = 1; // exit status if the pseudo-terminal fails during the run
const UNUSABLE: u8 = 2; // exit status if the program cannot start

fn main() -> ExitCode {
    programs::shipped::carry();
    let cli: Cli = programs::pages::parse();
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        if let Err(error) = signal_hook::flag::register(signal, Arc::clone(&stop)) {
            return fail(UNUSABLE, &format!("the signal handler cannot be installed: {error}"));
        }
    }
    if let Some(mapping) = &cli.station {
        return match Station::new(&cli, mapping) {
            Ok(mut station) => match station.run(&stop) {
                Ok(()) => ExitCode::SUCCESS,
                Err(reason) => fail(FAILED, &reason),
            },
            Err(reason) => fail(UNUSABLE, &reason),
        };
    }
    let Some(link) = &cli.link else { return emulate(&cli, &stop) };
    let plan = match cli.faults.as_deref().map(|name| plan(name, &cli.data)).transpose() {
        Ok(plan) => plan,
        Err(reason) => return fail(UNUSABLE, &reason),
    };
    let pty = match Pty::open(link) {
        Ok(pty) => pty,
        Err(error) => return fail(UNUSABLE, &error.to_string()),
    };
    let ended = match &cli.egm {
        Some(options) => match Gateway::new(options, &cli.data, cli.period, pty) {
            Ok(mut gateway) => gateway.run(&stop),
            Err(reason) => return fail(UNUSABLE, &reason),
        },
        None => Shell::new(&cli, plan.as_ref(), pty, stop).run(),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(FAILED, &error.to_string()),
    }
}

/// Runs an emulated robot, if the command line asks for one instead of a link or a station.
fn emulate(cli: &Cli, stop: &Arc<AtomicBool>) -> ExitCode {
    let target = cli.emulate.as_ref().ok_or_else(|| "--link, --emulate or --station is needed".to_owned());
    match target.and_then(|target| Emulation::new(target, &cli.data)) {
        Ok(mut emulation) => match emulation.run(stop, &emulate::typed(), |_| ()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => fail(FAILED, &format!("the socket has failed: {error}")),
        },
        Err(reason) => fail(UNUSABLE, &reason),
    }
}

/// Reads a fault plan; an error if the plan has faults that a pseudo-terminal cannot produce.
fn plan(name: &Path, data: &Path) -> Result<Plan, String> {
    let path = FAULTS.find(name, data).map_err(|error| error.to_string())?;
    let refused = |why: String| format!("{}: {why}", path.display());
    let text = os_io::files::read_text(&path).map_err(|error| refused(error.to_string()))?;
    let source = Source { name: path.display().to_string(), text: text.into() };
    let plan = plant::fault::text::parse_line(&source).map_err(|report| report.render_for_stderr())?;
    let useless = |rule: &Rule| rule.kind == FaultKind::CtsLow && !rule.to_controller;
    if plan.rules().iter().any(useless) {
        let why = "cts-low to-host has no effect, a pseudo-terminal has no modem lines: use to-controller";
        return Err(refused(why.to_owned()));
    }
    Ok(plan)
}

fn fail(status: u8, reason: &str) -> ExitCode {
    os_io::stderr_line!("rcs-cell: {reason}");
    ExitCode::from(status)
}
