//! What becomes of a command when the link fails: Prim restarts it, and goes on.

use interfaces::device::ForceSensor;

use super::*;
use crate::prim::state::{MOST_RESTARTS, RESTART_TICKS};

pub(super) const SCENARIOS: &[fn()] = &[
    a_motion_goes_on_from_rest_to_its_goal_after_every_fault,
    a_link_that_fails_while_pause_stands_is_reported_and_the_next_motion_restarts_it,
    a_restart_without_a_report_is_a_lost_link,
    too_many_restarts_are_a_lost_link_and_pass,
    a_link_that_fails_again_and_again_is_lost_by_its_last_fault,
    a_robot_that_is_elsewhere_waits_for_robot_init,
    robot_init_restarts_a_link_that_fails_after_its_report,
    robot_init_says_what_is_wrong_with_the_link,
    robot_init_clears_a_fault_of_the_link_but_not_a_robot_off_its_path,
    a_link_that_fails_leaves_no_motion_behind,
];

const FAULTS: [LinkFault; 5] = [
    LinkFault::NotResponding,
    LinkFault::DepcError,
    LinkFault::Checksum,
    LinkFault::NotTransmitted,
    LinkFault::InvalidCommand,
];

impl Rig {
    /// The link fails and is restarted; the command goes on executing meanwhile. Where the robot stopped.
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
fn a_motion_goes_on_from_rest_to_its_goal_after_every_fault() {
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
fn it_goes_on_to_the_goal_of_the_command_that_is_current_then() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    let stopped = rig.lose_and_restart(LinkFault::NotResponding);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&stopped.to_frame().unwrap());
}

#[test]
fn a_robot_that_flies_on_is_sent_on_by_the_next_motion() {
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
fn a_link_that_fails_while_pause_stands_is_reported_and_the_next_motion_restarts_it() {
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
fn a_guarded_move_asks_its_condition_before_the_first_point() {
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
fn a_guarded_move_that_was_stopping_is_done_where_it_rests() {
    let mut rig = Rig::initialized();
    rig.guard(PrimVerb::GoUntil, 3, "NEAR-R");
    rig.wait(40);
    rig.external.devices.holsters.right = 3;
    rig.wait(3);
    let detected = rig.memory.prim.status.detected_pose;
    let stopped = rig.lose_and_restart(LinkFault::NotResponding);
    // The condition has passed: it has come all the same.
    rig.external.devices.holsters.right = 0;
    assert_eq!((rig.finish(), rig.world.t3i.output), (PrimReport::Done, stopped));
    assert_eq!((rig.memory.prim.status.detected_pose, rig.world.t3i.path.len()), (detected, 0));
}

#[test]
fn a_missed_condition_is_waited_for_after_a_restart() {
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
fn cal_sensor_begins_its_samples_anew() {
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
fn a_restart_without_a_report_is_a_lost_link() {
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
fn a_controller_whose_dtr_is_off_is_a_link_that_is_off() {
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

/// A command that is done stays done; that the arm may sink is reported beside it.
#[test]
fn controller_that_goes_off_after_the_end_of_a_motion_is_reported_beside_done() {
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
fn too_many_restarts_are_a_lost_link_and_pass() {
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
fn a_link_that_fails_again_and_again_is_lost_by_its_last_fault() {
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
fn a_robot_that_is_elsewhere_waits_for_robot_init() {
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
fn robot_init_restarts_a_link_that_fails_after_its_report() {
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
fn robot_init_says_what_is_wrong_with_the_link() {
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
fn robot_init_clears_a_fault_of_the_link_but_not_a_robot_off_its_path() {
    let mut rig = Rig::initialized();
    rig.world.t3i.fault = LinkFault::DepcError;
    rig.wait(3);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    (rig.world.t3i.left, rig.world.t3i.astray) = (true, true);
    rig.wait(3);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::OffPath);
}

#[test]
fn a_link_that_fails_leaves_no_motion_behind() {
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
fn a_restarted_prim_goes_on_where_the_robot_stands() {
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
