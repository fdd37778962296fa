//! The contract of a device, with an emulated coupler in simulated time.

mod common;
#[path = "common/run.rs"]
mod run;

use couplers::{
    Area, Emulated, Fallback, Fault, InWords, Kind, MS, Mode, OutWords, Plan, Refusal, Simulated, Span,
    State, Trip, emulated::CouplerFault, link::FrameFault,
};
use proptest::prelude::*;
use rcs_core::Plain;

use self::{
    common::{CLAMP, CLOCK, TICK, VALVE, words},
    run::Run,
};

fn plan() -> Plan {
    common::plan(Kind::Bk9000)
}

fn running() -> Run {
    Run::running(plan())
}

#[test]
fn start_sets_the_watchdog_before_the_first_write() {
    let mut run = Run::of(plan());
    run.orders.mode = Mode::Watch;
    run.device.coupler_mut().inputs_mut()[3] = 77;
    run.ticks(3);
    let report = run.device.report();
    assert_eq!((report.state, report.inputs.words[3]), (State::Running, 77));
    assert!(report.is_valid(run.now, 100));
    assert_eq!(run.device.coupler().writes(), 0);
    run.orders.mode = Mode::Run;
    run.ticks(2);
    assert_eq!(run.outputs(), VALVE | CLAMP);
    // Without writes the watchdog fires after its time, because reading does not restart it.
    run.orders.mode = Mode::Watch;
    run.ticks(12);
    assert_eq!(run.device.coupler().fallbacks(), 0);
    run.ticks(2);
    assert_eq!((run.device.coupler().fallbacks(), run.outputs()), (1, 0));
}

#[test]
fn outputs_that_are_on_at_the_start_are_refused_by_name() {
    let mut run = Run::of(plan());
    run.device.coupler_mut().outputs_mut()[0] = VALVE | CLAMP;
    run.ticks(10);
    assert_eq!(run.state(), State::Starting);
    let report = run.device.report();
    assert_eq!(report.refusal, Some(Refusal::OutputsOn));
    assert_eq!(report.acknowledged.outside(&plan().rest), words(VALVE));
    assert_eq!(run.device.coupler().writes(), 0);
    run.orders.mode = Mode::Safe;
    run.ticks(2);
    assert_eq!((run.state(), run.outputs()), (State::Tripped(Trip::Ordered), 0));
}

#[test]
fn output_that_may_be_on_at_rest_is_adopted() {
    let mut run = Run::of(plan());
    run.device.coupler_mut().outputs_mut()[0] = CLAMP;
    run.orders.mode = Mode::Watch;
    run.ticks(3);
    assert_eq!((run.state(), run.device.report().acknowledged), (State::Running, words(CLAMP)));
    assert_eq!(run.outputs(), CLAMP);
}

/// A test of the inputs must not drop a part that an earlier run still holds.
#[test]
fn watched_device_that_trips_keeps_its_outputs() {
    let mut run = Run::of(plan());
    run.device.coupler_mut().outputs_mut()[0] = CLAMP;
    run.orders.mode = Mode::Watch;
    run.ticks(3);
    run.device.coupler_mut().set_fault(CouplerFault::Terminals(4));
    run.ticks(50);
    assert_eq!(run.state(), State::Tripped(Trip::Terminals(4)));
    assert_eq!((run.device.coupler().writes(), run.outputs()), (0, CLAMP));
}

#[test]
fn image_longer_than_that_of_the_device_is_refused() {
    let mut longer = plan();
    longer.reads[0].count = 5;
    let mut run = Run::of(longer);
    run.ticks(3);
    let Some(Refusal::Lengths(lengths)) = run.device.report().refusal else {
        panic!("{:?}", run.device.report())
    };
    assert_eq!((lengths.inputs_expected, lengths.inputs_found), (80, 64));
    assert_eq!((lengths.outputs_expected, lengths.outputs_found), (32, 32));
}

