//! Each kind of coupler: what only it does, and that the contract holds. Addresses are literal, as in its manual.

mod common;
#[path = "common/run.rs"]
mod run;

use couplers::{
    Area, Emulated, Fallback, Fault, Kind, MS, Mode, Orders, OutWords, Plan, Refusal, Simulated, Span, State,
    Trip,
};
use modbus::{Bits, Client, Error, Exception, MOST_FRAME_BYTES, Request, Words, request::Range};
use rcs_core::Plain;

use self::{
    common::{CLAMP, CLOCK, TICK, VALVE, plan, words},
    run::Run,
};

/// Another client of a coupler, with the number of its connection.
const OTHER: u64 = 1000;

/// Sends a request of another client; returns the registers of the answer, or the exception.
fn ask(run: &mut Run, request: Request<'_>) -> Result<Vec<u16>, Exception> {
    asked(run.device.coupler_mut(), run.now, OTHER, &request)
}

fn asked(coupler: &mut Emulated, now: u64, from: u64, request: &Request<'_>) -> Result<Vec<u16>, Exception> {
    let (mut client, mut frame) = (Client::new(1), [0; MOST_FRAME_BYTES]);
    let length = client.request(request, &mut frame).expect("a legal request");
    let mut answer = [0; MOST_FRAME_BYTES];
    let length = coupler.answer(now, from, &frame[..length], &mut answer).expect("a whole frame");
    match client.answer(request, &answer[..length]) {
        Ok(response) => Ok(response.words().into_iter().flat_map(Words::iter).collect()),
        Err(Error::Refused(exception)) => Err(exception),
        Err(error) => panic!("{error}"),
    }
}

const fn read(first: u16, count: u16) -> Request<'static> {
    Request::ReadHoldingRegisters(Range { first, count })
}

const fn write(address: u16, value: u16) -> Request<'static> {
    Request::WriteRegister { address, value }
}

/// Ticks until a condition holds; returns the simulated time, ms.
fn until(run: &mut Run, condition: impl Fn(&Run) -> bool) -> u64 {
    let begun = run.now;
    while !condition(run) {
        run.tick();
        assert!(run.now - begun < 5000 * MS, "{:?}", run.device.report());
    }
    (run.now - begun) / MS
}

/// True if the newest image has arrived.
fn is_new(run: &Run) -> bool {
    u64::from(run.device.coupler().outputs()[CLOCK]) == run.orders.tick
}

#[test]
fn every_kind_keeps_the_contract() {
    for &kind in Kind::ALL {
        let mut run = Run::running(plan(kind));
        run.device.coupler_mut().inputs_mut()[3] = 77;
        run.cut_for(5);
        assert_eq!(run.state(), State::Stale, "{kind}");
        let limit = if kind == Kind::Ek9000 { 350 } else { 2 * TICK / MS };
        assert!(until(&mut run, is_new) <= limit, "{kind}");
        let report = *run.device.report();
        assert_eq!((report.state, report.counters.trips, report.inputs.words[3]), (State::Running, 0, 77));
        run.cut_for(30);
        let holds = plan(kind).fallback == Fallback::Hold;
        assert_eq!(run.outputs(), if holds { VALVE | CLAMP } else { 0 }, "{kind}");
        run.ticks(20);
        assert!(matches!(run.state(), State::Tripped(Trip::Gap(_))), "{kind} {:?}", run.state());
        assert_eq!(run.outputs(), 0, "{kind}");
        assert!(run.device.report().is_valid(run.now, 100), "{kind}");
        (run.orders.go, run.orders.words) = (1, words(CLAMP));
        run.ticks(2);
        assert_eq!((run.state(), run.outputs()), (State::Running, CLAMP), "{kind}");
        // The watchdog was set again.
        run.cut_for(30);
        assert_eq!(run.outputs(), if holds { CLAMP } else { 0 }, "{kind}");
        run.ticks(20);
        run.orders.go = 2;
        run.ticks(2);
        run.orders.mode = Mode::End;
        run.ticks(1);
        assert_eq!((run.state(), run.outputs()), (State::Ended(true), CLAMP), "{kind}");
    }
}

#[test]
fn restart_of_every_kind_trips_before_an_output_is_on() {
    for &kind in Kind::ALL {
        let mut run = Run::running(plan(kind));
        run.device.restart();
        run.ticks(5);
        assert_eq!((run.state(), run.outputs()), (State::Tripped(Trip::Outputs), 0), "{kind}");
    }
}

