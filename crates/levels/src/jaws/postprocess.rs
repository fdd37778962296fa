use geometry::units::hundredths;
use interfaces::{
    JawsOutputs, Reason,
    device::JawValves,
    jaws::{JawsReport, JawsStatus},
};
use rcs_core::tick::Tick;

use super::{
    state::State,
    tables::{
        Action, Attachment, StateVariables,
        valves::{Air, Side, Supply, valves},
    },
};
use crate::execution::Outcome;

impl State {
    pub(super) fn act(&mut self, action: Action, seen: &StateVariables) {
        let set = match action {
            Action::Close => Air::Close,
            Action::Open => Air::Open,
            Action::Wait => Air::Keep,
            Action::Report(report) => {
                self.found = Some(report);
                self.execution.finish();
                Air::Keep
            }
            Action::Wrong(report) => {
                self.found = Some(report);
                self.execution.fail(Reason::JawsStuck);
                Air::Keep
            }
            Action::Refuse(reason) => {
                self.execution.fail(reason);
                Air::Keep
            }
            Action::Fail(reason) => {
                self.execution.fail(reason);
                Air::Off
            }
        };
        let connection = seen.situation.connection;
        let side = if self.valves.open { Side::Opening } else { Side::Other };
        let air = match valves((), &Supply { mated: seen.mated, connection, side, set }).action {
            Air::Keep => self.valves,
            Air::Off => JawValves { open: false, close: false },
            Air::Close => JawValves { open: false, close: true },
            Air::Open => JawValves { open: true, close: false },
        };
        if air != self.valves {
            (self.valves, self.air_ticks) = (air, 0);
        }
    }

    /// Of the words of VI.4.2 only `jaws-stuck` reports a failure. It reports every failure without a finger
    /// position; the reason has the details.
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
        if seen.situation.gripper == Attachment::Attached {
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
