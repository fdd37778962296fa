//! Options of the server.

use std::{sync::mpsc::Sender, time::Duration};

use crate::live::{
    commands::{Access, Knob},
    origin::Origin,
    protocol::ServerInfo,
};

/// Time without reading after which a client is disconnected.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Receives a sentence per disconnected client, with the name of the client and the reason.
pub type Notices = Sender<String>;

#[derive(Clone, Debug)]
pub struct Options {
    /// Origins of web pages that may connect, in addition to Foxglove's.
    pub origins: Vec<Origin>,
    /// The web page that connects to this server, if any.
    pub page: Option<String>,
    /// The first message to clients.
    pub info: ServerInfo,
    /// Time without reading after which a client is disconnected.
    pub patience: Duration,
    /// The velocity knob, if any.
    pub knob: Option<Knob>,
    /// Access for requests; `None` if the run accepts none.
    pub access: Option<Access>,
    /// Receives the reasons of disconnects, if set.
    pub notices: Option<Notices>,
}

impl Default for Options {
    fn default() -> Self {
        let (info, origins, page) = (ServerInfo::default(), Vec::new(), None);
        Self { origins, page, info, patience: PATIENCE, knob: None, access: None, notices: None }
    }
}
