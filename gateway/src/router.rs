//! `rcs-gateway router`: passes the status of several cells on to monitors. Any Zenoh router can do that. This router
//! also restricts each cell to its own status.

use zenoh::Wait as _;

use crate::{cli::RouterArguments, config, error::Error, keys::Keys, say, signals};

/// Routes until a signal arrives. Fails if the keys or the endpoint cannot be used.
pub fn route(arguments: &RouterArguments) -> Result<(), Error> {
    let RouterArguments { endpoint, keys, name, cells, monitors } = arguments;
    let own = Keys::named_or_only(keys, name.as_ref())?;
    let signals = signals::receive()?;
    endpoint.check_free().map_err(|source| Error::Endpoint { endpoint: *endpoint, source })?;
    let config = config::router(*endpoint, &own, cells, monitors).map_err(Error::zenoh)?;
    let session = zenoh::open(config).wait().map_err(Error::zenoh)?;
    say!("router {} at {endpoint}", own.name);
    signals::wait(signals);
    let _ = session.close().wait();
    Ok(())
}
