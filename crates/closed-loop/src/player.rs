//! Plays a job on a closed loop.

use std::convert::Infallible;

use executive::course::Levels;
use neighbours::{
    mailbox::{HWSC_COMMAND, Mailbox},
    workstation::{
        Unchecked, command,
        player::{Hwsc, JobFailure, Progress, TIME_LIMIT},
        status,
    },
};
use taskdata::{files::TaskData, load::job::JobLine};

use crate::{ClosedLoop, Given};

/// The emulator of the workstation controller with a job, and its command mailbox. A copy continues from the same line.
#[derive(Clone, Debug)]
pub struct JobPlayer {
    hwsc: Hwsc,
    command_box: Mailbox,
}

impl JobPlayer {
    /// A player before the first line of a job that was checked with its task data.
    #[must_use]
    pub fn new(steps: Vec<JobLine>) -> Self {
        Self { hwsc: Hwsc::new(steps, TIME_LIMIT), command_box: Mailbox::initialized(HWSC_COMMAND) }
    }

    /// Run one tick of a loop that this player commands, without anything from outside.
    pub fn step<L>(&mut self, closed: &mut ClosedLoop<L>) -> Progress
    where
        L: for<'a> Levels<TaskData<'a>, Error = Infallible>,
    {
        let Ok(()) = closed.decide(&Given::default());
        closed.settle(None);
        let Self { hwsc, command_box } = self;
        let progress = closed.exchange(|desk| {
            let refused = |why: String| Progress::Failed(JobFailure::Refused(why));
            let status = match status::decode(desk.gate.status_box().data()) {
                Ok(status) => status,
                Err(error) => return refused(error.to_string()),
            };
            let progress = hwsc.step(desk.tick, &status, desk.workstation).clone();
            if let Some(command) = hwsc.mailgram() {
                let written = command::encode(command)
                    .map_err(|error| error.to_string())
                    .and_then(|bytes| command_box.write(&bytes).map_err(|error| error.to_string()));
                if let Err(why) = written {
                    return refused(why);
                }
            }
            desk.gate.read(command_box, &Unchecked);
            progress
        });
        closed.reload();
        progress
    }
}
