//! The other programs of this workspace, and how a person starts them from the present terminal.

use std::{
    env, io,
    path::{Path, PathBuf},
};

use os_io::shell;

/// Path of a program that is installed in the directory of this one.
pub fn beside(program: &str) -> io::Result<PathBuf> {
    Ok(env::current_exe()?.with_file_name(program))
}

/// The beginning of a command line that starts a program like this one: with cargo, by a path, or by its name.
pub fn start_of(program: &str) -> String {
    let is_by_cargo = env::var_os("CARGO_MANIFEST_DIR").is_some();
    let own = env::args_os().next().map(PathBuf::from).unwrap_or_default();
    started_as(program, is_by_cargo, &own)
}

fn started_as(program: &str, is_by_cargo: bool, own: &Path) -> String {
    if is_by_cargo {
        let profile = if cfg!(debug_assertions) { "" } else { " --release" };
        return format!("cargo run{profile} --bin {program} --");
    }
    let is_by_path = own.parent().is_some_and(|directory| !directory.as_os_str().is_empty());
    if is_by_path { shell::path(own.with_file_name(program)) } else { program.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_command_follows_this_program() {
        let as_by = |own: &str| started_as("rcs-log", false, Path::new(own));
        assert_eq!(as_by("rcs-run"), "rcs-log");
        assert_eq!(as_by("target/release/rcs-run"), "target/release/rcs-log");
        assert_eq!(as_by("/opt/my robot/rcs-run"), "'/opt/my robot/rcs-log'");
        assert!(started_as("rcs-log", true, Path::new("x/rcs-run")).ends_with(" --bin rcs-log --"));
    }
}
