//! Every row of every table fires.

use interfaces::device::{ForceSensor, joystick_frame};

use super::*;
use crate::prim::tables::TABLES;

const MOTIONS: [PrimVerb; 5] =
    [PrimVerb::GoThru, PrimVerb::GotoPt, PrimVerb::GoUntil, PrimVerb::GoWhile, PrimVerb::DeltaMove];
const FAULTS: [LinkFault; 3] = [LinkFault::NotResponding, LinkFault::DepcError, LinkFault::InvalidCommand];
const GOOD: ForceSensor = ForceSensor { x: 2048, y: 2048, z: 2048, moment: 2048, valid: true };

/// Scenarios; the rows that fired in them.
#[derive(Default)]
struct Fired(Coverage);

impl Fired {
    /// Run a scenario on a rig; afterwards it is over.
    fn run(&mut self, mut rig: Rig, scenario: impl FnOnce(&mut Rig)) {
        rig.external.devices.force = GOOD;
        scenario(&mut rig);
        rig.steps(60);
        self.0.append(&mut rig.rows);
    }

    /// The same for a command that has just begun.
    fn during(&mut self, verb: PrimVerb, ticks: u32, scenario: impl FnOnce(&mut Rig)) {
        self.run(Rig::initialized(), |rig| {
            rig.guard(verb, 1, "NEAR-R");
            rig.steps(ticks);
            scenario(rig);
        });
    }
}

/// What hinders a command.
fn hindered(fired: &mut Fired) {
    for verb in MOTIONS.into_iter().chain([PrimVerb::CalSensor, PrimVerb::RobotInit]) {
        for fault in FAULTS {
            fired.during(verb, 4, |rig| rig.t3i.fault = fault);
        }
        fired.during(verb, 2, |rig| rig.t3i.dead = true);
        fired.during(verb, 4, |rig| rig.t3i.left = true);
        fired.during(verb, 2, |rig| rig.emove_dead = true);
        fired.during(verb, 2, |rig| {
            rig.frame_switch(joystick_frame::TOOL);
            rig.stick(1000, 0);
        });
        link_faults(fired, verb);
        fired.run(Rig::new(), |rig| {
            rig.steps(3);
            rig.guard(verb, 1, "NEAR-R");
        });
    }
    fired.during(PrimVerb::GotoPt, 20, |rig| {
        rig.run(PrimVerb::RobotInit, 0);
    });
    fired.run(Rig::paused(), |rig| {
        (rig.t3i.left, rig.t3i.astray) = (true, true);
        rig.steps(3);
        rig.run(PrimVerb::RobotInit, 0);
    });
    // ROBOT-INIT whose link fails for ever, or again and again.
    for fault in FAULTS {
        fired.run(Rig::new(), |rig| {
            rig.steps(3);
            rig.t3i.broken = fault;
            rig.run(PrimVerb::RobotInit, 0);
        });
    }
    fired.run(Rig::new(), |rig| {
        rig.steps(3);
        rig.t3i.more_faults = 20;
        rig.run(PrimVerb::RobotInit, 0);
    });
    fired.run(Rig::new(), |rig| {
        rig.steps(3);
        (rig.t3i.dtr_off, rig.t3i.broken) = (true, LinkFault::NotResponding);
        rig.run(PrimVerb::RobotInit, 0);
    });
}

/// A link that fails, and fails again.
fn link_faults(fired: &mut Fired, verb: PrimVerb) {
    for fault in FAULTS {
        // Before the RESTART is answered, and as soon as it is, and for ever.
        fired.during(verb, 4, |rig| {
            (rig.t3i.fault, rig.t3i.broken) = (fault, fault);
            rig.steps(30);
        });
        fired.during(verb, 4, |rig| {
            (rig.t3i.fault, rig.t3i.more_faults) = (fault, 2);
            rig.steps(40);
        });
        fired.during(verb, 4, |rig| {
            for _ in 0..=10 {
                rig.t3i.fault = fault;
                rig.steps(20);
            }
            rig.command(verb, 1);
            rig.steps(3);
        });
        fired.run(Rig::paused(), |rig| rig.t3i.fault = fault);
    }
    fired.during(verb, 4, |rig| (rig.t3i.fault, rig.t3i.dtr_off) = (LinkFault::NotResponding, true));
    fired.during(verb, 4, |rig| (rig.t3i.fault, rig.t3i.elsewhere) = (LinkFault::NotResponding, true));
    fired.run(Rig::paused(), |rig| rig.t3i.dead = true);
}

