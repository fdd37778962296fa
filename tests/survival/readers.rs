//! Permissions of the shared files of a run.

use std::{fs, os::unix::fs::PermissionsExt, path::Path};

use executive::memory;
use whole_system_tests::{
    Scratch,
    bench::{Running, assert_cleaned, traces},
};

#[test]
fn shared_files_belong_to_the_owner_alone() {
    let scratch = Scratch::new("modes");
    let mut run = Running::start(&scratch.file(""), "linkbar", &["--clock", "real", "--log", "none"]);
    drop(run.attach());
    let mode = |path: &Path| fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
    assert_eq!(mode(&memory::root()), 0o700, "no other user may open the files in it");
    let objects: Vec<_> = traces(&run.name).into_iter().filter(|path| path.starts_with("/dev/shm")).collect();
    assert!(objects.len() > 16, "{objects:?}");
    for object in objects {
        assert_eq!(mode(&object) & 0o077, 0, "{}", object.display());
    }
    run.kill();
    assert_cleaned(&scratch.file(""), &run.name);
}
