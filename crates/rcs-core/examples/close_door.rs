//! A commander sends CLOSE-DOOR, and its subordinate decides by a table: `cargo run -p rcs-core --example close_door`.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use door::{Action, Door, Outputs, Report};
use rcs_core::{
    Plain,
    handshake::{Commander, Lower},
    tick::Tick,
};

mod door {

    use rcs_core::{
        Actions, Plain, Variables, decision_table,
        handshake::{Arrival, Receiver},
        header::{Decided, Header},
        tick::Tick,
    };

    /// Position of the door.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    pub enum Door {
        /// The doorway is free.
        Open,
        /// The door's switch detects it.
        Shut,
    }

    /// The state variables.
    #[derive(Clone, Copy, Debug, Variables)]
    pub struct Situation {
        /// The door.
        pub door: Door,
    }

    /// Actions of the rows.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
    pub enum Action {
        /// No new output.
        Wait,
        /// Drive the door.
        Close,
        /// Report done.
        Finish,
    }

    decision_table! {
        /// CLOSE-DOOR.
        pub CLOSE_DOOR: fn close_door(enum CloseDoorStep, Situation) -> Action {
            any {
                1: door: Shut  => Finish;
            }
            /// The command has not started.
            Start {
                2: door: Open  => Close  -> Closing;
            }
            /// The door is driven.
            Closing {
                3: door: Open  => Wait;
            }
        }
    }

    /// Status of the command.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    pub enum Report {
        /// The command is executing.
        Executing,
        /// The command is complete.
        Done,
    }

    /// The output buffer.
    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    pub struct Outputs {
        /// Stamp and the row that fired.
        pub header: Header,
        /// Number of the command to which the report belongs.
        pub echo: u32,
        /// Status of that command.
        pub report: Report,
    }

    pub struct Process {
        receiver: Receiver,
        step: CloseDoorStep,
    }

    impl Process {
        pub fn new() -> Self {
            Self { receiver: Receiver::ZERO, step: CloseDoorStep::Start }
        }

        /// Reads the command number, consults the table, writes the outputs.
        pub fn step(&mut self, tick: Tick, number: u32, door: Door, outputs: &mut Outputs) -> Action {
            match self.receiver.observe(number) {
                Arrival::New => self.step = CloseDoorStep::Start,
                Arrival::Same => {}
                Arrival::Nothing | Arrival::Restarted => {
                    outputs.header.stamp = tick;
                    return Action::Wait;
                }
            }
            let decision = close_door(self.step, &Situation { door });
            self.step = decision.next;
            outputs.header.stamp = tick;
            outputs.header.decided = Some(Decided { table: 1, row: decision.row });
            outputs.echo = self.receiver.echo;
            outputs.report = if decision.action == Action::Finish { Report::Done } else { Report::Executing };
            decision.action
        }
    }
}

fn main() {
    let (mut commander, mut process) = (Commander::ZERO, door::Process::new());
    // Both processes read only the buffers of the previous tick, so their order does not matter.
    let (mut command, mut outputs) = (0, Outputs::ZERO);
    let mut closes_at = None;
    for tick in (1..=12).map(Tick) {
        let (number, below) = (command, outputs);

        let report = match below.report {
            Report::Executing => Lower::Executing,
            Report::Done => Lower::Done,
        };
        let status = if commander.started {
            commander.read(tick, &below.header, below.echo, report)
        } else {
            commander.start(below.echo);
            command = commander.send(tick);
            Lower::Pending
        };

        let door = if closes_at.is_some_and(|shut| tick >= shut) { Door::Shut } else { Door::Open };
        if process.step(tick, number, door, &mut outputs) == Action::Close {
            closes_at = Some(Tick(tick.0 + 4));
        }
        let row = outputs.header.decided.map_or(0, |decided| decided.row);
        println!("tick {:>2}: the commander reads {status:?}; door {door:?}, row {row}", tick.0);
        if status == Lower::Done {
            return;
        }
    }
}
