//! What monitors read.

use std::{
    collections::BTreeSet,
    process::Command,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use zenoh::{Wait as _, query::ConsolidationMode, sample::SampleKind};

use crate::{
    native::connect,
    shop::{CELL, Process, Shop, TIME_LIMIT, eventually, free_port, make_keys, start_router},
};

#[test]
fn monitor_sees_the_run_its_mailboxes_and_the_end_of_the_gateway() {
    let shop = Shop::new(&["hwsc-1", "mes"]);
    let _run = shop.real_run();
    let mut gateway = shop.serve(&["workstation=hwsc-1", "monitor=mes"]);
    let _connect = shop.connect("workstation", "hwsc-1");
    let monitor = connect(&shop.path("keys"), "mes", &shop.endpoint()).unwrap();
    let (states, mailboxes, gone) = <(Arc<Mutex<Vec<_>>>, Arc<Mutex<Vec<_>>>, Arc<Mutex<bool>>)>::default();
    let (state, mailbox, end) = (Arc::clone(&states), Arc::clone(&mailboxes), Arc::clone(&gone));
    let take = move |sample: zenoh::sample::Sample| {
        state
            .lock()
            .unwrap()
            .push(serde_json::from_slice::<serde_json::Value>(&sample.payload().to_bytes()).unwrap());
    };
    monitor.declare_subscriber("rcs/*/status/run").callback(take).background().wait().unwrap();
    let take =
        move |sample: zenoh::sample::Sample| mailbox.lock().unwrap().push(sample.key_expr().to_string());
    monitor.declare_subscriber("rcs/*/status/mailbox/*").callback(take).background().wait().unwrap();
    let take = move |token: zenoh::sample::Sample| *end.lock().unwrap() |= token.kind() == SampleKind::Delete;
    let tokens = monitor.liveliness();
    tokens.declare_subscriber("rcs/*/alive/*").history(true).callback(take).background().wait().unwrap();
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    hwsc.pause().unwrap();
    let finished = |state: &serde_json::Value| {
        state["state"] == "finished"
            && state["command"] == "PAUSE"
            && state["connected"]["workstation"] == "hwsc-1"
    };
    let start = Instant::now();
    while !states.lock().unwrap().iter().any(finished) {
        hwsc.tick().unwrap();
        assert!(start.elapsed() < TIME_LIMIT, "{:?}", states.lock().unwrap());
    }
    assert!(mailboxes.lock().unwrap().contains(&format!("rcs/{CELL}/status/mailbox/F6200")));
    let answer = monitor.get("rcs/*/status/run").consolidation(ConsolidationMode::None).wait().unwrap();
    assert!(answer.recv().unwrap().result().is_ok());
    gateway.kill();
    assert!(eventually(|| *gone.lock().unwrap()), "the killed gateway is not missed");
}

#[test]
fn router_lets_a_cell_write_its_own_status_only() {
    let directory = tempfile::tempdir().unwrap();
    let keys = directory.path().join("keys");
    make_keys(&keys, "c1", &["c2@127.0.0.1", "router@127.0.0.1", "mes", "nobody"]);
    let endpoint = format!("tls/127.0.0.1:{}", free_port());
    let _router = start_router(directory.path(), &endpoint, &["c1", "c2"]);
    let monitor = connect(&keys, "mes", &endpoint).unwrap();
    let heard = Arc::new(Mutex::new(BTreeSet::new()));
    let keys_of = Arc::clone(&heard);
    let take = move |sample: zenoh::sample::Sample| {
        keys_of.lock().unwrap().insert(sample.key_expr().to_string());
    };
    monitor.declare_subscriber("rcs/*/status/run").callback(take).background().wait().unwrap();
    let writers: Vec<_> = ["c2", "mes", "nobody"].map(|name| connect(&keys, name, &endpoint).unwrap()).into();
    let is_heard = eventually(|| {
        for writer in &writers {
            for cell in ["c1", "c2"] {
                writer.put(format!("rcs/{cell}/status/run"), "{}").wait().unwrap();
            }
        }
        heard.lock().unwrap().contains("rcs/c2/status/run")
    });
    assert!(is_heard, "the status of c2 does not arrive");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(*heard.lock().unwrap(), BTreeSet::from(["rcs/c2/status/run".to_owned()]));
}

/// A shop: each cell has a gateway of its own, and all connect to one router.
#[test]
fn monitor_sees_twenty_cells_through_a_router_and_misses_a_killed_one() {
    const CELLS: usize = 20;
    let directory = tempfile::tempdir().unwrap();
    let keys = directory.path().join("keys");
    let cells: Vec<_> = (1..=CELLS).map(|number| format!("c{number:02}")).collect();
    let addresses: Vec<_> = cells.iter().map(|cell| format!("{cell}@127.0.0.1")).collect();
    let mut names: Vec<_> = addresses.iter().map(String::as_str).collect();
    names.extend(["router@127.0.0.1", "mes"]);
    make_keys(&keys, CELL, &names);
    let endpoint = format!("tls/127.0.0.1:{}", free_port());
    let names: Vec<_> = cells.iter().map(String::as_str).collect();
    let mut first = start_router(directory.path(), &endpoint, &names);
    let mut gateways: Vec<_> = cells
        .iter()
        .map(|cell| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
            command.args(["serve", cell, &format!("tls/127.0.0.1:{}", free_port()), "--router", &endpoint]);
            command.arg("--run").arg(format!("unix:{}", directory.path().join(cell).display()));
            command.arg("--keys").arg(&keys).args(["--allow", "monitor=mes,router"]);
            Process::start(&mut command, directory.path().join(format!("{cell}.err")))
        })
        .collect();
    gateways.iter().for_each(|gateway| gateway.wait_for(" at tls/"));
    let watch = |monitor: &zenoh::Session| {
        let here = Arc::new(Mutex::new(BTreeSet::new()));
        let cells = Arc::clone(&here);
        let take = move |token: zenoh::sample::Sample| {
            let cell = token.key_expr().split('/').nth(1).unwrap().to_owned();
            match token.kind() {
                SampleKind::Put => cells.lock().unwrap().insert(cell),
                SampleKind::Delete => cells.lock().unwrap().remove(&cell),
            };
        };
        let tokens = monitor.liveliness();
        tokens.declare_subscriber("rcs/*/alive/*").history(true).callback(take).background().wait().unwrap();
        here
    };
    let monitor = connect(&keys, "mes", &endpoint).unwrap();
    let (here, start) = (watch(&monitor), Instant::now());
    assert!(eventually(|| here.lock().unwrap().len() == CELLS), "{:?}", here.lock().unwrap());
    println!("{CELLS} cells seen after {:?}", start.elapsed());
    gateways[6].kill();
    let start = Instant::now();
    assert!(eventually(|| !here.lock().unwrap().contains("c07")), "the killed cell is not missed");
    println!("killed cell missed after {:?}", start.elapsed());
    // A restarted router has all cells again within a second or two: gateways try once a second.
    drop(monitor);
    first.kill();
    let _second = start_router(directory.path(), &endpoint, &names);
    let start = Instant::now();
    let monitor = connect(&keys, "mes", &endpoint).unwrap();
    let here = watch(&monitor);
    assert!(eventually(|| here.lock().unwrap().len() == CELLS - 1), "{:?}", here.lock().unwrap());
    println!("all cells are back {:?} after the restart of the router", start.elapsed());
}
