//! The pedestal process and its hand's. Around them: Subtask, the fingers with a part or without, the rotary table.

use interfaces::{
    CommonMemory, ExternalInputs, GripOutputs, PedestalOutputs, Reason,
    device::GripSensors,
    grip::{GripCommand, GripReport},
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb, TableStatus, TableVerb},
    process::{Inputs, Process},
};
use levels::{
    execution::Outcome,
    grip::{self, tables::Phase},
    pedestal::{Hand, Pedestal, control},
};
use rcs_core::tick::Tick;

use crate::{
    fingers::{Fingers, Sizes, calibration, flow},
    image::{Image, rebase, rebase_echoes},
    search::{Mishap, World, Wrong, resumed},
    told::{Told, choices},
};

/// Longer than the time limit of the hand's commands.
const LONG: u64 = 200;
/// The greatest age that is within it, ticks.
const LIMIT: u64 = 150;
/// The opening of PRE-GRIP and RELEASE and the grasp size of a GRIP, 0.01 in.
const OPEN: i32 = 450;
const SIZE: i32 = 250;
const SIZES: Sizes = Sizes { open: 450, part: 256, force: 50 };
/// The angle of PRE-GRIP, and where FLIP leads from anywhere, 0.1 degree.
const RECEIVE: i32 = -1200;
const TURNED: i32 = -2200;

/// What the rotary table does with its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableDoes {
    /// Nothing new; an order that has just come is taken.
    Goes,
    Ends,
    Fails,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub told: Told,
    pub fingers: Fingers,
    pub table: TableDoes,
    pub mishap: Mishap,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    mishaps: u8,
    commands: &'static [PedestalVerb],
    command: PedestalCommand,
    pedestal: control::state::State,
    pedestal_out: PedestalOutputs,
    hand: grip::state::State,
    hand_out: GripOutputs,
    fingers: Fingers,
    table: TableStatus,
}

impl Pair {
    /// The first tick of a system that is booted, with a hand that is calibrated and open, and a table that is
    /// calibrated; so many mishaps can happen, and these commands can come.
    pub fn first(mishaps: u8, commands: &'static [PedestalVerb]) -> Self {
        let calibration = Some(calibration());
        let mut pair = Self {
            tick: Tick(10_000),
            mishaps,
            commands,
            command: PedestalCommand::default(),
            pedestal: control::state::State::default(),
            pedestal_out: PedestalOutputs::default(),
            hand: grip::state::State { phase: Phase::Valid, calibration, ..grip::state::State::default() },
            hand_out: GripOutputs { calibration, ..GripOutputs::default() },
            fingers: Fingers::Open,
            table: TableStatus { calibrated: true, position: Some(TURNED), ..TableStatus::default() },
        };
        pair.hand.execution.receiver.started = true;
        pair
    }

    fn tell(&mut self, verb: PedestalVerb) {
        self.command = PedestalCommand {
            cycle: self.tick,
            number: self.command.number + 1,
            command: verb,
            grasp_size: if verb == PedestalVerb::Grip { SIZE } else { OPEN },
            grasp_force: 50,
            table_angle: if verb == PedestalVerb::Flip { -100 } else { RECEIVE },
        };
    }

