//! The EGM robot of a station, in its own thread.

use std::{
    io,
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Sender, channel},
    },
    thread::{self, JoinHandle},
};

use executive::{
    egm::EgmOptions,
    realtime::{self, FIELD_PRIORITY},
};
use geometry::kinematics::{HOME_JOINTS, Joints};

use crate::{cli::EgmTarget, emulate::Emulation};

pub struct Robot {
    joints: Arc<Mutex<Joints>>,
    buttons: Sender<String>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl Robot {
    pub fn start(options: &EgmOptions, data: &Path) -> Result<Self, String> {
        let mut emulation = Emulation::new(&EgmTarget(options.clone()), data)?;
        let joints = Arc::new(Mutex::new(HOME_JOINTS));
        let (buttons, pressed) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let (ended, shown) = (Arc::clone(&stop), Arc::clone(&joints));
        let thread = thread::Builder::new()
            .name("robot".into())
            .spawn(move || {
                // The station reports missing settings for its own thread. This thread gets at most the same ones.
                let _ = realtime::raise_priority(FIELD_PRIORITY);
                emulation.run(&ended, &pressed, |robot| {
                    *shown.lock().unwrap_or_else(PoisonError::into_inner) = *robot.joints();
                })
            })
            .map_err(|error| format!("no thread for the robot: {error}"))?;
        Ok(Self { joints, buttons, stop, thread: Some(thread) })
    }

    /// Angles of the joints now, rad.
    pub fn joints(&self) -> Joints {
        *self.joints.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Presses a button: a command of `rcs-cell --emulate`.
    pub fn press(&self, button: &str) {
        // If the thread has ended, its failure is reported.
        let _ = self.buttons.send(button.to_owned());
    }

    /// Returns the failure of the robot's socket, once.
    pub fn failure(&mut self) -> Option<io::Error> {
        let thread = self.thread.take_if(|thread| thread.is_finished())?;
        thread.join().unwrap_or_else(|_| Err(io::Error::other("its thread has panicked"))).err()
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // The thread has already reported a failure.
            let _ = thread.join();
        }
    }
}
