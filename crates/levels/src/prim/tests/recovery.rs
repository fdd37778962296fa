//! Commands during link failures: Prim restarts the link and the command continues.

use interfaces::device::ForceSensor;

use super::*;
use crate::prim::state::{MOST_RESTARTS, RESTART_TICKS};

pub(super) const SCENARIOS: &[fn()] = &[
    motion_resumes_from_rest_after_every_fault,
    link_failure_in_pause_is_reported_and_next_motion_restarts,
    restart_without_a_report_is_a_lost_link,
    too_many_restarts_are_a_lost_link_for_a_while,
    repeated_link_failure_reports_its_last_fault,
    displaced_robot_waits_for_robot_init,
    robot_init_restarts_a_link_failing_after_its_report,
    robot_init_reports_the_fault_of_the_link,
    robot_init_clears_link_faults_but_not_a_robot_off_its_path,
    link_failure_ends_the_motion,
];

const FAULTS: [LinkFault; 5] = [
    LinkFault::NotResponding,
    LinkFault::DepcError,
    LinkFault::Checksum,
    LinkFault::NotTransmitted,
    LinkFault::InvalidCommand,
];

impl Rig {
    /// Fail and restart the link while the command stays in execution. Returns where the robot stopped.
    fn lose_and_restart(&mut self, fault: LinkFault) -> WireFrame {
        self.world.t3i.fault = fault;
        self.wait(3);
        let stopped = self.world.t3i.output;
        let status = &self.memory.prim.status;
        assert_eq!((status.report, status.restarting), (PrimReport::Executing, true));
        assert_eq!((status.present_pose, self.memory.prim.t3i.command), (None, T3iVerb::Restart));
        self.world.t3i.path.clear();
        stopped
    }
}

#[test]
fn motion_resumes_from_rest_after_every_fault() {
    for (verb, end) in [
        (PrimVerb::GotoPt, PrimReport::Done),
        (PrimVerb::DeltaMove, PrimReport::Done),
        (PrimVerb::GoWhile, PrimReport::Done),
        (PrimVerb::GoThru, PrimReport::Done),
        (PrimVerb::GoUntil, PrimReport::NotDetected),
    ] {
        for fault in FAULTS {
            for after in [2, 5, 30, 60] {
                let mut rig = Rig::initialized();
                rig.guard(verb, 3, "NEAR-R");
                rig.wait(after);
                let stopped = rig.lose_and_restart(fault);
                assert_eq!(rig.finish(), end, "{verb} {fault} {after}");
                assert!(!rig.memory.prim.status.restarting);
                rig.check_path(&stopped.to_frame().unwrap());
                rig.wait(100);
                assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
            }
        }
    }
}

#[test]
fn restart_resumes_towards_the_current_goal() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    let stopped = rig.lose_and_restart(LinkFault::NotResponding);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&stopped.to_frame().unwrap());
}

#[test]
fn next_motion_continues_after_a_fault_in_a_through_motion() {
    let mut rig = Rig::initialized();
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
    rig.world.t3i.fault = LinkFault::Checksum;
    rig.wait(20);
    assert_eq!((rig.report(), rig.memory.prim.t3i.command), (PrimReport::Done, T3iVerb::Pause));
    let stopped = rig.world.t3i.output.to_frame().unwrap();
    rig.world.t3i.path.clear();
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&stopped);
}

#[test]
fn link_failure_in_pause_is_reported_and_next_motion_restarts() {
    for (fault, report) in [
        (LinkFault::NotResponding, PrimReport::T3LinkOff),
        (LinkFault::DepcError, PrimReport::T3LinkErr),
        (LinkFault::InvalidCommand, PrimReport::T3BadCommand),
    ] {
        let mut rig = Rig::paused();
        let held = rig.world.t3i.output;
        rig.world.t3i.fault = fault;
        rig.wait(20);
        assert_eq!((rig.report(), rig.world.t3i.output), (report, held));
        rig.world.t3i.path.clear();
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        rig.check_path(&held.to_frame().unwrap());
    }
}

#[test]
fn restarted_guarded_move_tests_its_condition_first() {
    for (verb, report) in
        [(PrimVerb::GoUntil, PrimReport::Done), (PrimVerb::GoWhile, PrimReport::DetectedErr)]
    {
        let mut rig = Rig::initialized();
        rig.guard(verb, 3, "NEAR-R");
        rig.wait(30);
        let stopped = rig.lose_and_restart(LinkFault::NotResponding);
        rig.external.devices.holsters.right = 3;
        assert_eq!((rig.finish(), rig.world.t3i.output), (report, stopped));
        assert_eq!(rig.world.t3i.path, []);
    }
}

