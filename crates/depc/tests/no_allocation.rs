//! Ends, line and faults do not allocate. One test only, as every test in this file would use the counting allocator.

use depc::link::LinkBytes;
use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, Refusal, Robot, joints_for},
    fault::{Direction, FaultKind, Injector, Plan, Rule},
    host::{ANSWER_TICKS, Host, HostEvent, Intent},
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION},
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use os_io::alloc::{Counting, Section, allocations, is_installed};
use rcs_core::tick::Tick;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

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

#[test]
fn link_does_not_allocate() {
    let home = T3.forward(&HOME_JOINTS);
    let at = Plate::from_tool(&home, &T3, &Plate::default()).unwrap();
    let mut plan = Plan::new(1);
    for kind in FaultKind::ALL {
        plan.add(Rule::new(*kind).rate(2_000)).unwrap();
    }
    let (mut host, mut controller) = (Host::new(ANSWER_TICKS), Controller::new(Limits::NBS));
    let mut robot = Exact { joints: HOME_JOINTS, at };
    let mut line = Injector::new(&plan);
    let (mut rx, mut dtr) = (LinkBytes::default(), false);
    let mut position = Position::reported(at, &T3);
    let mut goal = home;
    assert!(is_installed());
    let before = allocations();
    let section = Section::enter();
    for tick in 0..20_000_u32 {
        if host.receive(&rx, dtr) == HostEvent::Started {
            position = Position::reported(host.position(), &T3);
        }
        goal.position.x = home.position.x + if tick % 80 < 40 { 5.0 } else { -5.0 };
        position = step(&position, &goal, &T3, &Limits::NBS).unwrap().position;
        let command = DataCommand { function: NO_FUNCTION, plate: position.plate };
        let mut tx = LinkBytes::default();
        host.transmit(&Intent::Position(command), &mut tx);
        let now = Tick(u64::from(tick));
        let (to_controller, cts) = line.carry(Direction::ToController, now, &tx, true);
        let answer = tick % 50 == 0;
        let inputs = ControllerInputs {
            rx: to_controller,
            cts,
            board: true,
            start: answer,
            enter: answer,
            ..Default::default()
        };
        let out = controller.step(&inputs, &mut robot);
        (rx, dtr) = line.carry(Direction::ToHost, now, &out.tx, out.dtr);
    }
    drop(section);
    assert_eq!(allocations(), before);
    let (counters, counts) = (host.counters(), line.total());
    assert!(counters.acknowledged > 2_000 && counters.restarts > 20, "{counters:?}");
    assert!(FaultKind::ALL.iter().all(|kind| counts.of(*kind) > 10), "{counts:?}");
}
