//! Every command ends, from whatever state and in whatever world it begins.

use interfaces::{
    Reason,
    grip::{Felt, GripReport, GripVerb},
    process::Process,
};

use super::{
    Grip,
    bench::Bench,
    calibrated,
    gripper::{Gripper, Object},
};
use crate::grip::{
    state::{State, Touch},
    tables::{Phase, Step},
};

/// What stands between the fingers: nothing, a part, one that only one finger reaches, two that fill them.
const OBJECTS: [Option<Object>; 4] = [
    None,
    Some(Object { size: 0.625, off_centre: 0.0 }),
    Some(Object { size: 0.625, off_centre: 9.0 }),
    Some(Object { size: 4.9, off_centre: 0.0 }),
];

/// A process in the middle of things: state and world agree in nothing but by chance.
fn beginning(phase: Phase, step: Step, attached: bool, world: &Gripper, remembered: &State) -> Bench {
    let mut bench = Bench::without(world.clone());
    bench.attach(attached);
    let known = matches!(phase, Phase::Valid | Phase::Adopting);
    let state = State {
        phase,
        step,
        calibration: remembered.calibration.filter(|_| known),
        felt: Felt::Something,
        touch: Touch::Both,
        ..*<Grip as Process<()>>::state(&bench.process)
    };
    Process::<()>::restore(&mut bench.process, state);
    bench
}

#[test]
fn every_command_ends_from_every_state_whether_the_fingers_obey_or_not() {
    let remembered = *<Grip as Process<()>>::state(&calibrated(26).process);
    let mut ends = [0; 2];
    for phase in Phase::ALL {
        for step in Step::ALL {
            for object in OBJECTS {
                for opening in [0.1, 0.625, 3.0, 5.0] {
                    for (attached, without_air, dead) in [
                        (true, false, false),
                        (true, true, false),
                        (true, false, true),
                        (false, false, false),
                    ] {
                        for verb in GripVerb::ALL {
                            let least = object.map_or(0.1, |object: Object| object.size);
                            let mut world = Gripper::new(f64::max(opening, least), 27);
                            (world.object, world.without_air) = (object, without_air);
                            if dead {
                                world.strain[0] = (0.0, 0.0);
                            }
                            let mut bench = beginning(*phase, *step, attached, &world, &remembered);
                            bench.command(*verb, 0.6, 30);
                            let status = bench.finish().1.status;
                            let failed = status.report == GripReport::Serror;
                            assert_eq!(
                                failed,
                                status.reason != Reason::None,
                                "{verb} in {phase} {step}: {status:?}"
                            );
                            ends[usize::from(failed)] += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(ends.iter().all(|count| *count > 500), "done and failed: {ends:?}");
}
