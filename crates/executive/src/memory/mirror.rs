//! The status of a run for programs that do not know its buffers: mirrored by publish-subscribe.
//!
//! `iox2`, the tool of iceoryx2 (`cargo install iceoryx2-cli`), shows no values of blackboards. So a thread publishes a
//! [`Status`] as one JSON object on the service [`SERVICE`], ten times per second. `iox2` finds a run by a
//! configuration file in the run's directory:
//!
//! ```sh
//! cd "$(rcs-run status --directory)"
//! iox2 node list
//! iox2 service hz rcs-ii/status
//! iox2 service subscribe rcs-ii/status
//! ```
//!
//! The mirror runs inside the program that moves a robot, so it must not cause that program to fail. It reads a copy of
//! the buffers that no other process can write. Its shared memory never grows; it publishes nothing while there is too
//! little for a new subscriber.

use std::{
    fs,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, ipc},
    service::service_name::ServiceName,
};

use super::{
    error::SharedMemoryError,
    name::RunName,
    place,
    publish::{self, Published, Window},
    runs,
};
use crate::status::Status;

pub const SERVICE: &str = "rcs-ii/status";
const PERIOD: Duration = Duration::from_millis(100);
/// Interval at which the thread checks whether it should end.
const LOOK: Duration = Duration::from_millis(10);
/// Longest wait for the thread at the start and the end of a run.
const MIRROR_LIMIT: Duration = Duration::from_secs(2);
const MESSAGE: usize = 16 * 1024; // greatest size of a message, bytes: about five times the usual size
const MAX_SUBSCRIBERS: usize = 8; // greatest number of monitors at a time

pub struct Mirror {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

struct Ports {
    run: RunName,
    window: Arc<Window>,
    publisher: Publisher<ipc::Service, [u8], ()>,
    _member: runs::RunNode,
}

impl Mirror {
    /// Start to mirror a run of this program. The thread inherits the priority of its creator: start it before the
    /// real-time requests. Fails with [`SharedMemoryError`] with the error of iceoryx2 or of the operating system.
    pub fn start(run: &publish::Publisher) -> Result<Self, SharedMemoryError> {
        let name = run.name();
        write_configuration(name)?;
        let stop = Arc::new(AtomicBool::new(false));
        let (seen, (say, opened)) = (Arc::clone(&stop), mpsc::channel());
        let (run, window) = (name.clone(), run.window());
        let work = move || match Ports::open(run, window) {
            Ok(ports) => {
                let _ = say.send(Ok(()));
                ports.mirror(&seen);
            }
            Err(error) => {
                let _ = say.send(Err(error));
            }
        };
        let failed = |source| SharedMemoryError::Io { path: place::place(name, &place::layout()), source };
        let thread = thread::Builder::new().name("mirror".into()).spawn(work).map_err(failed)?;
        let opened = opened.recv_timeout(MIRROR_LIMIT).unwrap_or_else(|_| {
            stop.store(true, Ordering::Relaxed);
            Err(SharedMemoryError::Late {
                what: "setting up the service of the status".to_owned(),
                limit: MIRROR_LIMIT,
            })
        });
        opened?;
        Ok(Self { stop, thread: Some(thread) })
    }
}

impl Ports {
    fn open(run: RunName, window: Arc<Window>) -> Result<Self, SharedMemoryError> {
        let failed = |error: &dyn std::fmt::Debug| SharedMemoryError::service("status", error);
        let member = runs::enter(&run, "status")?;
        let service_name = ServiceName::new(SERVICE).map_err(|error| failed(&error))?;
        let service = member
            .service_builder(&service_name)
            .publish_subscribe::<[u8]>()
            .max_subscribers(MAX_SUBSCRIBERS)
            .history_size(1)
            .enable_safe_overflow(true)
            .create()
            .map_err(|error| failed(&error))?;
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(MESSAGE)
            .allocation_strategy(AllocationStrategy::Static)
            .create()
            .map_err(|error| failed(&error))?;
        place::reserve(&run)?;
        Ok(Self { run, window, publisher, _member: member })
    }

    fn mirror(self, stop: &AtomicBool) {
        let mut due = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            if Instant::now() >= due && self.publish() {
                due += PERIOD;
            }
            thread::sleep(LOOK);
        }
        // The last status, which includes the end of the run if it is over.
        self.publish();
    }

    /// Returns false, without a message, if the tick is being written at the moment. The next message follows soon.
    fn publish(&self) -> bool {
        let Some(Published { external, memory, pulse }) = self.window.with(|published| *published) else {
            return false;
        };
        if place::have_room().is_ok() {
            self.send(&Status::of(self.run.as_str(), &external, &memory, &pulse));
        }
        true
    }

    fn send(&self, status: &Status) {
        let Ok(message) = serde_json::to_vec(status) else { return };
        if let Ok(sample) = self.publisher.loan_slice_uninit(message.len()) {
            let _ = sample.write_from_slice(&message).send();
        }
    }
}

impl Drop for Mirror {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let Some(thread) = self.thread.take() else { return };
        let started = Instant::now();
        // Memory that other processes can write could block the thread forever; the end of a run does not depend on it.
        while !thread.is_finished() && started.elapsed() < MIRROR_LIMIT {
            thread::sleep(Duration::from_millis(1));
        }
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}

/// Directory in which `iox2` finds the run: it looks there for `config/iceoryx2.toml`.
#[must_use]
pub fn directory(name: &RunName) -> PathBuf {
    place::place(name, &place::layout())
}

fn write_configuration(name: &RunName) -> Result<(), SharedMemoryError> {
    let config = runs::config(name)?;
    let text = toml::to_string(&config).map_err(|error| SharedMemoryError::service("status", &error))?;
    let path = place::place(name, &place::layout()).join("config");
    let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
    fs::create_dir_all(&path).map_err(failed)?;
    fs::write(path.join("iceoryx2.toml"), text).map_err(failed)
}
