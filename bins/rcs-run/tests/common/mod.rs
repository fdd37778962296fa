//! Helpers of the tests of the program.

pub mod data;

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-run"));
    command.args(arguments).current_dir(root()).stdin(Stdio::null());
    command
}
