//! For any goals, the host never exceeds the controller's velocity limits: no warning D3 or D4.

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, Refusal, Robot, Warning},
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION, Report},
};
use geometry::{
    frame::{Frame, Vector, rotation_by},
    kinematics::T3,
};
use proptest::prelude::*;

struct Anywhere(Plate); // a robot for which only the velocity limits can refuse a position

impl Robot for Anywhere {
    fn present(&mut self) -> Plate {
        self.0
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.0 = *goal;
        Ok(())
    }
}

/// Far and near; every third is at a pole or slightly off it.
fn goals() -> impl Strategy<Value = Vec<Frame>> {
    let point = || prop_oneof![-90.0_f64..90.0, -1.0_f64..1.0];
    let turn = || -3.1_f64..3.1;
    let anywhere = (point(), point(), point(), turn(), turn(), turn()).prop_map(|(x, y, z, a, b, c)| Frame {
        position: Vector::new(x, y, z),
        rotation: rotation_by(&Vector::new(a, b, c)),
    });
    let pole =
        (point(), any::<i16>(), 0_i16..40, any::<bool>(), any::<i16>()).prop_map(|(x, d, lean, up, r)| {
            let e = if up { lean } else { 18_000 - lean };
            Frame {
                position: Vector::new(x, 0.0, 0.0),
                rotation: Plate { words: [0, 0, 0, d, e, r] }.to_frame().rotation,
            }
        });
    proptest::collection::vec(prop_oneof![2 => anywhere, 1 => pole], 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_sequence_of_goals_brings_a_velocity_warning(
        goals in goals(),
        silence_limit in 1_usize..120,
        period in (1_u16..=5).prop_map(|n| n * 10),
    ) {
        let limits = Limits::new(period).unwrap();
        let mut controller = Controller::new(limits);
        let mut robot = Anywhere(Plate { words: [0, -6293, -636, -9000, 13_500, 0] });
        let well = ControllerInputs { cts: true, board: true, ..Default::default() };
        let out = controller.step(&ControllerInputs { start: true, ..well }, &mut robot);
        let reported = Report::parse(out.tx.as_slice()).unwrap().plate;
        let mut position = Position::reported(reported, &T3);
        for goal in &goals {
            // The goal may change before it is reached.
            for _ in 0..silence_limit {
                let next = step(&position, goal, &T3, &limits).unwrap();
                position = next.position;
                let mut frame = [0; 16];
                DataCommand { function: NO_FUNCTION, plate: position.plate }.emit(&mut frame);
                let mut inputs = well;
                prop_assert_eq!(inputs.rx.extend(&frame), 16);
                controller.step(&inputs, &mut robot);
                prop_assert_eq!(controller.warning(), Warning::None);
                prop_assert_eq!(robot.0, position.plate);
                if next.reached {
                    break;
                }
            }
        }
    }
}
