//! Postprocess of V-Grip and Tool-Grip: the valves, and the status to E-move.

use geometry::units::hundredths;
use interfaces::{
    JawsOutputs, Reason,
    device::JawValves,
    jaws::{JawsReport, JawsStatus},
};
use rcs_core::tick::Tick;

use super::{
    state::State,
    tables::{Action, Gripper, StateVariables},
};
use crate::execution::Outcome;

impl State {
    /// Carry out what a row asks for. Air stays on when the fingers have arrived: a part is held as long as
    /// they press. Without the gripper there is none; id pins that have lost their contact leave it as it is.
    pub(super) fn act(&mut self, action: Action, seen: &StateVariables) {
        const NONE: JawValves = JawValves { open: false, close: false };
        match action {
            Action::Close | Action::Open | Action::Wait => {}
            Action::Report(report) => {
                self.found = Some(report);
                self.execution.finish();
            }
            Action::Wrong(report) => {
                self.found = Some(report);
                self.execution.fail(Reason::JawsStuck);
            }
            Action::Refuse(reason) | Action::Fail(reason) => self.execution.fail(reason),
        }
        let air = match (seen.situation.gripper, action) {
            _ if seen.has_gone => NONE,
            (Gripper::Attached, Action::Fail(_)) => NONE,
            (Gripper::Attached, Action::Close) => JawValves { close: true, ..NONE },
            (Gripper::Attached, Action::Open) => JawValves { open: true, ..NONE },
            (Gripper::Detached, _)
            | (Gripper::Attached, Action::Wait | Action::Report(_) | Action::Wrong(_) | Action::Refuse(_)) => {
                self.valves
            }
        };
        if air != self.valves {
            (self.valves, self.air_ticks) = (air, 0);
        }
    }

    /// The outputs of this tick. Of the words of VI.4.2 only `jaws-stuck` is bad news, so it stands for every
    /// failure that finds the fingers nowhere; the reason says which.
    pub(super) fn report(&self, seen: &StateVariables, tick: Tick) -> JawsOutputs {
        let report = match self.execution.outcome {
            Outcome::Idle => JawsReport::Idle,
            Outcome::Executing => JawsReport::Executing,
            Outcome::Done | Outcome::Error | Outcome::Joystick => self.found.unwrap_or(JawsReport::Stuck),
        };
        let mut status = JawsStatus {
            echo: self.execution.receiver.echo,
            report,
            reason: self.execution.reason,
            ..JawsStatus::default()
        };
        if seen.situation.gripper == Gripper::Attached {
            status.size = hundredths(seen.opening);
            status.felt = seen.felt;
            status.velocity = hundredths(seen.velocity);
        }
        JawsOutputs {
            header: self.execution.rows.header(tick, self.step.text()),
            status,
            valves: self.valves,
        }
    }
}
