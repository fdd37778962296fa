//! The end of a run, before which the robot ramps to rest.

use closed_loop::{account::Kind, failure::Failure, rest::AT_LAST};
use interfaces::CommonMemory;
use rcs_core::{digest::Digest, tick::Tick};

use super::Run;
use crate::{event::Event, verdict::Ending};

/// A ramp to rest: the velocity knob is at zero, and no more commands are sent.
pub(super) struct Ramp {
    pub(super) ending: Ending,
    pub(super) ticks: u32,
    pub(super) before: Digest,
}

impl Run {
    /// End the run at the user's request.
    pub(super) fn stop_as_asked(&mut self, tick: Tick) {
        if self.ramp.is_some() {
            return;
        }
        self.observer.message(&format!("tick {tick}: {}", Event::UserStops));
        self.log_event(tick.next(), &Event::UserStops);
        // If another process commands, no job ends by itself.
        let is_commanded = self.neighbours.are_commanding();
        self.end_at_rest(if is_commanded { Ending::Stopped } else { Ending::StoppedByUser });
    }

    /// End a run with the inputs of a log that has ended, if the job waits for an operator: in fast clock it would wait
    /// forever.
    pub(super) fn end_without_inputs(&mut self, tick: Tick) {
        let have_ended = self.ramp.is_none() && self.asked.have_ended(tick);
        if have_ended && self.neighbours.job_under_way().is_ok_and(|job| job.waits_idle()) {
            let text = "the job waits for an operator, and the log with the operator's inputs has ended";
            let failure = Failure::outside(tick, Kind::Job, "operator", text.to_owned());
            self.end_at_rest(Failure { stopped: true, ..failure }.into());
        }
    }

    /// End the run as soon as the robot is at rest. The first ending is kept.
    pub(super) fn end_at_rest(&mut self, ending: Ending) {
        if self.ramp.is_none() {
            self.neighbours.stop_commanding();
            if let Some(announced) = &self.announced {
                announced.say("ends: the robot ramps to rest");
            }
            let before = self.closed.digest();
            self.ramp = Some(Ramp { ending, ticks: 0, before });
        }
    }

    /// After a tick: the ending, once the robot is at rest for it.
    pub(super) fn at_rest(&mut self, memory: &CommonMemory) -> Option<Ending> {
        self.rest.observe(memory);
        let ramp = self.ramp.as_mut()?;
        if !self.rest.is_at_rest() && ramp.ticks < AT_LAST {
            ramp.ticks += 1;
            return None;
        }
        let ending = std::mem::replace(&mut ramp.ending, Ending::Stopped);
        Some(if matches!(ending, Ending::Stopped) { self.left(ending) } else { ending })
    }
}
