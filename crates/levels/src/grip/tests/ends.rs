use interfaces::{
    Reason,
    grip::{Felt, GripReport, GripVerb},
};

use super::{bench::Bench, calibrated};
use crate::{
    environment::air::{Gripper, Object},
    grip::{
        state::{State, Touch},
        tables::{GripPhase, Step},
    },
};

/// Objects between the fingers: none, a part, one that only one finger reaches, two that fill the opening.
const OBJECTS: [Option<Object>; 4] = [
    None,
    Some(Object { size: 0.625, off_centre: 0.0 }),
    Some(Object { size: 0.625, off_centre: 9.0 }),
    Some(Object { size: 4.9, off_centre: 0.0 }),
];

/// Initial openings, in, and worlds: whether the gripper is attached, has no air, and reads no force.
const OPENINGS: [f64; 4] = [0.1, 0.625, 3.0, 5.0];
const WORLDS: [(bool, bool, bool); 4] =
    [(true, false, false), (true, true, false), (true, false, true), (false, false, false)];

/// A process in the middle of a command: state and environment agree only by chance.
fn beginning(phase: GripPhase, step: Step, attached: bool, world: &Gripper, remembered: &State) -> Bench {
    let mut bench = Bench::without(world.clone());
    bench.attach(attached);
    let known = matches!(phase, GripPhase::Valid | GripPhase::Adopting);
    bench.process.state = State {
        phase,
        step,
        calibration: remembered.calibration.filter(|_| known),
        felt: Felt::Something,
        touch: Touch::Both,
        ..bench.process.state
    };
    bench
}

#[test]
fn every_command_ends_from_every_state() {
    let remembered = calibrated(26).process.state;
    let mut ends = [0; 2];
    let worlds = OBJECTS.into_iter().flat_map(|object| OPENINGS.map(|opening| (object, opening)));
    for ((object, opening), (attached, without_air, dead)) in
        worlds.flat_map(|world| WORLDS.map(|other| (world, other)))
    {
        let least = object.map_or(0.1, |object: Object| object.size);
        let mut world = Gripper::new(f64::max(opening, least), 27);
        (world.object, world.without_air) = (object, without_air);
        if dead {
            world.strain[0] = (0.0, 0.0);
        }
        for (phase, step) in
            GripPhase::ALL.iter().flat_map(|phase| Step::ALL.iter().map(move |step| (phase, step)))
        {
            for verb in GripVerb::ALL {
                let mut bench = beginning(*phase, *step, attached, &world, &remembered);
                bench.command(*verb, 0.6, 30);
                let status = bench.finish().status;
                let failed = status.report == GripReport::Serror;
                assert_eq!(failed, status.reason != Reason::None, "{verb} in {phase} {step}: {status:?}");
                ends[usize::from(failed)] += 1;
            }
        }
    }
    assert!(ends.iter().all(|count| *count > 500), "done and failed: {ends:?}");
}