    fn table_does(&mut self, does: TableDoes) {
        let order = self.pedestal_out.table;
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

    /// What is reported done is done.
    ///
    /// `before` is the pair as it was when the processes read it.
    fn judge(&self, before: &Self) -> Result<(), Wrong> {
        let ended = |it: &Self| {
            let status = &it.pedestal_out.status;
            status.echo == self.command.number && status.report == PedestalReport::Done
        };
        if !ended(self) || ended(before) {
            return Ok(());
        }
        let is_open = matches!(before.fingers, Fingers::Open | Fingers::Drifted);
        match self.command.command {
            PedestalVerb::PreGrip | PedestalVerb::Release if !is_open => {
                Err("done, and the hand is not open")
            }
            PedestalVerb::PreGrip if before.table.position != Some(RECEIVE) => {
                Err("done, and the table is elsewhere")
            }
            PedestalVerb::Grip if !matches!(before.fingers, Fingers::Holding | Fingers::Emptied) => {
                Err("done, and nothing is between the fingers")
            }
            PedestalVerb::Pause if before.hand_out.status.report == GripReport::Executing => {
                Err("done, and the hand moves")
            }
            PedestalVerb::Pause if before.table.report == PedestalReport::Executing => {
                Err("done, and the table turns")
            }
            PedestalVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let turning = self.is_turning();
        let table: &[TableDoes] =
            if turning { &[TableDoes::Goes, TableDoes::Ends, TableDoes::Fails] } else { &[TableDoes::Goes] };
        let mut events = Vec::new();
        for mishap in Mishap::choices(self.mishaps, Mishap::RESTARTS) {
            for told in choices(self.commands, &self.command, &self.pedestal_out.status) {
                for &table in table {
                    for (fingers, arrive) in self.fingers.next(self.hand_out.valves.bits) {
                        if mishap != Mishap::None && told != Told::Nothing {
                            continue;
                        }
                        let quiet = told == Told::Nothing && mishap == Mishap::None;
                        let event = Event { told, fingers, table, mishap, long: false };
                        events.push((event, quiet && arrive && (!turning || table != TableDoes::Goes)));
                        let waits = quiet && fingers == self.fingers && !arrive;
                        if waits && !turning && self.is_settled() && self.is_still() {
                            events.push((Event { long: true, ..event }, true));
                        }
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut upper: Pedestal = resumed::<_, ()>(self.pedestal, event.mishap == Mishap::RestartUpper);
        let mut lower: Hand = resumed::<_, ()>(self.hand, event.mishap == Mishap::RestartLower);
        self.mishaps -= u8::from(event.mishap != Mishap::None);
        if let Told::Command(verb) = event.told {
            self.tell(verb);
        }
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.subtask.pedestal = self.command;
        (memory.pedestal, memory.hand) = (self.pedestal_out, self.hand_out);
        memory.table.status = self.table;
        let headers = [&mut memory.pedestal.header, &mut memory.hand.header, &mut memory.table.header];
        headers.into_iter().for_each(|header| header.stamp = before);
        let mut external = ExternalInputs::default();
        let sensors = &mut external.devices.pedestal;
        let GripSensors { potentiometer, strain_left, strain_right, .. } = self.fingers.sensors(&SIZES);
        (sensors.potentiometer, sensors.strain_left, sensors.strain_right) =
            (potentiometer, strain_left, strain_right);
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &() };
        let old = self.clone();
        let (mut pedestal_out, mut hand_out) = (self.pedestal_out, self.hand_out);
        upper.step(&inputs, &mut pedestal_out);
        lower.step(&inputs, &mut hand_out);
        // The table reads what was written in the tick before.
        self.table_does(event.table);
        self.fingers = event.fingers;
        (self.pedestal_out, self.hand_out) = (pedestal_out, hand_out);
        self.pedestal = *Process::<()>::state(&upper);
        self.hand = *Process::<()>::state(&lower);
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    /// Without what no row asks for any more: reasons; the step, the command, the goal and the times of a process
    /// that executes nothing; the text of an order that has been taken.
    fn image(&self) -> Vec<u8> {
        let counters = &[("settled", 6), ("missed", 3), ("touch_ticks", 5), ("still_ticks", 5)];
        let mut image = Image::new(self.tick, LIMIT, counters);
        let mut it = self.clone();
        let reasons =
            [&mut it.pedestal.execution.reason, &mut it.hand.execution.reason, &mut it.table.reason];
        reasons.into_iter().for_each(|reason| *reason = Reason::None);
        if it.pedestal.execution.outcome != Outcome::Executing {
            (it.pedestal.step, it.pedestal.ordered, it.pedestal.command) = Default::default();
        }
        if it.hand.execution.outcome != Outcome::Executing {
            (it.hand.step, it.hand.goal, it.hand.settled, it.hand.missed) = Default::default();
            it.hand.since = it.tick;
        }
        if it.is_settled() {
            let number = it.pedestal_out.hand.number;
            it.pedestal_out.hand = GripCommand { number, ..GripCommand::default() };
            it.pedestal_out.table.angle = if it.is_turning() { it.pedestal_out.table.angle } else { 0 };
        }
        (it.pedestal.command.number, it.hand.steady) = Default::default();
        image.add(&it.command);
        image.add(&it.pedestal);
        image.add(&it.pedestal_out.hand);
        image.add(&it.pedestal_out.table);
        image.add(&it.pedestal_out.status.echo);
        image.add(&it.pedestal_out.status.report);
        image.add(&it.hand);
        image.add(&it.hand_out.status.echo);
        image.add(&it.hand_out.status.report);
        image.add(&it.hand_out.status.felt);
        image.add(&it.hand_out.status.initialized);
        image.add(&it.table);
        image.bytes.extend([u8::from(it.hand_out.status.position > SIZE), it.mishaps]);
        image.bytes.push(it.hand_out.valves.bits);
        image.add(&it.fingers.sensors(&SIZES));
        image.bytes
    }

    fn rests(&self) -> bool {
        let status = &self.pedestal_out.status;
        status.echo == self.command.number
            && status.report != PedestalReport::Executing
            && self.is_settled()
            && self.hand.execution.outcome != Outcome::Executing
            && !self.is_turning()
            && flow(self.hand_out.valves.bits) == (false, false)
    }

    fn pauses(&self) -> bool {
        self.command.command == PedestalVerb::Pause
    }
}

impl Pair {
    /// The hand has read its last command, and the pedestal its echo.
    fn is_settled(&self) -> bool {
        let number = self.pedestal_out.hand.number;
        number == 0 || (number == self.hand_out.status.echo && number == self.hand.execution.receiver.echo)
    }

    /// The table has not ended its last order.
    fn is_turning(&self) -> bool {
        let number = self.pedestal_out.table.number;
        (number != self.table.echo && number != 0) || self.table.report == PedestalReport::Executing
    }

    /// The fingers have stood for so long that their process has noted it.
    fn is_still(&self) -> bool {
        let read = self.hand.sensed.map(|sensed| sensed.last);
        read == Some(self.fingers.sensors(&SIZES)) && self.hand.still_ticks >= 5 && self.hand.touch_ticks >= 5
    }

    /// What does not count any more begins again.
    fn renumber(&mut self) {
        let (pedestal, out) = (&mut self.pedestal, &mut self.pedestal_out);
        let echo = &mut pedestal.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut self.hand.execution.receiver.echo;
        rebase(&mut pedestal.hand, &mut [&mut out.hand.number, echo, &mut self.hand_out.status.echo]);
        rebase(&mut pedestal.table, &mut [&mut out.table.number, &mut self.table.echo]);
    }
}
