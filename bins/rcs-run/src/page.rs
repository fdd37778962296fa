//! The result of a run as text.

use std::fmt;

use os_io::text::amount;
use rcs_core::tick::{TICK_MS, TICK_S};
use runtime::{
    Ending, RunOutcome,
    result::{EmergencyResult, TickTimes},
};

const EVENTS_SHOWN: usize = 10; // number of printed events; the log has the rest

/// The text: the result, all steps of the job, and remarks that are not in the JSON object.
pub struct Page<'a>(pub &'a RunOutcome);

impl fmt::Display for Page<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(RunOutcome { ending, result, steps, log, slowest, .. }) = self;
        let outcome = match ending {
            Ending::Failed(_) => "failed".into(),
            other => other.text(),
        };
        writeln!(
            f,
            "{} {outcome}: {:.1} s simulated in {:.1} s, {:.0} x real time\n",
            result.job, result.simulated_s, result.wall_s, result.realtime_factor
        )?;
        let width = steps.iter().map(|step| step.text.len()).max().unwrap_or(0);
        for step in steps {
            let seconds = step.ticks as f64 * TICK_S;
            writeln!(f, "  {:width$}  {seconds:7.1} s  {}", step.text, step.ending())?;
        }
        writeln!(f)?;
        if let Some(simulated) = result.simulated {
            writeln!(f, "simulated  {simulated}")?;
        }
        if let Some(last) = result.retries.last() {
            writeln!(f, "retries    {}, the last one at tick {}", result.retries.len(), last.tick)?;
        }
        if let Some(operator) = &result.operator {
            writeln!(f, "operator   {}, {} refused", amount(operator.requests, "request"), operator.refused)?;
        }
        for item in &result.data_base {
            writeln!(f, "database   {item}")?;
        }
        if let Some(nearest) = &result.clearance {
            writeln!(f, "clearance  {nearest}")?;
        }
        for event in result.events.first.iter().take(EVENTS_SHOWN) {
            writeln!(f, "event      {event}")?;
        }
        let more = result.events.count.saturating_sub(EVENTS_SHOWN);
        if more > 0 {
            writeln!(f, "           and {more} more, all in the log")?;
        }
        if let Some(EmergencyResult { tick, cause, touched, .. }) = &result.emergency_stop {
            let into = match touched.len() {
                0 => "the sagging arm touched nothing".to_owned(),
                count => format!("the sagging arm ran into {}", amount(count, "thing")),
            };
            writeln!(f, "stop       tick {tick}: {cause}; {into}")?;
        }
        let link = &result.link;
        writeln!(
            f,
            "link       {}, {}, {}, {}, {} limited",
            amount(link.frames, "frame"),
            amount(link.naks, "NAK"),
            amount(link.retries, "retry"),
            amount(link.checksum_errors, "checksum error"),
            amount(link.limited, "point")
        )?;
        if result.ramp_ticks > 0 {
            let seconds = f64::from(result.ramp_ticks) * TICK_S;
            writeln!(
                f,
                "ramp       the robot came to rest within {} ({seconds:.1} s)",
                amount(result.ramp_ticks, "tick")
            )?;
        }
        if let Some(faults) = &result.faults {
            writeln!(f, "faults     {faults}")?;
        }
        for fault in &result.cell_faults {
            writeln!(f, "fault      {fault}")?;
        }
        if let Some(field) = &result.field {
            writeln!(f, "field      {field}")?;
        }
        if let Some(egm) = &result.egm {
            write!(
                f,
                "egm        {}, {} refused, {} from other addresses; the robot was {:.1} mm from its target \
                 at most",
                amount(egm.received, "message"),
                egm.refused,
                egm.elsewhere,
                egm.error_max_mm
            )?;
            match &egm.last_refused {
                Some(last) => writeln!(f, "\n           the last refused {last}")?,
                None => writeln!(f)?,
            }
        }
        if let Some(port) = &result.port {
            let TickTimes { p50, p99, max } = port.deviation_us;
            writeln!(
                f,
                "port       {} sent, {} received, {} not taken, lost {}\n           a frame every {TICK_MS} ms, off by p50 {p50:.0} us, p99 {p99:.0} us, max {max:.0} us",
                amount(port.sent, "byte"),
                port.received,
                port.unsent,
                amount(port.losses, "time")
            )?;
        }
        let allocations = result.allocations_after_start.map_or("not counted".to_owned(), |n| n.to_string());
        // The fast clock has no deadlines, so times are not part of the result.
        let is_timed = result.late_us.is_some();
        let times = &result.tick_us;
        let mut timing = String::new();
        if is_timed {
            let TickTimes { p50, p99, max } = times;
            timing = format!(
                ": p50 {p50:.1} us, p99 {p99:.1} us, max {max:.1} us; {} skipped",
                amount(result.overruns, "slot")
            );
        }
        writeln!(f, "controller {}{timing}; allocations: {allocations}", amount(result.ticks, "tick"))?;
        for board in result.boards.iter().flatten() {
            let TickTimes { p50, p99, max } = board.tick_us;
            let mut timing = String::new();
            if is_timed {
                timing = format!("p50 {p50:.1} us, p99 {p99:.1} us, max {max:.1} us; ");
            }
            writeln!(
                f,
                "board {}    {timing}allocations: {}; process {}: {}",
                board.board, board.allocations, board.pid, board.processes
            )?;
        }
        if is_timed && result.boards.is_none() {
            writeln!(f, "slowest    {slowest}")?;
        }
        if let Some(TickTimes { p50, p99, max }) = &result.late_us {
            let mut skipped = String::new();
            for (part, slots) in &result.overruns_by {
                skipped += &format!("; {} skipped for {part}", amount(*slots, "slot"));
            }
            writeln!(
                f,
                "punctual   ticks begin late by p50 {p50:.1} us, p99 {p99:.1} us, max {max:.1} us{skipped}"
            )?;
        }
        writeln!(f, "digest     {}", result.digest)?;
        writeln!(f, "data       {}", result.data)?;
        writeln!(f, "log        {log}")
    }
}
