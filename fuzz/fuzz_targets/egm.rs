//! The messages of EGM and the host: any bytes as datagrams, one after the other.

#![no_main]

use egm::{
    Host, Limits,
    host::Settings,
    message::{MOST_BYTES, Robot, Sensor},
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut host = Host::new(Settings::new(Limits::of_speed(400.0, 1.2)));
    let (mut rest, mut now) = (data, 0);
    while let [length, tail @ ..] = rest {
        let (datagram, later) = tail.split_at(tail.len().min(usize::from(*length)));
        rest = later;
        now += 4_000_000;
        let mut buffer = [0; MOST_BYTES];
        if let Ok(message) = Robot::decode(datagram) {
            let written = message.encode(&mut buffer).expect("a message that was read fits").to_vec();
            let again = Robot::decode(&written).expect("what was written is read");
            // Numbers that are none are not equal to themselves; their bytes are.
            let mut second = [0; MOST_BYTES];
            assert_eq!(again.encode(&mut second).expect("it fits again"), written);
        }
        if let Ok(message) = Sensor::decode(datagram) {
            let written = message.encode(&mut buffer).expect("a message that was read fits").to_vec();
            assert!(Sensor::decode(&written).is_ok());
        }
        if let Ok(Some(answer)) = host.receive(now, datagram, &mut buffer) {
            let answer = Sensor::decode(answer).expect("the host writes messages");
            let pose = answer.planned.and_then(|planned| planned.cartesian).expect("with a pose");
            let start = pose.pose().expect("of finite numbers");
            let _ = host.begin(now, &start);
            let _ = host.push(now + 40_000_000, &start);
        }
    }
});
