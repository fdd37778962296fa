//! The bytes by which states are told apart.
//!
//! A time enters as whether it is over its limit; the time of a command as its age, while an echo may be due. A counter
//! enters up to the value from which on it makes no difference. The row that fired is left out: no process reads it.

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

/// Ages that count exactly: one more than [`rcs_core::handshake::ECHO_LIMIT`].
const EXACT: u64 = 4;

/// A state as bytes.
pub struct Image {
    pub bytes: Vec<u8>,
    now: Tick,
    /// Ticks after which a time is over its limit.
    limit: u64,
    /// Fields of one byte, by name, that count up to a greatest value.
    counters: &'static [(&'static str, u8)],
}

impl Image {
    pub fn new(now: Tick, limit: u64, counters: &'static [(&'static str, u8)]) -> Self {
        Self { bytes: Vec::with_capacity(256), now, limit, counters }
    }

    /// Add a value without what does not count.
    pub fn add<T: Plain>(&mut self, value: &T) {
        let mut bytes = vec![0; T::SIZE];
        value.encode(&mut Writer::new(&mut bytes));
        let used = self.walk(&T::SCHEMA, "", &bytes);
        assert_eq!(used, bytes.len(), "the schema is that of the bytes");
    }

    /// Add what counts of a field; its size.
    fn walk(&mut self, schema: &Schema, name: &str, bytes: &[u8]) -> usize {
        match schema {
            Schema::Struct(record) if matches!(record.name, "Rows" | "Header") => schema.size(),
            Schema::Struct(record) => {
                let mut at = 0;
                for field in record.fields {
                    at += self.walk(&field.schema, field.name, &bytes[at..]);
                }
                at
            }
            Schema::Option(of) => {
                self.bytes.push(bytes[0]);
                1 + if bytes[0] == 0 { of.size() } else { self.walk(of, name, &bytes[1..]) }
            }
            Schema::Array(Schema::I32 | Schema::F64, _) => {
                let size = schema.size();
                self.bytes.extend_from_slice(&bytes[..size]);
                size
            }
            Schema::Array(of, count) => {
                let mut at = 0;
                for _ in 0..*count {
                    at += self.walk(of, name, &bytes[at..]);
                }
                at
            }
            Schema::U64 if name != "variables" => {
                let mut word = [0; 8];
                word.copy_from_slice(&bytes[..8]);
                let age = self.now.0.saturating_sub(u64::from_le_bytes(word));
                let rank = match name {
                    _ if age > self.limit => EXACT + 2,
                    "sent" => age.min(EXACT + 1),
                    _ => 0,
                };
                if !name.starts_with("cycle") {
                    self.bytes.push(u8::try_from(rank).unwrap_or(u8::MAX));
                }
                8
            }
            Schema::U8 => {
                let greatest = self.counters.iter().find(|(counter, _)| *counter == name);
                self.bytes.push(greatest.map_or(bytes[0], |(_, greatest)| bytes[0].min(*greatest)));
                1
            }
            _ => {
                let size = schema.size();
                self.bytes.extend_from_slice(&bytes[..size]);
                size
            }
        }
    }
}

/// Numbers of an interface begin again at 1: only their differences count, and they would never come again. When
/// a command was sent counts until it is echoed.
pub fn rebase(commander: &mut Commander, numbers: &mut [&mut u32]) {
    let mut all = vec![&mut commander.number];
    all.extend(numbers.iter_mut().map(|number| &mut **number));
    if rebase_echoes(&mut all) {
        commander.sent = Tick::BEFORE_START;
    }
}

/// The same of an interface to a commander that is not one of the pair. Are they all the same?
pub fn rebase_echoes(numbers: &mut [&mut u32]) -> bool {
    let least = numbers.iter().map(|number| **number).filter(|number| *number != 0).min();
    let Some(before) = least.map(|least| least - 1) else { return false };
    numbers.iter_mut().for_each(|number| **number = number.saturating_sub(before));
    numbers.iter().all(|number| **number == 1)
}

/// Record numbers of E-move begin again: those of the records that stand, in their order, and one for all others.
pub fn renumber_poses(emove: &mut emove::state::State, out: &mut EmoveOutputs) {
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
    if let Some(route) = &mut emove.route {
        (route.departure, route.goal) = (renamed(route.departure), renamed(route.goal));
    }
    emove.last_pose = others;
}

/// Take away what no row of E-move asks for any more: the reason, the nearest places, and what it has of a command that
/// it does not execute. Does it execute one?
pub fn forget(emove: &mut emove::state::State) -> bool {
    emove.execution.reason = Reason::None;
    emove.surroundings = Default::default();
    let executes = emove.execution.outcome == Outcome::Executing && !emove.execution.waiting;
    if !executes {
        if !matches!(emove.step, Step::EPause(_)) {
            emove.step = Step::default();
        }
        (emove.ordered, emove.uses_prim, emove.carrying) = Default::default();
        (emove.route, emove.back, emove.rejoin) = Default::default();
        (emove.execution.last_order, emove.tries) = Default::default();
    }
    let beliefs = &mut emove.beliefs;
    match &mut beliefs.grasping {
        grasping if beliefs.held.is_none() && beliefs.empty => *grasping = None,
        Some(grasping) => grasping.opening = 0,
        None => {}
    }
    if beliefs.held.is_none() {
        emove.unfelt = 0;
    }
    executes
}
