//! The bytes that distinguish states.
//!
//! The image of a time only says whether it is over its limit. The image of a command's time is its age, as long as an
//! echo may be due. A counter is limited to the value above which it makes no difference. The row that fired is left
//! out, because no process reads it.

use std::{any::TypeId, cell::RefCell, rc::Rc};

use interfaces::{EmoveOutputs, Reason, pose_range};
use levels::{
    emove::{self, tables::Step},
    execution::Outcome,
};
use rcs_core::{
    Plain,
    handshake::Commander,
    plain::{Schema, Writer},
    tick::Tick,
};

/// Ages that are kept exactly: one more than [`rcs_core::handshake::ECHO_LIMIT`].
const EXACT: u64 = 4;

type Counters = &'static [(&'static str, u8)];

enum Piece {
    Keep(usize),
    Skip(usize),
    Age(Option<Clock>), // the age of a tick; `None` if it is left out
    Count(u8),          // a byte that counts up to a greatest value
    /// The pieces of a value that is present only if its flag is set, with its size.
    Option(usize, Vec<Self>),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Clock {
    Sent,
    /// Only whether its age is over the limit counts.
    Other,
}

type Known = (TypeId, Counters, Rc<[Piece]>);

thread_local! {
    static PIECES: RefCell<Vec<Known>> = const { RefCell::new(Vec::new()) };
}

fn add_pieces(schema: &Schema, name: &str, counters: Counters, pieces: &mut Vec<Piece>) {
    match schema {
        Schema::Struct(record) if matches!(record.name, "Rows" | "Header") => {
            pieces.push(Piece::Skip(schema.size()));
        }
        Schema::Struct(record) => {
            record.fields.iter().for_each(|field| add_pieces(&field.schema, field.name, counters, pieces));
        }
        Schema::Option(of) => {
            let mut inner = Vec::new();
            add_pieces(of, name, counters, &mut inner);
            if inner.iter().all(|piece| matches!(piece, Piece::Keep(_))) {
                keep(schema.size(), pieces);
            } else {
                pieces.push(Piece::Option(of.size(), inner));
            }
        }
        Schema::Array(Schema::I32 | Schema::F64, _) => keep(schema.size(), pieces),
        Schema::Array(of, count) => (0..*count).for_each(|_| add_pieces(of, name, counters, pieces)),
        Schema::U64 if name != "variables" => pieces.push(Piece::Age(match name {
            "sent" => Some(Clock::Sent),
            _ => (!name.starts_with("cycle")).then_some(Clock::Other),
        })),
        Schema::U8 => match counters.iter().find(|(counter, _)| *counter == name) {
            Some((_, greatest)) => pieces.push(Piece::Count(*greatest)),
            None => keep(1, pieces),
        },
        _ => keep(schema.size(), pieces),
    }
}

fn keep(size: usize, pieces: &mut Vec<Piece>) {
    match pieces.last_mut() {
        Some(Piece::Keep(before)) => *before += size,
        _ => pieces.push(Piece::Keep(size)),
    }
}

pub struct Image {
    pub bytes: Vec<u8>,
    value: Vec<u8>,
    now: Tick,
    limit: u64, // ticks after which a time is over its limit
    counters: Counters,
}

impl Image {
    pub fn new(now: Tick, limit: u64, counters: Counters) -> Self {
        Self { bytes: Vec::with_capacity(1024), value: Vec::new(), now, limit, counters }
    }

    pub fn add<T: Plain + 'static>(&mut self, value: &T) {
        let pieces = PIECES.with_borrow_mut(|known| self.pieces_of::<T>(known));
        let mut bytes = std::mem::take(&mut self.value);
        bytes.resize(T::SIZE, 0);
        value.encode(&mut Writer::new(&mut bytes));
        let used = self.add_bytes(&pieces, &bytes);
        assert_eq!(used, bytes.len(), "the pieces are those of the bytes");
        self.value = bytes;
    }