#[test]
fn stopping_guarded_move_is_done_where_it_rests() {
    let mut rig = Rig::initialized();
    rig.guard(PrimVerb::GoUntil, 3, "NEAR-R");
    rig.wait(40);
    rig.external.devices.holsters.right = 3;
    rig.wait(3);
    let detected = rig.memory.prim.status.detected_pose;
    let stopped = rig.lose_and_restart(LinkFault::NotResponding);
    // The condition was met earlier and does not hold now.
    rig.external.devices.holsters.right = 0;
    assert_eq!((rig.finish(), rig.world.t3i.output), (PrimReport::Done, stopped));
    assert_eq!((rig.memory.prim.status.detected_pose, rig.world.t3i.path.len()), (detected, 0));
}

#[test]
fn missed_condition_may_still_arrive_after_a_restart() {
    let mut rig = Rig::initialized();
    rig.guard(PrimVerb::GoUntil, 2, "NEAR-R");
    assert_eq!(rig.finish(), PrimReport::NotDetected);
    rig.world.t3i.fault = LinkFault::NotResponding;
    rig.wait(30);
    assert_eq!(rig.report(), PrimReport::NotDetected);
    rig.external.devices.holsters.right = 3;
    rig.wait(2);
    assert_eq!(rig.finish(), PrimReport::Done);
}

#[test]
fn restart_discards_the_samples_of_cal_sensor() {
    let force = |z| ForceSensor { x: 2048, y: 2048, z, moment: 2048, valid: true };
    let mut rig = Rig::initialized();
    rig.external.devices.force = force(2048);
    rig.command(PrimVerb::CalSensor, 0);
    rig.wait(9);
    assert!(rig.process.state().calibration.samples > 2);
    rig.lose_and_restart(LinkFault::NotResponding);
    rig.external.devices.force = force(2148);
    assert_eq!(rig.finish(), PrimReport::Done);
    assert_eq!(rig.process.state().calibration.bias, Some([100.0, 0.0, 0.0, 0.0]));
}

#[test]
fn restart_without_a_report_is_a_lost_link() {
    for (broken, report) in [
        (LinkFault::NotResponding, PrimReport::T3LinkOff),
        (LinkFault::Checksum, PrimReport::T3LinkErr),
        (LinkFault::InvalidCommand, PrimReport::T3BadCommand),
    ] {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(30);
        rig.world.t3i.broken = broken;
        rig.lose_and_restart(LinkFault::DepcError);
        assert_eq!(rig.finish(), report);
    }
}

#[test]
fn controller_with_dtr_off_reports_link_off() {
    for before_the_restart in [true, false] {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(30);
        if before_the_restart {
            (rig.world.t3i.dtr_off, rig.world.t3i.fault) = (true, LinkFault::NotResponding);
        } else {
            rig.lose_and_restart(LinkFault::NotResponding);
            rig.world.t3i.dtr_off = true;
        }
        assert_eq!(rig.finish(), PrimReport::T3LinkOff);
        assert!(rig.memory.prim.status.controller_off);
    }
}

/// A command that is done stays done; the link failure is reported with it, since the arm may sink.
#[test]
fn controller_off_after_a_motion_is_reported_with_done() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    assert_eq!(rig.finish(), PrimReport::Done);
    assert!(!rig.memory.prim.status.controller_off);
    rig.world.t3i.dtr_off = true;
    rig.wait(3);
    let status = rig.memory.prim.status;
    assert_eq!((status.report, status.controller_off), (PrimReport::Done, true));
}

#[test]
fn too_many_restarts_are_a_lost_link_for_a_while() {
    let most = u32::try_from(MOST_RESTARTS).unwrap();
    for (faults, report) in [(most - 1, PrimReport::Done), (most, PrimReport::T3LinkErr)] {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(30);
        rig.lose_and_restart(LinkFault::Checksum);
        rig.world.t3i.more_faults = faults;
        assert_eq!(rig.finish(), report, "{faults}");
        if report == PrimReport::T3LinkErr {
            assert_eq!(rig.run(PrimVerb::GotoPt, 2), report, "at once again");
        }
        rig.wait(u32::try_from(RESTART_TICKS).unwrap());
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    }
}

