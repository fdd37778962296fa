//! Checks with a counting allocator that no exchange allocates: connected, cut, tripped and released.

use couplers::{Area, Emulated, Fallback, Kind, MS, Mode, Orders, OutWords, Plan, Simulated, Span, State};
use os_io::alloc::{Counting, Section, allocations, is_installed};
use rcs_core::Plain;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn ten_thousand_exchanges_allocate_nothing() {
    let plan = Plan {
        unit: 1,
        kind: Kind::Bk9000,
        fallback: Fallback::Zero,
        watchdog_ms: 500,
        stale_ms: 100,
        reads: vec![Span { area: Area::Input, first: 0, count: 33 }],
        writes: vec![Span { area: Area::Holding, first: 0x800, count: 4 }],
        safe: OutWords::ZERO,
        rest: OutWords::ZERO,
        alive: None,
    };
    let mut device = Simulated::new(plan, Emulated::new(Kind::Bk9000, 1, 33, 4), 15).unwrap();
    let mut orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: OutWords::ZERO };
    assert!(is_installed());
    let before = allocations();
    let section = Section::enter();
    let mut trips = 0;
    for tick in 0..5000 {
        orders.tick += 1;
        device.cut(tick % 500 < 20);
        for offset in [1, 32] {
            device.exchange((40 * tick + offset) * MS, &orders);
        }
        if matches!(device.report().state, State::Tripped(_)) {
            (trips, orders.go) = (trips + 1, orders.go + 1);
        }
    }
    drop(section);
    assert_eq!(allocations() - before, 0);
    assert!(trips >= 9, "{trips} trips");
}
