use interfaces::{
    CommonMemory, ExternalInputs, Header, PedestalOutputs, Reason,
    grip::{Felt, GripReport, GripVerb},
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb, TableVerb},
    process::{Inputs, Process},
};
use proptest::prelude::*;
use rcs_core::tick::Tick;

use super::Pedestal;
use crate::{
    bench::{self, Tested, World},
    coverage::silent,
    environment::{
        air::{Gripper, Object},
        rotary::Rotary,
    },
    pedestal::{Hand, Table},
};

type Bench = bench::Bench<Pedestal, ByHand>;
type Cell = bench::Bench<Pedestal, Real>;

impl Tested<()> for Pedestal {
    /// A command with grasp size, grasp force and table angle.
    type Order = (PedestalVerb, i32, i32, i32);
    type End = (PedestalReport, Reason);
    const LONGEST: u64 = 5000;

    fn order(
        memory: &mut CommonMemory,
        (command, grasp_size, grasp_force, table_angle): Self::Order,
        number: u32,
    ) {
        let cycle = memory.pedestal.header.stamp;
        memory.subtask.pedestal =
            PedestalCommand { cycle, number, command, grasp_size, grasp_force, table_angle };
    }

    fn end(outputs: &PedestalOutputs) -> Option<(PedestalReport, Reason)> {
        let status = outputs.status;
        (status.report != PedestalReport::Executing).then_some((status.report, status.reason))
    }

    fn check(outputs: &PedestalOutputs, memory: &CommonMemory, _: &ExternalInputs) {
        assert_eq!(outputs.status.cycle_echo, memory.subtask.pedestal.cycle);
    }
}

#[derive(Clone, Default)]
struct ByHand {
    silent: bool,
}

impl World<Pedestal> for ByHand {
    fn sense(&mut self, tick: Tick, memory: &mut CommonMemory, _: &mut ExternalInputs) {
        let stamp = if self.silent { Tick::BEFORE_START } else { tick.previous() };
        (memory.hand.header.stamp, memory.table.header.stamp) = (stamp, stamp);
    }
}

impl Bench {
    /// A bench after a tick without a command, with hand and table calibrated.
    fn new() -> Self {
        let mut bench = Self::before(ByHand::default());
        bench.memory.hand.status.initialized = true;
        bench.memory.hand.status.position = 500;
        bench.memory.hand.status.felt = Felt::Nothing;
        bench.memory.table.status.calibrated = true;
        bench.memory.table.status.position = Some(-2135);
        bench.step();
        bench
    }

    fn gripping() -> Self {
        let mut bench = Self::new();
        bench.send((PedestalVerb::Grip, 250, 50, 0));
        bench.step();
        bench.hand(GripReport::Done, 256).step();
        bench
    }

    /// The hand answers its last command. Fingers at the width of an object, 2.56 in, hold the object.
    fn hand(&mut self, report: GripReport, position: i32) -> &mut Self {
        let status = &mut self.memory.hand.status;
        (status.echo, status.report, status.position) = (self.memory.pedestal.hand.number, report, position);
        status.felt = if position == 256 { Felt::Something } else { Felt::Nothing };
        self
    }

    /// The table answers its last command; it is at its angle when it reports done.
    fn table(&mut self, report: PedestalReport) -> &mut Self {
        let order = self.memory.pedestal.table;
        if report == PedestalReport::Done && order.command == TableVerb::Turn {
            self.memory.table.status.position = Some(order.angle);
        }
        self.table_elsewhere(report)
    }

    /// The table answers its last command, and stays where it is.
    fn table_elsewhere(&mut self, report: PedestalReport) -> &mut Self {
        let status = &mut self.memory.table.status;
        (status.echo, status.report) = (self.memory.pedestal.table.number, report);
        self
    }

    fn end(&mut self) -> (PedestalReport, Reason) {
        let status = self.step().status;
        (status.report, status.reason)
    }
}

#[derive(Clone)]
struct Real {
    hand: Hand,
    table: Table,
    fingers: Gripper,
    rotary: Rotary,
}

