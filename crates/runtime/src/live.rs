//! The live view of a run: what its log gets, for viewers on this machine (`docs/live.md`).

use std::collections::BTreeMap;

use ::live::{Feed, Options, Server, protocol::ServerInfo, server::PATIENCE};
use record::Tap;

use crate::{
    config::{ClockKind, LogTarget, RunConfig},
    error::StartError,
    observer::Observer,
};

/// A live view, as long as it lives.
pub struct Live {
    feed: Feed,
    _server: Server,
}

impl Live {
    /// Let viewers connect, if a configuration asks for it.
    ///
    /// # Errors
    /// [`StartError`] if there is no log to show, or the port cannot be had.
    pub fn open(
        config: &RunConfig,
        job: &str,
        observer: &mut dyn Observer,
    ) -> Result<Option<Self>, StartError> {
        let Some(port) = config.live else { return Ok(None) };
        if config.log == LogTarget::None {
            return Err(StartError::LiveWithoutLog);
        }
        let facts = [
            ("job", job.to_owned()),
            ("seed", config.seed.to_string()),
            ("robot", config.robot.to_string()),
            ("clock", config.clock.text().to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("commit", crate::COMMIT.to_owned()),
        ];
        let metadata: BTreeMap<String, String> =
            facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        let info = ServerInfo { name: format!("rcs-run {job}"), metadata, ..ServerInfo::new()? };
        let options = Options { port, origins: config.live_origins.clone(), info, patience: PATIENCE };
        let feed = Feed::default();
        let server =
            Server::start(options, feed.clone()).map_err(|source| StartError::Live { port, source })?;
        let hint = match config.clock {
            ClockKind::Fast => "; the run does not wait for viewers, --clock real is for people",
            ClockKind::Real => "",
        };
        observer.message(&format!("viewers can connect at ws://{}{hint}", server.address()));
        Ok(Some(Self { feed, _server: server }))
    }

    /// What the log is to be given.
    #[must_use]
    pub fn tap(&self) -> Box<dyn Tap> {
        self.feed.tap()
    }
}
