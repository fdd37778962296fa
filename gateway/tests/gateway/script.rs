//! The shop of `gateway/shop.sh` with its monitor.

use std::process::Command;

use crate::shop::{Process, eventually, free_port, program};

#[test]
fn script_starts_five_cells_that_the_monitor_sees_executing_and_ends_all_of_them() {
    let directory = tempfile::tempdir().unwrap();
    // The ports of the gateways follow the port of the router.
    let port = (0..20).map(|_| free_port()).find(|port| (1..=5).all(|more| is_free(port + more))).unwrap();
    let mut command = Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/shop.sh"));
    command.arg(directory.path()).env("RCS_SHOP_PORT", port.to_string());
    command.env("RCS_PROGRAMS", program("rcs-run").parent().unwrap());
    command.env("RCS_GATEWAY", env!("CARGO_BIN_EXE_rcs-gateway"));
    let mut shop = Process::start(&mut command, directory.path().join("shop.err"));
    let watch = || {
        let output = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"))
            .args(["monitor", &format!("tls/127.0.0.1:{port}"), "--name", "mes", "--count", "2", "--keys"])
            .arg(directory.path().join("keys"))
            .output()
            .unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let mut page = String::new();
    let all_execute = eventually(|| {
        page = watch();
        let is_seen = |cell: &str| {
            let line = page.lines().rev().find(|line| line.starts_with(cell));
            line.is_some_and(|line| {
                line.contains(" tick ") && line.contains(&format!("workstation hwsc-{cell}"))
            })
        };
        ["c1", "c2", "c3", "c4", "c5"].into_iter().all(is_seen)
    });
    assert!(all_execute, "{page}\n{}", shop.errors());
    println!("{page}");
    shop.terminate();
    assert!(shop.finish().success());
    assert!(eventually(|| (0..=5).all(|more| is_free(port + more))), "a gateway is still running");
    assert!(!directory.path().join("c3.sock").exists(), "a run has left its socket");
}

fn is_free(port: u16) -> bool {
    std::net::TcpListener::bind(("127.0.0.1", port)).is_ok()
}
