//! Both ends of the link against each other over a line that changes, loses and delays bytes.
//!
//! Whatever one fault a tick and direction does: the robot never jumps, no command is executed twice, the controller never
//! has cause for a warning, and the link comes back by itself.

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, JointProblem, Robot, Warning, joints_for},
    host::{ANSWER_TICKS, Host, HostEvent, Intent},
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION},
};
use rcs_core::{
    frame::{Frame, Vector, rotation_by},
    interface::{device::LinkBytes, t3i::LinkFault},
    kinematics::{HOME_JOINTS, Joints, T3},
};

/// Numbers that depend on the seed alone (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn within(&mut self, most: f64) -> f64 {
        (self.next() as f64 / u64::MAX as f64 * 2.0 - 1.0) * most
    }
}

/// One direction of the line: at most one fault a tick.
#[derive(Default)]
struct Line {
    late: Vec<u8>,
    faults: usize,
}

impl Line {
    /// What arrives of `sent`; one tick in `one_in` is faulty, none if it is 0.
    fn carry(&mut self, sent: &LinkBytes, numbers: &mut Numbers, one_in: usize) -> LinkBytes {
        let mut bytes = std::mem::take(&mut self.late);
        bytes.extend(sent.as_slice());
        if one_in > 0 && !bytes.is_empty() && numbers.below(one_in) == 0 {
            self.faults += 1;
            let place = numbers.below(bytes.len());
            match numbers.below(3) {
                0 => bytes[place] ^= 1 << numbers.below(8),
                1 => drop(bytes.remove(place)),
                _ => self.late = bytes.split_off(place),
            }
        }
        let mut arrived = LinkBytes::default();
        assert_eq!(arrived.extend(&bytes), bytes.len());
        arrived
    }
}

/// A robot that is where it is told to be, and watches over every step.
struct Watched {
    joints: Joints,
    at: Plate,
    moves: usize,
}

impl Robot for Watched {
    fn present(&self) -> Plate {
        self.at
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        let way = goal.to_frame().position - self.at.to_frame().position;
        assert!(way.norm() < 0.5601, "a jump of {} in", way.norm());
        for place in 3..6 {
            let change = (i32::from(goal.words[place]) - i32::from(self.at.words[place])).rem_euclid(36_000);
            assert!(change.min(36_000 - change) <= 229, "a jump of {change} in word {place}");
        }
        self.moves += usize::from(*goal != self.at);
        self.at = *goal;
        Ok(())
    }
}

