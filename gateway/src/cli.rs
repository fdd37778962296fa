//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use neighbours::line::Address;

use crate::{
    address::{Allow, CellAddress, Endpoint, Name, Right},
    page::people::{PersonName, Role},
};

/// Carries the mailboxes of a controller between machines, over Zenoh with TLS, and shows its page to persons.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-gateway",
    version,
    about,
    after_help = "\
Examples:
  tools/keys.sh keys t3 10.0.0.1 hwsc-1 mes
                                       keys and certificates for a cell, once
  rcs-run --clock real --network unix:/run/user/1000/t3.sock --outside workstation
                                       the controller
  rcs-gateway serve t3 tls/10.0.0.1:7447 --run unix:/run/user/1000/t3.sock --keys keys \\
      --allow workstation=hwsc-1 monitor=mes
                                       its gateway, on the same machine
  rcs-gateway connect t3@tls/10.0.0.1:7447 workstation unix:/tmp/t3.sock --keys keys
                                       on the other machine, for any program at its Unix socket
  rcs-neighbour workstation --network unix:/tmp/t3.sock linkbar
                                       such a program
  rcs-gateway monitor tls/10.0.0.1:7447 --keys keys
                                       a monitor
  rcs-run --clock real --live --live-socket unix:/run/user/1000/t3-live.sock --operator network
                                       a controller with a page
  rcs-gateway person add anna --role operator --people people
                                       a person who may open the page; prints the secret once
  rcs-gateway page t3 tls/10.0.0.1:8443 --run unix:/run/user/1000/t3-live.sock --keys keys --people people
                                       the page, at https://10.0.0.1:8443/

Exit status: 0 ended by a signal; 2 usage, keys, or an address that cannot be used."
)]
pub struct Cli {
    /// Which end.
    #[command(subcommand)]
    pub command: Command,
}

/// The two ends, and what a shop of several cells needs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Serve a cell: beside its run
    Serve(ServeArguments),
    /// Connect to the gateway of a cell: beside a neighbour or an operator
    Connect(ConnectArguments),
    /// Route the status of several cells to monitors: one connection shows all
    Router(RouterArguments),
    /// Print the state of cells, one per line
    Monitor(MonitorArguments),
    /// Serve the page of a run to persons on the network of the cell, for their browsers
    Page(PageArguments),
    /// Persons who may open the page, and their secrets
    #[command(subcommand)]
    Person(PersonCommand),
}

/// Arguments of `page`.
#[derive(Clone, Debug, Args)]
pub struct PageArguments {
    /// Name of the cell, and of its certificate: CELL.pem and CELL.key in the directory of keys
    #[arg(value_name = "CELL")]
    pub cell: Name,
    /// Where browsers connect: tls/IP:PORT. The page is at https://IP:PORT/
    #[arg(value_name = "ENDPOINT")]
    pub endpoint: Endpoint,
    /// Where the run listens, its --live-socket: unix:PATH. The gateway may be started first
    #[arg(long, value_name = "ADDRESS")]
    pub run: Address,
    /// Directory with ca.pem, CELL.pem and CELL.key; tools/keys.sh makes it
    #[arg(long, value_name = "DIR")]
    pub keys: PathBuf,
    /// File with the persons; rcs-gateway person makes it. A change takes effect within a second
    #[arg(long, value_name = "FILE")]
    pub people: PathBuf,
}

/// Changes the file of persons, or lists it.
#[derive(Clone, Debug, Subcommand)]
pub enum PersonCommand {
    /// Add a person, and print the secret once
    Add {
        /// Name of the person: 1 to 16 letters, digits, -, _ and .
        #[arg(value_name = "NAME")]
        name: PersonName,
        /// Whether the person may operate the run
        #[arg(long, value_enum)]
        role: Role,
        /// File with the persons, created if missing
        #[arg(long, value_name = "FILE")]
        people: PathBuf,
    },
    /// Remove a person; a gateway ends the person's connections within a second
    Remove {
        /// Name of the person
        #[arg(value_name = "NAME")]
        name: PersonName,
        /// File with the persons
        #[arg(long, value_name = "FILE")]
        people: PathBuf,
    },
    /// Print the persons and their roles, one per line
    List {
        /// File with the persons
        #[arg(long, value_name = "FILE")]
        people: PathBuf,
    },
}

