//! Preprocess of the pedestal process: its state variables, from the command and the statuses of hand and
//! table.

use rcs_core::{
    handshake::{Arrival, Lower},
    interface::{CommonMemory, pedestal::PedestalVerb},
    process::Inputs,
    tick::Tick,
};

use super::{
    orders::{angle, opening},
    state::State,
    tables::{Object, Ordered, Orders, Request, Seen, Situation},
};
use crate::execution::Asked;

impl State {
    /// Read the inputs of a tick.
    pub(super) fn sense<Data: ?Sized>(&mut self, inputs: &Inputs<'_, Data>) -> Seen {
        let memory = inputs.memory;
        let command = &memory.subtask.pedestal;
        let (tick, written) = (inputs.tick, &memory.pedestal);
        self.hand.start_from(tick, written.hand.number, memory.hand.status.echo);
        self.table.start_from(tick, written.table.number, memory.table.status.echo);
        if command.number != 0 {
            self.cycle = command.cycle;
        }
        let arrival = self.execution.receiver.observe(command.number);
        if arrival == Arrival::New {
            (self.command, self.ordered) = (*command, Ordered::Nothing);
        }
        let object = self.object(memory);
        Seen {
            arrival,
            request: Request {
                asked: Asked::of(arrival),
                verb: command.command,
                angle: angle(command, &memory.table.status),
                opening: opening(command),
            },
            orders: Orders {
                verb: self.command.command,
                ordered: self.ordered,
                hand: self.hand(memory, inputs.tick),
                table: self.table(memory, inputs.tick),
                object,
            },
            situation: Situation { object },
        }
    }

    fn hand(&self, memory: &CommonMemory, tick: Tick) -> Lower {
        let status = &memory.hand.status;
        self.hand.read(tick, &memory.hand.header, status.echo, status.report.lower())
    }

    fn table(&self, memory: &CommonMemory, tick: Tick) -> Lower {
        let status = &memory.table.status;
        self.table.read(tick, &memory.table.header, status.echo, status.report.lower())
    }

    /// Fingers that stand wider than the grasp size have something between them (VIII.9.1). A hand that is
    /// not calibrated cannot tell.
    fn object(&self, memory: &CommonMemory) -> Object {
        let hand = &memory.hand.status;
        let gripping = self.command.command == PedestalVerb::Grip;
        match if gripping { Some(self.command.grasp_size) } else { self.held_size } {
            None => Object::None,
            Some(size) if !hand.initialized || hand.position > size => Object::Held,
            Some(_) => Object::Lost,
        }
    }
}
