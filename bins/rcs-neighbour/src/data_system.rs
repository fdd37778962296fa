//! The Data System: a server with a database of items, which serves one run after the other.

use neighbours::{
    data_system::{Server, command},
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox},
};
use sessions::{
    data_system::Store,
    network::{Peer, PeerError, Received, Role},
};

use crate::{Error, Reconnect, cli::DataSystemArguments, connect, connect_again};

/// Serves runs until none connects within the waiting time.
pub fn serve(arguments: &DataSystemArguments) -> Result<(), Error> {
    let mut server = Server::new(Store::open_alone(&arguments.database)?);
    let mut peer = connect(&arguments.controller, Role::DataSystem)?;
    let mut reconnect = Reconnect::new();
    loop {
        match attend(&mut peer, &mut server) {
            Err(Error::Peer(error)) if error.is_passing() => os_io::stdout_line!("{error}"),
            other => return other,
        }
        // The old connection is closed first, because the controller accepts one neighbour of each role.
        drop(peer);
        let Some(next) = connect_again(&arguments.controller, Role::DataSystem, &mut reconnect)? else {
            return Ok(());
        };
        peer = next;
    }
}

/// Executes the commands of a run.
fn attend(peer: &mut Peer, server: &mut Server<Store>) -> Result<(), Error> {
    let mut status_box = Mailbox::initialized(DATA_SYSTEM_STATUS);
    let mut read = 0;
    loop {
        let Received::Pulse(pulse) = peer.receive()? else { continue };
        let mailbox = peer.mailbox(DATA_SYSTEM_COMMAND);
        if mailbox.mailgram() != read {
            read = mailbox.mailgram();
            let answer = server.execute(mailbox.data());
            tell(mailbox.data(), &answer.why);
            status_box.write(&answer.status.encode()).map_err(PeerError::Mailbox)?;
            peer.send(&status_box)?;
        }
        peer.pulse(pulse)?;
    }
}

/// Prints one line for every command.
fn tell(bytes: &[u8], why: &str) {
    let said = command::decode(bytes).map_or_else(
        |_| "not a command".to_owned(),
        |received| match received.transaction {
            command::Transaction::Dml => format!("{} {}", received.client, received.statement),
            other => format!("{} {other:?}", received.client),
        },
    );
    if why.is_empty() {
        os_io::stdout_line!("{said}");
    } else {
        os_io::stdout_line!("{said}: refused: {why}");
    }
}
