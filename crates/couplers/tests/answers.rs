//! Twenty kinds of wrong answers, one at a time. No value of a wrong answer is used, no input is older than its report
//! claims, and inputs are fresh again within three ticks.

mod common;

use couplers::{
    Emulated, Fault, Kind, Link, MS, Mode, Orders, OutWords, Plan, Session, State, link::FrameFault,
};
use modbus::{Client, MOST_FRAME_BYTES, Request, Response};

use self::common::{CLAMP, TICK, VALVE, plan, words};

/// A value that only wrong answers have.
const POISON: u16 = 0xDEAD;
/// Register of the inputs that holds the time at which it was sampled, ms.
const SAMPLED: usize = 0;
const TIMEOUT: u64 = 15 * MS;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    OtherTransaction,
    PreviousTransaction,
    Protocol,
    Unit,
    Function,
    OtherFunction,
    LengthZero,
    LengthShort,
    LengthLong,
    ByteCountShort,
    ByteCountLong,
    ByteCountOdd,
    ByteCountZero,
    Truncated,
    ExtraByte,
    Empty,
    Busy,
    Failure,
    Previous,
    Lost,
    Closed,
}

const ALL: [Wrong; 21] = [
    Wrong::OtherTransaction,
    Wrong::PreviousTransaction,
    Wrong::Protocol,
    Wrong::Unit,
    Wrong::Function,
    Wrong::OtherFunction,
    Wrong::LengthZero,
    Wrong::LengthShort,
    Wrong::LengthLong,
    Wrong::ByteCountShort,
    Wrong::ByteCountLong,
    Wrong::ByteCountOdd,
    Wrong::ByteCountZero,
    Wrong::Truncated,
    Wrong::ExtraByte,
    Wrong::Empty,
    Wrong::Busy,
    Wrong::Failure,
    Wrong::Previous,
    Wrong::Lost,
    Wrong::Closed,
];

/// Changes an answer, and poisons its registers.
fn spoil(wrong: Wrong, answer: &mut Vec<u8>, previous: &[u8]) {
    if matches!(answer.get(7), Some(3 | 4 | 23)) {
        let registers = answer.get_mut(9..).unwrap_or_default();
        for pair in registers.chunks_exact_mut(2) {
            pair.copy_from_slice(&POISON.to_be_bytes());
        }
    }
    let length = u16::from_be_bytes([answer[4], answer[5]]);
    let mut set_length = |length: u16| answer[4..6].copy_from_slice(&length.to_be_bytes());
    match wrong {
        Wrong::OtherTransaction => answer[0] ^= 0x80,
        Wrong::PreviousTransaction => answer[1] = answer[1].wrapping_sub(1),
        Wrong::Protocol => answer[3] = 1,
        Wrong::Unit => answer[6] ^= 1,
        Wrong::Function => answer[7] = 43,
        Wrong::OtherFunction => answer[7] = if answer[7] == 3 { 4 } else { 3 },
        Wrong::LengthZero => set_length(0),
        Wrong::LengthShort => set_length(length - 1),
        Wrong::LengthLong => set_length(length + 1),
        Wrong::ByteCountShort => answer[8] = answer[8].wrapping_sub(2),
        Wrong::ByteCountLong => answer[8] = answer[8].wrapping_add(2),
        Wrong::ByteCountOdd => answer[8] ^= 1,
        Wrong::ByteCountZero => answer[8] = 0xFF,
        Wrong::Truncated => answer.truncate(answer.len() - 1),
        Wrong::ExtraByte => answer.push(0),
        Wrong::Empty => answer.clear(),
        Wrong::Busy | Wrong::Failure => {
            answer[7] |= 0x80;
            answer[8] = if wrong == Wrong::Busy { 6 } else { 4 };
            answer.truncate(9);
            answer[4..6].copy_from_slice(&3_u16.to_be_bytes());
        }
        Wrong::Previous => *answer = previous.to_vec(),
        Wrong::Lost | Wrong::Closed => {}
    }
}

/// A connection on which one answer is wrong.
struct Bad {
    client: Client,
    coupler: Emulated,
    now: u64,
    connections: u64,
    is_connected: bool,
    /// The number of answers until the wrong one.
    next: Option<(u32, Wrong)>,
    previous: Vec<u8>,
}

impl Link for Bad {
    fn now(&mut self) -> u64 {
        self.now
    }

    fn connect(&mut self) -> Result<(), Fault> {
        (self.connections, self.is_connected) = (self.connections + 1, true);
        Ok(())
    }

