//! Measures the time from the last write of a device to its fallback.

use std::{
    thread,
    time::{Duration, Instant},
};

use couplers::{Fault, Link as _, Mode};
use executive::field::TcpLink;
use modbus::{MOST_FRAME_BYTES, Request, Words, request::Range};

use super::Bench;

/// Reads holding registers of a device.
pub fn registers(link: &mut TcpLink, first: u16, count: u16) -> Result<Vec<u16>, Fault> {
    let mut answer = [0; MOST_FRAME_BYTES];
    let request = Request::ReadHoldingRegisters(Range { first, count });
    let words = link.exchange(&request, &mut answer)?.words();
    Ok(words.into_iter().flat_map(Words::iter).collect())
}

/// The time from the last write of a device to its fallback, over a second connection, ms. A register with a value
/// shows the fallback, or that the coupler refuses every request (`refuses_all`).
pub fn fallback(
    bench: &Bench,
    index: usize,
    ((register, value), refuses_all): ((u16, u16), bool),
) -> Option<u64> {
    let device = &bench.mapping.devices[index];
    let mut probe = bench.probe(index, Mode::Watch).ok()?;
    probe.orders.words = probe.report().acknowledged;
    probe.orders.mode = Mode::Run;
    probe.exchange_for(Duration::from_millis(100));
    let written = Instant::now();
    let mut second =
        TcpLink::new(device.address, device.plan.unit, Duration::from_millis(device.timeout_ms.into()));
    second.connect().ok()?;
    let limit = Duration::from_millis(device.plan.watchdog_ms.into()) + Duration::from_secs(1);
    let fired = loop {
        let is_fired = match registers(&mut second, register, 1) {
            Ok(words) => words == [value],
            Err(Fault::Exception(_)) => refuses_all,
            Err(_) => false,
        };
        if is_fired {
            break u64::try_from(written.elapsed().as_millis()).ok();
        }
        if written.elapsed() > limit {
            break None;
        }
        thread::sleep(Duration::from_millis(1));
    };
    probe.end();
    fired
}
