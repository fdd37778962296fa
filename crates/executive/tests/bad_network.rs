//! For every network fault, no message asks for a jump, and the robot rests at a position that the host knows.

use egm::{LinkState, Pose, Sample, Twist, pose::norm};
use executive::egm::{EgmOptions, Line, Order, Placement};
use proptest::prelude::*;

const TICK: u64 = 40_000_000;
/// Longest gap between messages, s, after which targets do not depend on the robot's position.
const GAP_S: f64 = 0.060;

/// A swinging motion of the tool: amplitudes in mm and rad, angular frequency in 1/s.
#[derive(Clone, Copy, Debug)]
struct Swing {
    linear: [f64; 3],
    angular: [f64; 3],
    rate: f64,
}

const WIDE: Swing = Swing { linear: [40.0, 0.0, 20.0], angular: [0.0, 0.1, 0.0], rate: 3.0 };

impl Swing {
    /// Pose after `seconds`; at rest at 0 s.
    fn at(&self, start: &Pose, seconds: f64) -> Pose {
        let part = 1.0 - (self.rate * seconds).cos();
        start.moved(&Twist { linear: self.linear, angular: self.angular }.scaled(part))
    }
}

struct Bench {
    line: Line,
    placement: Placement,
    swing: Swing,
    path: Option<(Pose, u32)>, // start of the path, and the number of its points
    begun: u32,
    last: Option<Sample>,
    travelled: f64,
    messages: u32,
}

impl Bench {
    fn new(network: &str, swing: Swing) -> Self {
        let options: EgmOptions = format!("sim{network}").parse().unwrap();
        let placement = Placement::default();
        let line = Line::Simulated(Box::new(options.simulated(&placement)));
        Self { line, placement, swing, path: None, begun: 0, last: None, travelled: 0.0, messages: 0 }
    }

    fn command(&mut self) {
        let (at, sample) = (self.line.now(), self.line.sample());
        let order = match (&mut self.path, sample.start) {
            (Some((from, points)), _) if sample.is_moving => {
                *points += 1;
                Order::Point { at, to: self.swing.at(from, f64::from(*points) * 0.04) }
            }
            (path, Some(from)) if sample.link == LinkState::Running => {
                *path = Some((from, 0));
                self.begun += 1;
                Order::Begin { at, from }
            }
            _ => return,
        };
        self.line.order(&order);
    }

    fn tick(&mut self) {
        self.line.advance(TICK);
        let limits = self.placement.limits();
        let (last, travelled, messages) = (&mut self.last, &mut self.travelled, &mut self.messages);
        self.line.reports(|report| {
            let now = report.sample;
            *messages += 1;
            assert_eq!(now.counters.beyond, 0);
            assert!(norm(&now.speed.linear) <= limits.speed && norm(&now.speed.angular) <= limits.turn);
            let Some(before) = last.replace(now) else { return };
            let seconds = (now.heard - before.heard) as f64 / 1e9;
            let (way, turn) = before.target.distance(&now.target);
            *travelled += way;
            let (off, twisted) = now.target.distance(&now.feedback);
            if off < 1e-6 && twisted < 1e-6 {
                // The target is the robot's own position.
                return;
            }
            assert!(way <= limits.speed * seconds + 1e-6, "{way} mm in {seconds} s");
            assert!(turn <= limits.turn * seconds + 1e-6, "{turn} rad in {seconds} s");
            let (lag, behind) = before.target.distance(&before.feedback);
            let (step, twist) = (limits.speed * GAP_S + 1e-6, limits.turn * GAP_S + 1e-6);
            assert!(way <= step || off <= lag + step, "{way} mm, {off} mm from the robot, {lag} mm before");
            assert!(turn <= twist || twisted <= behind + twist, "{turn} rad, {twisted} rad from the robot");
        });
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.command();
            self.tick();
        }
    }
}

fn swing() -> impl Strategy<Value = Swing> {
    let to = |most: f64| prop::array::uniform3(-most..most);
    (to(40.0), to(0.1), 0.5..3.5_f64).prop_map(|(linear, angular, rate)| Swing { linear, angular, rate })
}

prop_compose! {
    fn network()(
        [loss, double, reorder, jitter] in prop::array::uniform4(0..=20_u32),
        delay in 0..=5_u32,
        silence in prop::option::of((1.0..3.0_f64, 0.1..5.0_f64)),
        [patient, speed_ref] in any::<[bool; 2]>(),
        seed in any::<u32>(),
    ) -> String {
        let silence = silence.map(|(at, during)| format!(",silent-at={at},silent-for={during}")).unwrap_or_default();
        format!(
            ",loss={loss},double={double},reorder={reorder},jitter={jitter},delay={delay},seed={seed},timeout={},\
             speed-ref={}{silence}",
            if patient { 10 } else { 1 },
            if speed_ref { "on" } else { "off" },
        )
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn network_faults_cause_no_jump(network in network(), swing in swing()) {
        let mut bench = Bench::new(&network, swing);
        // Longer than the longest silence and the path that follows it.
        bench.run(250);
        // Without further orders, the robot comes to rest where the host says.
        for _ in 0..100 {
            bench.tick();
        }
        let sample = bench.line.sample();
        prop_assert!(!sample.is_moving && bench.messages > 500);
        match sample.link {
            LinkState::Running => {
                let start = sample.start.expect("a place where a path can begin");
                let (off, turned) = start.distance(&sample.feedback);
                prop_assert!(off < 0.5 && turned < 0.005, "{off} mm, {turned} rad");
            }
            // The robot has timed out and reports it.
            LinkState::Standby(_) => prop_assert!(network.contains("silent") && network.contains("timeout=1,")),
            other => prop_assert!(false, "{other:?}"),
        }
    }
}

/// The property above also holds for a host that never moves or is always interrupted, so this test requires motion.
#[test]
fn a_good_network_causes_no_interruption() {
    let mut bench = Bench::new("", WIDE);
    bench.run(250);
    assert!(bench.travelled > 500.0 && bench.begun == 1, "{} mm, {} times", bench.travelled, bench.begun);
    assert_eq!(bench.line.sample().counters.interrupted, 0);
}

/// After a silence shorter than 3 ticks the path continues, because the robot kept its speed.
#[test]
fn a_short_silence_interrupts_nothing() {
    for at in ["2.0", "2.1", "2.3", "2.5", "2.7"] {
        let mut bench = Bench::new(&format!(",silent-at={at},silent-for=0.1"), WIDE);
        bench.run(250);
        assert_eq!((bench.begun, bench.line.sample().counters.interrupted), (1, 0), "{at}");
    }
}

/// A longer silence ends the path; when messages arrive again, a new path begins at the robot's position.
#[test]
fn path_after_a_long_silence_begins_at_the_robot() {
    for during in ["0.15", "0.5", "2", "5"] {
        let mut bench = Bench::new(&format!(",silent-at=2.0,silent-for={during},timeout=10"), WIDE);
        bench.run(250);
        assert_eq!((bench.begun, bench.line.sample().counters.interrupted), (2, 1), "{during}");
    }
}
