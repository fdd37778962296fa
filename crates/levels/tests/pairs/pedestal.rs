//! The pedestal process and the rotary table's. Around them: Subtask, the hand, the motor and its sensors.

use interfaces::{
    CommonMemory, ExternalInputs, PedestalOutputs, Reason, TableOutputs,
    device::{MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH},
    grip::{Felt, GripReport, GripStatus, GripVerb},
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb},
    process::{Inputs, Process},
};
use levels::{
    execution::Outcome,
    pedestal::{Pedestal, Table, control, table, table::tables::Phase},
};
use rcs_core::tick::Tick;

use crate::{
    image::{Image, rebase, rebase_echoes},
    search::{Mishap, World, Wrong, resumed},
    told::{Told, choices},
};

/// Longer than the time limit of the table's commands.
const LONG: u64 = 2000;
/// Ticks after which the table takes a motor for silent that does not take an order.
const SILENT: u8 = 25;
/// The grasp size of a GRIP and the opening of what stands between the fingers, 0.01 in.
const SIZE: i32 = 250;
const WIDE: i32 = 256;
/// Where the commands lead the table, steps: to where it is parked, and on by -100 degrees each.
const GOALS: [i32; 4] = [-2000, -12_000, -22_000, -32_000];
/// Where a table stands that has stopped elsewhere, steps.
const ELSEWHERE: i32 = -15_000;

/// What the hand does with its command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandDoes {
    /// Nothing new; a command that has just come is taken.
    Goes,
    Ends(Felt),
    Fails,
    /// What is between the fingers is gone.
    Loses,
    /// It writes nothing.
    Silent,
}

/// What the motor does with its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorDoes {
    /// Nothing new: an order that it has not taken yet is not taken, one that it has taken goes on.
    Goes,
    Takes,
    Arrives,
    StopsElsewhere,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub told: Told,
    pub hand: HandDoes,
    pub motor: MotorDoes,
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
    table: table::State,
    table_out: TableOutputs,
    hand: GripStatus,
    silent: bool,
    motor: PedestalSensors,
    goal: i32,
    /// The table seeks its + limit.
    seeks: bool,
    slipped: bool,
    /// The motor has turned without taking orders for longer than the table waits for that.
    was_off: bool,
    /// The hand's last end is that of an order of the current command.
    hand_ended: bool,
}

impl Pair {
    /// The first tick of a system that is booted; so many mishaps can happen, and these commands can come.
    pub fn first(mishaps: u8, commands: &'static [PedestalVerb]) -> Self {
        let mut pair = Self {
            tick: Tick(10_000),
            mishaps,
            commands,
            command: PedestalCommand::default(),
            pedestal: control::state::State::default(),
            pedestal_out: PedestalOutputs::default(),
            table: table::State::default(),
            table_out: TableOutputs::default(),
            hand: GripStatus { felt: Felt::Nothing, ..GripStatus::default() },
            silent: false,
            motor: PedestalSensors { motor_counter: ELSEWHERE, ..PedestalSensors::default() },
            goal: ELSEWHERE,
            seeks: false,
            slipped: false,
            was_off: false,
            hand_ended: false,
        };
        for stamp in [&mut pair.pedestal_out.header.stamp, &mut pair.table_out.header.stamp] {
            *stamp = pair.tick;
        }
        pair
    }

    fn tell(&mut self, verb: PedestalVerb) {
        self.command = PedestalCommand {
            cycle: self.tick,
            number: self.command.number + 1,
            command: verb,
            grasp_size: if verb == PedestalVerb::Grip { SIZE } else { 450 },
            grasp_force: 50,
            table_angle: if verb == PedestalVerb::Flip { -1000 } else { -1200 },
        };
        self.hand_ended = false;
    }