    fn exchange<'a>(
        &mut self,
        request: &Request<'_>,
        buffer: &'a mut [u8; MOST_FRAME_BYTES],
    ) -> Result<Response<'a>, Fault> {
        assert!(self.is_connected, "a request after the end of its connection");
        let mut frame = [0; MOST_FRAME_BYTES];
        let length = self.client.request(request, &mut frame)?;
        self.coupler.inputs_mut()[SAMPLED] = u16::try_from(self.now / MS).expect("a short run");
        let answered = self.coupler.answer(self.now, self.connections, &frame[..length], buffer);
        let mut answer = buffer[..answered.expect("a whole frame")].to_vec();
        let previous = std::mem::replace(&mut self.previous, answer.clone());
        match &mut self.next {
            Some((0, wrong)) => {
                let wrong = *wrong;
                self.next = None;
                spoil(wrong, &mut answer, &previous);
                match wrong {
                    Wrong::Lost => {
                        self.now += TIMEOUT;
                        return Err(Fault::NoAnswer);
                    }
                    Wrong::Closed => return Err(Fault::Disconnected),
                    _ => {}
                }
            }
            Some((left, _)) => *left -= 1,
            None => {}
        }
        buffer[..answer.len()].copy_from_slice(&answer);
        Ok(self.client.answer(request, &buffer[..answer.len()])?)
    }

    fn reset(&mut self) {
        self.is_connected = false;
    }
}

struct Run {
    session: Session,
    link: Bad,
    orders: Orders,
}

impl Run {
    fn running(plan: &Plan) -> Self {
        let link = Bad {
            client: Client::new(1),
            coupler: Emulated::new(plan.kind, 1, 4, 2),
            now: 0,
            connections: 0,
            is_connected: false,
            next: None,
            previous: Vec::new(),
        };
        let session = Session::new(plan.clone()).expect("a sound plan");
        let orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: words(VALVE | CLAMP) };
        let mut run = Self { session, link, orders };
        for _ in 0..5 {
            run.tick();
        }
        assert!(run.is_fresh());
        run
    }

    fn tick(&mut self) {
        self.orders.tick += 1;
        for offset in [1, 32] {
            self.link.now = self.link.now.max(self.orders.tick * TICK + offset * MS);
            self.session.exchange(&mut self.link, &self.orders);
            let report = self.session.report();
            assert!(!report.inputs.words.contains(&POISON), "{report:?}");
            let sampled = u64::from(report.inputs.words[SAMPLED]) * MS;
            assert!(report.read_at.is_none_or(|read_at| read_at / MS * MS <= sampled), "{report:?}");
        }
    }

    fn is_fresh(&self) -> bool {
        self.session.report().state == State::Running
            && self.session.report().is_valid(self.link.now, 40)
            && self.link.coupler.outputs()[0] == VALVE | CLAMP
    }
}

#[test]
fn no_value_of_a_wrong_answer_is_used() {
    for kind in [Kind::Bk9000, Kind::Ek9000, Kind::Wago, Kind::Turck] {
        // The first answers after the fault begins are those of data, and later ones those of the checks.
        for (wrong, after) in ALL.into_iter().flat_map(|wrong| (0..5).map(move |after| (wrong, after))) {
            let mut run = Run::running(&plan(kind));
            let failures = run.session.report().counters.failures;
            run.link.next = Some((after, wrong));
            while run.link.next.is_some() {
                run.tick();
            }
            let report = *run.session.report();
            if let State::Tripped(_) = report.state {
                assert!(wrong == Wrong::Failure, "{kind} {wrong:?} {after}: {report:?}");
                (run.orders.go, run.orders.words) = (1, OutWords { words: [0; couplers::MOST_OUT] });
                run.tick();
                run.orders.words = words(VALVE | CLAMP);
            } else {
                let counted = report.counters.failures - failures;
                // A new connection of an EK9000 also meets the write lock of the old one.
                let is_counted = counted == 1 || (kind == Kind::Ek9000 && counted > 1);
                assert!(is_counted, "{kind} {wrong:?} {after}: {report:?}");
            }
            let ticks = (0..3).find(|_| {
                let is_fresh = run.is_fresh();
                run.tick();
                is_fresh
            });
            assert!(ticks.is_some(), "{kind} {wrong:?} {after}: {:?}", run.session.report());
        }
    }
}

#[test]
fn wrong_answer_is_named_in_the_report() {
    for (wrong, named) in [
        (Wrong::OtherTransaction, FrameFault::Transaction),
        (Wrong::Protocol, FrameFault::Protocol),
        (Wrong::Unit, FrameFault::Unit),
        (Wrong::Function, FrameFault::Function),
        (Wrong::Truncated, FrameFault::Length),
        (Wrong::ByteCountOdd, FrameFault::Length),
    ] {
        let mut run = Run::running(&plan(Kind::Bk9000));
        run.link.next = Some((0, wrong));
        run.tick();
        assert_eq!(run.session.report().fault, Some(Fault::Frame(named)), "{wrong:?}");
    }
}
