//! Long steps of the physics give the same results as small ones: the same scenes with and without them.

use crate::rig::{FIX_V1, Rig, description, scenes, tape::Beat};
use plant::{Cell, CellDescription};

/// Greatest distance of a part between a run with long steps and one with small steps, in.
const ALIKE: f64 = 0.02;

fn small(description: &CellDescription) -> CellDescription {
    let mut small = description.clone();
    small.physics.long_steps = false;
    small
}

/// Play a scene with long and with small steps. Returns the greatest distance of a part between the two, in.
fn compare(description: &CellDescription, scene: Rig) -> f64 {
    let mut cells = [description, &small(description)].map(|each| Cell::new(each, 1).unwrap());
    let mut apart = 0.0_f64;
    for beat in &scene.tape.expect("the scene is on tape").beats {
        cells.iter_mut().for_each(|cell| Beat::play(beat, cell));
        let [long, small] = &cells;
        for (one, other) in long.parts().iter().zip(small.parts()) {
            assert_eq!((one.held, one.clamped, &one.location), (other.held, other.clamped, &other.location));
            let frames = [long, small].map(|cell| cell.part_frame(one.id).expect("it is there"));
            apart = apart.max((frames[0].position - frames[1].position).norm());
        }
    }
    apart
}

#[test]
fn large_steps_grip_carry_and_clamp_like_small_steps() {
    let apart = compare(&description(), scenes::clamping(1));
    assert!(apart > 0.0, "no long step was taken");
    assert!(apart < ALIKE, "{apart} in");
}

#[test]
fn large_steps_carry_a_tool_like_small_steps() {
    let mut scene = scenes::with_tool_in_hand(1);
    for via in [scenes::TOOL_SAFE, scenes::TOOL_V1, FIX_V1] {
        scene.go(via.to_frame().unwrap(), 10.0);
    }
    let apart = compare(&scenes::with_tool_gripper(), scene);
    assert!(apart > 0.0, "no long step was taken");
    assert!(apart < ALIKE, "{apart} in");
}