/// The registers of the manuals, read by another client while a session runs.
#[test]
fn settings_of_every_kind_are_those_of_its_manual() {
    let cases: [(Kind, &[(u16, u16)]); 4] = [
        (
            Kind::Bk9000,
            &[(0x1000, 0x424B), (0x1120, 500), (0x1122, 0), (0x100C, 0), (0x1010, 32), (0x1011, 64)],
        ),
        (Kind::Ek9000, &[(0x1120, 500), (0x1122, 0), (0x1123, 0), (0x1124, 1), (0x1040, 1), (0x1021, 0)]),
        (Kind::Wago, &[(0x1000, 5), (0x1001, 0xC000), (0x1002, 0), (0x1006, 1), (0x1022, 32), (0x1020, 0)]),
        (Kind::Turck, &[(0x1120, 500), (0x100C, 0)]),
    ];
    for (kind, registers) in cases {
        let mut run = Run::running(plan(kind));
        for (register, expected) in registers {
            assert_eq!(ask(&mut run, read(*register, 1)), Ok(vec![*expected]), "{kind} {register:#x}");
        }
    }
}

#[test]
fn ek9000_holds_its_outputs_if_asked_to() {
    let mut held = plan(Kind::Ek9000);
    held.fallback = Fallback::Hold;
    held.rest = held.written();
    let mut run = Run::running(held);
    assert_eq!(ask(&mut run, read(0x1123, 1)), Ok(vec![1]));
    run.cut_for(30);
    assert_eq!(run.outputs(), VALVE | CLAMP);
    run.ticks(5);
    assert!(matches!(run.state(), State::Tripped(Trip::Gap(_))), "{:?}", run.state());
    assert_eq!(run.outputs(), 0, "the safe image");
}

/// An earlier run on another connection was killed a moment ago.
#[test]
fn ek9000_locked_by_an_earlier_run_starts_after_half_the_watchdog() {
    let mut earlier = Run::running(plan(Kind::Ek9000));
    earlier.orders.words = words(CLAMP);
    earlier.ticks(1);
    let now = earlier.now;
    assert_eq!(
        asked(earlier.device.coupler_mut(), now, OTHER, &write(0x800, 1)),
        Err(Exception::ServerDeviceFailure)
    );
    let mut coupler = earlier.device.coupler().clone();
    coupler.advance(now);
    let image = [CLAMP, 0];
    let by_other = Request::WriteRegisters { first: 0x800, words: Words::new(&image) };
    // Another connection takes the lock over half the time later.
    assert_eq!(asked(&mut coupler, now + 251 * MS, OTHER, &by_other), Ok(vec![]));
    let device = Simulated::new(plan(Kind::Ek9000), coupler, 15).expect("a sound plan");
    let mut run = Run { device, now: now + 252 * MS, ..earlier };
    run.orders.words = words(CLAMP);
    let locked = until(&mut run, is_new);
    assert!((200..=350).contains(&locked), "{locked} ms");
    assert_eq!((run.state(), run.device.report().counters.trips), (State::Running, 0));
}

/// Inputs are read while the outputs are locked.
#[test]
fn ek9000_shows_inputs_while_its_outputs_are_locked() {
    let mut run = Run::running(plan(Kind::Ek9000));
    run.cut_for(4);
    run.device.coupler_mut().inputs_mut()[0] = 5;
    assert!(until(&mut run, |run| run.device.report().inputs.words[0] == 5) <= 2 * TICK / MS);
    assert!(!is_new(&run));
    assert_eq!(run.device.report().fault, Some(Fault::Exception(4)));
}

/// The time of an active watchdog cannot be set; the start is refused with the register until it has fired.
#[test]
fn time_of_an_active_watchdog_delays_the_start_and_is_named() {
    for (kind, register, expected, found) in
        [(Kind::Bk9000, 0x1120, 700, 500), (Kind::Ek9000, 0x1120, 700, 500), (Kind::Wago, 0x1006, 0, 1)]
    {
        let mut earlier = Run::running(plan(kind));
        earlier.orders.words = OutWords::ZERO;
        earlier.ticks(1);
        let mut other = plan(kind);
        other.watchdog_ms = 700;
        let coupler = earlier.device.coupler().clone();
        let device = Simulated::new(other, coupler, 15).expect("a sound plan");
        let mut run = Run { device, ..earlier };
        run.ticks(2);
        let Some(Refusal::Register(refused)) = run.device.report().refusal else {
            panic!("{kind} {:?}", run.device.report())
        };
        assert_eq!((refused.address, refused.expected, refused.found), (register, expected, found), "{kind}");
        assert!(until(&mut run, |run| run.state() == State::Running) <= 500 + 100, "{kind}");
    }
}

