//! The Active Pedestal: its three processes behind their mailboxes, for one run after the other.
//!
//! After a broken connection the pedestal keeps its state. A new run has a new cell, so the pedestal starts from its
//! initial state.

use interfaces::pedestal::PedestalReport;
use neighbours::{
    mailbox::{PEDESTAL_COMMAND, PEDESTAL_SENSORS},
    pedestal::System,
};
use sessions::network::{Peer, PeerError, Received, Role};

use crate::{Error, Reconnect, cli::PedestalArguments, connect, connect_again};

/// Serves runs until none connects within the waiting time.
pub fn serve(arguments: &PedestalArguments) -> Result<(), Error> {
    let mut served = Served::default();
    let mut peer = connect(&arguments.controller, Role::Pedestal)?;
    let mut reconnect = Reconnect::new();
    loop {
        match served.attend(&mut peer) {
            Err(Error::Peer(error)) if error.is_passing() => {
                os_io::stdout_line!("{error}");
                if matches!(error, PeerError::Disconnected(_)) {
                    served = Served::default();
                }
            }
            other => return other,
        }
        // The old connection is closed first, because the controller accepts one neighbour of each role.
        drop(peer);
        let Some(next) = connect_again(&arguments.controller, Role::Pedestal, &mut reconnect)? else {
            return Ok(());
        };
        peer = next;
    }
}

/// The pedestal, and the state reported last.
#[derive(Default)]
struct Served {
    system: System,
    /// Tick number of the last pulse.
    pulse: u64,
    /// The last values printed: command number, report, and the reason for a refusal.
    said: (u32, PedestalReport, String),
}

impl Served {
    /// Executes the commands of a run.
    fn attend(&mut self, peer: &mut Peer) -> Result<(), Error> {
        self.system.join();
        let (mut sent, mut is_there) = ([0; 4], false);
        loop {
            let Received::Pulse(pulse) = peer.receive()? else { continue };
            if !is_there {
                os_io::stdout_line!("working since tick {pulse}");
                is_there = true;
            }
            if pulse <= self.pulse {
                // A pulse that does not increase comes from a new run.
                *self = Self::default();
            }
            self.pulse = pulse;
            self.system.step(peer.mailbox(PEDESTAL_COMMAND), peer.mailbox(PEDESTAL_SENSORS));
            for (mailbox, sent) in self.system.outgoing().iter().zip(&mut sent) {
                if mailbox.mailgram() != *sent {
                    *sent = mailbox.mailgram();
                    peer.send(mailbox)?;
                }
            }
            self.tell();
            peer.pulse(pulse)?;
        }
    }

    /// Prints a line for every change of a command's status.
    fn tell(&mut self) {
        let status = &self.system.memory().pedestal.status;
        let refused = self.system.refusal().map(ToString::to_string).unwrap_or_default();
        let says = (status.echo, status.report, refused);
        if says == self.said || (status.echo == 0 && says.2.is_empty()) {
            return;
        }
        let command = self.system.command();
        let verb = if command.number == status.echo { command.command.text() } else { "" };
        match (says.2.as_str(), status.reason.text()) {
            ("", "") => os_io::stdout_line!("{verb} {}: {}", says.0, says.1),
            ("", why) => os_io::stdout_line!("{verb} {}: {}, {why}", says.0, says.1),
            (refused, _) => os_io::stdout_line!("refused: {refused}"),
        }
        self.said = says;
    }
}