impl World<Pedestal> for Real {
    fn sense(&mut self, _: Tick, _: &mut CommonMemory, external: &mut ExternalInputs) {
        let (sensors, grip) = (&mut external.devices.pedestal, self.fingers.sensors());
        sensors.potentiometer = grip.potentiometer;
        (sensors.strain_left, sensors.strain_right) = (grip.strain_left, grip.strain_right);
        self.rotary.sense(sensors);
    }

    fn act(
        &mut self,
        tick: Tick,
        memory: &CommonMemory,
        after: &mut CommonMemory,
        external: &mut ExternalInputs,
    ) {
        let inputs = Inputs { tick, memory, external, data: &() };
        self.hand.step(&inputs, &mut after.hand);
        self.table.step(&inputs, &mut after.table);
        self.fingers.advance(after.hand.valves.bits);
        self.rotary.advance(&after.table.motor);
    }
}

impl Cell {
    /// A cell whose hand holds an object at the angle for receiving one, as in Figure VII.13.
    fn taken() -> Self {
        let (fingers, rotary) = (Gripper::new(1.0, 1987), Rotary::new(-1200));
        let world = Real { hand: Hand::default(), table: Table::default(), fingers, rotary };
        let mut cell = Self::before(world);
        cell.step();
        assert_eq!(cell.execute((PedestalVerb::PreGrip, 500, 50, -2135)), DONE);
        cell.world.fingers.object = Some(Object { size: 2.56, off_centre: 0.05 });
        assert_eq!(cell.execute((PedestalVerb::Grip, 250, 50, 0)), DONE);
        cell
    }
}

const EXECUTING: (PedestalReport, Reason) = (PedestalReport::Executing, Reason::None);
const DONE: (PedestalReport, Reason) = (PedestalReport::Done, Reason::None);

#[test]
fn pre_grip_opens_the_hand_and_turns_the_table_together() {
    let mut bench = Bench::new();
    bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
    let outputs = bench.step();
    assert_eq!((outputs.hand.command, outputs.hand.position), (GripVerb::OpenGrip, 450));
    assert_eq!((outputs.table.command, outputs.table.angle), (TableVerb::Turn, -1000));
    assert_eq!(bench.end(), EXECUTING, "not echoed yet");
    bench.hand(GripReport::Done, 450).table(PedestalReport::Executing);
    assert_eq!(bench.end(), EXECUTING);
    bench.hand(GripReport::Executing, 450).table(PedestalReport::Done);
    assert_eq!(bench.end(), EXECUTING);
    bench.hand(GripReport::Done, 450);
    assert_eq!(bench.end(), DONE);
}

#[test]
fn command_is_not_done_before_hand_and_table_arrive() {
    let error = |reason| (PedestalReport::Error, reason);
    for (hand, table, end) in [
        (450, true, DONE),
        (441, true, DONE),
        (400, true, error(Reason::HandTimeout)),
        (450, false, error(Reason::TableStuck)),
    ] {
        let mut bench = Bench::new();
        bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
        bench.step();
        bench.hand(GripReport::Done, hand);
        if table {
            bench.table(PedestalReport::Done);
        } else {
            bench.table_elsewhere(PedestalReport::Done);
        }
        if end != DONE {
            assert_eq!(bench.end(), EXECUTING, "waits for a newer reading");
        }
        assert_eq!(bench.end(), end, "hand at {hand}, table there: {table}");
    }
    let mut bench = Bench::new();
    bench.send((PedestalVerb::Flip, 0, 0, 1835));
    bench.step();
    assert_eq!(bench.table_elsewhere(PedestalReport::Done).end(), EXECUTING);
    assert_eq!(bench.end(), error(Reason::TableStuck));
    bench.send((PedestalVerb::Release, 450, 0, 0));
    bench.step();
    assert_eq!(bench.hand(GripReport::Done, 300).end(), EXECUTING);
    assert_eq!(bench.end(), error(Reason::HandTimeout));
}