#[test]
fn wago_refuses_everything_after_its_watchdog_until_the_reset() {
    let mut run = Run::running(plan(Kind::Wago));
    run.cut_for(20);
    assert_eq!(run.device.coupler().fallbacks(), 1);
    for request in [read(0, 1), read(0x200, 1), read(0x1006, 1), write(0x200, 1), write(0x1000, 9)] {
        assert_eq!(ask(&mut run, request), Err(Exception::ServerDeviceFailure), "{request:?}");
    }
    // A new run finds it so.
    let coupler = run.device.coupler().clone();
    let device = Simulated::new(plan(Kind::Wago), coupler, 15).expect("a sound plan");
    let mut run = Run { device, ..run };
    assert!(until(&mut run, is_new) <= 100);
    assert_eq!(run.state(), State::Running);
}

/// Old firmware does not count function 23. Only the functions 15 and 16 are in the mask, and a session writes with 16.
#[test]
fn wago_watchdog_counts_only_functions_that_write() {
    let mut run = Run::running(plan(Kind::Wago));
    run.ticks(50);
    assert_eq!((run.device.coupler().fallbacks(), run.state()), (0, State::Running));
    run.is_alive = false;
    run.ticks(4);
    assert_eq!((run.state(), run.outputs()), (State::Silent, 0));
    let range = Range { first: 0, count: 1 };
    for _ in 0..14 {
        let both = Request::ReadWriteRegisters { read: range, first: 0x200, words: Words::new(&[0]) };
        let _ = ask(&mut run, both);
        let _ = ask(&mut run, write(0x200, 0));
        run.ticks(1);
    }
    assert_eq!(run.device.coupler().fallbacks(), 1);
}

#[test]
fn wago_device_without_outputs_is_not_watched() {
    let mut read_only = plan(Kind::Wago);
    (read_only.writes, read_only.rest) = (Vec::new(), OutWords::ZERO);
    let mut device = Run::of(read_only).device;
    for tick in 0..50 {
        let orders = Orders { tick, mode: Mode::Run, go: 0, words: OutWords::ZERO };
        device.exchange((1 + 40 * tick) * MS, &orders);
    }
    assert_eq!((device.report().state, device.coupler().fallbacks()), (State::Running, 0));
}

/// A client that only reads must not keep outputs on after the controller is lost.
#[test]
fn reading_client_does_not_keep_outputs_on() {
    for kind in [Kind::Bk9000, Kind::Ek9000, Kind::Wago] {
        let mut run = Run::running(plan(kind));
        let begun = run.now;
        while run.outputs() != 0 {
            run.now += 10 * MS;
            let _ = ask(&mut run, read(0, 4));
            assert!(run.now - begun <= 510 * MS, "{kind}");
        }
    }
}

#[test]
fn units_of_the_server_itself_are_answered_and_others_refused() {
    for (unit, fault) in [(0, None), (255, None), (7, Some(Fault::Exception(11)))] {
        let mut addressed = plan(Kind::Bk9000);
        addressed.unit = unit;
        let mut run = Run::of(addressed);
        run.ticks(5);
        assert_eq!(run.device.report().fault, fault, "unit {unit}");
        assert_eq!(run.state() == State::Running, fault.is_none(), "unit {unit}");
    }
}

#[test]
fn device_whose_connections_are_taken_is_connected_once_one_is_free() {
    let mut patient = plan(Kind::Bk9000);
    patient.watchdog_ms = 600;
    let mut run = Run::of(patient);
    run.device.fill(true);
    run.ticks(50);
    assert_eq!((run.state(), run.device.report().fault), (State::Starting, Some(Fault::NoConnection)));
    run.device.fill(false);
    assert!(until(&mut run, is_new) <= 600 / 2 + 100);
}

#[test]
fn values_of_the_device_are_its_outputs_after_the_fallback() {
    let mut by_hand = plan(Kind::Values);
    by_hand.safe = words(CLAMP);
    let mut run = Run::running(by_hand);
    run.orders.words = words(VALVE);
    run.ticks(1);
    run.device.cut(true);
    run.ticks(20);
    assert_eq!(run.outputs(), VALVE, "its time is a second");
    run.ticks(10);
    assert_eq!((run.outputs(), run.device.coupler().fallbacks()), (CLAMP, 1));
    let range = Range { first: 0, count: 1 };
    let both = Request::ReadWriteRegisters { read: range, first: 0, words: Words::new(&[0]) };
    assert_eq!(ask(&mut run, both), Err(Exception::IllegalFunction));
}

