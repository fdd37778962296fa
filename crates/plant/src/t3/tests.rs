//! The start-up of IV.3.3, step by step.

use super::{off_printed_home as off, *};
use depc::controller::{ControllerState, Warning};
use depc::wire::{DataCommand, FRAME_BYTES, Report};

/// The report at HOME, calculated from appendix A.
const HOME_REPORT: [u8; 16] =
    [0xFF, 0xFF, 0x03, 0x00, 0x00, 0xE7, 0x6B, 0xFD, 0x84, 0xDC, 0xD8, 0x34, 0xBC, 0x00, 0x00, 0x7A];

fn t3() -> T3Controller {
    T3Controller::dark(Limits::NBS, &Actuators::default(), 1)
}

/// Let `seconds` pass in periods with a host on the line. Returns the sent bytes.
fn pass(t3: &mut T3Controller, seconds: f64) -> Vec<u8> {
    let mut sent = Vec::new();
    for _ in 0..(seconds / 0.04).ceil() as u32 {
        sent.extend(step(t3, &[], true));
    }
    sent
}

fn step(t3: &mut T3Controller, rx: &[u8], cts: bool) -> Vec<u8> {
    let mut inputs = StepInputs { cts, ..StepInputs::default() };
    assert_eq!(inputs.rx.extend(rx), rx.len());
    let tool = t3.arm().tool_weight();
    t3.advance(0.04, &[tool]);
    t3.step(&inputs).tx.as_slice().to_vec()
}

fn manual() -> T3Controller {
    let mut t3 = t3();
    for key in [Key::ControlPower(true), Key::FaultReset, Key::Hydraulics(true), Key::Manual(true)] {
        t3.press(key).unwrap();
    }
    pass(&mut t3, 4.0);
    assert_eq!(t3.stage(), Stage::Manual);
    t3
}

fn auto() -> T3Controller {
    let mut t3 = manual();
    t3.press(Key::Align(None)).unwrap();
    pass(&mut t3, 8.0);
    t3.press(Key::Auto).unwrap();
    pass(&mut t3, 3.0);
    assert_eq!(t3.stage(), Stage::Auto);
    t3
}

fn running() -> T3Controller {
    let mut t3 = auto();
    t3.press(Key::CycleStart).unwrap();
    let sent = pass(&mut t3, 6.0);
    assert_eq!(sent.first_chunk::<16>().map(|f| Report::parse(f).is_ok()), Some(true), "{sent:02X?}");
    t3.messages();
    t3
}

fn frame(words: [i16; 6], function: [u8; 2]) -> [u8; FRAME_BYTES] {
    let mut bytes = [0; FRAME_BYTES];
    DataCommand { function, plate: Plate { words } }.emit(&mut bytes);
    bytes
}

#[test]
fn steps_of_the_manual_end_with_a_report_of_home() {
    let mut t3 = auto();
    assert!(off(&t3.position()) <= HOME_TOLERANCE, "{:?}", t3.position());
    t3.press(Key::CycleStart).unwrap();
    let mut highest = i32::MIN;
    let mut sent = Vec::new();
    while sent.is_empty() {
        sent = step(&mut t3, &[], true);
        highest = highest.max(t3.position().tool[2]);
    }
    assert_eq!(sent, HOME_REPORT);
    assert!((highest - (-1483 + 100)).abs() <= 5, "{highest}");
    assert_eq!(t3.stage(), Stage::Depc);
    assert!(off(&t3.position()) <= HOME_TOLERANCE);
}

#[test]
fn missing_board_is_detected_when_the_function_begins() {
    let mut t3 = auto();
    assert_eq!(t3.press(Key::Board(false)), Err(Refusal::Powered));
    t3.press(Key::ControlPower(false)).unwrap();
    t3.press(Key::Board(false)).unwrap();
    for key in [Key::ControlPower(true), Key::FaultReset, Key::Hydraulics(true), Key::Manual(true)] {
        t3.press(key).unwrap();
    }
    pass(&mut t3, 4.0);
    t3.press(Key::Align(None)).unwrap();
    pass(&mut t3, 8.0);
    t3.press(Key::Auto).unwrap();
    pass(&mut t3, 3.0);
    t3.press(Key::CycleStart).unwrap();
    assert_eq!(pass(&mut t3, 6.0), []);
    assert_eq!((t3.depc().state(), t3.depc().warning()), (ControllerState::Warning, Warning::BoardMissing));
    assert!(t3.messages().contains(&Message::Warning(Warning::BoardMissing)));
    // ENTER repeats the check.
    t3.press(Key::Enter).unwrap();
    assert_eq!(pass(&mut t3, 0.2), []);
    assert_eq!(t3.depc().warning(), Warning::BoardMissing);
}