/// An active watchdog of an earlier run refuses other settings; the session waits until it has fired.
#[test]
fn watchdog_of_an_earlier_run_delays_the_start() {
    let mut earlier = running();
    earlier.orders.words = OutWords::ZERO;
    earlier.ticks(1);
    let mut other = plan();
    other.watchdog_ms = 300;
    let mut run = Run {
        device: Simulated::new(other, earlier.device.coupler().clone(), 15).expect("a sound plan"),
        now: earlier.now,
        ..earlier
    };
    run.ticks(2);
    let Some(Refusal::Register(register)) = run.device.report().refusal else { panic!("{:?}", run.state()) };
    assert_eq!((register.address, register.expected, register.found), (0x1120, 300, 500));
    run.ticks(12);
    assert_eq!(run.state(), State::Running);
}

#[test]
fn short_cut_changes_nothing() {
    let mut run = running();
    run.cut_for(1);
    run.ticks(2);
    let report = run.device.report();
    assert_eq!((report.state, report.counters.connections, report.counters.trips), (State::Running, 1, 0));
    assert!(report.counters.failures > 0);
}

#[test]
fn cut_shorter_than_the_watchdog_is_stale_and_continues() {
    let mut run = running();
    run.device.coupler_mut().inputs_mut()[0] = 5;
    run.ticks(1);
    run.device.cut(true);
    run.ticks(5);
    let report = *run.device.report();
    assert_eq!((report.state, report.inputs.words[0]), (State::Stale, 5));
    assert!(
        !report.is_valid(run.now, 100) && report.is_valid(run.now, 500),
        "a point may have a longer limit"
    );
    run.device.cut(false);
    run.ticks(2);
    let report = run.device.report();
    assert_eq!((report.state, report.counters.returns, report.counters.trips), (State::Running, 1, 0));
    assert!(report.is_valid(run.now, 100));
    assert_eq!(run.outputs(), VALVE | CLAMP);
}

/// A hung program may carry out the last request after the reset of the connection. Its outputs are then those sent
/// last, but not those acknowledged last.
#[test]
fn request_that_a_hanging_coupler_carries_out_late_is_no_trip() {
    let mut run = running();
    run.device.hang(true);
    run.ticks(5);
    assert_eq!(run.state(), State::Stale);
    let written = run.device.coupler().writes();
    run.device.hang(false);
    run.ticks(2);
    assert!(run.device.coupler().writes() > written);
    let report = run.device.report();
    assert_eq!((report.state, report.counters.returns, report.counters.trips), (State::Running, 1, 0));
}

#[test]
fn cut_longer_than_the_watchdog_trips_until_released() {
    let mut run = running();
    run.cut_for(25);
    assert_eq!((run.device.coupler().fallbacks(), run.outputs()), (1, 0));
    run.ticks(25);
    let State::Tripped(Trip::Gap(gap)) = run.state() else { panic!("{:?}", run.state()) };
    assert!((1000..1700).contains(&gap), "{gap} ms");
    assert!(run.device.report().is_valid(run.now, 100), "the inputs are read");
    // The release is refused while an output is commanded that may not be on at rest.
    run.orders.go = 1;
    run.ticks(3);
    assert_eq!((run.outputs(), run.device.report().counters.refused_releases), (0, 1));
    assert!(matches!(run.state(), State::Tripped(_)));
    run.orders.words = words(CLAMP);
    run.ticks(3);
    assert_eq!(run.outputs(), 0, "a refused release is not remembered");
    run.orders.go = 2;
    run.ticks(1);
    assert_eq!((run.state(), run.outputs()), (State::Running, CLAMP));
    assert_eq!(run.device.report().counters.trips, 1);
}

#[test]
fn release_of_an_absent_device_is_refused() {
    let mut run = running();
    run.cut_for(25);
    run.ticks(25);
    run.orders.words = words(CLAMP);
    run.device.cut(true);
    run.ticks(10);
    run.orders.go = 1;
    run.ticks(1);
    assert_eq!(run.device.report().counters.refused_releases, 1);
    run.device.cut(false);
    run.ticks(20);
    assert!(matches!(run.state(), State::Tripped(_)));
}

