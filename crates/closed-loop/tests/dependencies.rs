//! A closed loop depends on no package that does I/O or runs a clock.

use std::{collections::BTreeSet, env, process::Command};

/// Packages that do I/O or measure time, and their users in this workspace.
const WITH_IO: [&str; 15] = [
    "executive",
    "getrandom",
    "iceoryx2",
    "mio",
    "record",
    "ring",
    "rusqlite",
    "rustls",
    "serialport",
    "sessions",
    "signal-hook",
    "sockets",
    "thread-priority",
    "tungstenite",
    "zenoh",
];

/// All direct and indirect dependencies of a package, without those of tests.
fn below(package: &str) -> BTreeSet<String> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = ["tree", "--offline", "--edges", "normal", "--prefix", "none", "--package", package];
    let output = Command::new(cargo).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.expect("cargo has built this test");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tree = String::from_utf8_lossy(&output.stdout);
    tree.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn no_package_below_the_closed_loop_does_io() {
    let found = below("closed-loop");
    assert!(found.contains("levels") && found.contains("neighbours"), "{found:?}");
    let with_io: Vec<_> = WITH_IO.into_iter().filter(|name| found.contains(*name)).collect();
    assert_eq!(with_io, [""; 0]);
    let runtime = below("runtime");
    let missing: Vec<_> =
        ["iceoryx2", "rusqlite", "serialport"].into_iter().filter(|name| !runtime.contains(*name)).collect();
    assert_eq!(missing, [""; 0], "the names above are those of packages");
}
