use nalgebra::Rotation3;

mod follow;

use depc::{
    Plate,
    controller::{ControllerState, Warning},
    step::Position,
    wire::DataCommand,
};
use geometry::{
    frame::{Frame, Vector},
    kinematics::{HOME_JOINTS, T3},
    pose::WireFrame,
};
use interfaces::{
    CommonMemory, Decided, ExternalInputs, T3iOutputs,
    device::LinkBytes,
    t3i::{LinkFault, ReportCheck, T3iCommand, T3iReport, T3iVerb},
};
use rcs_core::tick::Tick;

use super::{T3i, tables};
use crate::{
    bench::{self, Tested, World},
    coverage::silent,
    environment::line::{Line, counts},
};

/// T3I, the line and the controller; the test acts as Prim.
type Bench = bench::Bench<T3i, Below>;

/// The line, and whether Prim is stepped in the next ticks.
#[derive(Clone)]
struct Below {
    line: Line,
    prim_runs: bool,
}

impl World<T3i> for Below {
    fn sense(&mut self, tick: Tick, memory: &mut CommonMemory, _: &mut ExternalInputs) {
        if self.prim_runs {
            memory.prim.header.stamp = tick.previous();
        }
    }

    fn act(&mut self, _: Tick, _: &CommonMemory, after: &mut CommonMemory, external: &mut ExternalInputs) {
        self.line.step(&after.t3i.link_tx, &mut external.devices);
    }
}

impl Tested<()> for T3i {
    type Order = T3iCommand;
    type End = T3iReport;
    const LONGEST: u64 = 2000;

    fn order(memory: &mut CommonMemory, order: T3iCommand, number: u32) {
        memory.prim.t3i = T3iCommand { number, ..order };
    }

    fn end(outputs: &T3iOutputs) -> Option<T3iReport> {
        Some(outputs.status.report).filter(|report| *report != T3iReport::Executing)
    }
}

fn home() -> Frame {
    T3.forward(&HOME_JOINTS)
}

impl Bench {
    fn new() -> Self {
        let mut external = ExternalInputs::default();
        let line = Line::new(&mut external.devices);
        Self { external, ..Self::before(Below { line, prim_runs: true }) }
    }

    fn running() -> Self {
        let mut bench = Self::new();
        bench.step();
        bench.command(T3iVerb::Restart);
        bench.wait(4);
        assert_eq!(bench.report(), T3iReport::Finished);
        bench
    }

    /// Prim writes a command; T3I reads it in the next tick.
    fn command(&mut self, command: T3iVerb) {
        self.send(T3iCommand { command, cycle: self.tick, ..self.memory.prim.t3i });
    }

    fn point(&mut self, frame: &Frame) {
        self.memory.prim.t3i.frame = WireFrame::from_frame(frame);
        self.command(T3iVerb::Point);
    }

    fn report(&self) -> T3iReport {
        self.memory.t3i.status.report
    }

    fn fault(&self) -> LinkFault {
        self.memory.t3i.status.fault
    }

    fn row(&self) -> (&'static str, u8) {
        let Decided { table, row } = self.memory.t3i.header.decided.unwrap();
        (tables::TABLES[usize::from(table) - 1].name, row)
    }

    /// Asserts that this row reports an invalid command.
    fn assert_refused_by(&self, table: &'static str, row: u8) {
        let refused = (T3iReport::Error, LinkFault::InvalidCommand, (table, row));
        assert_eq!((self.report(), self.fault(), self.row()), refused);
    }

    fn sent(&self) -> Option<Plate> {
        DataCommand::parse(self.memory.t3i.link_tx.as_slice()).ok().map(|command| command.plate)
    }

    fn at(&self) -> Plate {
        self.world.line.robot.at
    }

    fn robot_tool(&self) -> Frame {
        self.at().to_tool(&T3)
    }

    /// The line drops everything, including bytes in transit.
    fn cut(&mut self) {
        self.world.line.connected = false;
        self.external.devices.link_rx = LinkBytes::default();
    }
}

fn beside(x: f64) -> Frame {
    let mut frame = home();
    frame.position.x += x;
    frame
}