#[test]
fn grip_flip_and_release_command_one_neighbour_each() {
    let mut bench = Bench::new();
    bench.send((PedestalVerb::Grip, 250, 50, 0));
    let outputs = bench.step();
    assert_eq!(
        (outputs.hand.command, outputs.hand.position, outputs.hand.force),
        (GripVerb::CloseGrip, 250, 50)
    );
    assert_eq!(outputs.table.number, 0, "no command is sent to the rotary table");
    bench.memory.hand.status.left_force = 49;
    bench.memory.hand.status.right_force = 52;
    assert_eq!(bench.hand(GripReport::Done, 256).end(), DONE);
    let status = bench.memory.pedestal.status;
    assert_eq!((status.grip_size, status.grip_force, status.table_position), (256, 51, Some(-2135)));

    let gripping = bench.memory.pedestal.hand;
    bench.send((PedestalVerb::Flip, 0, 0, 1835));
    let outputs = bench.step();
    assert_eq!((outputs.table.command, outputs.table.angle), (TableVerb::Turn, -300), "relative");
    assert_eq!(outputs.hand, gripping, "no command is sent to the hand");
    assert_eq!(bench.table(PedestalReport::Executing).end(), EXECUTING);
    assert_eq!(bench.table(PedestalReport::Done).end(), DONE);

    let turned = bench.memory.pedestal.table;
    bench.send((PedestalVerb::Release, 450, 0, 0));
    let outputs = bench.step();
    assert_eq!((outputs.hand.command, outputs.hand.position), (GripVerb::OpenGrip, 450));
    assert_eq!(outputs.table, turned);
    assert_eq!(bench.hand(GripReport::Done, 450).end(), DONE);
}

#[test]
fn unattainable_command_is_refused_before_any_motion() {
    for (verb, size, force, angle, reason) in [
        (PedestalVerb::None, 0, 0, 0, Reason::UnknownCommand),
        (PedestalVerb::PreGrip, 450, 0, -100, Reason::TableLimit),
        (PedestalVerb::PreGrip, 450, 0, i32::MIN, Reason::TableLimit),
        (PedestalVerb::PreGrip, 600, 0, -1000, Reason::HandUnattainable),
        (PedestalVerb::Grip, 250, 500, 0, Reason::HandUnattainable),
        (PedestalVerb::Grip, -1, 50, 0, Reason::HandUnattainable),
        (PedestalVerb::Flip, 0, 0, 2000, Reason::TableLimit),
        (PedestalVerb::Flip, 0, 0, i32::MAX, Reason::TableLimit),
        (PedestalVerb::Release, 501, 0, 0, Reason::HandUnattainable),
    ] {
        let mut bench = Bench::new();
        let before = bench.memory.pedestal;
        bench.send((verb, size, force, angle));
        assert_eq!(bench.end(), (PedestalReport::CannotDo, reason), "{verb} {size} {force} {angle}");
        let after = bench.memory.pedestal;
        assert_eq!((after.hand, after.table), (before.hand, before.table));
    }
    let mut bench = Bench::new();
    bench.memory.table.status.position = None;
    bench.send((PedestalVerb::Flip, 0, 0, 1835));
    assert_eq!(bench.end(), (PedestalReport::CannotDo, Reason::TableAngleUnknown), "from where?");
}

#[test]
fn grip_without_a_sensed_object_fails() {
    for (felt, position, reason) in [
        (Felt::Nothing, 250, Reason::HandMissed),
        (Felt::Something, 250, Reason::HandMissed),
        (Felt::NotKnown, 256, Reason::HandUncertain),
    ] {
        let mut bench = Bench::new();
        bench.send((PedestalVerb::Grip, 250, 50, 0));
        bench.step();
        bench.hand(GripReport::Done, position).memory.hand.status.felt = felt;
        assert_eq!(bench.end(), (PedestalReport::Error, reason), "{felt}");
        assert_eq!(bench.memory.pedestal.status.gripped, felt == Felt::NotKnown);
    }
}