/// Outputs that were on show the restart; if all were off, only the settings show it.
#[test]
fn restarted_coupler_trips_before_an_output_is_on() {
    for (asked, cause) in [(VALVE | CLAMP, Trip::Outputs), (0, Trip::Settings)] {
        let mut run = running();
        run.orders.words = words(asked);
        // The clock word would also reveal the restart.
        run.is_alive = false;
        run.orders.words.words[CLOCK] = 0;
        run.orders.tick += 1;
        run.tick();
        run.device.restart();
        run.is_alive = true;
        let written = run.device.coupler().writes();
        for _ in 0..25 {
            run.orders.words = words(asked);
            run.tick();
            assert_eq!(run.outputs(), 0);
        }
        assert_eq!(run.state(), State::Tripped(cause));
        assert!(run.device.coupler().writes() > written, "the safe image is written");
        // The watchdog is set again: it fires after 500 ms.
        run.device.cut(true);
        run.ticks(13);
        assert_eq!(run.device.coupler().fallbacks(), 1);
    }
}

#[test]
fn lost_controller_makes_the_outputs_safe_once() {
    let mut run = running();
    run.is_alive = false;
    run.ticks(2);
    assert_eq!(run.outputs(), VALVE | CLAMP);
    let written = run.device.coupler().writes();
    // 121 ms after the last orders; the same image is written until then.
    run.device.exchange(run.now + MS, &run.orders);
    assert_eq!((run.state(), run.outputs()), (State::Silent, 0));
    assert_eq!(run.device.coupler().writes(), written + 1);
    run.ticks(14);
    assert_eq!(run.device.coupler().writes(), written + 1);
    assert_eq!(run.device.coupler().fallbacks(), 1, "the watchdog fires as well");
    run.is_alive = true;
    run.ticks(3);
    assert_eq!((run.state(), run.outputs()), (State::Tripped(Trip::NoOrders), 0));
}

/// The process was stopped for a time; the network is in order.
#[test]
fn stalled_thread_trips_before_an_output_is_on() {
    let mut run = running();
    run.now += 600 * MS;
    run.ticks(1);
    assert!(matches!(run.state(), State::Tripped(Trip::Gap(600..700))), "{:?}", run.state());
    run.ticks(3);
    assert_eq!(run.outputs(), 0);
}

#[test]
fn safe_orders_trip_at_once() {
    let mut run = running();
    run.orders.mode = Mode::Safe;
    run.ticks(1);
    assert_eq!((run.state(), run.outputs()), (State::Tripped(Trip::Ordered), 0));
    run.orders.mode = Mode::Run;
    run.ticks(5);
    assert_eq!(run.outputs(), 0, "only a release ends it");
}

#[test]
fn end_keeps_what_may_be_on_at_rest_and_is_confirmed() {
    let mut run = running();
    run.orders.mode = Mode::End;
    run.ticks(1);
    assert_eq!((run.state(), run.outputs()), (State::Ended(true), CLAMP));
    let written = run.device.coupler().writes();
    run.ticks(5);
    assert_eq!(run.device.coupler().writes(), written);
}

#[test]
fn end_without_an_answer_is_not_confirmed_within_200_ms() {
    let mut run = running();
    run.device.cut(true);
    run.orders.mode = Mode::End;
    run.ticks(5);
    assert_eq!(run.state(), State::Ended(false));
}

#[test]
fn frozen_inputs_trip_by_the_counter_of_the_program() {
    let mut counted = plan();
    counted.alive = Some(Span { area: Area::Input, first: 2, count: 1 });
    let mut run = Run::of(counted);
    let count = |run: &mut Run, ticks| {
        for _ in 0..ticks {
            run.device.coupler_mut().inputs_mut()[2] += 1;
            run.tick();
        }
    };
    count(&mut run, 100);
    assert_eq!(run.state(), State::Running);
    run.device.coupler_mut().set_fault(CouplerFault::Freeze);
    count(&mut run, 50);
    assert_eq!(run.state(), State::Tripped(Trip::Frozen), "within 2 s");
    assert!(!run.device.report().is_valid(run.now, 100));
}