#[test]
fn restart_starts_the_link_and_holds_the_reported_position() {
    let mut bench = Bench::new();
    bench.step();
    bench.command(T3iVerb::Restart);
    let out = bench.step();
    assert_eq!((out.link_tx.as_slice(), out.status.report), (&[0x05][..], T3iReport::Executing));
    let out = bench.step();
    assert_eq!((out.status.report, out.status.echo, out.status.link_running), (T3iReport::Finished, 1, true));
    assert_eq!(bench.sent(), Some(bench.at()));
    for _ in 0..10 {
        bench.step();
        assert_eq!((bench.sent(), bench.row()), (Some(bench.at()), ("RESTART", 4)));
    }
}

#[test]
fn one_point_per_tick_is_sustained() {
    let mut bench = Bench::running();
    let mut reports = Vec::new();
    for n in 1..=50 {
        bench.point(&beside(0.1 * f64::from(n)));
        bench.step();
        reports.push(bench.report());
        // A point is read and sent in the tick after it was written, and the cell executes it before the next tick.
        assert!((bench.robot_tool().position.x - 0.1 * f64::from(n)).abs() < 0.01, "point {n}");
        assert_eq!(bench.row(), ("POINT", 8));
    }
    assert!(reports.iter().all(|report| *report == T3iReport::Ready));
    bench.step();
    assert_eq!(bench.report(), T3iReport::Finished);
    assert_eq!(bench.memory.t3i.status.counters.limited, 0);
}

#[test]
fn point_beyond_the_limits_is_approached_in_a_straight_line() {
    let mut bench = Bench::running();
    let mut goal = home();
    goal.position += Vector::new(3.0, 4.0, 0.0);
    bench.point(&goal);
    let mut ticks = 0;
    loop {
        bench.step();
        let moved = bench.robot_tool().position - home().position;
        assert!((moved.x / 3.0 - moved.y / 4.0).abs() < 0.006 && moved.z.abs() < 0.006, "{moved:?}");
        let feedback = bench.memory.t3i.status.frame_feedback;
        assert_eq!(feedback, WireFrame::from_frame(&bench.robot_tool()));
        if bench.report() == T3iReport::Finished {
            break;
        }
        ticks += 1;
        assert_eq!(bench.report(), T3iReport::Ready);
    }
    // 5 in at 0.56 in per tick.
    assert_eq!(ticks, 9);
    assert_eq!(bench.memory.t3i.status.counters.limited, 8);
    assert_eq!(bench.memory.t3i.status.frame_feedback.tool, WireFrame::from_frame(&goal).tool);
}

#[test]
fn full_queue_makes_prim_wait_and_never_overflows() {
    let mut bench = Bench::running();
    let mut x = 0.0;
    let mut waited = 0;
    // Prim answers each report one tick later; 0.9 in per point is more than the line can do.
    for _ in 0..200 {
        let report = bench.report();
        bench.step();
        if matches!(report, T3iReport::Ready | T3iReport::Finished) {
            x += 0.9_f64.min(20.0 - x);
            bench.point(&beside(x));
        } else {
            waited += 1;
        }
        assert_ne!(bench.report(), T3iReport::Error);
    }
    assert!(waited > 10);
    assert!((bench.robot_tool().position.x - 20.0).abs() < 0.01);
}

#[test]
fn gap_in_the_numbers_is_invalid_until_pause() {
    let mut bench = Bench::running();
    bench.point(&beside(0.1));
    bench.step();
    bench.memory.prim.t3i.number += 1;
    bench.point(&beside(0.3));
    bench.step();
    bench.assert_refused_by("RECEIVE", 8);
    // The next point was already in transit.
    bench.point(&beside(0.4));
    bench.step();
    bench.assert_refused_by("RECEIVE", 10);
    assert!((bench.robot_tool().position.x - 0.1).abs() < 0.01);
    bench.command(T3iVerb::Pause);
    bench.step();
    bench.step();
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Finished, LinkFault::None));
    bench.point(&beside(0.2));
    bench.step();
    assert!((bench.robot_tool().position.x - 0.2).abs() < 0.01);
}

