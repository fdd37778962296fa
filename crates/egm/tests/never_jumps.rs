//! Each target is within the limits from the previous one, or it is the robot's own position.

use egm::{
    Host, Limits, LinkState, NotFollowing, Pose, Twist,
    host::Settings,
    message::{
        Header, MOST_BYTES, MciState, MessageType, Motion, MotorState, RapidState, Robot, Sensor, WirePose,
    },
    pose::norm,
};
use proptest::{collection::vec, prelude::*};

const LIMITS: Limits = Limits::of_speed(400.0, 1.2);
const MS: u64 = 1_000_000;
const CYCLE: u64 = 4_032_000;

#[derive(Clone, Debug)]
enum Event {
    /// `lost`: percentage of lost messages.
    Cycles {
        count: u16,
        lost: u8,
    },
    Silence(u16),     // ms without a message
    Double,           // the last message again
    Pushed([f64; 3]), // the robot is moved there
    States(u8),
    /// A path begins at the sample's start pose, or at another.
    Begin {
        misplaced: bool,
    },
    Point([f64; 3], [f64; 3]), // relative to the previous one, mm and rad
    Stop,
    Garbage(Vec<u8>), // not a message
}

fn event() -> impl Strategy<Value = Event> {
    let way = |most: f64| prop::array::uniform3(-most..most);
    prop_oneof![
        4 => (1..30_u16, 0..60_u8).prop_map(|(count, lost)| Event::Cycles { count, lost }),
        1 => (0..300_u16).prop_map(Event::Silence),
        1 => Just(Event::Double),
        1 => way(40.0).prop_map(Event::Pushed),
        1 => (0..6_u8).prop_map(Event::States),
        3 => any::<bool>().prop_map(|misplaced| Event::Begin { misplaced }),
        12 => (way(9.0), way(0.03)).prop_map(|(way, turn)| Event::Point(way, turn)),
        1 => (way(100.0), way(1.0)).prop_map(|(way, turn)| Event::Point(way, turn)),
        1 => Just(Event::Stop),
        1 => vec(any::<u8>(), 0..40).prop_map(Event::Garbage),
    ]
}

/// The robot is exactly at the target of the previous message.
struct Bench {
    host: Host,
    now: u64,
    seqno: u32,
    states: u8,
    at: Pose,
    before: Option<(u64, Pose, f64)>, // time of sending, pose, and the robot's distance from it, mm
    point: Pose,
    datagram: Vec<u8>,
    dice: u64,
}

impl Bench {
    fn new(seed: u64) -> Self {
        Self {
            host: Host::new(Settings::new(LIMITS)),
            now: 0,
            seqno: 0,
            states: 0,
            at: Pose::IDENTITY,
            before: None,
            point: Pose::IDENTITY,
            datagram: Vec::new(),
            dice: seed | 1,
        }
    }