    fn hand_does(&mut self, does: HandDoes) {
        let order = self.pedestal_out.hand;
        let hand = &mut self.hand;
        if does == HandDoes::Silent {
            return;
        }
        if order.number != hand.echo && order.number != 0 {
            (hand.echo, hand.report, hand.reason) = (order.number, GripReport::Executing, Reason::None);
        }
        match does {
            HandDoes::Goes | HandDoes::Silent => {}
            HandDoes::Ends(felt) => {
                (hand.report, hand.felt) = (GripReport::Done, felt);
                hand.position = match (order.command, felt) {
                    (GripVerb::CloseGrip, Felt::Something) => WIDE,
                    (GripVerb::CloseGrip, _) => SIZE,
                    _ => 450,
                };
                hand.initialized |= order.command == GripVerb::UpInit && felt == Felt::Nothing;
                self.hand_ended = true;
            }
            HandDoes::Fails => {
                (hand.report, hand.reason) = (GripReport::Serror, Reason::HandTimeout);
                hand.initialized &= order.command != GripVerb::UpInit;
            }
            HandDoes::Loses => hand.felt = Felt::Nothing,
        }
    }

    fn motor_does(&mut self, does: MotorDoes) {
        let (order, motor) = (self.table_out.motor, &mut self.motor);
        match does {
            MotorDoes::Goes => {}
            MotorDoes::Takes => {
                motor.motor_echo = order.number;
                match order.order {
                    MotorOrder::None => {}
                    MotorOrder::Turn => {
                        self.seeks = order.steps > 30_000;
                        let goal = motor.motor_counter.saturating_add(order.steps);
                        // A turn from where it was not ordered leads anywhere else.
                        self.goal = if GOALS.contains(&goal) { goal } else { ELSEWHERE };
                        (motor.motor_moving, motor.limit_plus) = (true, false);
                    }
                    MotorOrder::SetCounter => {
                        motor.motor_counter = order.steps;
                        self.slipped = false;
                    }
                    MotorOrder::Stop => self.goal = ELSEWHERE,
                }
            }
            MotorDoes::Arrives => {
                motor.motor_moving = false;
                motor.limit_plus = self.seeks;
                motor.motor_counter = if self.seeks { ELSEWHERE } else { self.goal };
            }
            MotorDoes::StopsElsewhere => {
                (motor.motor_moving, motor.motor_counter) = (false, ELSEWHERE);
            }
        }
        // The counter is set where the table has found its limit.
        let counter = if self.motor.limit_plus { 0 } else { self.motor.motor_counter };
        let counts = 3950 + counter / TABLE_STEPS_PER_TENTH - if self.slipped { 200 } else { 0 };
        self.motor.table_potentiometer = u16::try_from(counts).unwrap_or_default();
    }

