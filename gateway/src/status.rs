//! The data for monitors: `status/run` five times a second, and the image of each mailbox whenever it changes.
//!
//! The source is the mailboxes that pass through this gateway, so the run is not involved. `status/run` has the state
//! of Task while a workstation controller is connected through this gateway.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
    thread,
    time::Duration,
};

use neighbours::{
    line::Role,
    mailbox::{HWSC_STATUS, Mailbox},
    workstation::status,
};
use rustix::fs::{FileType, stat};
use serde_json::{Value, json};
use zenoh::{
    Session, Wait as _,
    qos::{CongestionControl, Priority},
    query::Query,
};

use crate::{keyspace::CellKeys, sample::State};

const PERIOD: Duration = Duration::from_millis(200); // time between two messages about the run

#[derive(Debug, Default)]
struct Known {
    tick: Option<u64>,
    /// Roles that are connected through this gateway, with the names of their certificates.
    roles: BTreeMap<&'static str, String>,
    mailboxes: BTreeMap<u32, Mailbox>,
}

pub struct Board {
    session: Session,
    cell: CellKeys,
    run: PathBuf,
    known: Arc<Mutex<Known>>,
}

impl Board {
    pub fn start(session: &Session, cell: &CellKeys, run: PathBuf) -> Result<Self, zenoh::Error> {
        let known: Arc<Mutex<Known>> = Arc::default();
        let publisher = session
            .declare_publisher(cell.run())
            .priority(Priority::Data)
            .congestion_control(CongestionControl::Drop)
            .wait()?;
        let (asked, path, key) = (Arc::clone(&known), run.clone(), cell.run());
        let answer = move |query: Query| {
            // The key of the query may match all cells. If the reply fails, the monitor has disconnected.
            let _ = query.reply(&key, lock(&asked).describe(is_socket(&path))).wait();
        };
        session.declare_queryable(cell.run()).callback(answer).background().wait()?;
        let (weak, path): (Weak<Mutex<Known>>, _) = (Arc::downgrade(&known), run.clone());
        thread::spawn(move || {
            while let Some(known) = weak.upgrade() {
                let text = lock(&known).describe(is_socket(&path));
                // The next status follows soon.
                let _ = publisher.put(text).wait();
                drop(known);
                thread::sleep(PERIOD);
            }
        });
        Ok(Self { session: session.clone(), cell: cell.clone(), run, known })
    }

    /// True if there is a socket at the path of the run. Connecting to it would appear in the log of the run.
    #[must_use]
    pub fn is_there(&self) -> bool {
        is_socket(&self.run)
    }

    pub fn connected(&self, role: Role, name: &str) {
        lock(&self.known).roles.insert(role.text(), name.to_owned());
    }

    /// A role is no longer connected, so its mailboxes become unknown.
    pub fn disconnected(&self, role: Role) {
        let mut known = lock(&self.known);
        known.roles.remove(role.text());
        for place in role.from_controller().iter().chain(role.to_controller()) {
            known.mailboxes.remove(&place.address);
        }
        if known.roles.is_empty() {
            known.tick = None;
        }
    }

    pub fn update(&self, state: &State) {
        let mut changed = Vec::new();
        {
            let mut known = lock(&self.known);
            known.tick = state.pulse.or(known.tick);
            for mailbox in state.mailboxes() {
                let address = mailbox.place().address;
                if known.mailboxes.get(&address) != Some(mailbox) {
                    known.mailboxes.insert(address, mailbox.clone());
                    changed.push((address, mailbox.used().to_vec()));
                }
            }
        }
        for (address, image) in changed {
            let put = self.session.put(self.cell.mailbox(address), image);
            // If this fails, the monitor gets the next change.
            let _ = put.priority(Priority::DataLow).congestion_control(CongestionControl::Drop).wait();
        }
    }
}

impl Known {
    fn describe(&self, is_there: bool) -> String {
        let status = self.mailboxes.get(&HWSC_STATUS.address);
        let status = status.and_then(|mailbox| status::decode(mailbox.data()).ok());
        let (command, state, reason) = match &status {
            Some(status) => (
                json!(status.command.to_string().trim_end()),
                json!(status.report.to_string()),
                json!(status.reason.trim_end()),
            ),
            None => (Value::Null, Value::Null, Value::Null),
        };
        json!({
            "run": is_there, "tick": self.tick, "connected": self.roles,
            "command": command, "state": state, "reason": reason,
        })
        .to_string()
    }
}

fn lock(known: &Mutex<Known>) -> MutexGuard<'_, Known> {
    known.lock().unwrap_or_else(PoisonError::into_inner)
}

fn is_socket(path: &std::path::Path) -> bool {
    stat(path).is_ok_and(|found| FileType::from_raw_mode(found.st_mode) == FileType::Socket)
}
