//! Postprocess: commands to hand and table, and the status to Subtask.

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
    preprocess::{Seen, angle, hand_command},
    state::State,
    tables::Action,
};
use crate::pedestal::table::report;

/// Carry out `action` and report.
pub(super) fn perform<Data: ?Sized>(
    state: &mut State,
    seen: &Seen,
    action: Action,
    inputs: &Inputs<'_, Data>,
    outputs: &mut PedestalOutputs,
) {
    let memory = inputs.memory;
    match action {
        Action::Wait => {}
        Action::OpenAndTurn => {
            open(state, inputs.tick, outputs);
            turn(state, state.command.table_angle, inputs.tick, outputs);
        }
        Action::Close => send_hand(state, inputs.tick, outputs),
        Action::TurnOver => {
            turn(state, angle(&state.command, &memory.table.status), inputs.tick, outputs);
        }
        Action::Open => open(state, inputs.tick, outputs),
        Action::StopTable => {
            let number = state.table.send(inputs.tick);
            outputs.table = TableCommand { number, command: TableVerb::Pause, angle: 0 };
        }
        Action::Finish => state.execution.finish(),
        Action::Gripped => {
            state.held_size = state.command.grasp_size;
            state.execution.finish();
        }
        Action::Fail(reason) => {
            if reason == Reason::ObjectLost {
                state.held_size = 0;
            }
            state.execution.fail(reason);
        }
        Action::FailHand => state.execution.fail(reason_of(seen.hand, memory.hand.status.reason)),
        Action::FailTable => state.execution.fail(reason_of(seen.table, memory.table.status.reason)),
    }
    let hand = &memory.hand.status;
    let force = f64::midpoint(f64::from(hand.left_force), f64::from(hand.right_force));
    outputs.header = state.execution.header(inputs.tick);
    outputs.status = PedestalStatus {
        cycle_echo: state.cycle,
        echo: state.execution.receiver.echo,
        report: report(state.execution.outcome, state.execution.reason),
        reason: state.execution.reason,
        grip_size: hand.position,
        grip_force: rounded(force),
        table_position: memory.table.status.position,
    };
}

fn reason_of(lower: Lower, below: Reason) -> Reason {
    if lower == Lower::Lost || below == Reason::None { Reason::NeighbourLost } else { below }
}

/// Open the hand: what it holds is let go.
fn open(state: &mut State, tick: Tick, outputs: &mut PedestalOutputs) {
    state.held_size = 0;
    send_hand(state, tick, outputs);
}

fn send_hand(state: &mut State, tick: Tick, outputs: &mut PedestalOutputs) {
    outputs.hand = GripCommand { number: state.hand.send(tick), ..hand_command(&state.command) };
}

fn turn(state: &mut State, angle: i32, tick: Tick, outputs: &mut PedestalOutputs) {
    outputs.table = TableCommand { number: state.table.send(tick), command: TableVerb::Turn, angle };
}