/// Arguments of `router`.
#[derive(Clone, Debug, Args)]
pub struct RouterArguments {
    /// Where gateways and monitors connect: tls/IP:PORT
    #[arg(value_name = "ENDPOINT")]
    pub endpoint: Endpoint,
    /// Directory with ca.pem, NAME.pem and NAME.key
    #[arg(long, value_name = "DIR")]
    pub keys: PathBuf,
    /// Name of the certificate; may be left out if the directory has only one
    #[arg(long, value_name = "NAME")]
    pub name: Option<Name>,
    /// Names of the cells, each of which may write its own status
    #[arg(long, value_name = "CELL", num_args = 1.., value_delimiter = ',', required = true)]
    pub cells: Vec<Name>,
    /// Names of the monitors, which may read the status of all cells
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',', required = true)]
    pub monitors: Vec<Name>,
}

/// Arguments of `monitor`.
#[derive(Clone, Debug, Args)]
pub struct MonitorArguments {
    /// A router, or the gateways of all cells: tls/IP:PORT
    #[arg(value_name = "ENDPOINT", required = true)]
    pub endpoints: Vec<Endpoint>,
    /// Directory with ca.pem, NAME.pem and NAME.key
    #[arg(long, value_name = "DIR")]
    pub keys: PathBuf,
    /// Name of the certificate; may be left out if the directory has only one
    #[arg(long, value_name = "NAME")]
    pub name: Option<Name>,
    /// Print N times, once a second, and end; without it until a signal
    #[arg(long, value_name = "N")]
    pub count: Option<u32>,
}

/// Arguments of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeArguments {
    /// Name of the cell, and of its certificate: CELL.pem and CELL.key in the directory of keys
    #[arg(value_name = "CELL")]
    pub cell: Name,
    /// Where neighbours connect: tls/IP:PORT
    #[arg(value_name = "ENDPOINT")]
    pub endpoint: Endpoint,
    /// Where the run listens, its --network: unix:PATH. The gateway may be started first
    #[arg(long, value_name = "ADDRESS")]
    pub run: Address,
    /// Router that passes the status on to monitors: tls/IP:PORT. Commands never go through it
    #[arg(long, value_name = "ENDPOINT")]
    pub router: Option<Endpoint>,
    /// Directory with ca.pem, CELL.pem and CELL.key; tools/keys.sh makes it
    #[arg(long, value_name = "DIR")]
    pub keys: PathBuf,
    /// Which certificates may do what: ROLE=NAME[,NAME], where NAME is the common name of a certificate, and ROLE is
    /// workstation, data-system, pedestal, vision, operator or monitor. Everything else is denied
    #[arg(long, value_name = "ROLE=NAME", num_args = 1.., required = true)]
    pub allow: Vec<Allow>,
}

/// Arguments of `connect`.
#[derive(Clone, Debug, Args)]
pub struct ConnectArguments {
    /// The cell and its gateway: CELL@tls/IP:PORT
    #[arg(value_name = "CELL")]
    pub cell: CellAddress,
    /// Role of the program at the socket: workstation, data-system, pedestal, vision or operator
    #[arg(value_name = "ROLE")]
    pub role: Right,
    /// Where this program listens for the neighbour: unix:PATH
    #[arg(value_name = "ADDRESS")]
    pub socket: Address,
    /// Directory with ca.pem, NAME.pem and NAME.key
    #[arg(long, value_name = "DIR")]
    pub keys: PathBuf,
    /// Name of the certificate; may be left out if the directory has only one
    #[arg(long, value_name = "NAME")]
    pub name: Option<Name>,
}
