//! Converts values to the words of devices and back.

use diagnostics::Source;
use interfaces::{
    device::JoystickBox,
    point::{Kind, Output},
};
use proptest::prelude::*;
use rcs_core::Plain as _;

use super::*;

const NOTHING: InWords = InWords::ZERO;
const OFF: OutWords = OutWords::ZERO;

fn station() -> Mapping {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/field/station.toml");
    let text = std::fs::read_to_string(path).unwrap();
    Mapping::parse(&Source { name: path.to_owned(), text: text.into() }).unwrap()
}

/// Carries inputs through the words of devices with these ages.
fn carried(mapping: &Mapping, inputs: &DeviceInputs, ages: [u32; 3]) -> DeviceInputs {
    let mut images = [NOTHING; 3];
    mapping.sample(inputs, &mut images);
    let mut arrived = DeviceInputs::default();
    mapping.apply(&seen(&images, ages), &mut arrived);
    arrived
}

fn seen(images: &[InWords; 3], ages: [u32; 3]) -> [Seen; 3] {
    let [a, b, c] = images;
    let [x, y, z] = ages;
    [(a, x), (b, y), (c, z)].map(|(words, age)| Seen { words: *words, age_ms: Some(age), is_tripped: false })
}

fn inputs() -> impl Strategy<Value = DeviceInputs> {
    let values = Input::all().map(|input| {
        let (least, most) = (*input.range().start(), *input.range().end());
        // The ends of a converter mean a broken wire, which its span of raw values cannot show here.
        let is_converter = matches!(input.kind(), Kind::Converter | Kind::Force);
        let inside = if is_converter { least + 1..=most - 1 } else { least..=most };
        inside.prop_map(move |value| (input, value))
    });
    values.collect::<Vec<_>>().prop_map(|values| {
        let mut inputs = DeviceInputs::default();
        for (input, value) in values {
            if !matches!(input.kind(), Kind::Cable | Kind::Camera) {
                input.write(&mut inputs, value);
            }
        }
        inputs
    })
}

fn outputs() -> impl Strategy<Value = DeviceOutputs> {
    let values = Output::all().map(|output| output.range().prop_map(move |value| (output, value)));
    values.collect::<Vec<_>>().prop_map(|values| {
        let mut outputs = DeviceOutputs::default();
        values.into_iter().for_each(|(output, value)| output.write(&mut outputs, value));
        outputs
    })
}

proptest! {
    #[test]
    fn inputs_survive_the_words_of_the_devices(inputs in inputs()) {
        let arrived = carried(&station(), &inputs, [7; 3]);
        for input in Input::all().filter(|input| !input.is_camera()) {
            prop_assert_eq!(input.read(&arrived), input.read(&inputs), "{}", input.name());
        }
        prop_assert_eq!(arrived.field, FieldHealth::default());
    }

    #[test]
    fn outputs_survive_the_words_of_the_devices(outputs in outputs()) {
        let mapping = station();
        let mut images = [OFF; 3];
        mapping.collect(&outputs, &mut images);
        let mut arrived = DeviceOutputs::default();
        mapping.spread(&images, &mut arrived);
        prop_assert_eq!(arrived, outputs);
    }

    #[test]
    fn any_words_give_values_in_range(words in prop::collection::vec(any::<u16>(), couplers::MOST_IN)) {
        let mapping = station();
        let image = InWords { words: words.try_into().unwrap() };
        let mut inputs = DeviceInputs::default();
        mapping.apply(&seen(&[image; 3], [7; 3]), &mut inputs);
        for input in Input::all().filter(|input| !input.is_camera()) {
            prop_assert!(input.range().contains(&input.read(&inputs)), "{}", input.name());
        }
    }
}

