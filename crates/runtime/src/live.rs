//! The live view of a run: the messages of its log, sent to viewers on this machine (`docs/live.md`).

use std::{
    collections::BTreeMap,
    path::Path,
    sync::mpsc::{Receiver, channel},
};

use page::Content;
use record::{Attachment, Epoch, Tap, explanation};
use serde_json::{Value, json};
use sessions::live::{
    Feed, NoRandom, Options, Port, Server,
    commands::{Access, Knob, Token},
    protocol::ServerInfo,
};

use rcs_core::tick::Tick;

use crate::{
    config::{ClockKind, LogTarget, RunConfig},
    error::StartError,
    observer::Observer,
};

pub struct Live {
    feed: Feed,
    knob: Knob,
    port: Option<Port>, // the port at which viewers wait until they are served
    server: Option<Server>,
    notices: Option<Receiver<String>>, // viewers that the server has disconnected
}

/// Data for viewers that the messages of a run do not contain.
pub struct Beginning {
    pub attachments: Vec<Attachment>,
    pub epoch: Epoch, // time of tick 0
    pub words: Words, // words of requests, for the completion of lines
}

#[derive(serde::Serialize)]
pub struct Words {
    pub first: Vec<&'static str>,
    pub names: Vec<String>,
}

impl Beginning {
    /// The page connects to its server. It contains no command line and no paths, because other users can read it.
    fn page(&self, job: &str, mut run: BTreeMap<String, String>) -> String {
        run.insert(TICK_0.to_owned(), self.epoch.of(Tick::BEFORE_START).to_string());
        let added = [
            json("tables.json", &explanation::tables()),
            json("reasons.json", &explanation::reasons()),
            json("words.json", &json!(self.words)),
        ];
        page::document(job, Content::Run(&page::pack_start(&run, &self.attachments, &added)))
    }
}

const TICK_0: &str = "tick_0_ns"; // metadata of the page: the time of tick 0, nanoseconds since 1970

fn json(name: &str, value: &Value) -> Attachment {
    Attachment {
        name: name.to_owned(),
        media_type: "application/json".to_owned(),
        data: value.to_string().into_bytes(),
    }
}

impl Live {
    /// Open the port, if the configuration has a live view. Fails if there is no log, or the port is not available.
    pub fn prepare(config: &RunConfig) -> Result<Option<Self>, StartError> {
        let Some(port) = config.live else { return Ok(None) };
        if config.log == LogTarget::None {
            return Err(StartError::LiveWithoutLog);
        }
        let taken = Port::take(port).map_err(|source| StartError::Live { port, source })?;
        Ok(Some(Self {
            feed: Feed::default(),
            knob: Knob::default(),
            port: Some(taken),
            server: None,
            notices: None,
        }))
    }

    #[must_use]
    pub fn tap(&self) -> Box<dyn Tap> {
        self.feed.tap()
    }

    /// Clients can send requests if operators can connect. Fails without random numbers or a thread.
    pub fn start(
        &mut self,
        config: &RunConfig,
        job: &str,
        beginning: &Beginning,
        operators: Option<&Path>,
        observer: &mut dyn Observer,
    ) -> Result<(), StartError> {
        let Some(port) = self.port.take() else { return Ok(()) };
        let access = operators.map(access).transpose()?;
        let token = access.as_ref().map(|access| access.token.clone());
        let facts = facts(config, job);
        let page = Some(beginning.page(job, facts.clone()));
        let info = ServerInfo { name: format!("rcs-run {job}"), metadata: facts, ..ServerInfo::new()? };
        let origins = config.live_origins.clone();
        let (sender, notices) = channel();
        self.notices = Some(notices);
        let options = Options {
            origins,
            page,
            info,
            knob: Some(self.knob.clone()),
            access,
            notices: Some(sender),
            ..Options::default()
        };
        let server = Server::start(port, options, self.feed.clone());
        let mut server =
            server.map_err(|source| StartError::Live { port: config.live.unwrap_or_default(), source })?;
        if let Some(address) = &config.live_socket {
            let opened = server.admit_gateway(address.path());
            opened.map_err(|source| StartError::LiveSocket { address: address.clone(), source })?;
            observer.message(&format!("rcs-gateway page can connect at {address}"));
        }
        let hint = match config.clock {
            ClockKind::Fast => "; the run does not wait for viewers; use --clock real to watch it",
            ClockKind::Real => "",
        };
        observer.message(&format!("viewers can connect at ws://{}{hint}", server.address()));
        if let Some(token) = token {
            observer.message(&format!("requests of viewers need the token {}", token.reveal()));
        }
        observer.message(&format!("open http://{}/ in a browser to see the run", server.address()));
        self.server = Some(server);
        Ok(())
    }

    /// The address of the page, once it is served.
    #[must_use]
    pub fn address(&self) -> Option<String> {
        self.server.as_ref().map(|server| format!("http://{}/", server.address()))
    }

    /// A viewer that the server has disconnected since the last call, and the reason, as a sentence.
    pub fn disconnected(&self) -> Option<String> {
        self.notices.as_ref()?.try_recv().ok()
    }

    /// Show the position of the velocity knob, per thousand, without blocking.
    pub fn knob(&self, velocity: u16) {
        self.knob.set(velocity);
    }
}

fn access(socket: &Path) -> Result<Access, NoRandom> {
    Ok(Access { socket: socket.to_owned(), token: Token::random()? })
}

fn facts(config: &RunConfig, job: &str) -> BTreeMap<String, String> {
    let facts = [
        ("job", job.to_owned()),
        ("seed", config.seed.to_string()),
        ("robot", config.robot.to_string()),
        ("clock", config.clock.text().to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("commit", crate::COMMIT.to_owned()),
    ];
    facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
