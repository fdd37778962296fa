//! Clients that keep the gateway busy.

use std::{
    io::Write as _,
    net::TcpStream,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use os_io::stdout_line;
use zenoh::Wait as _;

use crate::shop::{Hwsc, Shop};

const CROWD: usize = 300; // number of bad clients; as many of them as this connect again in a second
const THREADS: usize = 4;

/// Admits an honest client during an attack by many clients, and prints the time until then.
fn admitted_beside(shop: &Shop, crowd: impl FnOnce(&Arc<AtomicBool>)) {
    let _run = shop.real_run();
    let gateway = shop.serve(&["workstation=hwsc-1"]);
    let _connect = shop.connect("workstation", "hwsc-1");
    let is_over = Arc::new(AtomicBool::new(false));
    crowd(&is_over);
    thread::sleep(Duration::from_millis(500));
    let start = Instant::now();
    shop.hwsc("hwsc-1").unwrap();
    let needed = start.elapsed();
    is_over.store(true, Ordering::SeqCst);
    let lines = gateway.errors().lines().count();
    stdout_line!("beside {CROWD} bad clients: admitted after {needed:?}; the log has {lines} lines");
    assert!(lines < 60, "the log is flooded: {lines} lines");
}

#[test]
fn silent_clients_keep_no_honest_one_out() {
    let shop = Shop::new(&["hwsc-1"]);
    let port = shop.port;
    let mut silent = Vec::new();
    admitted_beside(&shop, |_| {
        silent.extend((0..CROWD).map(|_| TcpStream::connect(("127.0.0.1", port)).unwrap()));
    });
}

#[test]
fn clients_that_send_garbage_keep_no_honest_one_out() {
    let shop = Shop::new(&["hwsc-1"]);
    let port = shop.port;
    admitted_beside(&shop, |is_over| {
        for _ in 0..THREADS {
            let is_over = Arc::clone(is_over);
            thread::spawn(move || {
                let mut open = Vec::new();
                while !is_over.load(Ordering::SeqCst) {
                    if let Ok(mut stream) = TcpStream::connect(("127.0.0.1", port)) {
                        // The gateway may have closed it already.
                        let _ = stream.write_all(&[0xA5; 600]);
                        open.push(stream);
                    }
                    if open.len() > CROWD / THREADS {
                        open.clear();
                    }
                    thread::sleep(Duration::from_secs(1) / u32::try_from(CROWD / THREADS).unwrap());
                }
            });
        }
    });
}

/// A client that tries again without a pause would fill the eight places of the run for refused connections.
#[test]
fn refused_client_that_hammers_keeps_no_other_client_out() {
    let shop = Shop::new(&["eye"]);
    // The run has its own vision system, and refuses another one.
    let run = shop.real_run();
    let gateway = shop.serve(&["vision=eye"]);
    let is_over = AtomicBool::new(false);
    let keys = shop.path("keys");
    thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                let session = crate::native::connect(&keys, "eye", &shop.endpoint()).unwrap();
                while !is_over.load(Ordering::SeqCst) {
                    let replies = session.get("rcs/t3/open/vision/eye").payload("0".repeat(32));
                    // All of them are refused.
                    replies.wait().unwrap().into_iter().for_each(drop);
                }
            });
        }
        // The places fill within the first second.
        thread::sleep(Duration::from_secs(1));
        let admitted: Result<Vec<_>, _> = (0..20)
            .map(|_| {
                thread::sleep(Duration::from_millis(100));
                Hwsc::connect(&shop.run_socket()).map(drop)
            })
            .collect();
        is_over.store(true, Ordering::SeqCst);
        assert!(admitted.is_ok(), "{admitted:?}\n{}", run.errors());
    });
    let errors = gateway.errors();
    assert!(errors.contains("vision eye was refused: no vision was expected in another process"), "{errors}");
    assert!(errors.lines().count() < 30, "the log is flooded: {errors}");
}