#[test]
fn turck_is_off_as_delivered_and_zero_with_a_time() {
    let mut coupler = Emulated::new(Kind::Turck, 1, 4, 2);
    assert_eq!(asked(&mut coupler, 0, 1, &write(0x800, 3)), Ok(vec![]));
    coupler.advance(60_000 * MS);
    assert_eq!(coupler.outputs()[0], 3);
    assert_eq!(asked(&mut coupler, 60_000 * MS, 1, &write(0x1120, 300)), Ok(vec![]));
    assert_eq!(asked(&mut coupler, 60_000 * MS, 1, &write(0x800, 3)), Ok(vec![]));
    coupler.advance(60_301 * MS);
    assert_eq!(coupler.outputs()[0], 0);
}

/// Bits and registers of a plan have their own addresses in the emulated coupler.
#[test]
fn plan_of_bits_and_registers_is_emulated() {
    for kind in [Kind::Plain, Kind::Values, Kind::Wago] {
        let coil = *kind.facts().coils.start() + 3;
        let mut mixed = plan(kind);
        mixed.reads.push(Span { area: Area::Discrete, first: 5, count: 20 });
        mixed.writes = vec![Span { area: Area::Coil, first: coil, count: 18 }];
        (mixed.rest, mixed.safe) = (mixed.written(), OutWords::ZERO);
        let mut coupler = Emulated::of(&mixed);
        let mut image = couplers::InWords::ZERO;
        image.words[..6].copy_from_slice(&[1, 2, 3, 4, 0x8001, 0x000A]);
        coupler.show(&mixed, &image);
        let mut device = Simulated::new(mixed.clone(), coupler, 15).expect("a sound plan");
        let mut orders = Orders { tick: 1, mode: Mode::Run, go: 0, words: words(0x8001) };
        orders.words.words[1] = 0x0002;
        for exchange in 0..4 {
            device.exchange((1 + 20 * exchange) * MS, &orders);
        }
        assert_eq!(device.report().state, State::Running, "{kind} {:?}", device.report());
        assert_eq!(device.report().inputs, image, "{kind}");
        assert_eq!(device.coupler().image(&mixed), orders.words, "{kind}");
        let off = [0];
        let single = Request::WriteCoils { first: coil, bits: Bits::new(&off, 1).expect("a bit") };
        assert_eq!(asked(device.coupler_mut(), 100 * MS, OTHER, &single), Ok(vec![]));
        assert_eq!(device.coupler().image(&mixed).words[0], 0x8000, "{kind}");
    }
}

#[test]
fn requests_that_a_kind_refuses_are_refused_by_the_plan() {
    let check = |kind, change: &dyn Fn(&mut Plan)| {
        let mut changed = plan(kind);
        change(&mut changed);
        changed.check().map_err(|error| error.to_string())
    };
    let long = check(Kind::Wago, &|plan| plan.writes[0].count = 101).unwrap_err();
    assert!(
        long.starts_with("101 output registers in one request, and kind wago accepts at most 100"),
        "{long}"
    );
    let coils = Span { area: Area::Coil, first: 0x200, count: 801 };
    assert!(check(Kind::Wago, &|plan| plan.writes = vec![coils]).is_err());
    let read_elsewhere = Span { area: Area::Coil, first: 0, count: 8 };
    let found = check(Kind::Wago, &|plan| plan.writes = vec![read_elsewhere]).unwrap_err();
    assert_eq!(found, "addresses 0x0000 to 0x0007 are not coils of kind wago");
    for (kind, wrong, right) in [
        (Kind::Wago, 450, 400),
        (Kind::Ek9000, 499, 500),
        (Kind::Ek9000, 60_001, 60_000),
        (Kind::Values, 1500, 2000),
    ] {
        assert!(check(kind, &|plan| plan.watchdog_ms = wrong).is_err(), "{kind} {wrong}");
        assert_eq!(check(kind, &|plan| plan.watchdog_ms = right), Ok(()), "{kind} {right}");
    }
    let on = |plan: &mut Plan| plan.safe = words(CLAMP);
    assert!(check(Kind::Turck, &on).is_err());
    assert_eq!(check(Kind::Values, &on), Ok(()));
    let holds = |plan: &mut Plan| plan.fallback = Fallback::Hold;
    assert!(check(Kind::Values, &holds).unwrap_err().contains("permitted at rest"));
}
