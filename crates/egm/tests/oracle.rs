//! Compares the codec with `prost` for the same schema.

use egm::{
    Error,
    message::{
        Cartesian, Clock, Euler, Header, MOST_BYTES, MciState, MessageType, Motion, MotorState, Orientation,
        RapidState, Robot, Sensor, SpeedRef, Timestamp, Values, WirePose,
    },
};
use proptest::{collection::vec, option, prelude::*};
use prost::Message;

mod proto {
    use prost::Message;

    #[derive(Clone, PartialEq, Message)]
    pub struct Header {
        #[prost(uint32, optional, tag = "1")]
        pub seqno: Option<u32>,
        #[prost(uint32, optional, tag = "2")]
        pub tm: Option<u32>,
        #[prost(int32, optional, tag = "3")]
        pub mtype: Option<i32>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Cartesian {
        #[prost(double, required, tag = "1")]
        pub x: f64,
        #[prost(double, required, tag = "2")]
        pub y: f64,
        #[prost(double, required, tag = "3")]
        pub z: f64,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Quaternion {
        #[prost(double, required, tag = "1")]
        pub u0: f64,
        #[prost(double, required, tag = "2")]
        pub u1: f64,
        #[prost(double, required, tag = "3")]
        pub u2: f64,
        #[prost(double, required, tag = "4")]
        pub u3: f64,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Clock {
        #[prost(uint64, required, tag = "1")]
        pub sec: u64,
        #[prost(uint64, required, tag = "2")]
        pub usec: u64,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Timestamp {
        #[prost(uint64, optional, tag = "1")]
        pub sec: Option<u64>,
        #[prost(uint64, optional, tag = "2")]
        pub nsec: Option<u64>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Pose {
        #[prost(message, optional, tag = "1")]
        pub pos: Option<Cartesian>,
        #[prost(message, optional, tag = "2")]
        pub orient: Option<Quaternion>,
        #[prost(message, optional, tag = "3")]
        pub euler: Option<Cartesian>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Doubles {
        #[prost(double, repeated, packed = "false", tag = "1")]
        pub values: Vec<f64>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Packed {
        #[prost(double, repeated, packed = "true", tag = "1")]
        pub values: Vec<f64>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Motion {
        #[prost(message, optional, tag = "1")]
        pub joints: Option<Doubles>,
        #[prost(message, optional, tag = "2")]
        pub cartesian: Option<Pose>,
        #[prost(message, optional, tag = "3")]
        pub external: Option<Doubles>,
        #[prost(message, optional, tag = "4")]
        pub time: Option<Clock>,
        #[prost(message, optional, tag = "5")]
        pub timestamp: Option<Timestamp>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct PackedMotion {
        #[prost(message, optional, tag = "1")]
        pub joints: Option<Packed>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct State {
        #[prost(int32, required, tag = "1")]
        pub state: i32,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Force {
        #[prost(bool, optional, tag = "1")]
        pub active: Option<bool>,
        #[prost(double, repeated, packed = "false", tag = "2")]
        pub force: Vec<f64>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Robot {
        #[prost(message, optional, tag = "1")]
        pub header: Option<Header>,
        #[prost(message, optional, tag = "2")]
        pub feedback: Option<Motion>,
        #[prost(message, optional, tag = "3")]
        pub planned: Option<Motion>,
        #[prost(message, optional, tag = "4")]
        pub motor_state: Option<State>,
        #[prost(message, optional, tag = "5")]
        pub mci_state: Option<State>,
        #[prost(bool, optional, tag = "6")]
        pub convergence_met: Option<bool>,
        #[prost(message, optional, tag = "7")]
        pub test_signals: Option<Doubles>,
        #[prost(message, optional, tag = "8")]
        pub rapid_state: Option<State>,
        #[prost(message, optional, tag = "9")]
        pub force: Option<Force>,
        #[prost(double, optional, tag = "10")]
        pub utilization_rate: Option<f64>,
        #[prost(uint32, optional, tag = "11")]
        pub move_index: Option<u32>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct PackedRobot {
        #[prost(message, optional, tag = "2")]
        pub feedback: Option<PackedMotion>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct SpeedRef {
        #[prost(message, optional, tag = "1")]
        pub joints: Option<Doubles>,
        #[prost(message, optional, tag = "2")]
        pub cartesians: Option<Doubles>,
        #[prost(message, optional, tag = "3")]
        pub external: Option<Doubles>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub struct Sensor {
        #[prost(message, optional, tag = "1")]
        pub header: Option<Header>,
        #[prost(message, optional, tag = "2")]
        pub planned: Option<Motion>,
        #[prost(message, optional, tag = "3")]
        pub speed_ref: Option<SpeedRef>,
    }
}

/// Converts messages to those of `prost`.
mod same {
    use super::*;

    pub fn header(header: &Header) -> proto::Header {
        let mtype = header.mtype.map(|mtype| i32::try_from(mtype.code()).unwrap());
        proto::Header { seqno: header.seqno, tm: header.tm, mtype }
    }

    pub fn doubles(values: &Values) -> proto::Doubles {
        proto::Doubles { values: values.as_slice().to_vec() }
    }

    fn cartesian(numbers: &Cartesian) -> proto::Cartesian {
        let [x, y, z] = numbers.values();
        proto::Cartesian { x, y, z }
    }

    pub fn motion(motion: &Motion) -> proto::Motion {
        proto::Motion {
            joints: motion.joints.as_ref().map(doubles),
            cartesian: motion.cartesian.map(|pose| proto::Pose {
                pos: pose.pos.as_ref().map(cartesian),
                orient: pose.orient.map(|orient| {
                    let [u0, u1, u2, u3] = orient.values();
                    proto::Quaternion { u0, u1, u2, u3 }
                }),
                euler: pose.euler.as_ref().map(cartesian),
            }),
            external: motion.external.as_ref().map(doubles),
            time: motion.time.map(|time| proto::Clock { sec: time.sec.unwrap(), usec: time.usec.unwrap() }),
            timestamp: motion.timestamp.map(|time| proto::Timestamp { sec: time.sec, nsec: time.nsec }),
        }
    }

    pub fn robot(robot: &Robot) -> proto::Robot {
        let motor = robot.motor_state.map(|state| match state {
            MotorState::Undefined => 0,
            MotorState::On => 1,
            MotorState::Off => 2,
        });
        let mci = robot.mci_state.map(|state| match state {
            MciState::Undefined => 0,
            MciState::Error => 1,
            MciState::Stopped => 2,
            MciState::Running => 3,
        });
        let rapid = robot.rapid_state.map(|state| match state {
            RapidState::Undefined => 0,
            RapidState::Stopped => 1,
            RapidState::Running => 2,
        });
        let state = |code: Option<i32>| code.map(|state| proto::State { state });
        proto::Robot {
            header: robot.header.as_ref().map(header),
            feedback: robot.feedback.as_ref().map(motion),
            planned: robot.planned.as_ref().map(motion),
            motor_state: state(motor),
            mci_state: state(mci),
            convergence_met: robot.mci_convergence_met,
            test_signals: robot.test_signals.as_ref().map(doubles),
            rapid_state: state(rapid),
            force: robot
                .measured_force
                .map(|force| proto::Force { active: robot.force_active, force: force.as_slice().to_vec() }),
            utilization_rate: robot.utilization_rate,
            move_index: robot.move_index,
        }
    }

    pub fn sensor(sensor: &Sensor) -> proto::Sensor {
        proto::Sensor {
            header: sensor.header.as_ref().map(header),
            planned: sensor.planned.as_ref().map(motion),
            speed_ref: sensor.speed_ref.map(|speed| proto::SpeedRef {
                joints: speed.joints.as_ref().map(doubles),
                cartesians: speed.cartesians.as_ref().map(doubles),
                external: speed.external.as_ref().map(doubles),
            }),
        }
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e6..1e6_f64, Just(0.0), Just(f64::MAX), Just(f64::NEG_INFINITY)]
}

fn values() -> impl Strategy<Value = Values> {
    vec(number(), 0..=16).prop_map(|values| Values::of(&values))
}

fn header() -> impl Strategy<Value = Header> {
    let mtype = prop_oneof![
        Just(MessageType::Undefined),
        Just(MessageType::Command),
        Just(MessageType::Data),
        Just(MessageType::Correction),
        Just(MessageType::PathCorrection),
    ];
    (option::of(any::<u32>()), option::of(any::<u32>()), option::of(mtype))
        .prop_map(|(seqno, tm, mtype)| Header { seqno, tm, mtype })
}

fn motion() -> impl Strategy<Value = Motion> {
    let three = || option::of([number(), number(), number()]);
    let pose = (three(), option::of([number(), number(), number(), number()]), three()).prop_map(
        |(pos, orient, euler)| WirePose {
            pos: pos.map(Cartesian::new),
            orient: orient.map(Orientation::new),
            euler: euler.map(Euler::new),
        },
    );
    let clock = any::<(u64, u64)>().prop_map(|(sec, usec)| Clock { sec: Some(sec), usec: Some(usec) });
    let timestamp = any::<(Option<u64>, Option<u64>)>().prop_map(|(sec, nsec)| Timestamp { sec, nsec });
    (option::of(values()), option::of(pose), option::of(values()), option::of(clock), option::of(timestamp))
        .prop_map(|(joints, cartesian, external, time, timestamp)| Motion {
            joints,
            cartesian,
            external,
            time,
            timestamp,
        })
}

fn robot() -> impl Strategy<Value = Robot> {
    let motor = prop_oneof![Just(MotorState::Undefined), Just(MotorState::On), Just(MotorState::Off)];
    let mci = prop_oneof![Just(MciState::Error), Just(MciState::Stopped), Just(MciState::Running)];
    let rapid = prop_oneof![Just(RapidState::Stopped), Just(RapidState::Running)];
    let force = option::of((any::<Option<bool>>(), values()));
    let states = (option::of(motor), option::of(mci), option::of(rapid));
    let rest =
        (any::<Option<bool>>(), option::of(values()), force, option::of(number()), any::<Option<u32>>());
    (option::of(header()), option::of(motion()), option::of(motion()), states, rest).prop_map(
        |(header, feedback, planned, states, rest)| {
            let (met, test_signals, force, utilization_rate, move_index) = rest;
            Robot {
                header,
                feedback,
                planned,
                motor_state: states.0,
                mci_state: states.1,
                mci_convergence_met: met,
                test_signals,
                rapid_state: states.2,
                force_active: force.and_then(|(active, _)| active),
                measured_force: force.map(|(_, values)| values),
                utilization_rate,
                move_index,
            }
        },
    )
}

fn sensor() -> impl Strategy<Value = Sensor> {
    let speed = (option::of(values()), option::of(values()), option::of(values()))
        .prop_map(|(joints, cartesians, external)| SpeedRef { joints, cartesians, external });
    (option::of(header()), option::of(motion()), option::of(speed))
        .prop_map(|(header, planned, speed_ref)| Sensor { header, planned, speed_ref })
}

proptest! {
    #[test]
    fn encoded_messages_equal_those_of_the_oracle(message in robot(), answer in sensor()) {
        let mut buffer = [0xA5; MOST_BYTES];
        let oracle = same::robot(&message).encode_to_vec();
        prop_assert_eq!(message.encode(&mut buffer), Ok(oracle.as_slice()));
        prop_assert_eq!(Robot::decode(&oracle), Ok(message));
        let oracle = same::sensor(&answer).encode_to_vec();
        prop_assert_eq!(answer.encode(&mut buffer), Ok(oracle.as_slice()));
        prop_assert_eq!(Sensor::decode(&oracle), Ok(answer));
    }

    /// Bytes flipped, cut and joined: `prost` accepts what this crate accepts, with the same values.
    #[test]
    fn accepted_messages_decode_as_in_the_oracle(
        first in robot(),
        second in robot(),
        cut in any::<prop::sample::Index>(),
        flips in vec((any::<prop::sample::Index>(), any::<u8>()), 0..3),
    ) {
        let mut bytes = same::robot(&first).encode_to_vec();
        bytes.truncate(cut.index(bytes.len() + 1));
        bytes.extend(same::robot(&second).encode_to_vec());
        for (at, byte) in flips {
            if !bytes.is_empty() {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
        }
        if let Ok(ours) = Robot::decode(&bytes) {
            let theirs = proto::Robot::decode(bytes.as_slice());
            prop_assert!(theirs.is_ok(), "{theirs:?}");
            let theirs = theirs.unwrap();
            let ours = same::robot(&ours);
            let bits = |motion: &Option<proto::Motion>| format!("{motion:?}");
            prop_assert_eq!(bits(&ours.feedback), bits(&theirs.feedback));
            prop_assert_eq!(bits(&ours.planned), bits(&theirs.planned));
            prop_assert_eq!(ours.header.map(|h| (h.seqno, h.tm)), theirs.header.map(|h| (h.seqno, h.tm)));
            prop_assert_eq!(ours.move_index, theirs.move_index);
        }
    }

    #[test]
    fn packed_values_are_read_too(values in vec(number(), 0..=16)) {
        let joints = Some(proto::Packed { values: values.clone() });
        let feedback = Some(proto::PackedMotion { joints });
        let bytes = proto::PackedRobot { feedback }.encode_to_vec();
        let read = Robot::decode(&bytes).unwrap().feedback.unwrap().joints.unwrap();
        prop_assert_eq!(read.as_slice(), values);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in vec(any::<u8>(), 0..200)) {
        if Robot::decode(&bytes).is_ok() {
            prop_assert!(proto::Robot::decode(bytes.as_slice()).is_ok());
        }
        if Sensor::decode(&bytes).is_ok() {
            prop_assert!(proto::Sensor::decode(bytes.as_slice()).is_ok());
        }
    }
}

#[test]
fn a_target_is_these_bytes() {
    let pose = egm::Pose { position: [1.0, 2.0, -2.0], ..egm::Pose::IDENTITY };
    let mut buffer = [0xA5; MOST_BYTES];
    let bytes = Sensor::target(300, 8, &pose, None).encode(&mut buffer).unwrap();
    let mut expected = vec![0x0A, 7, 0x08, 0xAC, 0x02, 0x10, 8, 0x18, 3];
    expected.extend([0x12, 69, 0x12, 67, 0x0A, 27]);
    for (key, value) in [(0x09, 1.0_f64), (0x11, 2.0), (0x19, -2.0)] {
        expected.push(key);
        expected.extend(value.to_le_bytes());
    }
    expected.extend([0x12, 36]);
    for (key, value) in [(0x09, 1.0_f64), (0x11, 0.0), (0x19, 0.0), (0x21, 0.0)] {
        expected.push(key);
        expected.extend(value.to_le_bytes());
    }
    assert_eq!(bytes, expected);
}

#[test]
fn required_fields_are_required() {
    // `prost` replaces missing numbers by zeros: a position without z would be at z = 0.
    for (bytes, field) in [
        (&[0x12, 0x04, 0x12, 0x02, 0x0A, 0x00][..], "pos.x, y, z"),
        (&[0x12, 0x04, 0x12, 0x02, 0x12, 0x00], "orient.u0 to u3"),
        (&[0x1A, 0x04, 0x12, 0x02, 0x1A, 0x00], "euler.x, y, z"),
        (&[0x12, 0x04, 0x22, 0x02, 0x08, 0x01], "time.sec, usec"),
        (&[0x22, 0x00], "motorState.state"),
        (&[0x2A, 0x00], "mciState.state"),
        (&[0x42, 0x00], "rapidExecState.state"),
    ] {
        assert_eq!(Robot::decode(bytes), Err(Error::Missing { field }), "{bytes:02X?}");
        assert!(proto::Robot::decode(bytes).is_ok());
    }
    let essentials = |bytes: &[u8]| Robot::decode(bytes).and_then(|message| message.essentials());
    assert_eq!(essentials(&[]), Err(Error::Missing { field: "header" }));
    assert_eq!(essentials(&[0x0A, 0]), Err(Error::Missing { field: "header.seqno" }));
    assert_eq!(essentials(&[0x0A, 4, 8, 1, 24, 3]), Err(Error::BadType { expected: 2, found: 3 }));
    assert_eq!(essentials(&[0x0A, 4, 8, 1, 24, 2]), Err(Error::Missing { field: "feedBack" }));
    let no_pose = [0x0A, 4, 8, 1, 24, 2, 0x12, 0];
    assert_eq!(essentials(&no_pose), Err(Error::Missing { field: "feedBack.cartesian" }));
}

#[test]
fn too_many_values_are_refused_and_not_cut_off() {
    let feedback =
        proto::Motion { joints: Some(proto::Doubles { values: vec![1.0; 17] }), ..Default::default() };
    let bytes = proto::Robot { feedback: Some(feedback), ..Default::default() }.encode_to_vec();
    assert_eq!(Robot::decode(&bytes), Err(Error::TooMany { most: 16 }));
}

#[test]
fn the_longest_message_fits() {
    let full = Values::of(&[f64::MIN; 16]);
    let motion = Motion {
        joints: Some(full),
        cartesian: Some(WirePose {
            pos: Some(Cartesian::new([1.0; 3])),
            orient: Some(Orientation::new([1.0; 4])),
            euler: Some(Euler::new([1.0; 3])),
        }),
        external: Some(full),
        time: Some(Clock { sec: Some(u64::MAX), usec: Some(u64::MAX) }),
        timestamp: Some(Timestamp { sec: Some(u64::MAX), nsec: Some(u64::MAX) }),
    };
    let message = Robot {
        header: Some(Header::new(u32::MAX, u32::MAX, MessageType::Data)),
        feedback: Some(motion),
        planned: Some(motion),
        motor_state: Some(MotorState::On),
        mci_state: Some(MciState::Running),
        mci_convergence_met: Some(true),
        test_signals: Some(full),
        rapid_state: Some(RapidState::Running),
        force_active: Some(true),
        measured_force: Some(full),
        utilization_rate: Some(1.0),
        move_index: Some(u32::MAX),
    };
    assert!(message.encode(&mut [0; MOST_BYTES]).is_ok());
    assert_eq!(message.encode(&mut [0; 100]), Err(Error::NoRoom));
}