    /// What is reported done is done, by the orders of this command.
    ///
    /// `before` is the pair as it was when the processes read it.
    fn judge(&self, before: &Self) -> Result<(), Wrong> {
        let status = &self.pedestal_out.status;
        let ends = status.echo == self.command.number
            && status.report == PedestalReport::Done
            && !(before.pedestal_out.status.echo == status.echo
                && before.pedestal_out.status.report == PedestalReport::Done);
        if !ends {
            return Ok(());
        }
        let turned = before.table_out.status.position;
        match self.command.command {
            PedestalVerb::PreGrip | PedestalVerb::Grip | PedestalVerb::Release if !before.hand_ended => {
                Err("done, and the hand has not ended what this command ordered")
            }
            PedestalVerb::PreGrip if turned != Some(-1200) => Err("done, and the table is elsewhere"),
            PedestalVerb::PreGrip | PedestalVerb::Flip | PedestalVerb::Pause if before.turns() => {
                Err("done, and the table turns")
            }
            PedestalVerb::Grip if before.hand.felt != Felt::Something => Err("done, and nothing is held"),
            PedestalVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let order = &self.pedestal_out.hand;
        let busy = (order.number != self.hand.echo && order.number != 0)
            || self.hand.report == GripReport::Executing;
        let mut hand = vec![HandDoes::Goes];
        if busy {
            hand.push(HandDoes::Ends(Felt::Nothing));
            if matches!(order.command, GripVerb::CloseGrip | GripVerb::UpInit) {
                hand.push(HandDoes::Ends(Felt::Something));
            }
            hand.push(HandDoes::Fails);
        } else if self.hand.felt == Felt::Something {
            hand.push(HandDoes::Loses);
        }
        if self.mishaps > 0 {
            hand.push(HandDoes::Silent);
        }
        let pending = self.table_out.motor.number != self.motor.motor_echo;
        // One tick more or less does not matter to an order that is not taken, a long time does.
        let motor: &[MotorDoes] = match (pending, self.motor.motor_moving) {
            (true, _) => &[MotorDoes::Goes, MotorDoes::Takes],
            (false, true) => &[MotorDoes::Goes, MotorDoes::Arrives, MotorDoes::StopsElsewhere],
            (false, false) => &[MotorDoes::Goes],
        };
        let mut events = Vec::new();
        let all = [Mishap::RestartUpper, Mishap::RestartLower, Mishap::Slip];
        for mishap in Mishap::choices(self.mishaps, &all) {
            for told in choices(self.commands, &self.command, &self.pedestal_out.status) {
                for hand in &hand {
                    let mishaps = u8::from(*hand == HandDoes::Silent) + u8::from(mishap != Mishap::None);
                    if mishaps > self.mishaps || (mishaps > 0 && told != Told::Nothing) {
                        continue;
                    }
                    for motor in motor {
                        let event = Event { told, hand: *hand, motor: *motor, mishap, long: false };
                        let hand_prompt = match hand {
                            HandDoes::Goes => !busy,
                            HandDoes::Ends(_) | HandDoes::Fails => true,
                            HandDoes::Loses | HandDoes::Silent => false,
                        };
                        let waits = *motor == MotorDoes::Goes && (pending || self.motor.motor_moving);
                        let quiet = told == Told::Nothing && mishaps == 0;
                        if !pending || *motor == MotorDoes::Takes || self.table.unanswered < 2 {
                            events.push((event, quiet && hand_prompt && !waits));
                        }
                        // The table has time limits for its motor; the hand has its own.
                        if waits && quiet && self.is_settled() && !busy && self.is_timed() {
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
        if event.long && self.table.unanswered > 0 {
            self.table.unanswered = u8::MAX;
        }
        let mut upper: Pedestal = resumed::<_, ()>(self.pedestal, event.mishap == Mishap::RestartUpper);
        let mut lower: Table = resumed::<_, ()>(self.table, event.mishap == Mishap::RestartLower);
        self.mishaps -= u8::from(event.mishap != Mishap::None) + u8::from(event.hand == HandDoes::Silent);
        if let Told::Command(verb) = event.told {
            self.tell(verb);
        }
        let mut memory = CommonMemory::default();
        memory.subtask.pedestal = self.command;
        (memory.pedestal, memory.table) = (self.pedestal_out, self.table_out);
        memory.hand.status = self.hand;
        let before = self.tick.previous();
        memory.hand.header.stamp = if self.silent { Tick(before.0 - 1) } else { before };
        (memory.pedestal.header.stamp, memory.table.header.stamp) = (before, before);
        let mut external = ExternalInputs::default();
        external.devices.pedestal = self.motor;
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &() };
        let old = self.clone();
        let (mut pedestal_out, mut table_out) = (self.pedestal_out, self.table_out);
        upper.step(&inputs, &mut pedestal_out);
        lower.step(&inputs, &mut table_out);
        // Hand and motor read what was written in the tick before.
        self.hand_does(event.hand);
        self.silent = event.hand == HandDoes::Silent;
        self.slipped ^= event.mishap == Mishap::Slip;
        self.motor_does(event.motor);
        (self.pedestal_out, self.table_out) = (pedestal_out, table_out);
        self.pedestal = *Process::<()>::state(&upper);
        self.table = *Process::<()>::state(&lower);
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    /// Without what no row asks for any more: reasons; the step, the command and the time of a process that
    /// executes nothing; the text of an order that has been taken; the opening of a hand that holds nothing. The
    /// pedestal's status says what its state says.
    fn image(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, LONG - 500, &[("standing", 3), ("unanswered", SILENT + 2)]);
        let mut it = self.clone();
        let reasons = [
            &mut it.pedestal.execution.reason,
            &mut it.table.execution.reason,
            &mut it.table_out.status.reason,
            &mut it.hand.reason,
        ];
        reasons.into_iter().for_each(|reason| *reason = Reason::None);
        if it.pedestal.execution.outcome != Outcome::Executing {
            (it.pedestal.step, it.pedestal.ordered) = Default::default();
            (it.pedestal.command, it.hand_ended) = Default::default();
        }
        if it.table.execution.outcome != Outcome::Executing {
            (it.table.step, it.table.command) = Default::default();
        }
        if !it.is_timed() {
            it.table.since = self.tick;
        }
        if it.is_settled() {
            it.pedestal_out.table.angle = 0;
        }
        (it.pedestal.command.number, it.table.command.number) = (0, 0);
        let out = &mut it.pedestal_out.hand;
        if out.number == it.hand.echo && it.hand.report != GripReport::Executing {
            (out.command, out.force, out.position) = Default::default();
        }
        if it.hand.felt != Felt::Something {
            it.hand.position = 0;
        }
        image.add(&it.command);
        image.add(&it.pedestal);
        image.add(&it.pedestal_out.hand);
        image.add(&it.pedestal_out.table);
        image.add(&it.pedestal_out.status.echo);
        image.add(&it.pedestal_out.status.report);
        image.add(&it.table);
        image.add(&it.table_out.status);
        image.add(&it.table_out.motor);
        image.add(&it.hand);
        image.add(&it.motor);
        image.bytes.extend(it.goal.to_le_bytes());
        let flags = [it.silent, it.seeks, it.slipped, it.was_off, it.hand_ended].map(u8::from);
        image.bytes.extend(flags);
        image.bytes.push(it.mishaps);
        image.bytes
    }

    fn rests(&self) -> bool {
        let status = &self.pedestal_out.status;
        status.echo == self.command.number
            && status.report != PedestalReport::Executing
            && self.is_settled()
            && self.table_out.status.report != PedestalReport::Executing
            && self.hand.report != GripReport::Executing
            && self.hand.echo == self.pedestal_out.hand.number
            && (self.is_off() || self.table_out.motor.number == self.motor.motor_echo)
            && !self.turns()
    }

    fn pauses(&self) -> bool {
        self.command.command == PedestalVerb::Pause
    }
}

impl Pair {
    /// The table has read its last command, and the pedestal its echo.
    fn is_settled(&self) -> bool {
        let number = self.pedestal_out.table.number;
        number == 0 || (number == self.table_out.status.echo && number == self.table.execution.receiver.echo)
    }

    /// The table process has a time limit for what it does.
    fn is_timed(&self) -> bool {
        let phase = self.table.phase;
        self.table.execution.outcome == Outcome::Executing
            || matches!(phase, Phase::Adopting | Phase::Seeking | Phase::Setting | Phase::Parking)
    }

    /// The motor does not take its order, and the table knows.
    fn is_off(&self) -> bool {
        self.table_out.motor.number != self.motor.motor_echo && self.was_off
    }

    /// The motor turns, and takes orders: one that does not is left alone (PAUSE of the rotary table).
    fn turns(&self) -> bool {
        self.motor.motor_moving && !self.was_off
    }

    /// What does not count any more begins again.
    fn renumber(&mut self) {
        let (pedestal, out, table) = (&mut self.pedestal, &mut self.pedestal_out, &mut self.table);
        let echo = &mut pedestal.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        rebase(&mut pedestal.hand, &mut [&mut out.hand.number, &mut self.hand.echo]);
        let echo = &mut table.execution.receiver.echo;
        rebase(&mut pedestal.table, &mut [&mut out.table.number, echo, &mut self.table_out.status.echo]);
        // A motor takes the last order or none: by how many orders it is behind does not matter.
        let taken = table.motor.number == self.motor.motor_echo;
        if table.order.number != 0 {
            let numbers =
                [&mut table.motor.number, &mut table.order.number, &mut self.table_out.motor.number];
            numbers.into_iter().for_each(|number| *number = 2);
            self.motor.motor_echo = if taken { 2 } else { 1 };
            table.motor.sent = Tick::BEFORE_START;
        }
        let silent = self.table.unanswered > SILENT;
        self.was_off = silent || (self.was_off && (self.motor.motor_moving || self.table.unanswered > 0));
        if !self.motor.motor_moving {
            (self.goal, self.seeks) = (ELSEWHERE, false);
        }
        if self.table_out.motor.number == self.motor.motor_echo {
            (self.table.order.steps, self.table_out.motor.steps) = (0, 0);
        }
    }
}