#[test]
fn unsendable_frame_is_an_invalid_command() {
    for frame in [WireFrame::default(), WireFrame { tool: [50_000, 0, 0], ..WireFrame::from_frame(&home()) }]
    {
        let mut bench = Bench::running();
        bench.memory.prim.t3i.frame = frame;
        bench.command(T3iVerb::Point);
        bench.step();
        assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::InvalidCommand));
    }
}

/// A robot near the largest word, and a goal behind the robot: the tool turns half around on the way, and the end
/// plate would leave the range of the words.
fn bench_at_the_largest_word() -> (Bench, Frame) {
    let turned = |degrees: f64| Frame {
        position: Vector::new(320.0, 0.0, 0.0),
        rotation: Rotation3::from_axis_angle(&Vector::z_axis(), degrees.to_radians()),
    };
    let mut bench = Bench::running();
    // The robot of the bench is at HOME.
    bench.external.devices.resolvers.valid = false;
    let at = Plate::from_tool(&turned(100.0), &T3, &Plate::default()).unwrap();
    bench.process.state.position = Position::reported(at, &T3);
    (bench, turned(260.0))
}

#[test]
fn unsendable_way_is_an_invalid_command() {
    let (mut bench, goal) = bench_at_the_largest_word();
    let at = bench.process.state.position.plate;
    bench.point(&goal);
    bench.step();
    assert_eq!(
        (bench.sent(), bench.fault(), bench.row()),
        (Some(at), LinkFault::InvalidCommand, ("POINT", 10))
    );
    bench.point(&goal);
    bench.step();
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::InvalidCommand));
}

fn unanswered(bench: &mut Bench) {
    let late = std::mem::take(&mut bench.external.devices.link_rx);
    bench.step();
    bench.external.devices.link_rx.extend(late.as_slice());
}

#[test]
fn outstanding_frame_blocks_the_line() {
    let mut bench = Bench::running();
    bench.point(&beside(5.0));
    unanswered(&mut bench);
    assert_eq!((bench.sent(), bench.row()), (None, ("POINT", 3)));
    for _ in 0..2 {
        bench.point(&beside(5.0));
        bench.step();
    }
    unanswered(&mut bench);
    assert_eq!((bench.sent(), bench.row()), (None, ("POINT", 4)));
    bench.memory.prim.header.republished = true;
    bench.step();
    unanswered(&mut bench);
    assert_eq!((bench.sent(), bench.row()), (None, ("POINT", 2)), "Prim stands still");
    bench.step();
    assert_eq!((bench.sent(), bench.row()), (Some(bench.at()), ("POINT", 7)));
}

#[test]
fn first_of_two_unsendable_points_is_an_invalid_command() {
    let (mut bench, goal) = bench_at_the_largest_word();
    bench.point(&goal);
    unanswered(&mut bench);
    bench.point(&goal);
    bench.step();
    assert_eq!((bench.fault(), bench.row()), (LinkFault::InvalidCommand, ("POINT", 11)));
}

#[test]
fn unknown_command_is_invalid() {
    let mut bench = Bench::running();
    bench.command(T3iVerb::None);
    bench.step();
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::InvalidCommand));
}

#[test]
fn points_before_the_report_are_refused() {
    let mut bench = Bench::new();
    bench.cut();
    bench.step();
    bench.point(&beside(0.1));
    bench.step();
    bench.assert_refused_by("RECEIVE", 7);
}

#[test]
fn pause_empties_the_queue_and_holds_the_position() {
    let mut bench = Bench::running();
    bench.point(&beside(5.0));
    bench.step();
    bench.step();
    bench.command(T3iVerb::Pause);
    bench.step();
    let at = bench.at();
    for _ in 0..5 {
        bench.step();
        assert_eq!((bench.at(), bench.sent(), bench.report()), (at, Some(at), T3iReport::Finished));
    }
}

