//! A line that is interrupted for some time.

use std::{
    thread,
    time::{Duration, Instant},
};

use crate::{
    line::CutLine,
    shop::{Shop, eventually},
};

#[test]
fn cut_of_one_second_ends_neither_the_claim_nor_the_command() {
    let shop = Shop::new(&["hwsc-1"]);
    let _run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1"]);
    let line = CutLine::to(shop.port);
    let _connect = shop.connect_to(&format!("tls/127.0.0.1:{}", line.port), "workstation", "hwsc-1");
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    hwsc.pause().unwrap();
    let cutting = thread::spawn(move || line.cut(Duration::from_secs(1)));
    let (mut longest, mut last) = (Duration::ZERO, Instant::now());
    let until = last + Duration::from_secs(3);
    while Instant::now() < until {
        hwsc.tick().unwrap();
        longest = longest.max(last.elapsed());
        last = Instant::now();
    }
    cutting.join().unwrap();
    println!("cut of 1 s: longest gap {longest:?}");
    hwsc.pause().unwrap();
    assert!(!gateway.errors().contains("has disconnected"), "{}", gateway.errors());
}

#[test]
fn long_cut_ends_the_claim_after_ten_seconds_and_frees_the_role() {
    let shop = Shop::new(&["hwsc-1", "hwsc-2"]);
    let mut run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1,hwsc-2"]);
    let line = CutLine::to(shop.port);
    let _first = shop.connect_to(&format!("tls/127.0.0.1:{}", line.port), "workstation", "hwsc-1");
    let _second = shop.connect("workstation", "hwsc-2");
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    let start = Instant::now();
    hwsc.tick().unwrap();
    line.set_cut(true);
    gateway.wait_for("workstation hwsc-1 has disconnected");
    let ended = start.elapsed();
    assert!(eventually(|| shop.hwsc("hwsc-2").is_ok()), "the role is not free");
    while hwsc.tick().is_ok() {}
    println!("cut: the gateway ends the claim after {ended:?}, the client after {:?}", start.elapsed());
    assert!(ended >= Duration::from_secs(9), "a shorter cut ends the claim: {ended:?}");
    assert!(run.child.try_wait().unwrap().is_none());
}
