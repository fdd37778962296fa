//! A claim from its beginning to its end.

use std::time::{Duration, Instant};

use zenoh::{Wait as _, query::ConsolidationMode};

use crate::{
    native,
    shop::{Hwsc, Shop, eventually, free_port},
};

#[test]
fn workstation_through_a_gateway_commands_the_run() {
    let shop = Shop::new(&["hwsc-1"]);
    let _run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1"]);
    let _connect = shop.connect("workstation", "hwsc-1");
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    // The first PAUSE of a run takes longer. Of ten, one at least is not delayed by a busy machine.
    hwsc.pause().unwrap();
    let fastest = |hwsc: &mut Hwsc| (0..10).map(|_| hwsc.pause().unwrap()).min().unwrap();
    let through = fastest(&mut hwsc);
    drop(hwsc);
    gateway.wait_for("workstation hwsc-1 has disconnected");
    let direct = fastest(&mut shop.hwsc("run").unwrap());
    println!("PAUSE: {through} ticks through the gateway, {direct} without");
    assert!(through <= direct + 1, "PAUSE took {through} ticks through the gateway and {direct} without");
}

/// The refusal is the run's own text, and the present holder keeps its claim.
#[test]
fn second_claimant_is_refused_in_the_words_of_the_run() {
    let shop = Shop::new(&["hwsc-1", "hwsc-2"]);
    let _run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1,hwsc-2"]);
    let (_first, _second) = (shop.connect("workstation", "hwsc-1"), shop.connect("workstation", "hwsc-2"));
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    assert_eq!(shop.hwsc("hwsc-2").err().unwrap(), "workstation is connected already");
    gateway.wait_for("workstation hwsc-2 was refused: workstation is connected already");
    hwsc.tick().unwrap();
    drop(hwsc);
    // The next claimant is admitted as soon as the first has disconnected.
    assert!(eventually(|| shop.hwsc("hwsc-2").is_ok()));
}

#[test]
fn certificate_without_permission_gets_no_claim() {
    let shop = Shop::new(&["hwsc-1", "eye"]);
    let _run = shop.real_run();
    let _gateway = shop.serve(&["workstation=hwsc-1", "vision=eye"]);
    let _connect = shop.connect("workstation", "eye");
    let error = shop.hwsc("eye").err().unwrap();
    assert!(
        error.starts_with("the gateway gives no answer: does its --allow have workstation=eye"),
        "{error}"
    );
}

#[test]
fn gateway_without_a_run_warns_and_serves_the_run_that_starts_later() {
    let shop = Shop::new(&["hwsc-1"]);
    let gateway = shop.serve(&["workstation=hwsc-1"]);
    gateway.wait_for("no run listens at");
    let connect = shop.connect("workstation", "hwsc-1");
    // The connection is closed without a reason, so that a neighbour tries again.
    assert_eq!(shop.hwsc("hwsc-1").err().unwrap(), "closed");
    connect.wait_for("no run listens at");
    let _run = shop.real_run();
    shop.hwsc("hwsc-1").unwrap().pause().unwrap();
}

#[test]
fn killed_client_is_noticed_before_its_silence_ends_the_claim() {
    let shop = Shop::new(&["hwsc-1", "hwsc-2"]);
    let _run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1,hwsc-2"]);
    let mut first = shop.connect("workstation", "hwsc-1");
    let _second = shop.connect("workstation", "hwsc-2");
    let _hwsc = shop.hwsc("hwsc-1").unwrap();
    first.kill();
    let start = Instant::now();
    assert!(eventually(|| shop.hwsc("hwsc-2").is_ok()), "still occupied");
    gateway.wait_for("workstation hwsc-1 has disconnected: the other end has gone");
    println!("killed client: the next one is admitted after {:?}", start.elapsed());
}

/// The robot finishes the commanded motion.
#[test]
fn gateway_killed_in_a_motion_does_not_stop_it_and_the_next_one_admits_the_neighbour() {
    let shop = Shop::new(&["hwsc-1"]);
    let mut run = shop.real_run();
    let mut gateway = shop.serve(&["workstation=hwsc-1"]);
    let connect = shop.connect("workstation", "hwsc-1");
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    hwsc.pause().unwrap();
    hwsc.start_move("SAFE").unwrap();
    gateway.kill();
    let start = Instant::now();
    while hwsc.tick().is_ok() {}
    println!("killed gateway: noticed after {:?}", start.elapsed());
    connect.wait_for("the other end has gone");
    let _gateway = shop.serve(&["workstation=hwsc-1"]);
    let mut admitted = None;
    let start = Instant::now();
    assert!(eventually(|| {
        admitted = shop.hwsc("hwsc-1").ok();
        admitted.is_some()
    }));
    println!("next gateway: admitted after {:?}", start.elapsed());
    let mut hwsc = admitted.unwrap();
    hwsc.follow_last().unwrap();
    hwsc.finish().unwrap();
    hwsc.pause().unwrap();
    assert!(run.child.try_wait().unwrap().is_none(), "the run has ended: {}", run.errors());
}

