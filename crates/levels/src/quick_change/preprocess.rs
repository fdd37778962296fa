use interfaces::{
    QuickChangeOutputs, device::QuickChangeSensors, process::Inputs, quick_change::RingPosition,
};
use rcs_core::handshake::Arrival;

use super::{
    state::State,
    tables::{Clock, Id, Request, Situation, StateVariables},
};

pub(super) const STUCK_TICKS: u8 = 12; // 0.5 s that neither sensor sees the ring: more than its travel
pub(super) const MALFUNCTION_TICKS: u8 = 3; // with contradicting sensors, or an id without a gripper
pub(super) const TURN_TICKS: u64 = 25; // 1 s for a commanded ring to arrive
const GREATEST_ID: u8 = 3; // 1 parts, 2 v, 3 tool (III.3.6 to III.3.8); 0 without a gripper

impl State {
    /// `outputs` are those of the previous tick. A ring that had air when the process was restarted may still move in
    /// this tick, so it is read in the next one.
    pub(super) fn sense<Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &QuickChangeOutputs,
    ) -> StateVariables {
        let command = &inputs.memory.emove.quick_change;
        let may_go_on = !self.execution.receiver.started && outputs.valves.port;
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        if arrival == Arrival::New {
            (self.command, self.since) = (command.command, inputs.tick);
        }
        let devices = &inputs.external.devices;
        let (sensors, connection) = (&devices.quick_change, devices.field.quick_change);
        if connection.is_old() {
            // The last reading stays, and the time of the ring does not advance.
            self.since = self.since.next();
        } else if !may_go_on {
            self.read_ring(sensors);
        }
        let late = inputs.tick.since(self.since) > TURN_TICKS;
        StateVariables {
            arrival,
            request: Request { asked, verb: command.command },
            situation: Situation {
                ring: self.ring,
                id: self.read_id(sensors.end_effector_id),
                clock: if late { Clock::Expired } else { Clock::Running },
                connection,
            },
        }
    }

    fn read_ring(&mut self, sensors: &QuickChangeSensors) {
        let (reading, needed) = match (sensors.locked, sensors.unlocked) {
            (true, false) => (RingPosition::Locked, 1),
            (false, true) => (RingPosition::Unlocked, 1),
            (false, false) => (RingPosition::Between, STUCK_TICKS),
            (true, true) => (RingPosition::Implausible, MALFUNCTION_TICKS),
        };
        self.reading_ticks = if reading == self.reading { self.reading_ticks.saturating_add(1) } else { 1 };
        self.reading = reading;
        if self.reading_ticks >= needed {
            self.ring = reading;
        }
    }

    fn read_id(&mut self, id: u8) -> Id {
        if id <= GREATEST_ID {
            self.end_effector_id = (id != 0).then_some(id);
            self.illegal_ticks = 0;
        } else {
            self.illegal_ticks = self.illegal_ticks.saturating_add(1);
        }
        if self.illegal_ticks >= MALFUNCTION_TICKS { Id::Illegal } else { Id::Legal }
    }
}