#[test]
fn repeated_link_failure_reports_its_last_fault() {
    for (fault, report, next) in [
        (LinkFault::NotResponding, PrimReport::T3LinkOff, PrimReport::T3LinkOff),
        (LinkFault::DepcError, PrimReport::T3LinkErr, PrimReport::T3LinkErr),
        // PAUSE clears the refusal; the position stays lost.
        (LinkFault::InvalidCommand, PrimReport::T3BadCommand, PrimReport::T3LinkErr),
    ] {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        for _ in 0..=MOST_RESTARTS {
            rig.wait(20);
            rig.world.t3i.fault = fault;
        }
        rig.wait(20);
        assert_eq!((rig.report(), rig.run(PrimVerb::GotoPt, 2)), (report, next), "{fault}");
    }
}

#[test]
fn displaced_robot_waits_for_robot_init() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.lose_and_restart(LinkFault::NotResponding);
    rig.world.t3i.elsewhere = true;
    rig.world.t3i.output = WireFrame::from_frame(&shifted(3.0, 3.0));
    let elsewhere = |rig: &mut Rig| {
        assert_eq!(rig.finish(), PrimReport::Error);
        assert_eq!(rig.memory.prim.status.reason, Reason::RobotElsewhere);
        assert_eq!(
            (rig.world.t3i.output, rig.world.t3i.path.len()),
            (WireFrame::from_frame(&shifted(3.0, 3.0)), 0)
        );
    };
    elsewhere(&mut rig);
    rig.command(PrimVerb::GotoPt, 2);
    elsewhere(&mut rig);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    rig.check_path(&shifted(3.0, 3.0));
}

#[test]
fn robot_init_restarts_a_link_failing_after_its_report() {
    let most = u32::try_from(MOST_RESTARTS).unwrap();
    for (faults, report) in
        [(1, PrimReport::Done), (most, PrimReport::Done), (most + 2, PrimReport::T3LinkErr)]
    {
        let mut rig = Rig::new();
        rig.wait(3);
        rig.world.t3i.more_faults = faults;
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), report, "{faults}");
    }
}

#[test]
fn robot_init_reports_the_fault_of_the_link() {
    for (broken, dtr_off, reason) in [
        (LinkFault::InvalidCommand, false, Reason::InterfaceRefused),
        (LinkFault::DepcError, false, Reason::LinkError),
        (LinkFault::NotResponding, false, Reason::LinkOff),
        (LinkFault::NotResponding, true, Reason::LinkOff),
    ] {
        let mut rig = Rig::new();
        rig.wait(3);
        (rig.world.t3i.broken, rig.world.t3i.dtr_off) = (broken, dtr_off);
        assert_ne!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        assert_eq!(rig.memory.prim.status.reason, reason, "{broken:?}");
    }
}

#[test]
fn robot_init_clears_link_faults_but_not_a_robot_off_its_path() {
    let mut rig = Rig::initialized();
    rig.world.t3i.fault = LinkFault::DepcError;
    rig.wait(3);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    (rig.world.t3i.left, rig.world.t3i.misplaced) = (true, true);
    rig.wait(3);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::OffPath);
}

#[test]
fn link_failure_ends_the_motion() {
    for (fault, dtr_off) in [
        (LinkFault::NotResponding, true),
        (LinkFault::NotResponding, false),
        (LinkFault::DepcError, false),
        (LinkFault::InvalidCommand, false),
    ] {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(30);
        assert!(rig.process.state().motion.is_some());
        (rig.world.t3i.fault, rig.world.t3i.dtr_off) = (fault, dtr_off);
        rig.wait(3);
        assert_eq!(rig.process.state().motion, None, "{fault:?}, DTR off: {dtr_off}");
    }
}

#[test]
fn restarted_prim_resumes_at_the_robot_position() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.restart();
    rig.wait(5);
    assert_eq!((rig.report(), rig.memory.prim.status.reason), (PrimReport::Error, Reason::Restarted));
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Pause);
    let stopped = rig.world.t3i.output;
    rig.wait(20);
    assert_eq!(rig.world.t3i.output, stopped);
    rig.world.t3i.path.clear();
    assert_eq!(rig.run(PrimVerb::GotoPt, 3), PrimReport::Done);
    rig.check_path(&stopped.to_frame().unwrap());
}
