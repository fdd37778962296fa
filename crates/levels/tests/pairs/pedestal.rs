//! The pedestal process and the rotary table's. Around them: Subtask, the hand, the motor and its sensors.

use interfaces::{
    CommonMemory, ExternalInputs, Reason,
    device::{MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH},
    grip::{Felt, GripCommand, GripReport, GripStatus, GripVerb},
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb},
};
use levels::{
    execution::Outcome,
    pedestal::{Pedestal, Table, table::tables::TablePhase},
};
use rcs_core::tick::Tick;

use crate::{
    frame::{self, Choice, Event, Half, Scene},
    hand,
    image::{Image, rebase, rebase_echoes},
    search::{DeliveryFault, Wrong},
};

/// Ticks until a motor that takes no order is reported silent.
const SILENT: u8 = 25;
/// Grasp size of a GRIP, and opening with the object, 0.01 in.
const SIZE: i32 = 250;
const WIDE: i32 = 256;
/// Goals of the commands, steps: the parking place, then steps of -100 degrees.
const GOALS: [i32; 4] = [-2000, -12_000, -22_000, -32_000];
/// Place of a table that has stopped elsewhere, steps.
const ELSEWHERE: i32 = -15_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandDoes {
    /// Nothing new; a new command is taken.
    Goes,
    Ends(Felt),
    Fails,
    Loses,
    Silent,
}

/// Reaction of the motor to its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorDoes {
    /// The motor takes no new order, and continues the one that it has taken.
    Goes,
    Takes,
    Arrives,
    StopsElsewhere,
}

#[derive(Clone)]
pub struct Around {
    hand: GripStatus,
    silent: bool,
    motor: PedestalSensors,
    goal: i32,
    seeks: bool,
    slipped: bool,
    was_off: bool,    // the motor took no orders for longer than the table's time limit
    hand_ended: bool, // the hand's last end belongs to the current command
}

pub type Pair = frame::Pair<Around>;

/// A pair before its first tick.
pub fn first(mishaps: u8, commands: &[PedestalVerb]) -> Pair {
    let around = Around {
        hand: GripStatus { felt: Felt::Nothing, ..GripStatus::default() },
        silent: false,
        motor: PedestalSensors { motor_counter: ELSEWHERE, ..PedestalSensors::default() },
        goal: ELSEWHERE,
        seeks: false,
        slipped: false,
        was_off: false,
        hand_ended: false,
    };
    Pair::new(commands, (None, mishaps), Half::default(), around)
}

