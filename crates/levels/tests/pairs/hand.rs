//! The pedestal process and its hand's. Around them: Subtask, the fingers with or without a part, the rotary table.

use crate::{
    fingers::{Fingers, Sizes, calibration, flow},
    frame::{self, Choice, Event, Half, Scene},
    image::{Image, rebase, rebase_echoes},
    search::Wrong,
};
use interfaces::{
    CommonMemory, ExternalInputs, GripOutputs, Reason,
    device::GripSensors,
    grip::{GripCommand, GripReport},
    pedestal::{
        PedestalCommand, PedestalReport, PedestalStatus, PedestalVerb, TableCommand, TableStatus, TableVerb,
    },
};
use levels::{
    execution::Outcome,
    grip::{self, tables::GripPhase},
    pedestal::{Hand, Pedestal},
};

/// The greatest age within the time limit of the hand's commands, ticks.
const LIMIT: u64 = 150;
/// Opening of PRE-GRIP and RELEASE, and grasp size of a GRIP, 0.01 in.
const OPEN: i32 = 450;
const SIZE: i32 = 250;
const SIZES: Sizes = Sizes { open: 450, part: 256, force: 50 };
/// Angle of PRE-GRIP, and goal of every FLIP, 0.1 degree.
const RECEIVE: i32 = -1200;
const TURNED: i32 = -2200;

/// Reaction of the rotary table to its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableDoes {
    Goes,
    Ends,
    Fails,
}

#[derive(Clone)]
pub struct Around {
    fingers: Fingers,
    table: TableStatus,
}

pub type Pair = frame::Pair<Around>;

/// A pair before its first tick: hand and table are calibrated, the hand is open.
pub fn first(mishaps: u8, commands: &[PedestalVerb]) -> Pair {
    let calibration = Some(calibration());
    let mut hand = Half::<Hand> {
        state: grip::state::State { phase: GripPhase::Valid, calibration, ..grip::state::State::default() },
        out: GripOutputs { calibration, ..GripOutputs::default() },
    };
    hand.state.execution.receiver.started = true;
    let table = TableStatus { calibrated: true, position: Some(TURNED), ..TableStatus::default() };
    Pair::new(commands, (None, mishaps), hand, Around { fingers: Fingers::Open, table })
}

impl Around {
    fn table_does(&mut self, does: TableDoes, order: &TableCommand) {
        if order.number != self.table.echo && order.number != 0 {
            (self.table.echo, self.table.report) = (order.number, PedestalReport::Executing);
            self.table.position = None;
        }
        match does {
            TableDoes::Goes => {}
            TableDoes::Ends => {
                let at_receive = order.command == TableVerb::Turn && order.angle == RECEIVE;
                self.table.report = PedestalReport::Done;
                self.table.position = Some(if at_receive { RECEIVE } else { TURNED });
            }
            TableDoes::Fails => self.table.report = PedestalReport::Error,
        }
    }
}

impl Scene for Around {
    type Upper = Half<Pedestal>;
    type Lower = Half<Hand>;
    type Line = PedestalVerb;
    type Command = PedestalCommand;
    type Does = (Fingers, TableDoes);
    /// Longer than the time limit of the hand's commands.
    const LONG: u64 = 200;

    fn choices(pair: &Pair) -> Vec<Choice<Self::Does>> {
        let turning = pair.is_turning();
        let table: &[TableDoes] =
            if turning { &[TableDoes::Goes, TableDoes::Ends, TableDoes::Fails] } else { &[TableDoes::Goes] };
        let mut choices = Vec::new();
        for &table in table {
            for (fingers, arrive) in pair.scene.fingers.next(pair.lower.out.valves.bits) {
                let waits = fingers == pair.scene.fingers && !arrive && !turning;
                let long = waits && pair.is_settled() && pair.is_still();
                let prompt = arrive && (!turning || table != TableDoes::Goes);
                choices.push(Choice { long, ..Choice::new((fingers, table), prompt) });
            }
        }
        choices
    }

    fn has_ended(pair: &Pair) -> bool {
        has_ended(&pair.command, &pair.upper.out.status)
    }

    fn is_other(pair: &Pair, verb: &PedestalVerb) -> bool {
        *verb != pair.command.command
    }

    fn command(pair: &mut Pair, nth: usize) {
        let verb = pair.lines[nth];
        pair.command = PedestalCommand {
            cycle: pair.tick,
            number: pair.command.number + 1,
            command: verb,
            grasp_size: if verb == PedestalVerb::Grip { SIZE } else { OPEN },
            grasp_force: 50,
            table_angle: if verb == PedestalVerb::Flip { -100 } else { RECEIVE },
        };
    }

    fn inputs(pair: &Pair) -> (CommonMemory, ExternalInputs) {
        let before = pair.tick.previous();
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        memory.subtask.pedestal = pair.command;
        (memory.pedestal, memory.hand) = (pair.upper.out, pair.lower.out);
        memory.table.status = pair.scene.table;
        let headers = [&mut memory.pedestal.header, &mut memory.hand.header, &mut memory.table.header];
        headers.into_iter().for_each(|header| header.stamp = before);
        let sensors = &mut external.devices.pedestal;
        let GripSensors { potentiometer, strain_left, strain_right, .. } = pair.scene.fingers.sensors(&SIZES);
        (sensors.potentiometer, sensors.strain_left, sensors.strain_right) =
            (potentiometer, strain_left, strain_right);
        (memory, external)
    }

