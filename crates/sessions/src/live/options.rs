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
pub const READ_LIMIT: Duration = Duration::from_secs(5);

/// Receives a sentence per disconnected client, with the name of the client and the reason.
pub type Notices = Sender<String>;

#[derive(Clone, Debug)]
pub struct Options {
    pub origins: Vec<Origin>, // origins of web pages that may connect, in addition to Foxglove's
    pub page: Option<String>, // the web page that connects to this server, if any
    pub info: ServerInfo,     // the first message to clients
    pub patience: Duration,   // time without reading after which a client is disconnected
    pub knob: Option<Knob>,   // the velocity knob, if any
    pub access: Option<Access>, // access for requests; `None` if the run accepts none
    pub notices: Option<Notices>, // receives the reasons of disconnects, if set
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
        Self { origins, page, info, patience: READ_LIMIT, knob: None, access: None, notices: None }
    }
}
