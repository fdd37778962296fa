//! What monitors read.

use std::{
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use zenoh::{Wait as _, query::ConsolidationMode, sample::SampleKind};

use crate::{
    native::connect,
    shop::{CELL, Shop, within},
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
        assert!(start.elapsed() < Duration::from_secs(2), "{:?}", states.lock().unwrap());
    }
    assert!(mailboxes.lock().unwrap().contains(&format!("rcs/{CELL}/status/mailbox/F6200")));
    let answer = monitor.get("rcs/*/status/run").consolidation(ConsolidationMode::None).wait().unwrap();
    assert!(answer.recv().unwrap().result().is_ok());
    gateway.kill();
    assert!(within(1.0, || *gone.lock().unwrap()), "the killed gateway is not missed");
}