/// IV.1 steps 2 and 5: the error stays, and FAULT RESET has no effect, until the Prim Interface Box has power.
#[test]
fn fault_resets_only_with_the_prim_interface_box() {
    let mut t3 = t3();
    assert_eq!(t3.error(), None);
    t3.press(Key::PrimBox(false)).unwrap();
    t3.press(Key::ControlPower(true)).unwrap();
    assert_eq!(t3.error(), Some("ERROR-E22"));
    assert_eq!(t3.press(Key::FaultReset), Err(Refusal::PrimBoxOff));
    t3.press(Key::PrimBox(true)).unwrap();
    t3.press(Key::FaultReset).unwrap();
    assert_eq!(t3.error(), None);
    let mut t3 = running();
    t3.press(Key::PrimBox(false)).unwrap();
    assert_eq!((t3.error(), t3.cut()), (Some("ERROR-E22"), Some(Cut::PrimBox)));
}

/// IV.3.4: after INTERRUPT and CANCEL twice the pendant moves single axes near HOME.
#[test]
fn pendant_turns_single_axes_in_manual_mode() {
    let mut t3 = running();
    let jog = |axis, degrees| Key::Jog { axis, degrees };
    assert_eq!(t3.press(jog(1, 5)), Err(Refusal::Running));
    for key in [Key::Interrupt, Key::Cancel, Key::Cancel] {
        t3.press(key).unwrap();
        pass(&mut t3, 0.2);
    }
    assert_eq!(t3.stage(), Stage::PreManual);
    let before = *t3.arm().joints();
    t3.press(jog(1, -5)).unwrap();
    pass(&mut t3, 4.0);
    let turned = *t3.arm().joints();
    assert!((turned[0] - before[0] + 5_f64.to_radians()).abs() < 0.01, "{turned:?}");
    assert!((1..6).all(|joint| (turned[joint] - before[joint]).abs() < 0.01), "{turned:?}");
    assert!(!t3.aligned()[0], "it stands off its arrow");
    assert_eq!(t3.press(jog(7, 5)), Err(Refusal::NoAxis(7)));
    let far = (0..40).find_map(|_| {
        let refused = t3.press(jog(4, 20)).err();
        pass(&mut t3, 8.0);
        refused
    });
    assert_eq!(far, Some(Refusal::Limit(4)));
    t3.press(Key::Auto).unwrap();
    assert_eq!(t3.press(jog(1, 5)), Err(Refusal::Moving));
}

#[test]
fn broken_transmitter_is_detected_at_the_next_answer() {
    let mut t3 = running();
    t3.press(Key::Transmitter(false)).unwrap();
    assert_eq!(pass(&mut t3, 0.2), []);
    assert_eq!(t3.depc().warning(), Warning::None, "no answer was due");
    assert_eq!(step(&mut t3, &[0x05], true), []);
    assert_eq!(t3.depc().warning(), Warning::Transmitter);
    t3.press(Key::Enter).unwrap();
    assert_eq!(pass(&mut t3, 0.2), []);
    assert_eq!(t3.depc().warning(), Warning::Transmitter);
    t3.press(Key::Transmitter(true)).unwrap();
    t3.press(Key::Enter).unwrap();
    assert_eq!(pass(&mut t3, 0.2).len(), 16);
    assert_eq!(t3.depc().state(), ControllerState::Running);
}