#[test]
fn held_or_lost_prim_holds_the_position() {
    for lost in [true, false] {
        let mut bench = Bench::running();
        bench.point(&beside(5.0));
        bench.step();
        bench.step();
        let at = bench.at();
        (bench.world.prim_runs, bench.memory.prim.header.republished) = (!lost, !lost);
        for _ in 0..5 {
            bench.step();
            assert_eq!((bench.at(), bench.sent()), (at, Some(at)));
        }
        (bench.world.prim_runs, bench.memory.prim.header.republished) = (true, false);
        bench.wait(10);
        assert!((bench.robot_tool().position.x - 5.0).abs() < 0.01);
    }
}

#[test]
fn cut_line_is_reported_until_restart() {
    let mut bench = Bench::running();
    bench.point(&beside(5.0));
    bench.step();
    bench.world.line.connected = false;
    bench.wait(4);
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::NotResponding));
    assert!(!bench.memory.t3i.status.link_running);
    let at = bench.at();
    bench.world.line.connected = true;
    for _ in 0..30 {
        bench.step();
        assert_eq!((bench.report(), bench.at()), (T3iReport::Error, at));
    }
    assert!(bench.memory.t3i.status.link_running);
    bench.point(&beside(5.0));
    bench.step();
    assert_eq!((bench.report(), bench.row(), bench.at()), (T3iReport::Error, ("RECEIVE", 6), at));
    bench.command(T3iVerb::Restart);
    bench.wait(3);
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Finished, LinkFault::None));
    bench.point(&beside(bench.robot_tool().position.x - home().position.x));
    bench.step();
    assert_eq!(bench.report(), T3iReport::Ready);
}

#[test]
fn unsent_bytes_are_reported_as_not_transmitted() {
    let mut bench = Bench::running();
    bench.point(&beside(5.0));
    bench.step();
    let at = bench.at();
    // The serial line is not ready either after a torn frame.
    (bench.external.devices.link_unsent, bench.external.devices.link_ready) = (true, false);
    bench.step();
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::NotTransmitted));
    assert_eq!(LinkFault::NotTransmitted.code(), 4);
    bench.external.devices.link_unsent = false;
    for _ in 0..5 {
        bench.step();
        assert_eq!((bench.fault(), bench.at()), (LinkFault::NotTransmitted, at));
    }
    bench.command(T3iVerb::Restart);
    bench.wait(12);
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Finished, LinkFault::None));
}

#[test]
fn singly_stepped_prim_sends_one_point_per_step() {
    let mut bench = Bench::running();
    for n in 1..=6 {
        // Prim answers the report of the previous tick, and is then held again.
        assert!(matches!(bench.report(), T3iReport::Ready | T3iReport::Finished));
        bench.memory.prim.header.republished = false;
        bench.point(&beside(0.4 * f64::from(n)));
        bench.step();
        bench.memory.prim.header.republished = true;
        for _ in 0..5 {
            bench.step();
            let x = bench.robot_tool().position.x;
            assert!((x - 0.4 * f64::from(n)).abs() < 0.01, "{x} after {n} steps");
        }
    }
}

#[test]
fn unanswered_restart_fails_after_the_time_limit() {
    for (patience, ticks) in [(Some(100), 100), (None, 1500)] {
        let mut bench = Bench::running();
        bench.external.devices.link_patience = patience;
        bench.world.line.connected = false;
        bench.command(T3iVerb::Restart);
        let (mut executing, mut asked) = (0, 0);
        while bench.step().status.report == T3iReport::Executing {
            executing += 1;
            asked += usize::from(bench.memory.t3i.link_tx.as_slice() == [0x05]);
            let status = &bench.memory.t3i.status;
            assert_eq!((status.controller_ready, status.silent), (true, executing > 25));
        }
        assert_eq!((executing, asked, bench.fault()), (ticks, ticks / 25, LinkFault::NotResponding));
    }
}

fn check(bench: &Bench) -> ReportCheck {
    bench.memory.t3i.status.check
}

/// A robot that moves along X, and whose line is cut; the last words arrive if `taken`.
fn cut_off(taken: bool) -> Bench {
    let mut bench = Bench::running();
    for point in 1..=5 {
        bench.point(&beside(0.3 * f64::from(point)));
        bench.step();
    }
    assert_eq!(check(&bench), ReportCheck::AsSent);
    if !taken {
        bench.world.line.connected = false;
    }
    bench.point(&beside(1.8));
    bench.step();
    bench.cut();
    bench.wait(4);
    assert_eq!((bench.fault(), check(&bench)), (LinkFault::NotResponding, ReportCheck::NoReport));
    bench
}

