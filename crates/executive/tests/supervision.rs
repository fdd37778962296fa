//! A gateway supervises its robot: the host at the other end of the line gets no feedback.

use depc::{
    Limits, Plate,
    host::{ANSWER_TICKS, Host, Intent},
    link::LinkBytes,
    wire::{DataCommand, NO_FUNCTION},
};
use executive::egm::{Bridge, EgmOptions, Line, Placement};

const TICK: u64 = 40_000_000;

struct Gateway {
    host: Host,
    bridge: Bridge,
    line: Line,
    rx: LinkBytes,
    dtr: bool,
    x: i16,
    behind: f64, // greatest distance of the robot from its target so far, mm
}

impl Gateway {
    fn new(robot: &str, lag_ms: Option<u16>) -> Self {
        let options: EgmOptions = robot.parse().unwrap();
        let placement = Placement::default();
        let bridge = Bridge::new(Limits::NBS, placement);
        Self {
            host: Host::new(ANSWER_TICKS),
            bridge: match lag_ms {
                Some(lag_ms) => bridge.supervised(lag_ms),
                None => bridge,
            },
            line: Line::Simulated(Box::new(options.simulated(&placement))),
            rx: LinkBytes::default(),
            dtr: false,
            x: 0,
            behind: 0.0,
        }
    }

    /// One tick; the host moves its position on by `step`, 0.01 in.
    fn tick(&mut self, step: i16) {
        self.line.advance(TICK);
        self.host.receive(&self.rx, self.dtr);
        let mut tx = LinkBytes::default();
        let [x, y, z, d, e, r] = self.host.position().words;
        let plate = Plate { words: [x + step, y, z, d, e, r] };
        if self.host.can_send() {
            self.x += step;
            self.host.transmit(&Intent::Position(DataCommand { function: NO_FUNCTION, plate }), &mut tx);
        } else {
            self.host.transmit(&Intent::Idle, &mut tx);
        }
        let out = self.bridge.step(&mut self.line, &tx, true, false);
        (self.rx, self.dtr) = (out.tx, out.dtr);
        let sample = self.line.sample();
        self.behind = self.behind.max(sample.target.distance(&sample.feedback).0);
    }

    /// Runs until the robot is off its path. True if it followed for 100 ticks.
    fn follows(&mut self) -> bool {
        (0..20).for_each(|_| self.tick(0));
        (0..100).all(|_| {
            self.tick(30);
            self.bridge.trouble().is_none()
        })
    }
}

#[test]
fn a_robot_that_follows_is_not_stopped() {
    let mut gateway = Gateway::new("sim", Some(200));
    assert!(gateway.follows(), "{:?}", gateway.bridge.trouble());
    assert!(gateway.x > 2500 && gateway.behind < 5.0, "{} mm", gateway.behind);
    let mut slow = Gateway::new("sim,speed-ref=off", Some(400));
    assert!(slow.follows(), "{:?}", slow.bridge.trouble());
}

#[test]
fn a_robot_that_falls_behind_is_held_where_it_is() {
    let mut gateway = Gateway::new("sim,deviation=2", Some(200));
    assert!(!gateway.follows());
    assert!(gateway.behind < 80.0, "{} mm", gateway.behind);
    let held = gateway.line.sample().feedback;
    (0..50).for_each(|_| gateway.tick(0));
    let sample = gateway.line.sample();
    let (way, _) = held.distance(&sample.feedback);
    let (off, _) = sample.target.distance(&sample.feedback);
    assert!(way < 10.0 && off < 0.5, "it moved on by {way} mm, and is {off} mm from its target");
    // The host can begin a new path from this position.
    assert!(gateway.bridge.trouble().is_none() && gateway.host.is_running());
    let mut unsupervised = Gateway::new("sim,deviation=2", None);
    unsupervised.follows();
    assert!(unsupervised.behind > 300.0, "{} mm", unsupervised.behind);
}
