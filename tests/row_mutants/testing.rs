//! Tests run separately, with a selected change, or to find the changes that they reach.

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::switch::{CHANGED, REACHED};

#[derive(Clone, Debug)]
pub struct Program {
    pub path: PathBuf,
    pub directory: PathBuf, // of the package, in which it is run
}

#[derive(Debug)]
pub struct Test<'a> {
    program: &'a Program,
    pub name: String,
    pub taken: Duration,
    pub reaches: BTreeSet<usize>, // changes that would have decided otherwise
}

impl Program {
    fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        command.current_dir(&self.directory).env("CARGO_MANIFEST_DIR", &self.directory);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        // The same random cases for each change, without shrinking.
        command.env("PROPTEST_RNG_SEED", "1988").env("PROPTEST_CASES", "16").env("RCS_MOVES", "2000");
        command.env("PROPTEST_MAX_SHRINK_ITERS", "0");
        command
    }

    pub fn tests(&self) -> io::Result<Vec<String>> {
        let output = self.command().args(["--list", "--format=terse"]).stdout(Stdio::piped()).output()?;
        let listed = String::from_utf8_lossy(&output.stdout).into_owned();
        Ok(listed.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
    }
}

impl<'a> Test<'a> {
    /// `reached` is a separate file for this test.
    pub fn measure(program: &'a Program, name: String, reached: &Path) -> io::Result<Self> {
        fs::write(reached, "")?;
        let mut test = Self { program, name, taken: Duration::ZERO, reaches: BTreeSet::new() };
        let began = Instant::now();
        if !program.command().args(["--exact", &test.name]).env(REACHED, reached).status()?.success() {
            return Err(io::Error::other(format!("{} fails without a change", test.name)));
        }
        test.taken = began.elapsed();
        test.reaches = fs::read_to_string(reached)?.lines().filter_map(|line| line.parse().ok()).collect();
        Ok(test)
    }

    /// The time limit is three times its duration without the change, and some seconds.
    pub fn passes(&self, change: usize) -> io::Result<bool> {
        let patience = self.taken * 3 + Duration::from_secs(20);
        let mut command = self.program.command();
        command.args(["--exact", &self.name]).env(CHANGED, change.to_string());
        let (mut child, began) = (command.spawn()?, Instant::now());
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok(status.success());
            }
            if began.elapsed() > patience {
                child.kill()?;
                child.wait()?;
                return Ok(false);
            }
            thread::sleep(Duration::from_millis(5));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    /// Two tests, of which change 3 breaks one.
    const SCRIPT: &str = r#"#!/bin/sh
case "$*" in
    --list*) echo 'opens: test'; echo 'closes: test' ;;
    *opens) [ -z "$RCS_REACHED_ROWS" ] || echo 3 >> "$RCS_REACHED_ROWS"; [ "$RCS_CHANGED_ROW" != 3 ] ;;
esac
"#;

    #[test]
    fn test_reports_reached_and_detected_changes() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("program");
        fs::write(&path, SCRIPT).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        let program = Program { path, directory: directory.path().to_owned() };
        let names = program.tests().unwrap();
        assert_eq!(names, ["opens", "closes"]);
        let reached = directory.path().join("reached");
        let [opens, closes] =
            ["opens", "closes"].map(|name| Test::measure(&program, name.to_owned(), &reached).unwrap());
        assert_eq!((opens.reaches.len(), opens.reaches.contains(&3), closes.reaches.len()), (1, true, 0));
        assert_eq!([2, 3].map(|change| opens.passes(change).unwrap()), [true, false]);
    }
}
