//! `rcs-run board`: runs one board of a run in this process.

use std::{
    process::ExitCode,
    sync::{Arc, atomic::AtomicBool},
};

use executive::{
    boards::{
        Member,
        member::{MemberEnd, end_with_parent},
    },
    memory::{OnTimeout, SET_UP_LIMIT, within_limit},
    realtime::{self, Verdict},
};
use os_io::stderr_line;
use runtime::{StartError, boards, loads::BoardFiles, setup::TaskFiles};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::rcs_run::{
    arguments::BoardArguments,
    error::{Error, STOPPED},
    interrupt::interruption,
    memory_fault::stuck,
};

/// Take a board's place in a run until the run has ended.
pub fn board(arguments: &BoardArguments) -> Result<ExitCode, Error> {
    let stop = match arguments.parent {
        None => interruption()?,
        Some(parent) => {
            // Terminals and service managers send signals to all processes of a run; only board 0 acts on them.
            for signal in [SIGINT, SIGHUP, SIGTERM] {
                signal_hook::flag::register(signal, Arc::default()).map_err(Error::Signals)?;
            }
            if !end_with_parent(parent)? {
                return Ok(ExitCode::from(STOPPED));
            }
            Arc::new(AtomicBool::new(false))
        }
    };
    let TaskFiles { store, job, .. } = TaskFiles::load(&arguments.data, arguments.played(), true)?;
    let fingerprint = boards::fingerprint(&store, &job);
    // Generation 0 is the task data loaded before the first tick; each reload is the next one.
    let mut files = BoardFiles::new(&arguments.run, store, job.reloads)
        .map_err(|source| Error::Start(StartError::Thread(source)))?;
    let join = || Member::join(&arguments.run, arguments.board, fingerprint);
    let mut member = within_limit(SET_UP_LIMIT, Some(stuck as OnTimeout), join)?;
    let name = arguments.board;
    let real_time = member.is_real_time().then(|| realtime::acquire(arguments.cpu));
    let verdict = real_time.as_ref().map(|granted| &granted.verdict);
    if let Some(verdict) = verdict {
        stderr_line!("rcs-run: {name}: real time: {verdict}");
    }
    let punctual = verdict.is_none_or(Verdict::complete);
    if arguments.parent.is_none() {
        stderr_line!("rcs-run: {name} of {} waits for the pulse", arguments.run);
    }
    files.catch_up(member.loaded());
    let end = member.run(files, punctual, &stop)?;
    drop(member);
    Ok(match end {
        MemberEnd::Over => ExitCode::SUCCESS,
        MemberEnd::Asked => {
            stderr_line!("rcs-run: {name} has left {}, which stops without it", arguments.run);
            ExitCode::SUCCESS
        }
        MemberEnd::Replaced => {
            stderr_line!("rcs-run: {name} ends: another process runs this board of {}", arguments.run);
            ExitCode::from(STOPPED)
        }
        MemberEnd::Orphaned => {
            stderr_line!("rcs-run: {name} ends: board 0 of {} is gone", arguments.run);
            ExitCode::from(STOPPED)
        }
    })
}