impl Around {
    fn hand_does(&mut self, does: HandDoes, order: &GripCommand) {
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

    fn motor_does(&mut self, does: MotorDoes, order: &MotorCommand) {
        let motor = &mut self.motor;
        match does {
            MotorDoes::Goes => {}
            MotorDoes::Takes => {
                motor.motor_echo = order.number;
                match order.order {
                    MotorOrder::None => {}
                    MotorOrder::Turn => {
                        self.seeks = order.steps > 30_000;
                        let goal = motor.motor_counter.saturating_add(order.steps);
                        // A turn from another place than ordered ends elsewhere.
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
        // The counter is set at the limit.
        let counter = if self.motor.limit_plus { 0 } else { self.motor.motor_counter };
        let counts = 3950 + counter / TABLE_STEPS_PER_TENTH - if self.slipped { 200 } else { 0 };
        self.motor.table_potentiometer = u16::try_from(counts).unwrap_or_default();
    }
}

impl Scene for Around {
    type Upper = Half<Pedestal>;
    type Lower = Half<Table>;
    type Line = PedestalVerb;
    type Command = PedestalCommand;
    type Does = (HandDoes, MotorDoes);
    /// Longer than the time limit of the table's commands.
    const LONG: u64 = 2000;
    const DELIVERY_FAULTS: &'static [DeliveryFault] =
        &[DeliveryFault::RestartUpper, DeliveryFault::RestartLower, DeliveryFault::Slip];

    fn choices(pair: &Pair) -> Vec<Choice<Self::Does>> {
        let order = &pair.upper.out.hand;
        let busy = (order.number != pair.scene.hand.echo && order.number != 0)
            || pair.scene.hand.report == GripReport::Executing;
        let mut hand = vec![HandDoes::Goes];
        if busy {
            hand.push(HandDoes::Ends(Felt::Nothing));
            if matches!(order.command, GripVerb::CloseGrip | GripVerb::UpInit) {
                hand.push(HandDoes::Ends(Felt::Something));
            }
            hand.push(HandDoes::Fails);
        } else if pair.scene.hand.felt == Felt::Something {
            hand.push(HandDoes::Loses);
        }
        hand.push(HandDoes::Silent);
        let pending = pair.lower.out.motor.number != pair.scene.motor.motor_echo;
        // For an order that is not taken, one tick does not matter; a long time does.
        let motor: &[MotorDoes] = match (pending, pair.scene.motor.motor_moving) {
            (true, _) => &[MotorDoes::Goes, MotorDoes::Takes],
            (false, true) => &[MotorDoes::Goes, MotorDoes::Arrives, MotorDoes::StopsElsewhere],
            (false, false) => &[MotorDoes::Goes],
        };
        let mut choices = Vec::new();
        for hand in hand {
            let hand_prompt = match hand {
                HandDoes::Goes => !busy,
                HandDoes::Ends(_) | HandDoes::Fails => true,
                HandDoes::Loses | HandDoes::Silent => false,
            };
            for &motor in motor {
                let waits = motor == MotorDoes::Goes && (pending || pair.scene.motor.motor_moving);
                choices.push(Choice {
                    mishaps: u8::from(hand == HandDoes::Silent),
                    short: !pending || motor == MotorDoes::Takes || pair.lower.state.unanswered < 2,
                    // The table has time limits for its motor; the hand has its own.
                    long: waits && pair.is_settled() && !busy && pair.is_timed(),
                    ..Choice::new((hand, motor), hand_prompt && !waits)
                });
            }
        }
        choices
    }

    fn has_ended(pair: &Pair) -> bool {
        hand::has_ended(&pair.command, &pair.upper.out.status)
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
            grasp_size: if verb == PedestalVerb::Grip { SIZE } else { 450 },
            grasp_force: 50,
            table_angle: if verb == PedestalVerb::Flip { -1000 } else { -1200 },
        };
        pair.scene.hand_ended = false;
    }

    fn begin(pair: &mut Pair, event: &Event<Self::Does>) {
        if event.long && pair.lower.state.unanswered > 0 {
            pair.lower.state.unanswered = u8::MAX;
        }
    }

    fn inputs(pair: &Pair) -> (CommonMemory, ExternalInputs) {
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        memory.subtask.pedestal = pair.command;
        (memory.pedestal, memory.table) = (pair.upper.out, pair.lower.out);
        memory.hand.status = pair.scene.hand;
        let before = pair.tick.previous();
        memory.hand.header.stamp = if pair.scene.silent { before.previous() } else { before };
        (memory.pedestal.header.stamp, memory.table.header.stamp) = (before, before);
        external.devices.pedestal = pair.scene.motor;
        (memory, external)
    }

    fn act(pair: &mut Pair, event: &Event<Self::Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        let (hand, motor) = event.does;
        pair.scene.hand_does(hand, &memory.pedestal.hand);
        pair.scene.silent = hand == HandDoes::Silent;
        pair.scene.slipped ^= event.mishap == DeliveryFault::Slip;
        pair.scene.motor_does(motor, &memory.table.motor);
        Ok(())
    }

    fn judge(pair: &Pair, before: &Pair, _: &Event<Self::Does>) -> Result<(), Wrong> {
        let status = &pair.upper.out.status;
        let ends = status.echo == pair.command.number
            && status.report == PedestalReport::Done
            && !(before.upper.out.status.echo == status.echo
                && before.upper.out.status.report == PedestalReport::Done);
        if !ends {
            return Ok(());
        }
        let turned = before.lower.out.status.position;
        match pair.command.command {
            PedestalVerb::PreGrip | PedestalVerb::Grip | PedestalVerb::Release
                if !before.scene.hand_ended =>
            {
                Err("done, and the hand has not ended the order of this command")
            }
            PedestalVerb::PreGrip if turned != Some(-1200) => Err("done, and the table is elsewhere"),
            PedestalVerb::PreGrip | PedestalVerb::Flip | PedestalVerb::Pause if before.turns() => {
                Err("done, and the table turns")
            }
            PedestalVerb::Grip if before.scene.hand.felt != Felt::Something => {
                Err("done, and the hand is empty")
            }
            PedestalVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    fn renumber(pair: &mut Pair) {
        let (pedestal, out, table) = (&mut pair.upper.state, &mut pair.upper.out, &mut pair.lower.state);
        let echo = &mut pedestal.execution.receiver.echo;
        rebase_echoes(&mut [&mut pair.command.number, echo, &mut out.status.echo]);
        rebase(&mut pedestal.hand, &mut [&mut out.hand.number, &mut pair.scene.hand.echo]);
        let echo = &mut table.execution.receiver.echo;
        rebase(&mut pedestal.table, &mut [&mut out.table.number, echo, &mut pair.lower.out.status.echo]);
        // A motor takes the last order or none, so the number of missed orders does not matter.
        let taken = table.motor.number == pair.scene.motor.motor_echo;
        if table.order.number != 0 {
            let numbers =
                [&mut table.motor.number, &mut table.order.number, &mut pair.lower.out.motor.number];
            numbers.into_iter().for_each(|number| *number = 2);
            pair.scene.motor.motor_echo = if taken { 2 } else { 1 };
            table.motor.sent = Tick::BEFORE_START;
        }
        let silent = pair.lower.state.unanswered > SILENT;
        pair.scene.was_off = silent
            || (pair.scene.was_off && (pair.scene.motor.motor_moving || pair.lower.state.unanswered > 0));
        if !pair.scene.motor.motor_moving {
            (pair.scene.goal, pair.scene.seeks) = (ELSEWHERE, false);
        }
        if pair.lower.out.motor.number == pair.scene.motor.motor_echo {
            (pair.lower.state.order.steps, pair.lower.out.motor.steps) = (0, 0);
        }
    }

    /// Omits what no row tests: reasons, the text of an order that has been taken, the opening of an empty hand, and
    /// step, command and time of an idle process. Omits the pedestal's status, which repeats its state.
    fn image(pair: &Pair) -> Vec<u8> {
        let mut image =
            Image::new(pair.tick, Self::LONG - 500, &[("standing", 3), ("unanswered", SILENT + 2)]);
        let mut it = pair.clone();
        let reasons = [
            &mut it.upper.state.execution.reason,
            &mut it.lower.state.execution.reason,
            &mut it.lower.out.status.reason,
            &mut it.scene.hand.reason,
        ];
        reasons.into_iter().for_each(|reason| *reason = Reason::None);
        if it.upper.state.execution.outcome != Outcome::Executing {
            (it.upper.state.step, it.upper.state.ordered) = Default::default();
            (it.upper.state.command, it.scene.hand_ended) = Default::default();
        }
        if it.lower.state.execution.outcome != Outcome::Executing {
            (it.lower.state.step, it.lower.state.command) = Default::default();
        }
        if !it.is_timed() {
            it.lower.state.since = pair.tick;
        }
        if it.is_settled() {
            it.upper.out.table.angle = 0;
        }
        (it.upper.state.command.number, it.lower.state.command.number) = (0, 0);
        let out = &mut it.upper.out.hand;
        if out.number == it.scene.hand.echo && it.scene.hand.report != GripReport::Executing {
            (out.command, out.force, out.position) = Default::default();
        }
        if it.scene.hand.felt != Felt::Something {
            it.scene.hand.position = 0;
        }
        image.add(&it.command);
        image.add(&it.upper.state);
        image.add(&it.upper.out.hand);
        image.add(&it.upper.out.table);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.status.report);
        image.add(&it.lower.state);
        image.add(&it.lower.out.status);
        image.add(&it.lower.out.motor);
        image.add(&it.scene.hand);
        image.add(&it.scene.motor);
        image.bytes.extend(it.scene.goal.to_le_bytes());
        let flags =
            [it.scene.silent, it.scene.seeks, it.scene.slipped, it.scene.was_off, it.scene.hand_ended]
                .map(u8::from);
        image.bytes.extend(flags);
        image.bytes.push(it.mishaps);
        image.bytes
    }

    fn rests(pair: &Pair) -> bool {
        Self::has_ended(pair)
            && pair.is_settled()
            && pair.lower.out.status.report != PedestalReport::Executing
            && pair.scene.hand.report != GripReport::Executing
            && pair.scene.hand.echo == pair.upper.out.hand.number
            && (pair.is_off() || pair.lower.out.motor.number == pair.scene.motor.motor_echo)
            && !pair.turns()
    }

    fn pauses(pair: &Pair) -> bool {
        pair.command.command == PedestalVerb::Pause
    }
}

impl Pair {
    fn is_settled(&self) -> bool {
        let number = self.upper.out.table.number;
        number == 0
            || (number == self.lower.out.status.echo && number == self.lower.state.execution.receiver.echo)
    }

    /// The table process has a time limit for its current activity.
    fn is_timed(&self) -> bool {
        let phase = self.lower.state.phase;
        self.lower.state.execution.outcome == Outcome::Executing
            || matches!(
                phase,
                TablePhase::Adopting | TablePhase::Seeking | TablePhase::Setting | TablePhase::Parking
            )
    }

    fn is_off(&self) -> bool {
        self.lower.out.motor.number != self.scene.motor.motor_echo && self.scene.was_off
    }

    /// The motor turns, and takes orders. Without orders it is ignored (PAUSE of the rotary table).
    fn turns(&self) -> bool {
        self.scene.motor.motor_moving && !self.scene.was_off
    }
}
