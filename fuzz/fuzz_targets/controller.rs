//! The controller's end against a host and an operator that do anything at any time.
//!
//! The robot never moves further in a tick than the limits allow, never without an ACK in the same tick, never on hold or
//! outside the function; and the operator can always bring it back to work.

#![no_main]

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot, joints_for},
    wire::DataCommand,
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use interfaces::device::LinkBytes;
use libfuzzer_sys::fuzz_target;

const HOME: Plate = Plate { words: [0, -6293, -636, -9000, 13500, 0] };

struct Watched {
    joints: Joints,
    at: Plate,
    moves: usize,
}

impl Robot for Watched {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        assert_eq!(Limits::NBS.check(&self.at, goal), Ok(()));
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        self.moves += 1;
        Ok(())
    }
}

/// What the host sends in this tick: raw bytes, or a frame with a right checksum near the robot.
fn line(kind: u8, bytes: &[u8], at: &Plate) -> LinkBytes {
    let mut rx = LinkBytes::default();
    if kind & 0x80 == 0 {
        rx.extend(bytes);
        return rx;
    }
    let mut plate = *at;
    for (word, by) in plate.words.iter_mut().zip(bytes) {
        *word = word.wrapping_add(i16::from(by.cast_signed()));
    }
    let mut frame = [0; 16];
    DataCommand { function: [0, kind], plate }.emit(&mut frame);
    rx.extend(&frame);
    rx
}

fuzz_target!(|data: &[u8]| {
    let mut controller = Controller::new(Limits::NBS);
    let mut robot = Watched { joints: HOME_JOINTS, at: HOME, moves: 0 };
    let well = ControllerInputs { cts: true, board: true, ..Default::default() };
    controller.step(&ControllerInputs { start: true, ..well }, &mut robot);
    let mut rest = data;
    // A tick: the panel, the kind of line and its length, bytes.
    while let [panel, kind, bytes @ ..] = rest {
        let (now, later) = bytes.split_at(bytes.len().min(usize::from(*kind & 0x3F)));
        rest = later;
        let inputs = ControllerInputs {
            rx: line(*kind, now, &robot.at),
            cts: panel & 0x01 == 0,
            board: panel & 0x02 == 0,
            transmitter_fault: panel & 0x04 != 0,
            start: panel & 0x08 != 0,
            hold: panel & 0x10 != 0,
            interrupt: panel & 0x20 != 0,
            enter: panel & 0x40 != 0,
            cancel: panel & 0x80 != 0,
        };
        let (state, moves) = (controller.state(), robot.moves);
        let out = controller.step(&inputs, &mut robot);
        assert_eq!(out.moving, robot.moves > moves);
        assert!(matches!(out.tx.length, 0 | 1 | 16));
        if out.moving {
            assert!(state == ControllerState::Running && robot.moves == moves + 1);
            assert!(!inputs.hold && !inputs.interrupt && inputs.cts && out.tx.as_slice() == [0x06]);
        }
        if inputs.transmitter_fault {
            assert_eq!(out.tx.length, 0);
        }
    }
    // What is left in the receiver may bring a warning; CANCEL, and CANCEL again for P-IG, then the program once more: at work.
    for _ in 0..4 {
        controller.step(&ControllerInputs { cancel: true, ..well }, &mut robot);
    }
    controller.step(&ControllerInputs { start: true, ..well }, &mut robot);
    assert_eq!(controller.state(), ControllerState::Running);
});
