//! The keeper of a Data System on a separate thread, because the disk must not delay a tick.
//!
//! A run in fast clock waits when an answer is due, so that its ticks are the same in every run. On the 40 ms grid it
//! uses the answer once it has arrived. At its end a run does not wait for a server in another process.

use std::{
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use neighbours::data_system::{Answer, Item, ItemStore, Records as _, Reply, Server};

use super::{
    agent::{Agent, Remark},
    store::Store,
};
use crate::network::StopHandle;

/// Time after which a waiting run considers the server dead, long even for a disk. An agent has its own time limit.
const END_LIMIT: Duration = Duration::from_secs(30);

/// Time between two checks for a server while no command is in progress.
const IDLE: Duration = Duration::from_millis(500);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// For runs in fast clock: the tick waits for an answer that is due.
    Wait,
    /// For runs on the grid: the answer takes effect in the tick of its arrival.
    Poll,
}

enum Request {
    Execute(u16, Vec<u8>),
    Items,
    Look,
}

enum Response {
    Executed(u16, Answer),
    /// The command of this number has no answer.
    Silent(u16),
    Items(rusqlite::Result<Vec<Item>>),
    Looked,
}

enum Place {
    Here(Box<Server<Store>>),
    Elsewhere(Box<Agent>),
}

impl Place {
    fn respond(&mut self, request: Request) -> Response {
        match (&mut *self, request) {
            (Self::Here(server), Request::Execute(id, bytes)) => {
                Response::Executed(id, server.execute(&bytes))
            }
            (Self::Here(server), Request::Items) => Response::Items(server.records().items()),
            (Self::Elsewhere(agent), Request::Execute(id, bytes)) => {
                agent.execute(&bytes).map_or(Response::Silent(id), |answer| Response::Executed(id, answer))
            }
            // Only the process that keeps the items can list them.
            (Self::Elsewhere(_), Request::Items) => Response::Items(Ok(Vec::new())),
            (_, Request::Look) => {
                self.idle();
                Response::Looked
            }
        }
    }

    fn idle(&mut self) {
        if let Self::Elsewhere(agent) = self {
            agent.idle();
        }
    }

    fn remarks(&mut self) -> Vec<Remark> {
        match self {
            Self::Here(_) => Vec::new(),
            Self::Elsewhere(agent) => agent.remarks(),
        }
    }
}

#[derive(Debug)]
pub struct Threaded {
    pace: Pace,
    remarks: Receiver<Remark>,
    stop_handle: Option<StopHandle>, // ends the wait for a server in another process, if there is one
    requests: Option<Sender<Request>>,
    responses: Receiver<Response>,
    thread: Option<JoinHandle<()>>,
}

impl Threaded {
    pub fn here(store: Store, pace: Pace) -> Self {
        Self::with(Place::Here(Box::new(Server::new(store))), pace)
    }

    pub fn elsewhere(agent: Agent, pace: Pace) -> Self {
        let stop_handle = Some(agent.stop_handle());
        let mut threaded = Self::with(Place::Elsewhere(Box::new(agent)), pace);
        threaded.stop_handle = stop_handle;
        threaded
    }

    fn with(mut place: Place, pace: Pace) -> Self {
        let (requests, incoming) = channel::<Request>();
        let (outgoing, responses) = channel();
        let (tell, remarks) = channel();
        let thread = thread::spawn(move || {
            loop {
                let response = match incoming.recv_timeout(IDLE) {
                    Ok(request) => Some(place.respond(request)),
                    Err(RecvTimeoutError::Timeout) => {
                        place.idle();
                        None
                    }
                    Err(RecvTimeoutError::Disconnected) => return,
                };
                // The remarks precede the answer, so that a tick that has waited for the answer also has them.
                let told = place.remarks().into_iter().all(|remark| tell.send(remark).is_ok());
                if !told || response.is_some_and(|response| outgoing.send(response).is_err()) {
                    return;
                }
            }
        });
        Self { pace, remarks, stop_handle: None, requests: Some(requests), responses, thread: Some(thread) }
    }

    /// Check for a server in another process. If the run waits for answers, wait for the result, because [`IDLE`] is
    /// many ticks in fast clock.
    pub fn look(&self) {
        if self.pace == Pace::Poll || self.stop_handle.is_none() || !self.send(Request::Look) {
            return;
        }
        while !matches!(self.responses.recv(), Ok(Response::Looked) | Err(_)) {}
    }

    /// Remarks about a server in another process since the last call.
    pub fn remarks(&self) -> Vec<Remark> {
        self.remarks.try_iter().collect()
    }

    fn send(&self, request: Request) -> bool {
        self.requests.as_ref().is_some_and(|requests| requests.send(request).is_ok())
    }

    fn response(&self) -> Result<Option<Response>, Dead> {
        match self.pace {
            Pace::Poll => match self.responses.try_recv() {
                Ok(response) => Ok(Some(response)),
                Err(TryRecvError::Empty) => Ok(None),
                Err(TryRecvError::Disconnected) => Err(Dead),
            },
            Pace::Wait if self.stop_handle.is_some() => self.responses.recv().map(Some).map_err(|_| Dead),
            Pace::Wait => self.responses.recv_timeout(END_LIMIT).map(Some).map_err(|_| Dead),
        }
    }
}

struct Dead;

impl ItemStore for Threaded {
    fn execute(&mut self, id: u16, bytes: &[u8]) -> bool {
        self.send(Request::Execute(id, bytes.to_vec()))
    }

    fn reply(&mut self, id: u16) -> Reply {
        loop {
            match self.response() {
                Ok(Some(Response::Executed(of, answer))) if of == id => return Reply::Answer(answer),
                Ok(Some(Response::Silent(of))) if of == id => return Reply::Silent,
                Ok(Some(_)) => {}
                Ok(None) => return Reply::Pending,
                Err(Dead) => return Reply::Dead,
            }
        }
    }

    fn items(&mut self) -> Result<Vec<Item>, String> {
        if self.stop_handle.is_some() {
            // The thread may be waiting for that process.
            return Ok(Vec::new());
        }
        if !self.send(Request::Items) {
            return Err("the Data System has ended".to_owned());
        }
        loop {
            match self.responses.recv_timeout(END_LIMIT) {
                Ok(Response::Items(items)) => return items.map_err(|error| error.to_string()),
                Ok(Response::Executed(..) | Response::Silent(_) | Response::Looked) => {}
                Err(_) => return Err("the Data System does not answer".to_owned()),
            }
        }
    }
}

impl Drop for Threaded {
    fn drop(&mut self) {
        if let Some(stop_handle) = &self.stop_handle {
            stop_handle.stop();
        }
        // Closing the channel of requests ends the thread. It closes the database, so that no journal is left.
        self.requests = None;
        let Some(thread) = self.thread.take() else { return };
        let ended = Instant::now();
        // A disk could block the thread indefinitely. The end of a run must not depend on it.
        while !thread.is_finished() && ended.elapsed() < END_LIMIT {
            thread::sleep(Duration::from_millis(1));
        }
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}