/// Both ends, the line, and what the host wants.
struct Bench {
    host: Host,
    controller: Controller,
    robot: Watched,
    there: Line,
    back: Line,
    to_host: LinkBytes,
    dtr: bool,
    position: Position,
    sent: Position,
    goal: Frame,
    number: u16,
    executed: Vec<u16>,
    numbers: Numbers,
    started: usize,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let home = T3.forward(&HOME_JOINTS);
        let at = Plate::from_tool(&home, &T3, &Plate::default()).unwrap();
        Self {
            host: Host::new(ANSWER_TICKS),
            controller: Controller::new(Limits::NBS),
            robot: Watched { joints: HOME_JOINTS, at, moves: 0 },
            there: Line::default(),
            back: Line::default(),
            to_host: LinkBytes::default(),
            dtr: false,
            position: Position::default(),
            sent: Position::default(),
            goal: home,
            number: 0,
            executed: Vec::new(),
            numbers: Numbers(seed),
            started: 0,
        }
    }

    fn new_goal(&mut self) {
        let home = T3.forward(&HOME_JOINTS);
        let shift = Vector::new(self.numbers.within(6.0), self.numbers.within(6.0), self.numbers.within(6.0));
        let turn = Vector::new(self.numbers.within(0.3), self.numbers.within(0.3), self.numbers.within(0.3));
        self.goal = Frame { position: home.position + shift, rotation: rotation_by(&turn) * home.rotation };
    }

    /// One tick of both ends; true if the goal is reached.
    fn tick(&mut self, one_in: usize, start: bool) -> bool {
        match self.host.receive(&self.to_host, self.dtr) {
            HostEvent::Acknowledged => self.position = self.sent,
            HostEvent::Started => {
                self.position = Position::reported(self.host.position(), &T3);
                self.started += 1;
            }
            HostEvent::None | HostEvent::Lost => {}
        }
        let next = step(&self.position, &self.goal, &T3, &Limits::NBS).unwrap();
        let reached = self.host.can_send() && next.reached && next.position.plate == self.position.plate;
        let number = self.number.checked_add(1).unwrap();
        let command = DataCommand { function: number.to_be_bytes(), plate: next.position.plate };
        let mut tx = LinkBytes::default();
        if self.host.transmit(&Intent::Position(command), &mut tx) {
            (self.sent, self.number) = (next.position, number);
        }
        let rx = self.there.carry(&tx, &mut self.numbers, one_in);
        let inputs = ControllerInputs { rx, cts: true, board: true, start, ..Default::default() };
        let out = self.controller.step(&inputs, &mut self.robot);
        if out.function != NO_FUNCTION {
            self.executed.push(u16::from_be_bytes(out.function));
        }
        self.to_host = self.back.carry(&out.tx, &mut self.numbers, one_in);
        self.dtr = out.dtr;
        reached
    }

    fn until_reached(&mut self, most: usize) {
        for _ in 0..most {
            if self.tick(0, false) {
                return;
            }
        }
        panic!("the goal is not reached in {most} ticks: {:?} {:?}", self.host, self.controller);
    }
}

#[test]
fn without_faults_a_command_goes_out_every_tick() {
    let mut bench = Bench::new(1);
    bench.tick(0, true);
    bench.new_goal();
    for _ in 0..100 {
        bench.tick(0, false);
    }
    let counters = bench.host.counters();
    assert_eq!((counters.frames, counters.acknowledged, counters.restarts), (100, 99, 0));
    assert_eq!(bench.executed, (1..=99).collect::<Vec<u16>>());
    assert_eq!(bench.host.fault(), LinkFault::None);
}

#[test]
fn faults_neither_jump_nor_repeat_and_the_link_comes_back() {
    for seed in 0..20 {
        let mut bench = Bench::new(seed);
        bench.tick(0, true);
        for tick in 0..5000 {
            if tick % 30 == 0 {
                bench.new_goal();
            }
            bench.tick(8, false);
            assert_eq!(bench.controller.warning(), Warning::None, "seed {seed} tick {tick}");
            assert_eq!(bench.controller.state(), ControllerState::Running, "seed {seed} tick {tick}");
        }
        assert!(
            bench.executed.windows(2).all(|pair| pair[0] < pair[1]),
            "seed {seed}: a command was executed twice"
        );
        let counters = *bench.host.counters();
        assert!(bench.there.faults > 200 && bench.back.faults > 200, "seed {seed}: hardly any faults");
        assert!(
            counters.naks > 0 && counters.retries > 0 && counters.timeouts > 0,
            "seed {seed}: {counters:?}"
        );
        assert!(bench.started > 20 && bench.robot.moves > 1000, "seed {seed}: {} moves", bench.robot.moves);
        // The line is mended: the next goal is reached, exactly.
        bench.new_goal();
        bench.until_reached(200);
        let expected = Plate::from_tool(&bench.goal, &T3, &bench.robot.at).unwrap();
        assert_eq!(bench.robot.at, expected, "seed {seed}");
    }
}

#[test]
fn the_same_seed_gives_the_same_session() {
    let session = |seed| {
        let mut bench = Bench::new(seed);
        bench.tick(0, true);
        bench.new_goal();
        for _ in 0..500 {
            bench.tick(8, false);
        }
        (bench.host, bench.controller, bench.executed)
    };
    assert_eq!(session(3), session(3));
    assert_ne!(session(3).2, session(4).2);
}