fn restarted(mut bench: Bench) -> Bench {
    bench.world.line.connected = true;
    bench.command(T3iVerb::Restart);
    bench.wait(40);
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Finished, LinkFault::None));
    bench
}

/// Moves the robot by some words without the line.
fn led(mut bench: Bench, words: i16) -> Bench {
    bench.world.line.robot.at.words[0] += words;
    bench
}

#[test]
fn robot_near_the_last_words_is_at_its_commanded_position() {
    for (taken, words) in
        [(true, 0), (true, 2), (true, -15), (true, -32), (false, 0), (false, -2), (false, 32)]
    {
        let bench = restarted(led(cut_off(taken), words));
        assert_eq!(check(&bench), ReportCheck::AsSent, "{taken} {words}");
        let at = bench.at().to_tool(&T3);
        assert_eq!(bench.memory.t3i.status.frame_feedback, WireFrame::from_frame(&at));
    }
    for (taken, words) in [(true, 3), (true, -33), (false, -3), (false, 33)] {
        let bench = restarted(led(cut_off(taken), words));
        assert_eq!(check(&bench), ReportCheck::Elsewhere, "{taken} {words}");
    }
}

/// A robot between the last words and the previous ones; the next check uses that position.
#[test]
fn next_report_is_compared_with_the_reported_position() {
    for (words, expected) in
        [(2, ReportCheck::AsSent), (15, ReportCheck::Elsewhere), (-15, ReportCheck::Elsewhere)]
    {
        let mut bench = restarted(led(cut_off(true), -15));
        assert_eq!(check(&bench), ReportCheck::AsSent);
        bench.cut();
        bench.wait(4);
        let bench = restarted(led(bench, words));
        assert_eq!(check(&bench), expected, "{words}");
    }
}

#[test]
fn displaced_robot_stays_displaced_until_the_next_point() {
    let mut bench = restarted(led(cut_off(true), 100));
    assert_eq!(check(&bench), ReportCheck::Elsewhere);
    // Another RESTART, or another loss of the link, does not change the result.
    for connected in [true, false] {
        bench.world.line.connected = connected;
        bench.wait(5);
        bench = restarted(bench);
        assert_eq!(check(&bench), ReportCheck::Elsewhere);
    }
    bench.point(&bench.robot_tool());
    bench.step();
    bench.step();
    assert_eq!(check(&bench), ReportCheck::AsSent);
}

#[test]
fn report_after_dtr_off_is_not_trusted() {
    let mut bench = Bench::running();
    bench.point(&beside(0.3));
    bench.step();
    (bench.world.line.on, bench.external.devices.link_ready) = (false, false);
    bench.step();
    let status = &bench.memory.t3i.status;
    assert_eq!((status.controller_ready, status.report), (false, T3iReport::Error));
    bench.world.line.on = true;
    let bench = restarted(bench);
    assert_eq!(check(&bench), ReportCheck::Elsewhere);
    // Before the first position a controller that is off does not matter.
    let mut bench = Bench::new();
    (bench.world.line.on, bench.external.devices.link_ready) = (false, false);
    bench.step();
    assert_eq!(check(&bench), ReportCheck::NoReport);
    bench.world.line.on = true;
    assert_eq!(check(&restarted(bench)), ReportCheck::AsSent);
}

#[test]
fn restarted_t3i_takes_the_sent_words_from_its_outputs() {
    for (words, expected) in [(0, ReportCheck::AsSent), (3, ReportCheck::Elsewhere)] {
        let mut bench = cut_off(true);
        bench.restart();
        bench.step();
        assert_eq!(bench.fault(), LinkFault::InvalidCommand);
        let bench = restarted(led(bench, words));
        assert_eq!(check(&bench), expected);
    }
    // A restarted T3I also keeps the result that the operator must decide.
    let mut bench = restarted(led(cut_off(true), 100));
    bench.restart();
    bench.step();
    assert_eq!(check(&restarted(bench)), ReportCheck::Elsewhere);
}

