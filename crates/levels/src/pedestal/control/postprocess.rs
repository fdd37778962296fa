//! Postprocess of the pedestal process: commands to hand and table, and the status to Subtask.

use rcs_core::{
    handshake::Lower,
    interface::{
        PedestalOutputs, Reason,
        grip::GripCommand,
        pedestal::{PedestalStatus, TableCommand, TableVerb},
    },
    process::Inputs,
    tick::Tick,
    units::rounded,
};

use super::{
    orders::{hand_command, table_angle},
    state::State,
    tables::{Action, Ordered, Seen},
};
use crate::pedestal::table::report_of;

impl State {
    /// Set the outputs that a row asks for.
    pub(super) fn act<Data: ?Sized>(
        &mut self,
        action: Action,
        seen: &Seen,
        inputs: &Inputs<'_, Data>,
        outputs: &mut PedestalOutputs,
    ) {
        let (memory, tick) = (inputs.memory, inputs.tick);
        let angle = table_angle(&self.command, &memory.table.status);
        match action {
            Action::Wait => {}
            Action::OpenAndTurn => {
                self.open(tick, outputs);
                self.command_table(TableVerb::Turn, angle, tick, outputs);
                self.ordered = Ordered::Both;
            }
            Action::Close => self.command_hand(tick, outputs),
            Action::Turn => self.command_table(TableVerb::Turn, angle, tick, outputs),
            Action::Open => self.open(tick, outputs),
            Action::StopTable => self.command_table(TableVerb::Pause, 0, tick, outputs),
            Action::Finish => self.execution.finish(),
            Action::Hold => {
                self.held_size = Some(self.command.grasp_size);
                self.execution.finish();
            }
            Action::Lose => {
                self.held_size = None;
                self.execution.fail(Reason::ObjectLost);
            }
            Action::Fail(reason) => self.execution.fail(reason),
            Action::PassUpHand => self.pass_up(seen.orders.hand, memory.hand.status.reason),
            Action::PassUpTable => self.pass_up(seen.orders.table, memory.table.status.reason),
        }
    }

    /// A process below has failed; one that does not answer gives no reason.
    fn pass_up(&mut self, lower: Lower, below: Reason) {
        let silent = lower == Lower::Lost || below == Reason::None;
        self.execution.fail(if silent { Reason::NeighbourLost } else { below });
    }

    /// Open the hand: what it holds is let go.
    fn open(&mut self, tick: Tick, outputs: &mut PedestalOutputs) {
        self.held_size = None;
        self.command_hand(tick, outputs);
    }

    fn command_hand(&mut self, tick: Tick, outputs: &mut PedestalOutputs) {
        self.ordered = Ordered::Hand;
        outputs.hand = GripCommand { number: self.hand.send(tick), ..hand_command(&self.command) };
    }

    /// A command to the table; the absolute angle in 0.1 degree.
    fn command_table(&mut self, command: TableVerb, angle: i32, tick: Tick, outputs: &mut PedestalOutputs) {
        self.ordered = Ordered::Table;
        outputs.table = TableCommand { number: self.table.send(tick), command, angle };
    }

    /// Write the status to Subtask.
    pub(super) fn report<Data: ?Sized>(&self, inputs: &Inputs<'_, Data>, outputs: &mut PedestalOutputs) {
        let execution = &self.execution;
        let hand = &inputs.memory.hand.status;
        let force = f64::midpoint(f64::from(hand.left_force), f64::from(hand.right_force));
        outputs.header = execution.header(inputs.tick, self.step.text());
        outputs.status = PedestalStatus {
            cycle_echo: self.cycle,
            echo: execution.receiver.echo,
            report: report_of(execution.outcome, execution.reason),
            reason: execution.reason,
            grip_size: hand.position,
            grip_force: rounded(force),
            table_position: inputs.memory.table.status.position,
        };
    }
}
