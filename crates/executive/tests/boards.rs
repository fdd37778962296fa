//! Boards in threads of one process give the same bits as one board and allocate nothing; a board that leaves or does
//! not match the run is detected. `tests/boards.rs` of the whole system tests the boards' programs.

use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread::{self, ScopedJoinHandle},
    time::Duration,
};

use closed_loop::{
    Present,
    course::{Course, Levels},
};
use executive::{
    alloc::Counting,
    boards::{
        Board, BoardData, Checked, Coordinator, Fingerprint, Lost, Member, MemberError,
        coordinator::BoardEvent, lost::LossReason, member::MemberEnd, pulse::RunCard,
    },
    memory::{self, RunName},
    runner::Runner,
};
use interfaces::{ExternalInputs, HwsCommand, device::single_step};
use rcs_core::{Plain as _, digest::Digest, name::Name16, tick::Tick};
use taskdata::{files::TaskData, load::Store};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations are counted for the whole process: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

const TIME_LIMIT: Duration = Duration::from_secs(30);
const FINGERPRINT: Fingerprint = Fingerprint { program: 1, data: 2, job: 3 };
const CARD: RunCard = RunCard { fingerprint: FINGERPRINT, real_time: false, start: Tick::BEFORE_START };

fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

/// Commands, actions at the joystick box, a gripper that appears and disappears, another generation.
fn external(tick: Tick) -> ExternalInputs {
    let mut external = ExternalInputs::default();
    let number = u32::try_from(tick.0 / 100).unwrap();
    let verbs = ["PAUSE", "MOVE", "DANCE", "MOVE"];
    let name = |text| Name16::new(text).unwrap();
    external.hws = HwsCommand {
        number,
        command: name(verbs[number as usize % verbs.len()]),
        destination: Some(name("SAFE")),
        ..HwsCommand::default()
    };
    let devices = &mut external.devices;
    devices.joystick.velocity = 1000;
    devices.joystick.hold = if (250..300).contains(&tick.0) { single_step::EMOVE } else { 0 };
    devices.joystick.single_step = if tick.0.is_multiple_of(7) { single_step::EMOVE } else { 0 };
    devices.quick_change.locked = true;
    devices.quick_change.end_effector_id = if tick.0 % 500 < 400 { 1 } else { 2 };
    devices.resolvers.valid = true;
    external.generation = u32::from(tick.0 > 300);
    external
}

struct Played<L, E> {
    course: Course<L>,
    runner: Runner<L>,
    error: Option<E>, // error of the levels, which has ended it
}

/// Run a number of ticks, or until the levels fail; call `before` ahead of each.
fn play<L, E>(levels: L, ticks: u64, mut before: impl FnMut(Tick)) -> Played<L, E>
where
    L: for<'a> Levels<TaskData<'a>, Error = E>,
{
    let (mut course, mut runner) = (Course::new(levels), Runner::new(None));
    let data = store().view();
    for tick in 1..=ticks {
        before(Tick(tick));
        if let Err(error) = runner.step(&mut course, &external(Tick(tick)), &data, 0) {
            return Played { course, runner, error: Some(error) };
        }
    }
    Played { course, runner, error: None }
}

struct Fixed;

impl BoardData for Fixed {
    fn generation(&mut self, generation: u32, _: u32) -> Option<TaskData<'_>> {
        (generation < 2).then(|| store().view())
    }

    fn check(&mut self, _: u32) -> Checked {
        Checked::ZERO
    }
}

/// Run a board in a thread, as `rcs-run board` runs it in a process.
fn board<'s>(
    scope: &'s thread::Scope<'s, '_>,
    name: &RunName,
    board: Board,
    stop: &'s AtomicBool,
) -> ScopedJoinHandle<'s, Result<MemberEnd, MemberError>> {
    let name = name.clone();
    scope.spawn(move || {
        let mut member = Member::join(&name, board, FINGERPRINT)?;
        member.run(Fixed, true, stop)
    })
}

#[test]
fn four_boards_compute_the_bits_of_one_and_allocate_nothing() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    const TICKS: u64 = 1500;
    let Played { course: one, .. } = play(Present::default(), TICKS, |_| ());
    let name = RunName::unique("bits");
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut coordinator = Coordinator::create(&name, &CARD).expect("this machine has shared memory");
        let boards: Vec<_> = Board::ALL.iter().map(|&b| board(scope, &name, b, &stop)).collect();
        let mut arrivals = 0;
        coordinator.gather(TIME_LIMIT, &stop, |_, _| arrivals += 1).expect("all come");
        assert_eq!(arrivals, 4);
        let Played { course: split, runner, error } = play(coordinator, TICKS, |_| ());
        assert_eq!(error, None);
        assert_eq!(split.digest(), one.digest());
        assert_ne!(one.digest(), Digest::new());
        assert_eq!(*split.levels().states(), one.levels().ladder().state());
        // All threads of this process are counted together, so each figure is that of all boards.
        assert_eq!(runner.allocations(), Some(0));
        for figures in split.levels().figures() {
            assert_eq!((figures.times.count(), figures.allocations), (TICKS, 0), "{}", figures.board);
        }
        let (tick, board) =
            (runner.times().summary(), split.levels().figures().next().unwrap().times.summary());
        println!(
            "tick p50 {} us, p99 {} us; board 2 p50 {} us, p99 {} us",
            tick.p50, tick.p99, board.p50, board.p99
        );
        drop(split);
        for board in boards {
            assert!(matches!(board.join().expect("no panic"), Ok(MemberEnd::Over)));
        }
    });
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
}

