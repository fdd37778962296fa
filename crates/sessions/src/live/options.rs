//! Options of the server.

use std::{sync::mpsc::Sender, time::Duration};

use crate::live::{
    commands::{Access, Knob},
    origin::Origin,
    protocol::ServerInfo,
};

/// Time after which a client that reads nothing is disconnected.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Receives a sentence for each client that the server disconnects, with the name of the client and the reason.
pub type Notices = Sender<String>;

#[derive(Clone, Debug)]
pub struct Options {
    /// Origins of web pages that may connect, besides Foxglove's.
    pub origins: Vec<Origin>,
    /// The web page, which connects to this server; `None` if there is none.
    pub page: Option<String>,
    /// The first message to clients.
    pub info: ServerInfo,
    /// Time after which a client that reads nothing is disconnected.
    pub patience: Duration,
    /// The velocity knob; `None` if there is none.
    pub knob: Option<Knob>,
    /// Access for requests; `None` if the run accepts none.
    pub access: Option<Access>,
    /// Receives the reasons of disconnects; `None` if nobody wants to know.
    pub notices: Option<Notices>,
}

impl Default for Options {
    fn default() -> Self {
        let (info, origins, page) = (ServerInfo::default(), Vec::new(), None);
        Self { origins, page, info, patience: PATIENCE, knob: None, access: None, notices: None }
    }
}
