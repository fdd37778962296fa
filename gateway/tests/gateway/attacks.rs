//! Attacks with certificates of the cell beyond their roles, and with a certificate without any permission.

use std::{
    sync::{Arc, Mutex},
    thread,
    time::Duration,
};

use neighbours::{
    line::{Role, frame},
    mailbox::{HWSC_COMMAND, HWSC_STATUS, Mailbox},
    workstation::{command, player, status},
};
use zenoh::{Session, Wait as _, query::ConsolidationMode};

use crate::{
    native::{Claim, connect, router},
    shop::{CELL, Shop, eventually, free_port},
};

const VICTIM: &str = "hwsc-1";

/// A sample with a PAUSE for any number, which a run that reads it would execute.
fn forged(pulse: u64) -> Vec<u8> {
    let mut pause = player::pause();
    pause.number = 7;
    let mut mailbox = Mailbox::initialized(HWSC_COMMAND);
    mailbox.write(&command::encode(&pause).unwrap()).unwrap();
    let mut bytes = Vec::new();
    frame::put_mailbox(&mut bytes, &mailbox);
    frame::put_pulse(&mut bytes, pulse);
    bytes
}

fn end() -> Vec<u8> {
    let mut bytes = Vec::new();
    frame::put(&mut bytes, frame::DISCONNECT, b"forged");
    bytes
}

type Heard = Arc<Mutex<Vec<String>>>;

/// Listens to the claim `id` of the victim, and answers instead of the gateway. Returns the received samples, by key.
fn listen(listener: &Session, id: &str) -> (Heard, u32) {
    let heard = Heard::default();
    let listen = |key: &str| {
        let heard = Arc::clone(&heard);
        let take =
            move |sample: zenoh::sample::Sample| heard.lock().unwrap().push(sample.key_expr().to_string());
        // A denied subscriber can be declared, but receives nothing.
        listener.declare_subscriber(key.to_owned()).callback(take).background().wait().unwrap();
    };
    let mut attacks = 0;
    let front = format!("rcs/{CELL}/workstation/{VICTIM}/{id}");
    for key in [
        format!("{front}/out"),
        format!("{front}/in"),
        "rcs/**".into(),
        "**".into(),
        format!("rcs/{CELL}/workstation/*/*/out"),
    ] {
        listen(&key);
        attacks += 1;
    }
    let tokens = Arc::clone(&heard);
    let take = move |token: zenoh::sample::Sample| {
        tokens.lock().unwrap().push(format!("token {}", token.key_expr()))
    };
    listener
        .liveliness()
        .declare_subscriber(format!("{front}/alive"))
        .history(true)
        .callback(take)
        .background()
        .wait()
        .unwrap();
    attacks += 1;
    // Answers in the place of the gateway.
    let answer = |query: zenoh::query::Query| drop(query.reply_err("refused forged").wait());
    for key in [format!("rcs/{CELL}/open/workstation/{VICTIM}"), format!("rcs/{CELL}/open/**")] {
        listener.declare_queryable(key).callback(answer).background().wait().unwrap();
        attacks += 1;
    }
    (heard, attacks)
}

/// Sends commands and ends in the place of the victim, and asks for claims in its name. Returns the answers.
fn speak(session: &Session, id: &str) -> (Vec<String>, u32) {
    let (mut heard, mut attacks) = (Vec::new(), 0);
    let front = format!("rcs/{CELL}/workstation/{VICTIM}/{id}");
    for key in [
        format!("{front}/in"),
        format!("rcs/{CELL}/workstation/{VICTIM}/*/in"),
        format!("rcs/{CELL}/workstation/*/*/in"),
        format!("rcs/{CELL}/**"),
        "**".to_owned(),
        format!("{front}/out"),
    ] {
        for sample in [forged(1), end()] {
            session.put(&key, sample).wait().unwrap();
            attacks += 1;
        }
        session.delete(&key).wait().unwrap();
        attacks += 1;
    }
    // The tokens of the victim and of a gateway, which disappear at once.
    for key in [format!("{front}/alive"), format!("rcs/{CELL}/alive/0123")] {
        drop(session.liveliness().declare_token(key).wait().unwrap());
        attacks += 1;
    }
    session.put(format!("rcs/{CELL}/status/run"), "forged").wait().unwrap();
    attacks += 1;
    // A claim in the name of the victim, and by wildcard.
    for key in [format!("rcs/{CELL}/open/workstation/{VICTIM}"), format!("rcs/{CELL}/open/*/*")] {
        let replies = session.get(key).payload("0".repeat(32)).consolidation(ConsolidationMode::None);
        for reply in replies.timeout(Duration::from_secs(1)).wait().unwrap() {
            match reply.into_result() {
                Ok(sample) => heard.push(format!("claim {}", sample.key_expr())),
                Err(error) if error.payload().to_bytes().starts_with(b"refused") => {
                    heard.push("an answer".into());
                }
                Err(_) => {}
            }
        }
        attacks += 1;
    }
    (heard, attacks)
}

/// Numbers of the last command and of the last mailgram that the run has read.
fn echo(claim: &Claim) -> (u16, u16) {
    let mut data = Vec::new();
    let is_known = eventually(|| {
        let found = claim.frames().into_iter().find(|(address, _)| *address == HWSC_STATUS.address);
        data = found.map(|(_, data)| data).unwrap_or_default();
        !data.is_empty()
    });
    assert!(is_known, "the run has no status");
    let status = status::decode(&data).unwrap();
    (status.echo, status.mailgram_echo)
}

