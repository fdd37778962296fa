//! Checks with a counting allocator that handling a message does not allocate.

use egm::{
    Host, Limits, Pose,
    host::Settings,
    message::{Header, MOST_BYTES, MciState, MessageType, Motion, MotorState, RapidState, Robot, WirePose},
};
use os_io::alloc::{Counting, Section, allocations, is_installed};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn ten_thousand_messages_do_not_allocate() {
    let mut host = Host::new(Settings::new(Limits::of_speed(400.0, 1.2)));
    let (mut buffer, mut answer) = ([0; MOST_BYTES], [0; MOST_BYTES]);
    assert!(is_installed());
    let before = allocations();
    let section = Section::enter();
    let mut answered = 0;
    for cycle in 0..10_000_u32 {
        let now = u64::from(cycle) * 4_000_000;
        let message = Robot {
            header: Some(Header::new(cycle, 0, MessageType::Data)),
            feedback: Some(Motion::at(WirePose::of(&Pose::IDENTITY))),
            motor_state: Some(MotorState::On),
            mci_state: Some(MciState::Running),
            rapid_state: Some(RapidState::Running),
            ..Robot::default()
        };
        let datagram = message.encode(&mut buffer).unwrap();
        answered += u32::from(host.receive(now, datagram, &mut answer).unwrap().is_some());
        if cycle == 10 {
            host.begin(now, &Pose::IDENTITY).unwrap();
        }
        if cycle > 10 && cycle % 10 == 0 {
            let _ = host.push(now, &Pose::IDENTITY);
        }
    }
    let _ = host.receive(0, &[1, 2, 3], &mut answer);
    drop(section);
    assert_eq!((allocations() - before, answered), (0, 10_000));
}