#[test]
fn arm_jumps_twice_during_start_up() {
    let mut t3 = t3();
    for key in [Key::ControlPower(true), Key::FaultReset, Key::Hydraulics(true), Key::Manual(true)] {
        t3.press(key).unwrap();
    }
    let below = t3.arm().tool().position;
    pass(&mut t3, 0.4);
    assert!((t3.arm().tool().position - below).norm() < 0.01, "the pressure comes after a delay");
    pass(&mut t3, 3.0);
    let jump = t3.arm().tool().position - below;
    assert!(jump.z > 2.0 && (5.0..12.0).contains(&jump.norm()), "{jump}");
    t3.press(Key::Align(None)).unwrap();
    pass(&mut t3, 8.0);
    assert_eq!(t3.aligned(), [true; 6]);
    assert!(off(&t3.position()) > HOME_TOLERANCE, "arrows are set by eye");
    t3.press(Key::Auto).unwrap();
    pass(&mut t3, 3.0);
    assert!(off(&t3.position()) <= HOME_TOLERANCE);
}

#[test]
fn steps_out_of_order_are_refused_without_effect() {
    let all = [
        Key::ControlPower(true),
        Key::FaultReset,
        Key::Hydraulics(true),
        Key::Manual(true),
        Key::Align(None),
        Key::Auto,
        Key::CycleStart,
    ];
    let order = [
        (Stage::Dark, vec![Refusal::NoPower; 6]),
        (
            Stage::Faulted,
            vec![Refusal::Fault, Refusal::Fault, Refusal::NoPressure, Refusal::NoPressure, Refusal::NotAuto],
        ),
        (Stage::Ready, vec![Refusal::NotEnabled, Refusal::NoPressure, Refusal::NoPressure, Refusal::NotAuto]),
        (Stage::Enabled, vec![Refusal::NoPressure, Refusal::NoPressure, Refusal::NotAuto]),
        (Stage::Manual, vec![Refusal::NotAligned, Refusal::NotAuto]),
    ];
    let mut t3 = t3();
    for (done, (stage, refusals)) in order.into_iter().enumerate() {
        for (key, refusal) in all[done + 1..].iter().zip(refusals) {
            assert_eq!((t3.press(*key), t3.stage()), (Err(refusal), stage), "{key:?}");
        }
        t3.press(all[done]).unwrap();
        pass(&mut t3, 4.0);
    }
    assert_eq!(t3.press(Key::CycleStart), Err(Refusal::NotAuto));
    t3.press(Key::Auto).unwrap();
    assert_eq!(t3.press(Key::CycleStart), Err(Refusal::Moving));
    assert_eq!(t3.press(Key::Enter), Err(Refusal::NothingToAnswer));
}

#[test]
fn axes_are_aligned_one_by_one() {
    let mut t3 = manual();
    t3.press(Key::Align(Some(3))).unwrap();
    assert_eq!(t3.press(Key::Align(Some(4))), Err(Refusal::Moving));
    pass(&mut t3, 8.0);
    assert_eq!(t3.aligned(), [false, false, true, false, false, false]);
    assert_eq!(t3.press(Key::Auto), Err(Refusal::NotAligned));
}

#[test]
fn wd_error_is_cleared_by_step_12() {
    let mut t3 = auto();
    t3.press(Key::CycleStart).unwrap();
    for _ in 0..200 {
        assert_eq!(step(&mut t3, &[], false), []);
    }
    assert!(t3.messages().contains(&Message::Warning(Warning::CtsLow)));
    assert_eq!(t3.press(Key::Auto), Err(Refusal::Warned));
    for key in [Key::Interrupt, Key::Cancel, Key::Cancel] {
        t3.press(key).unwrap();
        step(&mut t3, &[], true);
    }
    assert!(t3.messages().contains(&Message::Warning(Warning::Terminated)));
    assert_eq!(t3.stage(), Stage::PreManual);
    t3.press(Key::Auto).unwrap();
    pass(&mut t3, 3.0);
    t3.press(Key::CycleStart).unwrap();
    assert_eq!(pass(&mut t3, 6.0), HOME_REPORT);
}