#[test]
fn object_and_angle_are_published_for_every_command() {
    let mut bench = Bench::new();
    let status = bench.step().status;
    assert_eq!((status.felt, status.gripped, status.table_position), (Felt::Nothing, false, Some(-2135)));
    bench.send((PedestalVerb::Grip, 250, 50, 0));
    bench.step();
    // During a PAUSE the hand finishes its GRIP, and its object is published.
    bench.send((PedestalVerb::Pause, 0, 0, 0));
    bench.step();
    bench.hand(GripReport::Done, 256).table(PedestalReport::Done);
    let status = bench.step().status;
    assert_eq!((status.report, status.felt, status.gripped), (PedestalReport::Done, Felt::Something, true));
    // A restarted process determines it again.
    bench.restart();
    let status = bench.step().status;
    assert_eq!((status.reason, status.felt, status.gripped), (Reason::Restarted, Felt::Something, true));
    bench.table(PedestalReport::Done);
    bench.memory.hand.status.felt = Felt::Nothing;
    bench.send((PedestalVerb::Flip, 0, 0, 1835));
    assert_eq!(bench.end(), (PedestalReport::Error, Reason::HandLost), "it was gripped before");
    // The statuses of a hand and table without an answer are not used.
    bench.world.silent = true;
    let status = bench.step().status;
    assert_eq!((status.felt, status.table_position), (Felt::NotKnown, None));
}

#[test]
fn pre_grip_calibrates_only_a_hand_without_an_object() {
    let mut bench = Bench::new();
    bench.memory.hand.status.initialized = false;
    bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
    let outputs = bench.step();
    assert_eq!((outputs.hand.command, outputs.table.number), (GripVerb::UpInit, 0));
    bench.hand(GripReport::Executing, 0).step();
    bench.memory.hand.status.initialized = true;
    let outputs = bench.hand(GripReport::Done, 500).step();
    assert_eq!((outputs.hand.command, outputs.table.command), (GripVerb::OpenGrip, TableVerb::Turn));
    // A hand that reports done and is not calibrated gets no second UP-INIT.
    bench.hand(GripReport::Done, 500).table(PedestalReport::Done).step();
    bench.memory.hand.status.initialized = false;
    bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
    bench.step();
    let (report, reason) = bench.hand(GripReport::Done, 500).end();
    assert_eq!((report, reason), (PedestalReport::CannotDo, Reason::HandNotCalibrated));
    // A hand that may hold an object is not closed on it.
    bench.memory.hand.status.initialized = true;
    bench.send((PedestalVerb::Grip, 250, 50, 0));
    bench.step();
    bench.hand(GripReport::Done, 256).step();
    bench.memory.hand.status.initialized = false;
    let before = bench.memory.pedestal.hand;
    bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
    assert_eq!(bench.end(), (PedestalReport::CannotDo, Reason::HandNotCalibrated));
    assert_eq!(bench.memory.pedestal.hand, before);
}

#[test]
fn interrupted_flip_is_completed_by_the_remaining_angle() {
    let mut cell = Cell::taken();
    let goal = -2135 + 1835;
    for (nth, verb) in [PedestalVerb::Pause, PedestalVerb::None].into_iter().cycle().take(4).enumerate() {
        let left = goal - cell.memory.pedestal.status.table_position.unwrap();
        assert!(left > 0);
        cell.send((PedestalVerb::Flip, 0, 50, left));
        cell.wait(20);
        if verb == PedestalVerb::None {
            // A restart stops the table, and the same command can be sent again.
            if nth == 1 {
                cell.restart()
            } else {
                cell.world.table = Table::default()
            }
            cell.wait(40);
            assert_eq!(cell.memory.pedestal.status.reason, Reason::Restarted);
        } else {
            assert_eq!(cell.execute((verb, 0, 50, 0)), DONE);
        }
        let stopped = cell.world.rotary.position;
        cell.wait(20);
        assert_eq!(cell.world.rotary.position, stopped);
    }
    let left = goal - cell.memory.pedestal.status.table_position.unwrap();
    assert_eq!(cell.execute((PedestalVerb::Flip, 0, 50, left)), DONE);
    assert_eq!(cell.memory.pedestal.status.table_position, Some(goal));
    assert!(
        (cell.world.rotary.angle() + 30.0).abs() < 0.06 && (cell.world.fingers.force - 50.0).abs() <= 3.0
    );
    assert_eq!(cell.execute((PedestalVerb::Flip, 0, 50, 0)), DONE, "no angle remains");
    assert_eq!(cell.memory.pedestal.status.table_position, Some(goal));
}

