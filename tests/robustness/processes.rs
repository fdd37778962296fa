//! Attacking processes: this program starts itself, so that they can be killed, stopped, or belong to another user.

use std::{
    env, fs,
    io::{BufRead as _, BufReader},
    process::{Child, Command, ExitCode, Stdio},
    thread,
    time::{Duration, Instant},
};

use clap::ValueEnum;
use executive::memory::{Attached, RunName};

const LIFE: Duration = Duration::from_secs(120); // if its parent cannot end it

/// The attack.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Process {
    /// Reads the buffers of a run on and on
    Reader,
    /// Empties every object in shared memory that it can open for writing, and prints its name
    Stranger,
}

impl Process {
    /// Returns `None` if the process could not begin, as when the run has ended.
    pub fn start(self, run: &RunName) -> Option<Child> {
        let name = self.to_possible_value().expect("no process is skipped");
        let mut child = Command::new(env::current_exe().expect("a program has a path"))
            .args(["--process", name.get_name(), "--run", run.as_str()])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("this program can be started again");
        let mut line = String::new();
        let output = child.stdout.as_mut().expect("its output is piped");
        BufReader::new(output).read_line(&mut line).expect("it has a line to say");
        if line == "at work\n" {
            return Some(child);
        }
        child.wait().expect("it has ended");
        None
    }

    pub fn be(self, run: &str) -> ExitCode {
        let began = Instant::now();
        match self {
            Self::Reader => {
                let reader = run.parse().ok().and_then(|run: RunName| Attached::open(&run).ok());
                let Some(reader) = reader else { return ExitCode::FAILURE };
                println!("at work");
                while began.elapsed() < LIFE {
                    let _ = (reader.memory(), reader.external(), reader.pulse());
                    thread::sleep(Duration::from_micros(100));
                }
            }
            Self::Stranger => {
                println!("at work");
                while began.elapsed() < LIFE {
                    for entry in fs::read_dir("/dev/shm").into_iter().flatten().flatten() {
                        if let Ok(file) = fs::File::options().write(true).open(entry.path())
                            && file.set_len(0).is_ok()
                        {
                            println!("opened {}", entry.path().display());
                        }
                    }
                }
            }
        }
        ExitCode::SUCCESS
    }
}