    fn act(pair: &mut Pair, event: &Event<Self::Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        let (fingers, table) = event.does;
        pair.scene.table_does(table, &memory.pedestal.table);
        pair.scene.fingers = fingers;
        Ok(())
    }

    fn judge(pair: &Pair, before: &Pair, _: &Event<Self::Does>) -> Result<(), Wrong> {
        let ended = |it: &Pair| {
            let status = &it.upper.out.status;
            status.echo == pair.command.number && status.report == PedestalReport::Done
        };
        if !ended(pair) || ended(before) {
            return Ok(());
        }
        let is_open = matches!(before.scene.fingers, Fingers::Open | Fingers::Drifted);
        match pair.command.command {
            PedestalVerb::PreGrip | PedestalVerb::Release if !is_open => {
                Err("done, and the hand is not open")
            }
            PedestalVerb::PreGrip if before.scene.table.position != Some(RECEIVE) => {
                Err("done, and the table is elsewhere")
            }
            PedestalVerb::Grip if !matches!(before.scene.fingers, Fingers::Holding | Fingers::Emptied) => {
                Err("done, and the fingers are empty")
            }
            PedestalVerb::Pause if before.lower.out.status.report == GripReport::Executing => {
                Err("done, and the hand moves")
            }
            PedestalVerb::Pause if before.scene.table.report == PedestalReport::Executing => {
                Err("done, and the table turns")
            }
            PedestalVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    fn renumber(pair: &mut Pair) {
        let (pedestal, out) = (&mut pair.upper.state, &mut pair.upper.out);
        let echo = &mut pedestal.execution.receiver.echo;
        rebase_echoes(&mut [&mut pair.command.number, echo, &mut out.status.echo]);
        let echo = &mut pair.lower.state.execution.receiver.echo;
        rebase(&mut pedestal.hand, &mut [&mut out.hand.number, echo, &mut pair.lower.out.status.echo]);
        rebase(&mut pedestal.table, &mut [&mut out.table.number, &mut pair.scene.table.echo]);
    }

    /// Omits what no row tests: reasons, the text of an order that has been taken, and step, command, goal and times of
    /// an idle process.
    fn image(pair: &Pair) -> Vec<u8> {
        let counters = &[("settled", 6), ("missed", 3), ("touch_ticks", 5), ("still_ticks", 5)];
        let mut image = Image::new(pair.tick, LIMIT, counters);
        let mut it = pair.clone();
        let reasons = [
            &mut it.upper.state.execution.reason,
            &mut it.lower.state.execution.reason,
            &mut it.scene.table.reason,
        ];
        reasons.into_iter().for_each(|reason| *reason = Reason::None);
        if it.upper.state.execution.outcome != Outcome::Executing {
            (it.upper.state.step, it.upper.state.ordered, it.upper.state.command) = Default::default();
        }
        if it.lower.state.execution.outcome != Outcome::Executing {
            (it.lower.state.step, it.lower.state.goal, it.lower.state.settled, it.lower.state.missed) =
                Default::default();
            it.lower.state.since = it.tick;
        }
        if it.is_settled() {
            let number = it.upper.out.hand.number;
            it.upper.out.hand = GripCommand { number, ..GripCommand::default() };
            it.upper.out.table.angle = if it.is_turning() { it.upper.out.table.angle } else { 0 };
        }
        (it.upper.state.command.number, it.lower.state.steady) = Default::default();
        image.add(&it.command);
        image.add(&it.upper.state);
        image.add(&it.upper.out.hand);
        image.add(&it.upper.out.table);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.status.report);
        image.add(&it.lower.state);
        image.add(&it.lower.out.status.echo);
        image.add(&it.lower.out.status.report);
        image.add(&it.lower.out.status.felt);
        image.add(&it.lower.out.status.initialized);
        image.add(&it.scene.table);
        image.bytes.extend([u8::from(it.lower.out.status.position > SIZE), it.mishaps]);
        image.bytes.push(it.lower.out.valves.bits);
        image.add(&it.scene.fingers.sensors(&SIZES));
        image.bytes
    }

    fn rests(pair: &Pair) -> bool {
        Self::has_ended(pair)
            && pair.is_settled()
            && pair.lower.state.execution.outcome != Outcome::Executing
            && !pair.is_turning()
            && flow(pair.lower.out.valves.bits) == (false, false)
    }

    fn pauses(pair: &Pair) -> bool {
        pair.command.command == PedestalVerb::Pause
    }
}

pub fn has_ended(command: &PedestalCommand, status: &PedestalStatus) -> bool {
    status.echo == command.number && status.report != PedestalReport::Executing
}

impl Pair {
    fn is_settled(&self) -> bool {
        let number = self.upper.out.hand.number;
        number == 0
            || (number == self.lower.out.status.echo && number == self.lower.state.execution.receiver.echo)
    }

    fn is_turning(&self) -> bool {
        let number = self.upper.out.table.number;
        (number != self.scene.table.echo && number != 0)
            || self.scene.table.report == PedestalReport::Executing
    }

    fn is_still(&self) -> bool {
        let read = self.lower.state.sensed.map(|sensed| sensed.last);
        read == Some(self.scene.fingers.sensors(&SIZES))
            && self.lower.state.still_ticks >= 5
            && self.lower.state.touch_ticks >= 5
    }
}
