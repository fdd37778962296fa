//! Options of the server.

use std::{sync::mpsc::Sender, time::Duration};

use crate::{
    live::{
        commands::{Access, Knob},
        origin::Origin,
        person::{Person, Role},
        protocol::ServerInfo,
        session::Requests,
    },
    operator::Name,
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

impl Options {
    /// Whether the requests of a client are sent to the run.
    #[must_use]
    pub fn requests(&self, person: Option<&Person>) -> Requests {
        match (&self.access, person.map(|person| person.role)) {
            (None, _) => Requests::Closed,
            (Some(_), Some(Role::Viewer)) => Requests::OnlyViewer,
            (Some(_), Some(Role::Operator)) => Requests::Granted,
            (Some(access), None) => Requests::Token(access.token.clone()),
        }
    }
}

/// The name of a client among the operators of a run: `viewer-3`, or `page3.anna` for a person.
pub(crate) fn name(number: u64, person: Option<Person>) -> Option<Name> {
    match person {
        Some(person) => Some(person.name.from(&format!("page{number}."))),
        None => format!("viewer-{number}").parse().ok(),
    }
}

impl Default for Options {
    fn default() -> Self {
        let (info, origins, page) = (ServerInfo::default(), Vec::new(), None);
        Self { origins, page, info, patience: PATIENCE, knob: None, access: None, notices: None }
    }
}