#[test]
fn a_board_that_leaves_stops_the_pulse_and_is_named() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let name = RunName::unique("leaves");
    let (stop, leave) = (AtomicBool::new(false), AtomicBool::new(false));
    thread::scope(|scope| {
        let mut coordinator = Coordinator::create(&name, &CARD).expect("this machine has shared memory");
        for &b in Board::ALL {
            board(scope, &name, b, if b == Board::Eight { &leave } else { &stop });
        }
        coordinator.gather(TIME_LIMIT, &stop, |_, _| ()).expect("all come");
        let Played { course, error: lost, .. } =
            play(coordinator, 500, |tick| leave.store(tick == Tick(400), Ordering::Relaxed));
        let lost: Lost = lost.expect("a board left");
        assert_eq!((lost.board, lost.how), (Board::Eight, LossReason::Left));
        // The flag is set while the board may still answer the previous tick.
        assert!((400..=401).contains(&lost.tick.0), "{lost}");
        assert_eq!(course.tick(), lost.tick.previous(), "the tick does not count");
        let text = lost.explain(&external(lost.tick).hws, course.memory());
        assert!(text.contains("board 8 (Quick Change, Grip,") && text.contains("left the run"), "{text}");
    });
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
}

#[test]
fn missing_boards_are_named() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let name = RunName::unique("missing");
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut coordinator = Coordinator::create(&name, &CARD).expect("this machine has shared memory");
        for &b in &[Board::Two, Board::Four, Board::Eight] {
            board(scope, &name, b, &stop);
        }
        let mut absent = Vec::new();
        let error = coordinator.gather(TIME_LIMIT, &stop, |event, missing| {
            assert!(matches!(event, BoardEvent::Came { .. }), "{event:?}");
            absent = missing.to_vec();
            stop.store(missing == [Board::Six], Ordering::Relaxed);
        });
        assert_eq!(absent, [Board::Six]);
        let error = error.expect_err("one is missing");
        assert_eq!(error.to_string(), "interrupted while waiting for board 6");
        let error = coordinator.gather(Duration::ZERO, &AtomicBool::new(false), |_, _| ());
        let error = error.expect_err("it does not come");
        assert_eq!(error.to_string(), "board 6 did not start within 0 s");
    });
}

#[test]
fn a_board_with_other_data_or_in_a_taken_place_is_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let name = RunName::unique("refused");
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let coordinator = Coordinator::create(&name, &CARD).expect("this machine has shared memory");
        let other = Fingerprint { data: 9, ..FINGERPRINT };
        let Err(error) = Member::join(&name, Board::Two, other) else { panic!("it has other data") };
        assert!(
            error.to_string().contains("board 2 cannot take part") && error.to_string().contains("--data")
        );
        let (joined, has_joined) = mpsc::channel();
        let (there, flag) = (name.clone(), &stop);
        let first = scope.spawn(move || {
            let mut member = Member::join(&there, Board::Two, FINGERPRINT)?;
            joined.send(()).expect("it is waited for");
            member.run(Fixed, true, flag)
        });
        has_joined.recv().expect("the first one joins");
        let second = Member::join(&name, Board::Two, FINGERPRINT);
        assert!(matches!(second, Err(MemberError::Taken { board: Board::Two, .. })));
        drop(coordinator);
        let end = first.join().expect("no panic");
        assert!(matches!(end, Ok(MemberEnd::Over)), "{end:?}");
        let late = Member::join(&name, Board::Two, FINGERPRINT);
        assert!(matches!(late, Err(MemberError::SharedMemory(_))), "the run is over");
    });
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
}

#[test]
fn a_replaced_board_behaves_like_restarted_processes() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    const TICKS: u64 = 800;
    let name = RunName::unique("replaced");
    let (stop, leave) = (AtomicBool::new(false), AtomicBool::new(false));
    thread::scope(|scope| {
        let mut coordinator = Coordinator::create(&name, &CARD).expect("this machine has shared memory");
        for &b in Board::ALL {
            board(scope, &name, b, if b == Board::Two { &leave } else { &stop });
        }
        coordinator.gather(TIME_LIMIT, &stop, |_, _| ()).expect("all come");
        let mut course = Course::new(coordinator);
        let data = store().view();
        let mut restarted = None;
        for tick in (1..=TICKS).map(Tick) {
            leave.store(tick == Tick(433), Ordering::Relaxed);
            while let Err(lost) = course.advance(&external(tick), &data) {
                assert_eq!((lost.board, lost.tick, restarted), (Board::Two, tick, None), "{lost}");
                restarted = Some(tick);
                board(scope, &name, Board::Two, &stop);
                course.levels_mut().await_successor(&lost, TIME_LIMIT, &stop, |_, _| ()).expect("one comes");
            }
        }
        let restarted = restarted.expect("a board left");
        assert!((433..=434).contains(&restarted.0));

        let mut one = Course::new(Present::default());
        for tick in (1..=TICKS).map(Tick) {
            if tick == restarted {
                Board::Two.processes().for_each(|process| one.levels_mut().restart(process));
            }
            let Ok(()) = one.advance(&external(tick), &data);
        }
        assert_eq!(course.digest(), one.digest());
        assert_eq!(course.memory(), one.memory());
        assert_eq!(course.levels().epochs(), &[2, 1, 1, 1]);
    });
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
}
