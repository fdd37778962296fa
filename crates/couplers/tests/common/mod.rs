//! The plan of a small device of each kind.

use couplers::{Area, Fallback, Kind, MS, OutWords, Plan, Span};
use rcs_core::Plain;

pub const TICK: u64 = 40 * MS;
/// The valve that may not be on at rest, and the one that may.
pub const VALVE: u16 = 0x01;
pub const CLAMP: u16 = 0x02;
/// Word of the output image that holds the number of the tick.
pub const CLOCK: usize = 1;

pub fn words(first: u16) -> OutWords {
    let mut image = OutWords::ZERO;
    image.words[0] = first;
    image
}

/// Four input registers and two output registers, with the first fallback of the kind.
pub fn plan(kind: Kind) -> Plan {
    let facts = kind.facts();
    let mut rest = words(CLAMP);
    rest.words[CLOCK] = u16::MAX;
    let mut plan = Plan {
        unit: 1,
        kind,
        fallback: facts.fallbacks[0],
        watchdog_ms: if kind == Kind::Values { 1000 } else { 500 },
        stale_ms: 100,
        reads: vec![Span { area: Area::Input, first: *facts.inputs.start(), count: 4 }],
        writes: vec![Span { area: Area::Holding, first: *facts.outputs.start(), count: 2 }],
        safe: OutWords::ZERO,
        rest,
        alive: None,
    };
    if plan.fallback == Fallback::Hold {
        plan.rest = plan.written();
    }
    plan
}