#[test]
fn enter_restarts_at_the_place_of_the_robot() {
    let mut t3 = running();
    assert_eq!(step(&mut t3, &frame([30, -6293, -636, -9000, 13500, 0], [0; 2]), true), [0x06]);
    assert_eq!(step(&mut t3, &[], false), []);
    assert_eq!(t3.messages(), [Message::Warning(Warning::CtsLow)]);
    t3.press(Key::Enter).unwrap();
    let report = step(&mut t3, &[], true);
    assert_eq!(Report::parse(&report).unwrap().plate.words, [30, -6293, -636, -9000, 13500, 0]);
    // A move too far: ACK, then the warning, and the robot does not move.
    assert_eq!(step(&mut t3, &frame([90, -6293, -636, -9000, 13500, 0], [0; 2]), true), [0x06]);
    assert!(t3.messages().contains(&Message::Warning(Warning::Translation)));
    t3.press(Key::Enter).unwrap();
    assert_eq!(step(&mut t3, &[], true), report);
}

#[test]
fn arm_follows_points_and_functions_run_on_arrival() {
    let mut t3 = running();
    for count in 1..=50_i16 {
        let sent = step(&mut t3, &frame([count * 20, -6293, -636, -9000, 13500, 0], [7, 9]), true);
        assert_eq!(sent, [0x06]);
    }
    pass(&mut t3, 2.0);
    assert!((t3.position().tool[0] - 1000).abs() <= 2, "{:?}", t3.position());
    assert_eq!(t3.counts(), Counts { moves: 50, naks: 0, reports: 1 });
    assert_eq!(t3.messages(), vec![Message::Function([7, 9]); 50]);
}

#[test]
fn cancelled_program_moves_home_and_can_begin_again() {
    let mut t3 = running();
    for count in 1..=20_i16 {
        step(&mut t3, &frame([count * 50, -6293, -636, -9000, 13500, 0], [0; 2]), true);
    }
    assert_eq!(step(&mut t3, &[0x18], true), [0x06]);
    assert_eq!((t3.stage(), step(&mut t3, &[0x05], true)), (Stage::Homing, vec![]));
    pass(&mut t3, 5.0);
    assert_eq!(t3.stage(), Stage::Auto);
    t3.press(Key::CycleStart).unwrap();
    assert_eq!(pass(&mut t3, 6.0), HOME_REPORT);
}

#[test]
fn emergency_stop_requires_the_whole_start_up() {
    let mut t3 = running();
    t3.press(Key::Press(EStop::Terminals)).unwrap();
    let before = t3.position().tool[2];
    assert_eq!(step(&mut t3, &[0x05], true), []);
    pass(&mut t3, 10.0);
    assert!(before - t3.position().tool[2] > 500);
    assert_eq!((t3.stage(), t3.aligned()), (Stage::Faulted, [false; 6]));
    assert_eq!(t3.press(Key::Hydraulics(true)), Err(Refusal::Fault));
    assert_eq!(t3.press(Key::FaultReset), Err(Refusal::Pressed(EStop::Terminals)));
    assert_eq!(t3.press(Key::Release(EStop::Pedestal)), Err(Refusal::NotPressed(EStop::Pedestal)));
    t3.press(Key::Release(EStop::Terminals)).unwrap();
    assert_eq!(t3.stage(), Stage::Faulted, "nothing comes back by itself");
    t3.press(Key::FaultReset).unwrap();
    assert_eq!(t3.press(Key::Manual(true)), Err(Refusal::NotEnabled));
    assert_eq!(t3.cut(), Some(Cut::EStop(EStop::Terminals)));
}

#[test]
fn hold_stops_and_interrupt_ends_program_motions() {
    let mut t3 = auto();
    t3.press(Key::CycleStart).unwrap();
    pass(&mut t3, 0.2);
    t3.press(Key::Hold(true)).unwrap();
    pass(&mut t3, 1.0);
    let held = t3.position();
    pass(&mut t3, 5.0);
    assert_eq!((t3.position(), t3.stage()), (held, Stage::Rehearsing));
    t3.press(Key::Interrupt).unwrap();
    assert_eq!(t3.stage(), Stage::PreManual);
}

#[test]
fn equal_seeds_give_equal_start_ups() {
    let morning = |seed| T3Controller::dark(Limits::NBS, &Actuators::default(), seed).position();
    assert_eq!(morning(3), morning(3));
    assert_ne!(morning(3), morning(4));
}
