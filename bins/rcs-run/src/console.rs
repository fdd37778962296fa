//! `rcs-run --console`: the operator's console beside the run, on the same terminal.

use std::{
    env, io,
    path::PathBuf,
    process::{Child, Command},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use executive::memory::RunName;

use crate::error::Error;

/// The program, which is installed beside this one.
const PROGRAM: &str = "rcs-console";

/// The console of a run.
pub struct Console {
    waiting: JoinHandle<()>,
}

impl Console {
    /// Where the program is.
    ///
    /// # Errors
    /// [`Error::NoConsole`] if it is not beside this program.
    pub fn program() -> Result<PathBuf, Error> {
        let program = env::current_exe()?.with_file_name(PROGRAM);
        if program.is_file() { Ok(program) } else { Err(Error::NoConsole(program)) }
    }

    /// Show a run that shares its memory. When the person leaves the console, `stop` is set: the robot ramps to rest, and
    /// the run ends.
    ///
    /// # Errors
    /// [`Error::Console`] if it cannot be started.
    pub fn start(program: PathBuf, run: &RunName, stop: Arc<AtomicBool>) -> Result<Self, Error> {
        let mut command = Command::new(program);
        let mut child = command.args(["--operate", "--run", run.as_str()]).spawn().map_err(Error::Console)?;
        let waiting = thread::spawn(move || {
            // However it ends, no one watches the robot any more.
            let _ = ended(&mut child);
            stop.store(true, Ordering::Relaxed);
        });
        Ok(Self { waiting })
    }

    /// Wait until the person has left the console: after the end of a run it shows the last picture.
    pub fn wait(self) {
        // The thread does not panic.
        let _ = self.waiting.join();
    }
}

fn ended(child: &mut Child) -> io::Result<()> {
    child.wait().map(|_| ())
}