#[test]
fn terminals_with_an_error_trip_and_make_the_inputs_invalid() {
    let mut run = running();
    run.device.coupler_mut().set_fault(CouplerFault::Terminals(4));
    run.ticks(26);
    assert_eq!(run.state(), State::Tripped(Trip::Terminals(4)));
    assert!(!run.device.report().is_valid(run.now, 100));
}

#[test]
fn late_answers_are_not_used() {
    let mut run = running();
    run.device.coupler_mut().set_fault(CouplerFault::Stale);
    run.device.coupler_mut().inputs_mut()[0] = 9;
    run.ticks(20);
    let report = *run.device.report();
    assert_eq!(report.fault, Some(Fault::Frame(FrameFault::Transaction)));
    assert_eq!(report.inputs.words[0], 0, "no value of a late answer is used");
    run.device.coupler_mut().set_fault(CouplerFault::None);
    run.ticks(30);
    assert_eq!(run.device.report().inputs.words[0], 9);
}

#[test]
fn bits_and_registers_share_an_image() {
    let mut mixed = plan();
    mixed.kind = Kind::Plain;
    mixed.fallback = Fallback::Hold;
    mixed.reads = vec![
        Span { area: Area::Discrete, first: 3, count: 18 },
        Span { area: Area::Input, first: 2, count: 2 },
    ];
    mixed.writes = vec![Span { area: Area::Coil, first: 0, count: 20 }];
    mixed.rest = mixed.written();
    assert_eq!(mixed.rest.words[..3], [0xFFFF, 0x000F, 0]);
    let coupler = Emulated::new(Kind::Plain, 1, 4, 2);
    let mut run = Run::of(plan());
    run.device = Simulated::new(mixed, coupler, 15).expect("a sound plan");
    *run.device.coupler_mut().inputs_mut() =
        std::array::from_fn(|index| [0x8008, 0x0014, 7, 8, 0][index.min(4)]);
    run.ticks(3);
    let mut expected = InWords::ZERO;
    expected.words[..4].copy_from_slice(&[0x9001, 0x0002, 7, 8]);
    assert_eq!(run.device.report().inputs, expected);
    assert_eq!(run.outputs(), VALVE | CLAMP);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// For any sequence of cuts: an image that is carried out is not older than `stale_ms` + 20 ms, and no output is on
    /// between a trip and the release. Once joined and released, the device runs.
    #[test]
    fn no_old_image_is_carried_out(
        kind in prop::sample::select(vec![Kind::Bk9000, Kind::Ek9000, Kind::Wago, Kind::Turck]),
        cuts in prop::collection::vec((1..40_u64, 1..40_u64, any::<bool>()), 1..12),
    ) {
        let mut run = Run::running(common::plan(kind));
        for (joined, cut, restart) in cuts {
            for (is_cut, ticks) in [(true, cut), (false, joined)] {
                run.device.cut(is_cut);
                if !is_cut && restart {
                    run.device.restart();
                }
                for _ in 0..ticks {
                    let written = run.device.coupler().writes();
                    run.tick();
                    let is_written = run.device.coupler().writes() > written;
                    let outputs = *run.device.coupler().outputs();
                    if is_written && outputs[0] != 0 {
                        let age = run.now - (u64::from(outputs[CLOCK]) - 1) * TICK;
                        prop_assert!(age <= 120 * MS, "{} ms", age / MS);
                    }
                    if matches!(run.state(), State::Tripped(_)) {
                        prop_assert_eq!(outputs[0], 0);
                        run.orders.words = OutWords::ZERO;
                        run.orders.go += u32::from(!is_cut);
                    } else {
                        run.orders.words = words(VALVE | CLAMP);
                    }
                }
            }
        }
        run.orders.words = OutWords::ZERO;
        for _ in 0..30 {
            run.orders.go += 1;
            run.tick();
        }
        prop_assert_eq!(run.state(), State::Running, "joined and released");
    }
}