#[test]
fn no_certificate_gets_beyond_its_role() {
    let attackers = ["hwsc-2", "data-1", "pedestal-1", "vision-1", "op-1", "mes", "nobody"];
    let shop = Shop::new(&[&[VICTIM][..], &attackers].concat());
    let run = shop.run(&[
        "--clock",
        "real",
        "--outside",
        "workstation,data-system,pedestal,vision",
        "--operator",
        "network",
    ]);
    let gateway = shop.serve(&[
        "workstation=hwsc-1,hwsc-2",
        "data-system=data-1",
        "pedestal=pedestal-1",
        "vision=vision-1",
        "operator=op-1",
        "monitor=mes",
    ]);
    let keys = shop.path("keys");
    let honest = connect(&keys, VICTIM, &shop.endpoint()).unwrap();
    let claim = Claim::open(honest, CELL, VICTIM, &"c".repeat(32)).unwrap();
    assert!(claim.is_alive(), "{}", run.errors());
    let before = echo(&claim);
    for name in attackers {
        // Two sessions are needed, because a session receives its own samples.
        let attacker = || connect(&keys, name, &shop.endpoint()).unwrap();
        let (listener, speaker) = (attacker(), attacker());
        let (heard, listening) = listen(&listener, &claim.id);
        let (answers, speaking) = speak(&speaker, &claim.id);
        thread::sleep(Duration::from_millis(300));
        assert_eq!(echo(&claim), before, "{name} has commanded the run");
        assert!(claim.is_alive(), "{name} has ended the claim");
        let mut heard = heard.lock().unwrap().clone();
        heard.sort();
        heard.dedup();
        assert!(heard.is_empty(), "{name} has heard {heard:?}");
        assert!(answers.is_empty(), "{name} was answered {answers:?}");
        println!("{name}: {} attacks, without effect", listening + speaking);
    }
    assert!(!gateway.errors().contains("disconnected"), "{}", gateway.errors());
    assert_eq!(Role::ALL.len(), 5, "a new role needs an attacker");
}

/// The certificate of another server of the same authority is not accepted.
#[test]
fn a_neighbour_refuses_a_gateway_with_another_name() {
    let shop = Shop::new(&["hwsc-1", "other@127.0.0.1"]);
    let _run = shop.real_run();
    // This gateway serves the cell's keys with the certificate of another server.
    let keys = shop.path("keys");
    std::fs::rename(keys.join("t3.pem"), keys.join("kept.pem")).unwrap();
    std::fs::copy(keys.join("other.pem"), keys.join("t3.pem")).unwrap();
    std::fs::copy(keys.join("other.key"), keys.join("t3.key")).unwrap();
    let mut gateway = shop.start_serve(&["workstation=hwsc-1"]);
    assert_eq!(gateway.finish().code(), Some(2));
    assert!(gateway.errors().contains("common name t3, found \"other\""), "{}", gateway.errors());
    // The same with a program that does not check its own certificate.
    let rogue = crate::native::rogue_gateway(&keys, "other", &shop.endpoint()).unwrap();
    let asked = Arc::new(Mutex::new(0));
    let count = Arc::clone(&asked);
    let answer = move |query: zenoh::query::Query| {
        *count.lock().unwrap() += 1;
        drop(query.reply(query.key_expr(), "real").wait());
    };
    rogue.declare_queryable(format!("rcs/{CELL}/open/**")).callback(answer).background().wait().unwrap();
    let connect = shop.connect("workstation", "hwsc-1");
    let error = shop.hwsc("hwsc-1").err().unwrap();
    assert!(error == "closed" || error.starts_with("the gateway gives no answer"), "{error}");
    assert_eq!(*asked.lock().unwrap(), 0, "{}", connect.errors());
}

/// The gateway connects to a router for monitors. A compromised router receives the status, but commands nothing.
#[test]
fn a_compromised_router_can_neither_command_nor_read_claims() {
    let shop = Shop::new(&[VICTIM, "router@127.0.0.1"]);
    let _run = shop.real_run();
    let keys = shop.path("keys");
    let endpoint = format!("tls/127.0.0.1:{}", free_port());
    let router = router(&keys, "router", &endpoint).unwrap();
    let _gateway = shop.serve(&["workstation=hwsc-1", "monitor=router", "--router", &endpoint]);
    let honest = connect(&keys, VICTIM, &shop.endpoint()).unwrap();
    let claim = Claim::open(honest, CELL, VICTIM, &"c".repeat(32)).unwrap();
    let states = Arc::new(Mutex::new(0));
    let count = Arc::clone(&states);
    let take = move |_| *count.lock().unwrap() += 1;
    router.declare_subscriber("rcs/*/status/run").callback(take).background().wait().unwrap();
    assert!(eventually(|| *states.lock().unwrap() > 0), "the router is not connected");
    let before = echo(&claim);
    let (heard, _) = listen(&router, &claim.id);
    assert!(claim.is_alive());
    let is_status = |key: &String| key.starts_with(&format!("rcs/{CELL}/status/"));
    assert!(heard.lock().unwrap().iter().all(is_status), "the router has heard {heard:?}");
    speak(&router, &claim.id);
    thread::sleep(Duration::from_millis(300));
    assert_eq!(echo(&claim), before, "the router has commanded the run");
    assert!(claim.is_alive(), "the router has ended the claim");
}