#[test]
fn old_words_keep_their_values_and_mark_their_group() {
    let mapping = station();
    let mut inputs = DeviceInputs::default();
    (inputs.grip.potentiometer, inputs.holsters.left, inputs.resolvers.valid) = (1893, 5, true);
    inputs.joystick = JoystickBox { velocity: 800, x: -300, frame: 1, hold: 2, ..JoystickBox::default() };
    // The devices are arm, fixture and pedestal, in the order of their names.
    let late = carried(&mapping, &inputs, [101, 7, 7]);
    assert_eq!((late.grip.potentiometer, late.holsters.left), (1893, 5), "never zeroed");
    assert_eq!((late.joystick.velocity, late.joystick.x, late.joystick.frame), (0, 0, 0), "released");
    assert_eq!(late.joystick.hold, 2, "suspended processes stay suspended");
    assert!(!late.resolvers.valid);
    let health = late.field;
    assert_eq!(
        (health.grip, health.force, health.any),
        (GroupHealth::Stale, GroupHealth::Stale, GroupHealth::Stale)
    );
    assert_eq!((health.holsters, health.hand), (GroupHealth::Fresh, GroupHealth::Fresh));
    let force = carried(&mapping, &inputs, [81, 7, 7]).field;
    assert_eq!(
        (force.force, force.grip, force.any),
        (GroupHealth::Stale, GroupHealth::Fresh, GroupHealth::Stale)
    );
    let fixture = carried(&mapping, &inputs, [7, 1001, 7]);
    assert_eq!((fixture.field.holsters, fixture.field.grip), (GroupHealth::Lost, GroupHealth::Fresh));
    assert_eq!(fixture.joystick.velocity, 0, "the robot ramps to rest whichever device is old");
}

#[test]
fn tripped_device_is_reported_while_its_words_are_new() {
    let mapping = station();
    let images = [NOTHING; 3];
    let mut devices = seen(&images, [7; 3]);
    devices[0].is_tripped = true;
    devices[1].age_ms = None;
    let mut inputs = DeviceInputs::default();
    mapping.apply(&devices, &mut inputs);
    assert_eq!((inputs.field.grip, inputs.field.holsters), (GroupHealth::Tripped, GroupHealth::Lost));
    assert_eq!(inputs.field.any, GroupHealth::Lost);
}

#[test]
fn outputs_that_are_on_are_found_unless_they_may_be() {
    let mapping = station();
    let mut images = [OFF; 3];
    let mut outputs = DeviceOutputs::default();
    (outputs.tool_grip.close, outputs.joystick_leds) = (true, 1);
    mapping.collect(&outputs, &mut images);
    assert_eq!(mapping.outputs_on(0, &images[0]).count(), 0);
    outputs.grip.bits = interfaces::device::valve::VENT;
    mapping.collect(&outputs, &mut images);
    let on: Vec<&str> = mapping.outputs_on(0, &images[0]).map(|point| point.name.as_str()).collect();
    assert_eq!(on, ["grip.vent"]);
    assert_eq!(mapping.outputs_on(1, &images[0]).count(), 0, "another device");
}

#[test]
fn gripper_on_the_robot_decides_on_the_line() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/field/station.toml");
    let own =
        "counts = [0, 4095], stale_ms = 100, by_gripper = { 2 = { raw = [0, 1000], counts = [205, 805] } } }";
    let text =
        std::fs::read_to_string(path).unwrap().replacen("counts = [0, 4095], stale_ms = 100 }", own, 1);
    let mapping = Mapping::parse(&Source { name: path.to_owned(), text: text.into() }).unwrap();
    let arrives = |gripper: u8, counts: u16| {
        let mut inputs = DeviceInputs::default();
        (inputs.quick_change.end_effector_id, inputs.grip.potentiometer) = (gripper, counts);
        let mut images = [NOTHING; 3];
        mapping.sample(&inputs, &mut images);
        (images[0].words[0], carried(&mapping, &inputs, [7; 3]).grip.potentiometer)
    };
    assert_eq!(arrives(2, 505), (500, 505));
    assert_eq!(arrives(1, 505).1, 505);
    assert_ne!(arrives(1, 505).0, 500);
}