/// What becomes of a motion.
fn motions(fired: &mut Fired) {
    for verb in MOTIONS {
        fired.during(verb, 2, |rig| {
            rig.until_over();
        });
        fired.during(verb, 2, |rig| rig.steps(300));
        // It does not come to rest at the goal.
        fired.during(verb, 2, |rig| {
            rig.t3i.off = 3;
            rig.steps(300);
        });
        // The sensor says something on the way, at the goal, or is not there.
        for ticks in [10, 200] {
            fired.during(verb, ticks, |rig| rig.external.devices.holsters.right = 3);
        }
        fired.run(Rig::initialized(), |rig| {
            rig.guard(verb, 1, "PUSH-X");
            rig.steps(3);
        });
    }
    // After the trip the robot does not stand.
    fired.during(PrimVerb::GoUntil, 10, |rig| {
        rig.external.devices.holsters.right = 3;
        for tick in 0..200 {
            rig.t3i.off = if tick % 3 == 0 { 3 } else { 0 };
            rig.step();
        }
    });
}

fn calibrations(fired: &mut Fired) {
    fired.during(PrimVerb::CalSensor, 30, |_| {});
    fired.during(PrimVerb::GotoPt, 20, |rig| {
        rig.run(PrimVerb::CalSensor, 0);
    });
    fired.during(PrimVerb::CalSensor, 1, |rig| {
        rig.external.devices.force.valid = false;
        rig.steps(20);
    });
    fired.during(PrimVerb::CalSensor, 1, |rig| {
        for tick in 0..100 {
            rig.t3i.off = if tick % 3 == 0 { 3 } else { 0 };
            rig.step();
        }
    });
}

/// Commands that are refused, and a ROBOT-INIT that finds the link in error.
fn refusals(fired: &mut Fired) {
    for (pose, sensor, parameters) in [(1, "NOSE", 1), (99, "NEAR-R", 1), (1, "NEAR-R", 2)] {
        fired.run(Rig::initialized(), |rig| {
            rig.guard(PrimVerb::GoUntil, pose, sensor);
            rig.memory.emove.prim.trajectory_parameters = parameters;
        });
    }
    fired.during(PrimVerb::GotoPt, 4, |rig| {
        rig.t3i.fault = LinkFault::NotResponding;
        rig.steps(4);
        rig.command(PrimVerb::RobotInit, 0);
    });
}

/// PAUSE, the joystick box and the record button.
fn pauses(fired: &mut Fired) {
    let both = joystick_frame::WORLD | joystick_frame::TOOL;
    for frame in [0, joystick_frame::WORLD] {
        fired.run(Rig::new(), |rig| {
            rig.steps(3);
            rig.frame_switch(frame);
            rig.command(PrimVerb::Pause, 0);
            rig.steps(3);
            rig.external.devices.joystick.record = true;
        });
        fired.during(PrimVerb::GotoPt, 20, |rig| {
            rig.command(PrimVerb::Pause, 0);
            rig.steps(3);
            rig.frame_switch(frame);
        });
    }
    fired.run(Rig::paused(), |rig| {
        rig.stick(1000, 0);
        for frame in [joystick_frame::WORLD, both, 0, both, joystick_frame::TOOL, 0] {
            rig.frame_switch(frame);
            rig.steps(20);
        }
        rig.external.devices.joystick.record = true;
        rig.steps(3);
        rig.external.devices.joystick.resume = true;
    });
    // The robot never rests.
    fired.run(Rig::initialized(), |rig| {
        rig.command(PrimVerb::Pause, 0);
        for tick in 0..100 {
            rig.t3i.off = if tick % 3 == 0 { 3 } else { 0 };
            rig.step();
        }
    });
    // The operator takes a robot that flies on.
    fired.run(Rig::initialized(), |rig| {
        rig.run(PrimVerb::GoThru, 1);
        rig.frame_switch(both);
        rig.stick(1000, 0);
    });
    fired.during(PrimVerb::GotoPt, 20, |rig| rig.command(PrimVerb::None, 0));
    fired.during(PrimVerb::GotoPt, 20, |rig| rig.prim = Prim::default());
    fired.during(PrimVerb::GotoPt, 20, |rig| rig.stalls = 1);
}

#[test]
fn every_row_fires() {
    let mut fired = Fired::default();
    hindered(&mut fired);
    motions(&mut fired);
    calibrations(&mut fired);
    pauses(&mut fired);
    refusals(&mut fired);
    assert_eq!(fired.0.missing(TABLES), [""; 0]);
}
