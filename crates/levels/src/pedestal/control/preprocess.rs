use interfaces::{
    CommonMemory, PedestalOutputs,
    grip::{Felt, GripVerb},
    pedestal::{PedestalVerb, TableVerb},
    process::Inputs,
};
use rcs_core::handshake::Lower;

use super::{
    goals::proof,
    orders::{angle, opening},
    state::State,
    tables::{
        Gripped, Object, PedestalCalibration, PedestalRecipient, Request, Situation, StateVariables,
        Subordinates,
    },
};
use crate::{
    execution::{Asked, Work},
    halt::{Above, Below, BoxState, Intake, Kind, Replaced},
};

impl State {
    /// A starting process adopts its last command to the hand.
    pub(super) fn sense<Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &PedestalOutputs,
    ) -> StateVariables {
        let memory = inputs.memory;
        let command = &memory.subtask.pedestal;
        let (tick, written) = (inputs.tick, &memory.pedestal);
        self.hand.start_from(tick, written.hand.number, memory.hand.status.echo);
        self.table.start_from(tick, written.table.number, memory.table.status.echo);
        if command.number != 0 {
            self.cycle = command.cycle;
        }
        if !self.execution.receiver.started {
            self.gripped = outputs.status.gripped;
        }
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        if asked == Asked::Now {
            (self.command, self.ordered) = (*command, PedestalRecipient::Nothing);
        }
        let hand = self.hand.status_of(tick, &memory.hand);
        let table = self.table.status_of(tick, &memory.table);
        // A hand that was commanded to open and has not, for example after a restart, still grips.
        if written.hand.command == GripVerb::OpenGrip && hand == Lower::Done {
            self.gripped = false;
        }
        let object = self.object(felt(inputs), memory);
        let situation = Situation {
            object,
            calibration: if memory.hand.status.initialized {
                PedestalCalibration::Known
            } else {
                PedestalCalibration::Missing
            },
            gripped: if self.gripped { Gripped::Yes } else { Gripped::No },
            fingers: match hand {
                Lower::Pending | Lower::Executing => Work::Busy,
                Lower::Done | Lower::Error | Lower::Joystick | Lower::Lost => Work::Over,
            },
        };
        StateVariables {
            arrival,
            verb: self.command.command,
            replaced: Replaced {
                intake: Intake::Taken,
                kind: if command.command == PedestalVerb::Pause { Kind::Pause } else { Kind::Other },
                above: Above::Live,
                joystick: BoxState::Off,
                below: Below::of(hand, false)
                    .and(Below::of(table, written.table.command == TableVerb::Pause)),
            },
            request: Request {
                asked,
                verb: command.command,
                angle: angle(command, &memory.table.status),
                opening: opening(command),
            },
            subordinates: Subordinates {
                verb: self.command.command,
                ordered: self.ordered,
                hand,
                table,
                object,
            },
            proof: proof(&self.command, &situation, memory),
            situation,
        }
    }

    /// The object in the hand. Fingers no wider than the grasp size have missed it (VIII.9.1).
    fn object(&self, felt: Felt, memory: &CommonMemory) -> Object {
        let gripping = self.command.command == PedestalVerb::Grip;
        let wide = !gripping || memory.hand.status.position > self.command.grasp_size;
        match felt {
            Felt::NotKnown => Object::NotKnown,
            Felt::Something if wide => Object::Held,
            Felt::Something | Felt::Nothing if self.gripped => Object::Lost,
            Felt::Something | Felt::Nothing => Object::None,
        }
    }
}

/// Not known if the hand does not answer.
pub(super) fn felt<Data: ?Sized>(inputs: &Inputs<'_, Data>) -> Felt {
    let hand = &inputs.memory.hand;
    if hand.header.stamp == inputs.tick.previous() { hand.status.felt } else { Felt::NotKnown }
}
