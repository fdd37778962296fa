use geometry::units::rounded;
use interfaces::{
    PedestalOutputs, Reason,
    grip::{GripCommand, GripVerb},
    pedestal::{PedestalStatus, TableCommand, TableVerb},
    process::Inputs,
};
use rcs_core::{handshake::Lower, tick::Tick};

use super::{
    orders::{hand_command, table_angle},
    preprocess::felt,
    state::State,
    tables::{Action, PedestalRecipient, StateVariables},
};
use crate::{execution::Report, pedestal::table::report_of};

impl State {
    pub(super) fn act<Data: ?Sized>(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut PedestalOutputs,
    ) {
        let (memory, tick) = (inputs.memory, inputs.tick);
        let angle = table_angle(&self.command, &memory.table.status);
        match action {
            Action::Wait => {}
            Action::OpenAndTurn => {
                self.command_hand(hand_command(&self.command), tick, outputs);
                self.command_table(TableVerb::Turn, angle, tick, outputs);
                self.ordered = PedestalRecipient::Both;
            }
            Action::Calibrate => {
                self.command_hand(
                    GripCommand { command: GripVerb::UpInit, ..GripCommand::default() },
                    tick,
                    outputs,
                );
            }
            Action::Close => {
                self.gripped = true;
                self.command_hand(hand_command(&self.command), tick, outputs);
            }
            Action::Turn => self.command_table(TableVerb::Turn, angle, tick, outputs),
            Action::Open => self.command_hand(hand_command(&self.command), tick, outputs),
            Action::StopTable => self.command_table(TableVerb::Pause, 0, tick, outputs),
            Action::Finish => self.execution.finish(),
            Action::Lose(reason) => {
                self.gripped = false;
                self.execution.fail(reason);
            }
            Action::Fail(reason) => self.execution.fail(reason),
            Action::PassUpHand => self.pass_up(seen.subordinates.hand, memory.hand.status.reason),
            Action::PassUpTable => self.pass_up(seen.subordinates.table, memory.table.status.reason),
        }
    }

    /// A process that does not answer gives no reason.
    fn pass_up(&mut self, lower: Lower, below: Reason) {
        let silent = lower == Lower::Lost || below == Reason::None;
        self.execution.fail(if silent { Reason::NeighbourLost } else { below });
    }

    fn command_hand(&mut self, command: GripCommand, tick: Tick, outputs: &mut PedestalOutputs) {
        self.ordered = PedestalRecipient::Hand;
        outputs.hand = GripCommand { number: self.hand.send(tick), ..command };
    }

    /// `angle` is absolute, in 0.1 degree.
    fn command_table(&mut self, command: TableVerb, angle: i32, tick: Tick, outputs: &mut PedestalOutputs) {
        self.ordered = PedestalRecipient::Table;
        outputs.table = TableCommand { number: self.table.send(tick), command, angle };
    }

    pub(super) fn report<Data: ?Sized>(&self, inputs: &Inputs<'_, Data>, outputs: &mut PedestalOutputs) {
        let execution = &self.execution;
        let Report { outcome, reason, .. } = execution.report(None);
        let hand = &inputs.memory.hand.status;
        let force = f64::midpoint(f64::from(hand.left_force), f64::from(hand.right_force));
        outputs.header = execution.rows.header(inputs.tick, self.step.text());
        outputs.status = PedestalStatus {
            cycle_echo: self.cycle,
            echo: execution.receiver.echo,
            report: report_of(outcome, reason),
            reason,
            grip_size: hand.position,
            grip_force: rounded(force),
            table_position: table_position(inputs),
            felt: felt(inputs),
            gripped: self.gripped,
        };
    }
}

/// Not known if the table does not answer.
fn table_position<Data: ?Sized>(inputs: &Inputs<'_, Data>) -> Option<i32> {
    let table = &inputs.memory.table;
    table.status.position.filter(|_| table.header.stamp == inputs.tick.previous())
}