    /// The pieces are cached in `known`.
    fn pieces_of<T: Plain + 'static>(&self, known: &mut Vec<Known>) -> Rc<[Piece]> {
        let of = TypeId::of::<T>();
        if let Some((.., pieces)) =
            known.iter().find(|(id, counters, _)| *id == of && std::ptr::eq(*counters, self.counters))
        {
            return Rc::clone(pieces);
        }
        let mut pieces = Vec::new();
        add_pieces(&T::SCHEMA, "", self.counters, &mut pieces);
        let pieces: Rc<[Piece]> = pieces.into();
        known.push((of, self.counters, Rc::clone(&pieces)));
        pieces
    }

    fn add_bytes(&mut self, pieces: &[Piece], bytes: &[u8]) -> usize {
        let mut at = 0;
        for piece in pieces {
            at += match piece {
                Piece::Keep(size) => {
                    self.bytes.extend_from_slice(&bytes[at..at + size]);
                    *size
                }
                Piece::Skip(size) => *size,
                Piece::Age(clock) => {
                    let word = bytes[at..].first_chunk().expect("a tick has eight bytes");
                    let age = self.now.0.saturating_sub(u64::from_le_bytes(*word));
                    let rank = match clock {
                        _ if age > self.limit => EXACT + 2,
                        Some(Clock::Sent) => age.min(EXACT + 1),
                        _ => 0,
                    };
                    self.bytes.extend(clock.and_then(|_| u8::try_from(rank).ok()));
                    8
                }
                Piece::Count(greatest) => {
                    self.bytes.push(bytes[at].min(*greatest));
                    1
                }
                Piece::Option(size, inner) => {
                    self.bytes.push(bytes[at]);
                    if bytes[at] != 0 {
                        self.add_bytes(inner, &bytes[at + 1..]);
                    }
                    1 + size
                }
            };
        }
        at
    }
}

/// Restart the numbers at 1, since they would never repeat. The send time matters until the echo.
pub fn rebase(commander: &mut Commander, numbers: &mut [&mut u32]) {
    let mut all = vec![&mut commander.number];
    all.extend(numbers.iter_mut().map(|number| &mut **number));
    if rebase_echoes(&mut all) {
        commander.sent = Tick::BEFORE_START;
    }
}

/// The same for a commander outside the pair. Returns whether all numbers are equal.
pub fn rebase_echoes(numbers: &mut [&mut u32]) -> bool {
    let least = numbers.iter().map(|number| **number).filter(|number| *number != 0).min();
    let Some(before) = least.map(|least| least - 1) else { return false };
    numbers.iter_mut().for_each(|number| **number = number.saturating_sub(before));
    numbers.iter().all(|number| **number == 1)
}

/// Number the current records of E-move in their order, and all others as one.
pub fn renumber_poses(emove: &mut emove::State, out: &mut EmoveOutputs) {
    let (first, others) = (pose_range::EMOVE | 1, pose_range::EMOVE | 9);
    let stand = out.poses.map(|record| record.number);
    let renamed = |number: u32| {
        let at = stand.iter().position(|stands| *stands == Some(number));
        at.map_or(others, |at| first + u32::try_from(at).unwrap_or_default())
    };
    for record in &mut out.poses {
        record.number = record.number.map(renamed);
    }
    if out.prim.pose & pose_range::WRITER == pose_range::EMOVE {
        out.prim.pose = renamed(out.prim.pose);
    }
    let (route, last) = emove.motion.pose_numbers();
    if let Some(route) = route {
        (route.departure, route.goal) = (renamed(route.departure), renamed(route.goal));
    }
    *last = others;
}

/// No row tests the reason, the nearest places, or an idle E-move's command. Returns whether it executes a command.
pub fn forget(emove: &mut emove::State) -> bool {
    emove.execution.reason = Reason::None;
    emove.localization.forget_surroundings();
    let executes = emove.execution.outcome == Outcome::Executing && !emove.execution.waiting;
    if !executes {
        if !matches!(emove.step, Step::EPause(_)) {
            emove.step = Step::default();
        }
        (emove.ordered, emove.uses_prim) = Default::default();
        emove.execution.last_order = None;
        emove.ordered_at = Default::default();
        emove.motion.forget_flight();
        emove.vision.begin();
        emove.held.begin();
    }
    emove.held.forget_unread();
    executes
}
