//! What certificates of the cell try beyond their role, and a certificate without any permission.

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
    native::{Claim, connect},
    shop::{CELL, Shop},
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

/// A sample that ends a claim.
fn end() -> Vec<u8> {
    let mut bytes = Vec::new();
    frame::put(&mut bytes, frame::DISCONNECT, b"forged");
    bytes
}

/// What an attacker has heard.
type Heard = Arc<Mutex<Vec<String>>>;

/// All attacks of a certificate on the claim `id` of the victim. Returns what it has heard, by key.
fn attack(session: &Session, id: &str) -> (Heard, u32) {
    let heard = Heard::default();
    let listen = |key: &str| {
        let heard = Arc::clone(&heard);
        let take =
            move |sample: zenoh::sample::Sample| heard.lock().unwrap().push(sample.key_expr().to_string());
        // A denied subscriber is declared, and hears nothing.
        session.declare_subscriber(key.to_owned()).callback(take).background().wait().unwrap();
    };
    let mut attacks = 0;
    let front = format!("rcs/{CELL}/workstation/{VICTIM}/{id}");
    // Listening.
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
    let liveliness = session.liveliness();
    liveliness
        .declare_subscriber(format!("{front}/alive"))
        .history(true)
        .callback(take)
        .background()
        .wait()
        .unwrap();
    attacks += 1;
    // Commands, and the end of the claim: direct, by wildcards, and to the neighbour.
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
    // The tokens of the victim and of a gateway, which vanish at once.
    for key in [format!("{front}/alive"), format!("rcs/{CELL}/alive/0123")] {
        drop(liveliness.declare_token(key).wait().unwrap());
        attacks += 1;
    }
    // Answers and status in the place of the gateway.
    let answer = |query: zenoh::query::Query| drop(query.reply_err("refused forged").wait());
    for key in [format!("rcs/{CELL}/open/workstation/{VICTIM}"), format!("rcs/{CELL}/open/**")] {
        session.declare_queryable(key).callback(answer).background().wait().unwrap();
        attacks += 1;
    }
    session.put(format!("rcs/{CELL}/status/run"), "forged").wait().unwrap();
    attacks += 1;
    // A claim in the name of the victim, and by wildcard.
    for key in [format!("rcs/{CELL}/open/workstation/{VICTIM}"), format!("rcs/{CELL}/open/*/*")] {
        let replies = session.get(key).payload("0".repeat(32)).consolidation(ConsolidationMode::None);
        for reply in replies.timeout(Duration::from_secs(1)).wait().unwrap() {
            match reply.into_result() {
                Ok(sample) => heard.lock().unwrap().push(format!("claim {}", sample.key_expr())),
                Err(error) if error.payload().to_bytes().starts_with(b"refused") => {
                    heard.lock().unwrap().push("an answer".into());
                }
                // Time is up.
                Err(_) => {}
            }
        }
        attacks += 1;
    }
    (heard, attacks)
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
    let echo = |claim: &Claim| {
        let frames = claim.frames();
        let (_, data) = frames.iter().find(|(address, _)| *address == HWSC_STATUS.address).unwrap();
        let status = status::decode(data).unwrap();
        (status.echo, status.mailgram_echo)
    };
    let before = echo(&claim);
    for name in attackers {
        let attacker = connect(&keys, name, &shop.endpoint()).unwrap();
        let (heard, attacks) = attack(&attacker, &claim.id);
        thread::sleep(Duration::from_millis(300));
        assert_eq!(echo(&claim), before, "{name} has commanded the run");
        assert!(claim.is_alive(), "{name} has ended the claim");
        let mut heard = heard.lock().unwrap().clone();
        heard.sort();
        heard.dedup();
        assert!(heard.is_empty(), "{name} has heard {heard:?}");
        println!("{name}: {attacks} attacks, without effect");
    }
    assert!(!gateway.errors().contains("disconnected"), "{}", gateway.errors());
    assert_eq!(Role::ALL.len(), 5, "a new role needs an attacker");
}

/// A neighbour listens to nobody but the gateway of its cell: another certificate of the same authority in its place is
/// not asked.
#[test]
fn neighbour_believes_no_gateway_with_another_name() {
    let shop = Shop::new(&["hwsc-1", "other@127.0.0.1"]);
    let _run = shop.real_run();
    // A gateway that serves the cell's keys with the certificate of another server.
    let keys = shop.path("keys");
    std::fs::rename(keys.join("t3.pem"), keys.join("kept.pem")).unwrap();
    std::fs::copy(keys.join("other.pem"), keys.join("t3.pem")).unwrap();
    std::fs::copy(keys.join("other.key"), keys.join("t3.key")).unwrap();
    let mut gateway = shop.start_serve(&["workstation=hwsc-1"]);
    assert_eq!(gateway.finish(10.0).code(), Some(2));
    assert!(gateway.errors().contains("common name t3, found \"other\""), "{}", gateway.errors());
    // The same by a program that does not check itself.
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