/// Commands do not pass through the router, so only monitors detect its end.
#[test]
fn router_killed_in_a_motion_disturbs_no_claim_and_the_next_one_has_the_status() {
    let shop = Shop::new(&["hwsc-1", "router@127.0.0.1", "mes"]);
    let _run = shop.real_run();
    let endpoint = format!("tls/127.0.0.1:{}", free_port());
    let mut router = shop.router(&endpoint);
    let gateway = shop.serve(&["workstation=hwsc-1", "monitor=router", "--router", &endpoint]);
    let _connect = shop.connect("workstation", "hwsc-1");
    let sees_cell = || {
        let monitor = native::connect(&shop.path("keys"), "mes", &endpoint).unwrap();
        let seen = || {
            let answer =
                monitor.get("rcs/*/status/run").consolidation(ConsolidationMode::None).wait().unwrap();
            answer.into_iter().any(|reply| reply.result().is_ok())
        };
        eventually(seen)
    };
    assert!(sees_cell());
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    hwsc.pause().unwrap();
    hwsc.start_move("SAFE").unwrap();
    let (mut longest, mut last) = (Duration::ZERO, Instant::now());
    router.kill();
    for _ in 0..25 {
        hwsc.tick().unwrap();
        longest = longest.max(last.elapsed());
        last = Instant::now();
    }
    println!("killed router: longest gap of the claim {longest:?}");
    hwsc.finish().unwrap();
    let _router = shop.router(&endpoint);
    assert!(sees_cell(), "the next router has no status");
    assert!(!gateway.errors().contains("has disconnected"), "{}", gateway.errors());
}

/// The manual's shift, with all four neighbours behind gateways, has the same digest.
#[test]
fn shift_through_gateways_has_the_same_digest() {
    let roles = ["workstation", "data-system", "pedestal", "vision"];
    let shop = Shop::new(&roles);
    let outside = "workstation,data-system,pedestal,vision";
    let shift = |networks: &dyn Fn(&str) -> String, items: &str| {
        let mut run = shop.run(&["shift", "--outside", outside, "--outbox", &format!("{items}.outbox")]);
        let items = shop.path(items).display().to_string();
        let mut neighbours: Vec<_> = roles
            .iter()
            .rev()
            .map(|role| {
                let arguments: &[&str] = match *role {
                    "workstation" => &["shift"],
                    "data-system" => &[&items],
                    _ => &[],
                };
                shop.neighbour(role, &networks(role), arguments)
            })
            .collect();
        let (start, ended) = (Instant::now(), run.finish());
        println!("shift in {:?}", start.elapsed());
        assert!(ended.success(), "{}", run.errors());
        assert!(neighbours.last_mut().unwrap().finish().success());
        shop.digest()
    };
    let direct = format!("unix:{}", shop.run_socket().display());
    let expected = shift(&|_| direct.clone(), "direct.db");
    let allow: Vec<_> = roles.iter().map(|role| format!("{role}={role}")).collect();
    let _gateway = shop.serve(&allow.iter().map(String::as_str).collect::<Vec<_>>());
    let _connects: Vec<_> = roles.iter().map(|role| shop.connect(role, role)).collect();
    assert_eq!(shift(&|role| shop.socket_address(role), "gateway.db"), expected);
}

#[test]
fn both_ends_stop_in_order_and_remove_their_sockets() {
    let shop = Shop::new(&["hwsc-1"]);
    let _run = shop.real_run();
    let mut gateway = shop.serve(&["workstation=hwsc-1"]);
    let mut connect = shop.connect("workstation", "hwsc-1");
    let mut hwsc = shop.hwsc("hwsc-1").unwrap();
    connect.terminate();
    assert!(connect.finish().success());
    assert!(!shop.path("hwsc-1.sock").exists());
    while hwsc.tick().is_ok() {}
    gateway.terminate();
    assert!(gateway.finish().success());
}

#[test]
fn program_of_another_role_is_refused() {
    let shop = Shop::new(&["eye"]);
    let _run = shop.run(&["--clock", "real", "--outside", "workstation,vision"]);
    let _gateway = shop.serve(&["vision=eye"]);
    let connect = shop.connect("vision", "eye");
    assert_eq!(shop.hwsc("eye").err().unwrap(), "expected vision, found workstation");
    connect.wait_for("expected vision, found workstation");
}