#[test]
fn object_lost_while_turning_is_reported() {
    for when in [0, 1, 5] {
        let mut bench = Bench::gripping();
        bench.send((PedestalVerb::Flip, 0, 0, 1835));
        for _ in 0..when {
            bench.step();
            bench.table(PedestalReport::Executing);
        }
        bench.memory.hand.status.felt = Felt::Nothing;
        assert_eq!(bench.end(), (PedestalReport::Error, Reason::HandLost));
    }
}

#[test]
fn failure_below_is_passed_up_without_a_command_to_the_hand() {
    let pass_up = |verb, fail: &dyn Fn(&mut Bench), reason| {
        let mut bench = Bench::gripping();
        bench.send((verb, 250, 50, if verb == PedestalVerb::Flip { 1835 } else { -1000 }));
        bench.step();
        let hand = bench.memory.pedestal.hand;
        bench.hand(GripReport::Executing, 256).table(PedestalReport::Executing).step();
        fail(&mut bench);
        assert_eq!(bench.end(), (PedestalReport::Error, reason), "{verb}");
        for _ in 0..20 {
            assert_eq!(bench.step().hand, hand, "{verb}");
        }
    };
    let hand_fails = |bench: &mut Bench| {
        bench.hand(GripReport::Serror, 256).memory.hand.status.reason = Reason::GripTimeout;
    };
    let table_fails = |bench: &mut Bench| {
        bench.table(PedestalReport::Error).memory.table.status.reason = Reason::TableStuck;
    };
    for verb in [PedestalVerb::PreGrip, PedestalVerb::Grip, PedestalVerb::Release] {
        pass_up(verb, &hand_fails, Reason::GripTimeout);
    }
    for verb in [PedestalVerb::PreGrip, PedestalVerb::Flip, PedestalVerb::Pause] {
        pass_up(verb, &table_fails, Reason::TableStuck);
    }
}

#[test]
fn silent_neighbour_is_lost() {
    for (verb, angle) in [(PedestalVerb::Grip, 0), (PedestalVerb::Flip, 100)] {
        let mut bench = Bench::new();
        bench.send((verb, 250, 50, angle));
        let first = bench.end();
        assert!((0..3).all(|_| bench.end() == first), "before its time limit");
        assert_eq!(bench.end(), (PedestalReport::Error, Reason::NeighbourLost), "{verb}");
    }
}

#[test]
fn pause_stops_the_table_and_waits_for_the_hand() {
    for end in [GripReport::Done, GripReport::Serror] {
        let mut bench = Bench::new();
        bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
        let before = bench.step();
        bench.hand(GripReport::Executing, 300).table(PedestalReport::Executing).step();
        bench.send((PedestalVerb::Pause, 0, 0, 0));
        let outputs = bench.step();
        assert_eq!((outputs.table.command, outputs.hand), (TableVerb::Pause, before.hand));
        assert_eq!(bench.table(PedestalReport::Executing).end(), EXECUTING);
        assert_eq!(bench.table(PedestalReport::Done).end(), EXECUTING, "the hand still moves");
        assert_eq!(bench.hand(end, 450).end(), DONE);
    }
}

#[test]
fn restarted_process_adopts_the_command_and_stops_the_table() {
    let mut bench = Bench::new();
    bench.send((PedestalVerb::Flip, 0, 0, 100));
    let before = bench.step();
    bench.hand(GripReport::Done, 256).table(PedestalReport::Executing);
    bench.restart();
    assert_eq!(bench.end(), EXECUTING);
    let PedestalOutputs { hand, table, .. } = bench.memory.pedestal;
    assert_eq!((hand, table.command), (before.hand, TableVerb::Pause), "no command to the hand");
    assert_eq!(bench.end(), EXECUTING, "the table stops");
    assert_eq!(bench.memory.pedestal.table, table, "one stop command");
    assert_eq!(bench.table(PedestalReport::Done).end(), (PedestalReport::Error, Reason::Restarted));
    bench.send((PedestalVerb::Flip, 0, 0, 100));
    bench.step();
    assert_eq!(bench.table(PedestalReport::Done).end(), DONE, "with any object in the hand");
    // A restart while the table comes to rest after a PAUSE keeps that PAUSE.
    bench.send((PedestalVerb::Flip, 0, 0, 100));
    bench.step();
    bench.table(PedestalReport::Executing).send((PedestalVerb::Pause, 0, 0, 0));
    let pause = bench.step().table;
    bench.table(PedestalReport::Executing).restart();
    assert_eq!((bench.end(), bench.memory.pedestal.table), (EXECUTING, pause));
}

