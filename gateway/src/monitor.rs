//! `rcs-gateway monitor`: the state of all cells of a shop, one per line. `examples/fleet.py` is the same in Python.

use std::{
    collections::BTreeMap,
    fmt,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use os_io::console;
use serde_json::Value;
use zenoh::{
    Wait as _,
    sample::{Sample, SampleKind},
};

use crate::{
    cli::MonitorArguments,
    config,
    error::{Error, words},
    keys::Keys,
    keyspace::{ANY, CellKeys},
    sample::plain,
    signals,
};

const PERIOD: Duration = Duration::from_secs(1); // time between two pages

#[derive(Debug, Default)]
struct Cell {
    is_here: bool,
    status: Value,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { is_here, status } = self;
        if !is_here {
            return f.write_str("gone");
        }
        if status["run"] != true {
            return f.write_str("no run");
        }
        let word = |name: &str| plain(status[name].as_str().unwrap_or("-").as_bytes());
        let tick = status["tick"].as_u64().map_or("-".to_owned(), |tick| tick.to_string());
        write!(f, "{} tick {tick} {}", word("state"), word("command"))?;
        if let Some(reason) = status["reason"].as_str().filter(|reason| !reason.is_empty()) {
            write!(f, " {}", plain(reason.as_bytes()))?;
        }
        let connected: Vec<_> = status["connected"].as_object().into_iter().flatten().collect();
        let connected: Vec<_> = connected
            .into_iter()
            .map(|(role, who)| plain(format!("{role} {}", who.as_str().unwrap_or("-")).as_bytes()))
            .collect();
        write!(
            f,
            " ({})",
            if connected.is_empty() { "nobody connected".to_owned() } else { connected.join(", ") }
        )
    }
}

type Cells = Arc<Mutex<BTreeMap<String, Cell>>>;

fn change(cells: &Cells, sample: &Sample, change: impl FnOnce(&mut Cell)) {
    let name = sample.key_expr().split('/').nth(1).map(|name| plain(name.as_bytes()));
    if let Some(name) = name {
        change(cells.lock().unwrap_or_else(PoisonError::into_inner).entry(name).or_default());
    }
}

/// Prints the states once per second. Fails if the keys cannot be used, or the only endpoint cannot be reached.
pub fn monitor(arguments: &MonitorArguments) -> Result<(), Error> {
    let MonitorArguments { endpoints, keys, name, count } = arguments;
    let own = Keys::named_or_only(keys, name.as_ref())?;
    let signals = signals::receive()?;
    let is_over = Arc::new(AtomicBool::new(false));
    let over = Arc::clone(&is_over);
    thread::spawn(move || {
        signals::wait(signals);
        over.store(true, Ordering::Release);
    });
    let config = config::monitor(endpoints, &own).map_err(Error::zenoh)?;
    let session = zenoh::open(config).wait().map_err(|error| Error::Unreachable {
        endpoints: endpoints.clone(),
        name: own.name.clone(),
        reason: words(&error),
    })?;
    let (cells, every) = (Cells::default(), CellKeys::of(ANY));
    let (here, states) = (Arc::clone(&cells), Arc::clone(&cells));
    let token =
        move |sample: Sample| change(&here, &sample, |cell| cell.is_here = sample.kind() == SampleKind::Put);
    let liveliness = session.liveliness();
    let tokens = liveliness.declare_subscriber(every.alive(ANY)).history(true).callback(token);
    tokens.background().wait().map_err(Error::zenoh)?;
    let status = move |sample: Sample| {
        // Payloads that are not JSON are ignored.
        if let Ok(status) = serde_json::from_slice(&sample.payload().to_bytes()) {
            change(&states, &sample, |cell| cell.status = status);
        }
    };
    session.declare_subscriber(every.run()).callback(status).background().wait().map_err(Error::zenoh)?;
    let mut left = count.unwrap_or(u32::MAX);
    while left > 0 && !is_over.load(Ordering::Acquire) {
        thread::sleep(PERIOD);
        let page: String = {
            let cells = cells.lock().unwrap_or_else(PoisonError::into_inner);
            cells.iter().map(|(name, cell)| format!("{name:12} {cell}\n")).collect()
        };
        if console::answer(&page).is_err() {
            // Nobody reads any more.
            break;
        }
        left -= u32::from(count.is_some());
    }
    let _ = session.close().wait();
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn cell_is_described_in_one_line_without_control_characters() {
        let line = |is_here, status| Cell { is_here, status }.to_string();
        assert_eq!(line(false, Value::Null), "gone");
        assert_eq!(line(true, json!({"run": false})), "no run");
        let nobody = json!({"run": true, "tick": null, "connected": {}, "state": null, "command": null});
        assert_eq!(line(true, nobody), "- tick - - (nobody connected)");
        let busy = json!({
            "run": true, "tick": 7, "connected": {"workstation": "hwsc-1"},
            "command": "MOVE", "state": "error", "reason": "no\u{1b}[2J",
        });
        assert_eq!(line(true, busy), "error tick 7 MOVE no?[2J (workstation hwsc-1)");
    }
}
