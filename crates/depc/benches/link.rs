//! Speed of the link: writing and reading a frame, and an exchange of both ends with and without faults.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use depc::link::LinkBytes;
use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, Refusal, Robot, joints_for},
    fault::{Direction, FaultKind, Injector, Plan, Rule},
    host::{ANSWER_TICKS, Host, Intent},
    receive::ReplyReceiver,
    wire::{DataCommand, NO_FUNCTION, Report},
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use rcs_core::tick::Tick;

const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

struct Exact {
    joints: Joints,
    at: Plate,
}

impl Robot for Exact {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        Ok(())
    }
}

fn codec(c: &mut Criterion) {
    let command = DataCommand { function: NO_FUNCTION, plate: HOME };
    let mut frame = [0; 16];
    c.bench_function("encode a data command", |b| b.iter(|| black_box(&command).emit(black_box(&mut frame))));
    c.bench_function("decode a data command", |b| b.iter(|| DataCommand::parse(black_box(&frame))));
    let mut report = [0; 16];
    Report { plate: HOME }.emit(&mut report);
    c.bench_function("receive a report byte by byte", |b| {
        let mut receiver = ReplyReceiver::default();
        b.iter(|| black_box(&report).iter().filter_map(|byte| receiver.push(*byte)).count());
    });
}

fn exchange(c: &mut Criterion) {
    let mut noisy = Plan::new(1);
    noisy.add(Rule::new(FaultKind::Flip).rate(1)).expect("the rule is sound");
    for (name, plan) in [("a whole exchange", Plan::new(1)), ("a whole exchange on a watched line", noisy)] {
        let (mut host, mut controller) = (Host::new(ANSWER_TICKS), Controller::new(Limits::NBS));
        let mut robot = Exact { joints: HOME_JOINTS, at: HOME };
        let mut line = Injector::new(&plan);
        let mut inputs = ControllerInputs { board: true, start: true, cts: true, ..Default::default() };
        let (mut rx, mut dtr, mut tick) = (LinkBytes::default(), false, Tick(0));
        let command = Intent::Position(DataCommand { function: NO_FUNCTION, plate: HOME });
        c.bench_function(name, |b| {
            b.iter(|| {
                host.receive(&rx, dtr);
                let mut tx = LinkBytes::default();
                host.transmit(black_box(&command), &mut tx);
                (inputs.rx, inputs.cts) = line.carry(Direction::ToController, tick, &tx, true);
                let out = controller.step(&inputs, &mut robot);
                inputs.start = false;
                (rx, dtr) = line.carry(Direction::ToHost, tick, &out.tx, out.dtr);
                tick = tick.next();
            });
        });
        assert!(host.counters().acknowledged > 1000);
    }
}

criterion_group!(benches, codec, exchange);
criterion_main!(benches);