/// A new command while hand and table move.
fn replaced(verb: PedestalVerb, paused: bool) -> Bench {
    let mut bench = Bench::new();
    bench.send((PedestalVerb::PreGrip, 450, 0, -1000));
    let before = bench.step();
    bench.hand(GripReport::Executing, 300).table(PedestalReport::Executing).step();
    if paused {
        bench.hand(GripReport::Done, 450).send((PedestalVerb::Pause, 0, 0, 0));
        bench.step();
    }
    bench.send((verb, 250, 0, 0));
    assert_eq!(bench.end(), EXECUTING, "{verb}");
    let PedestalOutputs { hand, table, .. } = bench.memory.pedestal;
    assert_eq!((hand, table.command), (before.hand, TableVerb::Pause));
    assert_eq!(bench.end(), EXECUTING, "the table stops");
    bench.table(PedestalReport::Done);
    if !paused {
        assert_eq!(bench.end(), EXECUTING, "the hand still moves");
        bench.hand(GripReport::Done, 450);
    }
    assert_eq!(bench.end(), EXECUTING, "they are at rest");
    assert_eq!(bench.memory.pedestal.hand, before.hand);
    bench
}

#[test]
fn new_command_waits_until_table_and_hand_rest() {
    for paused in [false, true] {
        let mut bench = replaced(PedestalVerb::None, paused);
        assert_eq!(bench.end(), (PedestalReport::CannotDo, Reason::UnknownCommand));
        let mut bench = replaced(PedestalVerb::Release, paused);
        assert_eq!((bench.end(), bench.memory.pedestal.hand.position), (EXECUTING, 250));
    }
}

#[test]
fn every_row_fires() {
    let silent = silent::<Pedestal, ()>(&[
        command_is_not_done_before_hand_and_table_arrive,
        grip_flip_and_release_command_one_neighbour_each,
        unattainable_command_is_refused_before_any_motion,
        grip_without_a_sensed_object_fails,
        object_and_angle_are_published_for_every_command,
        pre_grip_calibrates_only_a_hand_without_an_object,
        failure_below_is_passed_up_without_a_command_to_the_hand,
        pause_stops_the_table_and_waits_for_the_hand,
        restarted_process_adopts_the_command_and_stops_the_table,
        new_command_waits_until_table_and_hand_rest,
    ]);
    // The pedestal process does not watch Subtask.
    assert_eq!(silent, ["HALT 4"]);
}

/// FIX-GRIP (V.3.1) with the clevis of Figure VII.13, from the start of the system.
#[test]
fn pedestal_takes_turns_and_returns_an_object() {
    let mut cell = Cell::taken();
    assert!((cell.world.rotary.angle() + 213.5).abs() < 0.06);
    assert!((cell.world.fingers.force - 50.0).abs() <= 3.0);
    assert_eq!(cell.execute((PedestalVerb::Flip, 0, 50, 1835)), DONE);
    assert!((cell.world.rotary.angle() + 30.0).abs() < 0.06);
    assert!((cell.world.fingers.force - 50.0).abs() <= 3.0, "still held");
    let status = cell.memory.pedestal.status;
    assert!((status.grip_size - 256).abs() <= 2 && (status.grip_force - 50).abs() <= 3);
    assert_eq!(status.table_position, Some(-300));
    assert_eq!(cell.execute((PedestalVerb::Release, 450, 50, 0)), DONE);
    assert!((cell.world.fingers.opening - 4.5).abs() <= 0.02 && cell.world.fingers.force == 0.0);
}