#[test]
fn restart_recovers_from_a_joint_limit() {
    let mut bench = Bench::running();
    let mut goal = home();
    let mut reports = Vec::new();
    for _ in 0..2 {
        goal = goal.turned(&Rotation3::from_axis_angle(&Vector::x_axis(), 1.3));
        bench.point(&goal);
        bench.step();
    }
    for _ in 0..100 {
        bench.step();
        reports.push((bench.report(), bench.world.line.controller.warning()));
    }
    assert!(reports.iter().any(|(_, warning)| *warning == Warning::JointLimit));
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::NotResponding));
    bench.command(T3iVerb::Restart);
    bench.wait(3);
    assert_eq!(
        (bench.report(), bench.world.line.controller.state()),
        (T3iReport::Finished, ControllerState::Running)
    );
    // T3I publishes the robot's true position, not the commanded one.
    assert!(bench.world.line.robot.joints[5] <= T3.limits[5].1);
    assert_eq!(bench.memory.t3i.status.frame_feedback, WireFrame::from_frame(&bench.robot_tool()));
}

#[test]
fn panel_hold_does_not_lose_the_link() {
    let mut bench = Bench::running();
    bench.point(&beside(1.0));
    bench.step();
    bench.world.line.hold = true;
    bench.wait(20);
    assert_eq!(bench.report(), T3iReport::Error);
    bench.world.line.hold = false;
    bench.wait(10);
    assert_eq!(bench.world.line.controller.state(), ControllerState::Running);
    bench.command(T3iVerb::Restart);
    bench.wait(4);
    assert_eq!((bench.report(), bench.fault()), (T3iReport::Finished, LinkFault::None));
}

#[test]
fn restarted_t3i_does_not_move_and_reports_it() {
    let mut bench = Bench::running();
    bench.point(&beside(0.3));
    bench.restart();
    for _ in 0..10 {
        bench.step();
        assert_eq!((bench.report(), bench.fault()), (T3iReport::Error, LinkFault::InvalidCommand));
    }
    assert!(bench.robot_tool().position.x.abs() < 0.01);
}

#[test]
fn feedback_is_the_resolver_frame_before_the_link_runs() {
    let mut bench = Bench::new();
    bench.cut();
    bench.world.line.robot.joints[0] += 0.2;
    bench.external.devices.resolvers.counts = counts(&bench.world.line.robot.joints);
    let expected = WireFrame::from_frame(&T3.forward(&bench.world.line.robot.joints));
    let status = bench.step().status;
    assert!(!status.link_running);
    assert_eq!((Some(status.frame_feedback), status.scale_factor), (status.resolver_frame, 131_072));
    for (found, expected) in status.frame_feedback.tool.iter().zip(expected.tool) {
        assert!((found - expected).abs() <= 1, "{found} for {expected}");
    }
}

#[test]
fn restored_state_continues_identically() {
    let mut bench = Bench::running();
    bench.point(&beside(5.0));
    bench.step();
    let mut other = bench.clone();
    other.restore();
    assert_eq!(bench.step(), other.step());
    assert_eq!(bench.memory.t3i.link_tx.length, 16);
}

#[test]
fn every_row_fires() {
    let silent = silent::<T3i, ()>(&[
        gap_in_the_numbers_is_invalid_until_pause,
        unsendable_way_is_an_invalid_command,
        outstanding_frame_blocks_the_line,
        first_of_two_unsendable_points_is_an_invalid_command,
        unknown_command_is_invalid,
        points_before_the_report_are_refused,
        held_or_lost_prim_holds_the_position,
        displaced_robot_stays_displaced_until_the_next_point,
        report_after_dtr_off_is_not_trusted,
        follow::a_robot_off_its_path_gets_nothing_until_a_restart,
        follow::the_resolvers_have_a_second_to_come_near_a_reported_position,
    ]);
    // Points are taken only while the link runs, and a lost link is a fault.
    assert_eq!(silent, ["POINT 1"]);
}