    fn roll(&mut self) -> u64 {
        self.dice = self.dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.dice >> 33) % 100
    }

    fn message(&mut self) {
        self.seqno += 2;
        let states = match self.states {
            0..=2 => (MotorState::On, MciState::Running, RapidState::Running),
            3 => (MotorState::Off, MciState::Stopped, RapidState::Stopped),
            4 => (MotorState::On, MciState::Error, RapidState::Running),
            _ => (MotorState::On, MciState::Running, RapidState::Stopped),
        };
        let message = Robot {
            header: Some(Header::new(self.seqno, 0, MessageType::Data)),
            feedback: Some(Motion::at(WirePose::of(&self.at))),
            motor_state: Some(states.0),
            mci_state: Some(states.1),
            rapid_state: Some(states.2),
            ..Robot::default()
        };
        let mut buffer = [0; MOST_BYTES];
        self.datagram = message.encode(&mut buffer).unwrap().to_vec();
        self.receive();
    }

    fn receive(&mut self) {
        let mut buffer = [0; MOST_BYTES];
        let feedback = Robot::decode(&self.datagram).unwrap().essentials().unwrap().1;
        let Ok(Some(answer)) = self.host.receive(self.now, &self.datagram, &mut buffer) else { return };
        let answer = Sensor::decode(answer).unwrap();
        let target = answer.planned.unwrap().cartesian.unwrap().pose().unwrap();
        let speed = answer.speed_ref.unwrap().twist();
        assert!(norm(&speed.linear) <= 400.001 && norm(&speed.angular) <= 1.2001, "{speed:?}");
        let (way, turn) = target.distance(&feedback);
        let is_at_robot = way < 1e-6 && turn < 1e-6;
        if let Some((then, before, lag)) = self.before.filter(|_| !is_at_robot) {
            let seconds = (self.now - then).max(1) as f64 / 1e9;
            let (way, turn) = before.distance(&target);
            assert!(way <= 400.01 * seconds + 1e-6, "{way} mm in {seconds} s");
            assert!(turn <= 1.201 * seconds + 1e-6, "{turn} rad in {seconds} s");
            let (off, _) = target.distance(&feedback);
            let step = 400.01 * 0.0605;
            assert!(way <= step || off <= lag + step, "{way} mm after a gap, {off} mm from the robot");
        }
        if self.host.sample().link == LinkState::Running {
            self.at = target;
        } else {
            assert!(is_at_robot, "a robot that does not follow is asked to stay");
        }
        self.before = Some((self.now, target, target.distance(&feedback).0));
    }

    fn happen(&mut self, event: &Event) {
        match event {
            Event::Cycles { count, lost } => {
                for _ in 0..*count {
                    self.now += CYCLE;
                    if self.roll() >= u64::from(*lost) {
                        self.message();
                    } else {
                        self.seqno += 2;
                        self.host.poll(self.now);
                    }
                }
            }
            Event::Silence(ms) => {
                self.now += u64::from(*ms) * MS;
                self.host.poll(self.now);
            }
            Event::Double => self.receive(),
            Event::Pushed(way) => self.at = self.at.moved(&Twist { linear: *way, angular: [0.0; 3] }),
            Event::States(states) => self.states = *states,
            Event::Begin { misplaced } => {
                let start = self.host.sample().start;
                let from = start.unwrap_or(self.at);
                let from = if *misplaced {
                    from.moved(&Twist { linear: [50.0; 3], ..Default::default() })
                } else {
                    from
                };
                let begun = self.host.begin(self.now, &from);
                assert_eq!(begun.is_ok(), start.is_some() && !misplaced);
                self.point = from;
            }
            Event::Point(way, turn) => {
                // One period apart, as in a control ladder.
                for _ in 0..10 {
                    self.now += 4 * MS;
                    self.message();
                }
                let point = self.point.moved(&Twist { linear: *way, angular: *turn });
                if self.host.push(self.now, &point).is_ok() {
                    self.point = point;
                }
            }
            Event::Stop => self.host.stop(self.now),
            Event::Garbage(bytes) => {
                let before = self.host.sample();
                if self.host.receive(self.now, bytes, &mut [0; MOST_BYTES]).is_err() {
                    let after = self.host.sample();
                    assert_eq!((before.target, before.link), (after.target, after.link));
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn targets_stay_within_the_limits_for_any_events(seed in any::<u64>(), events in vec(event(), 1..80)) {
        let mut bench = Bench::new(seed);
        bench.message();
        for event in &events {
            bench.happen(event);
        }
    }
}

/// The property above also holds for a host that never moves, so this test requires motion.
#[test]
fn a_robot_that_follows_is_moved() {
    let mut bench = Bench::new(1);
    bench.message();
    bench.happen(&Event::Begin { misplaced: false });
    for _ in 0..50 {
        bench.happen(&Event::Point([8.0, 0.0, 0.0], [0.0, 0.0, 0.02]));
    }
    assert!(bench.at.position[0] > 370.0, "{:?}", bench.at);
    assert_eq!(bench.host.sample().counters.points, 50);
}

#[test]
fn an_interrupted_run_does_not_resume_by_itself() {
    let mut bench = Bench::new(1);
    bench.message();
    bench.happen(&Event::Begin { misplaced: false });
    for _ in 0..10 {
        bench.happen(&Event::Point([8.0, 0.0, 0.0], [0.0; 3]));
    }
    bench.happen(&Event::Silence(100));
    bench.message();
    let stopped = bench.at;
    bench.happen(&Event::Point([8.0, 0.0, 0.0], [0.0; 3]));
    bench.happen(&Event::Cycles { count: 60, lost: 0 });
    let sample = bench.host.sample();
    assert!(!sample.is_moving && sample.counters.interrupted == 1, "{sample:?}");
    let (way, _) = stopped.distance(&bench.at);
    assert!(way <= 200.0 * 0.05 + 0.01, "it came to rest within {way} mm");
    assert_eq!(sample.start, Some(sample.target));
}

#[test]
fn path_begins_where_the_robot_was_moved_while_stopped() {
    let mut bench = Bench::new(1);
    bench.message();
    bench.happen(&Event::Begin { misplaced: false });
    for _ in 0..10 {
        bench.happen(&Event::Point([8.0, 0.0, 0.0], [0.0; 3]));
    }
    bench.states = 3;
    bench.message();
    let sample = bench.host.sample();
    assert_eq!(sample.link, LinkState::Standby(NotFollowing::MotorsOff));
    assert_eq!((sample.start, sample.is_moving), (None, false));
    bench.happen(&Event::Pushed([0.0, 0.0, -30.0]));
    bench.states = 0;
    bench.message();
    assert_eq!(bench.host.sample().start.map(|start| start.position[2]), Some(-30.0));
}

/// 100 ms with points but without messages, at 350 mm/s; meanwhile the robot moves by `moved` mm.
fn after_a_gap(moved: f64) -> u64 {
    let mut bench = Bench::new(1);
    bench.message();
    bench.happen(&Event::Begin { misplaced: false });
    for _ in 0..10 {
        bench.happen(&Event::Point([14.0, 0.0, 0.0], [0.0; 3]));
    }
    for _ in 0..2 {
        bench.now += 40 * MS;
        bench.host.poll(bench.now);
        bench.point = bench.point.moved(&Twist { linear: [14.0, 0.0, 0.0], angular: [0.0; 3] });
        bench.host.push(bench.now, &bench.point).unwrap();
    }
    bench.now += 20 * MS;
    bench.happen(&Event::Pushed([moved, 0.0, 0.0]));
    bench.message();
    bench.host.sample().counters.interrupted
}

#[test]
fn after_a_gap_only_a_robot_that_kept_its_speed_continues() {
    assert_eq!((after_a_gap(35.0), after_a_gap(20.0)), (0, 0));
    assert_eq!((after_a_gap(0.0), after_a_gap(70.0)), (1, 1));
}
