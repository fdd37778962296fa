//! `rcs-run --console`: starts the operator's console on the terminal of the run.

use std::{
    path::PathBuf,
    process::{Child, Command},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use executive::memory::RunName;
use rustix::process::{Pid, Signal, kill_process};

use crate::rcs_run::{error::Error, programs};

/// Name of the console program, which is installed in the same directory.
const PROGRAM: &str = "rcs-console";
const LOOK: Duration = Duration::from_millis(20); // time between two checks of the console

pub struct Console {
    stop: Arc<AtomicBool>,
    over: Arc<AtomicBool>, // set when the run has ended
    waiting: JoinHandle<()>,
}

impl Console {
    /// Path of the console program. Fails with [`Error::NoConsole`] if it is not in the directory of this program.
    pub fn program() -> Result<PathBuf, Error> {
        let program = programs::beside(PROGRAM)?;
        if program.is_file() { Ok(program) } else { Err(Error::NoConsole(program)) }
    }

    /// Show a run with shared memory. When the operator leaves the console, or its terminal disappears, `stop` is set.
    pub fn start(program: PathBuf, run: &RunName, stop: Arc<AtomicBool>) -> Result<Self, Error> {
        let mut command = Command::new(program);
        let child = command
            .args(["--operate", "--ends-run", "--run", run.as_str()])
            .spawn()
            .map_err(Error::Console)?;
        let over = Arc::<AtomicBool>::default();
        let (stopped, ended) = (Arc::clone(&stop), Arc::clone(&over));
        let waiting = thread::spawn(move || watch(child, &stopped, &ended));
        Ok(Self { stop, over, waiting })
    }

    /// After the end of a run: wait until the operator leaves the console. A signal ends the console, too.
    pub fn wait(self) {
        while !self.waiting.is_finished() {
            self.over.store(self.stop.load(Ordering::Relaxed), Ordering::Relaxed);
            thread::sleep(LOOK);
        }
        let _ = self.waiting.join();
    }
}

/// Wait for the end of the console, and then set `stop`, because nobody watches the robot. `over` ends the console.
fn watch(mut child: Child, stop: &AtomicBool, over: &AtomicBool) {
    let mut is_asked = false;
    while matches!(child.try_wait(), Ok(None)) {
        if over.load(Ordering::Relaxed) && !is_asked {
            // The console restores the terminal. An error means that it has just ended.
            let _ = kill_process(Pid::from_child(&child), Signal::TERM);
            is_asked = true;
        }
        thread::sleep(LOOK);
    }
    stop.store(true, Ordering::Relaxed);
}
