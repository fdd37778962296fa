//! Messages on standard error, which no flood of connections can fill: each source has a limited rate, and its next
//! line states how many were omitted.

use std::{
    fmt::{self, Write as _},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use os_io::stderr_line;
use tracing::{
    Event, Level, Metadata, Subscriber,
    field::{Field, Visit},
    span,
};

use crate::{budget::Budget, error::without_places};

const BURST: u32 = 10; // number of lines that a source may write at once
const REFILL: Duration = Duration::from_secs(2); // time after which a source may write one more line
const LINE: usize = 400; // greatest length of a line, characters

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    Gateway, // the gateway's own events
    Refused,
    Zenoh, // warnings of Zenoh, among them failed handshakes
}

static BUDGETS: Mutex<[Budget; 3]> = Mutex::new([Budget::new(BURST, REFILL); 3]);

pub fn write(source: Source, text: &dyn fmt::Display) {
    let omitted = {
        let mut budgets = BUDGETS.lock().unwrap_or_else(PoisonError::into_inner);
        budgets[source as usize].take(Instant::now())
    };
    let Some(omitted) = omitted else { return };
    let text: String = text.to_string().chars().take(LINE).collect();
    let front = if source == Source::Zenoh { "zenoh: " } else { "" };
    match omitted {
        0 => stderr_line!("rcs-gateway: {front}{text}"),
        count => stderr_line!("rcs-gateway: {front}{text} ({count} lines before it were left out)"),
    }
}

/// Writes a line of the gateway itself.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => { $crate::log::write($crate::log::Source::Gateway, &::std::format_args!($($text)*)) };
}

/// Writes a line about a refused client.
#[macro_export]
macro_rules! say_refused {
    ($($text:tt)*) => { $crate::log::write($crate::log::Source::Refused, &::std::format_args!($($text)*)) };
}

struct Warnings;

struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            let _ = write!(self.0, "{value:?}");
        }
    }
}

impl Subscriber for Warnings {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && *metadata.level() <= Level::WARN
    }

    fn new_span(&self, _: &span::Attributes<'_>) -> span::Id {
        span::Id::from_u64(1)
    }

    fn record(&self, _: &span::Id, _: &span::Record<'_>) {}

    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut text = Text(String::new());
        event.record(&mut text);
        // It is disabled on purpose.
        if text.0.starts_with("Gossip is disabled") {
            return;
        }
        // Zenoh attributes every failed handshake to the limit of open files, so that text is removed.
        let text = without_places(&text.0.replace(". Hint: increase the system open file limit.", ""));
        write(Source::Zenoh, &text);
    }

    fn enter(&self, _: &span::Id) {}

    fn exit(&self, _: &span::Id) {}
}

pub fn log_zenoh_warnings() {
    // This fails only if a subscriber is already set, and this program sets only this one.
    let _ = tracing::subscriber::set_global_default(Warnings);
}
