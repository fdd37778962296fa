//! `rcs-run --console`: starts the operator's console on the terminal of the run.

use std::{
    io,
    path::PathBuf,
    process::{Child, Command},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use executive::memory::RunName;

use crate::{error::Error, programs};

/// Name of the console program, which is installed in the same directory.
const PROGRAM: &str = "rcs-console";

/// The console of a run.
pub struct Console {
    waiting: JoinHandle<()>,
}

impl Console {
    /// Path of the console program.
    ///
    /// # Errors
    /// [`Error::NoConsole`] if it is not beside this program.
    pub fn program() -> Result<PathBuf, Error> {
        let program = programs::beside(PROGRAM)?;
        if program.is_file() { Ok(program) } else { Err(Error::NoConsole(program)) }
    }

    /// Show a run with shared memory. When the operator leaves the console, `stop` is set: the robot ramps to rest, and
    /// the run ends.
    ///
    /// # Errors
    /// [`Error::Console`] if it cannot be started.
    pub fn start(program: PathBuf, run: &RunName, stop: Arc<AtomicBool>) -> Result<Self, Error> {
        let mut command = Command::new(program);
        let mut child = command.args(["--operate", "--run", run.as_str()]).spawn().map_err(Error::Console)?;
        let waiting = thread::spawn(move || {
            // However the console ends, nobody watches the robot any more.
            let _ = ended(&mut child);
            stop.store(true, Ordering::Relaxed);
        });
        Ok(Self { waiting })
    }

    /// Wait until the operator leaves the console, which shows the last picture after the end of a run.
    pub fn wait(self) {
        // The thread does not panic.
        let _ = self.waiting.join();
    }
}

fn ended(child: &mut Child) -> io::Result<()> {
    child.wait().map(|_| ())
}
