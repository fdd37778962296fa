//! The lines of the job, and their actions of the workstation.

use closed_loop::workstation::SimulatedWorkstation;
use neighbours::workstation::player::Workstation as _;
use rcs_core::tick::Tick;
use taskdata::load::job::{JobLine, Step, Workstation as Action};

use super::{Activity, DelayedAction, Ended, Operator};

impl Operator<'_> {
    pub(super) fn next(&mut self, tick: Tick, workstation: &mut SimulatedWorkstation) {
        self.current += 1;
        (self.tried, self.second_pause, self.has_finished, self.remedied) = (0, None, false, false);
        (self.began, self.failed_line) = (tick, None);
        let lines = self.lines;
        let Some(line) = lines.get(self.current - 1) else {
            self.doing = Activity::Over;
            return;
        };
        self.doing = Activity::Action;
        match &line.step {
            Step::Command(command) => {
                self.doing = Activity::Command;
                self.later.extend(self.delayed.drain(..).map(|(ticks, action, text)| DelayedAction {
                    due: Tick(tick.0.saturating_add(ticks)),
                    action,
                    text,
                }));
                self.send(tick, command);
            }
            Step::Workstation(Action::Wait { .. }) => {}
            Step::Workstation(_) => self.begin(workstation),
            Step::After { ticks, action } => {
                self.delayed.push((u64::from(*ticks), *action, line.text.clone()))
            }
        }
    }

    /// Begins the current line of the workstation.
    pub(super) fn begin(&mut self, workstation: &mut SimulatedWorkstation) {
        self.doing = Activity::Action;
        let line = self.current.checked_sub(1).and_then(|at| self.lines.get(at));
        if let Some(JobLine { step: Step::Workstation(action), text, .. }) = line
            && let Err(refused) = workstation.begin(action, text)
        {
            self.fail_recovery(format!("workstation: {refused}"));
        }
    }

    /// True if the part of the current line has been machined.
    pub(super) fn is_machined(&self, workstation: &SimulatedWorkstation) -> bool {
        let line = self.current.checked_sub(1).and_then(|at| self.lines.get(at));
        match line.map(|line| &line.step) {
            Some(Step::Workstation(Action::Machine { part, location, .. })) => {
                let is_there = |one: &plant::PartState| {
                    one.name == part.as_str() && one.location == location.name.as_str()
                };
                workstation.cell.parts().iter().any(is_there)
            }
            _ => false,
        }
    }

    /// Notes that devices have not executed the current line of the workstation.
    pub(super) fn note_line(&mut self, tick: Tick, failure: &str) {
        let line = self.current.checked_sub(1).and_then(|at| self.lines.get(at));
        let command = line.map_or_else(String::new, |line| line.text.clone());
        self.ended.push(Ended {
            tick,
            line: self.current,
            command,
            of_job: true,
            failure: failure.to_owned(),
        });
    }

    pub(super) fn is_done(&self, tick: Tick, workstation: &SimulatedWorkstation) -> bool {
        match self.current.checked_sub(1).and_then(|at| self.lines.get(at)).map(|line| &line.step) {
            Some(Step::Workstation(Action::Wait { ticks })) => tick.since(self.began) >= u64::from(*ticks),
            _ => !workstation.busy(),
        }
    }
}