#[test]
fn object_stays_gripped_after_every_failure() {
    for (fault, breakage) in [
        ("the table is blocked", (|c: &mut Cell| c.world.rotary.blocked = true) as fn(&mut Cell)),
        ("the table's controller is off", |c| c.world.rotary.off = true),
        ("steps are lost", |c| c.world.rotary.slip = 4),
        ("the pedestal process is restarted", |c| c.restart()),
        ("the hand process is restarted", |c| c.world.hand = Hand::default()),
        ("the table process is restarted", |c| c.world.table = Table::default()),
        ("the angle is beyond the limit", |c| c.memory.subtask.pedestal.table_angle = 9000),
        ("unknown command", |c| c.memory.subtask.pedestal.command = PedestalVerb::None),
    ] {
        for later in [0, 30] {
            let mut cell = Cell::taken();
            let force = cell.world.fingers.force;
            cell.send((PedestalVerb::Flip, 0, 0, 1835));
            cell.wait(later);
            breakage(&mut cell);
            cell.wait(2500);
            assert!(
                (cell.world.fingers.force - force).abs() <= 2.0,
                "{fault}: {} lb",
                cell.world.fingers.force
            );
            assert_ne!(cell.memory.pedestal.status.report, PedestalReport::Executing, "{fault}");
            cell.execute((PedestalVerb::Pause, 0, 50, 0));
            assert!(
                (cell.world.fingers.force - force).abs() <= 2.0,
                "{fault}: {} lb after PAUSE",
                cell.world.fingers.force
            );
        }
    }
}

/// A hand that is restarted before its fingers have opened keeps its part, and the pedestal process reports it.
#[test]
fn object_not_released_by_the_hand_is_gripped() {
    let mut kept = 0;
    for later in 0..40 {
        let mut cell = Cell::taken();
        cell.send((PedestalVerb::Release, 450, 50, 0));
        cell.wait(later);
        cell.world.hand = Hand::default();
        cell.wait(200);
        let status = cell.memory.pedestal.status;
        assert!(status.gripped || status.felt != Felt::Something, "restarted after {later} ticks");
        kept += u32::from(status.gripped && status.felt == Felt::Something);
        assert_eq!(cell.execute((PedestalVerb::Release, 450, 50, 0)), DONE, "restarted after {later} ticks");
        assert!(!cell.memory.pedestal.status.gripped);
    }
    assert!(kept > 0, "the first restarts are before the fingers move");
}

proptest! {
    /// Random commands and neighbours cause no panic. The hand is opened only for PRE-GRIP and RELEASE, and the same
    /// inputs give the same bytes.
    #[test]
    fn nonsense(
        ticks in prop::collection::vec(
            (0_u8..20, any::<i32>(), any::<i32>(), 0_u8..5, any::<bool>()),
            1..200,
        ),
    ) {
        let (mut bench, mut twin) = (Bench::new(), Bench::new());
        for (what, a, b, report, answers) in ticks {
            for bench in [&mut bench, &mut twin] {
                if let Some(verb) = PedestalVerb::from_code(what) {
                    bench.send((verb, a, b, if what % 2 == 0 { b } else { -1000 }));
                }
                match what {
                    10 => bench.process = Pedestal::default(),
                    11 => bench.memory.table.header = Header::default(),
                    12 => bench.memory.hand.status.position = a,
                    13 => bench.memory.table.status.position = (b % 7 != 0).then_some(b),
                    14 => bench.memory.hand.status.felt = Felt::from_code(report % 3).unwrap(),
                    15 => bench.memory.hand.status.initialized = answers,
                    _ => {}
                }
                if answers {
                    bench.hand(GripReport::from_code(report).unwrap(), a);
                    bench.table(PedestalReport::from_code(report).unwrap());
                }
                let sent = bench.memory.pedestal.hand.number;
                let outputs = bench.step();
                let verb = bench.memory.subtask.pedestal.command;
                if outputs.hand.number != sent && outputs.hand.command == GripVerb::OpenGrip {
                    prop_assert!(matches!(verb, PedestalVerb::PreGrip | PedestalVerb::Release));
                }
            }
            twin.restore();
            prop_assert_eq!(bench.image(), twin.image());
        }
    }
}
