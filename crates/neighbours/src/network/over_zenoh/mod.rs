//! Mailboxes between machines over [Zenoh](https://zenoh.io): published under keys, peer to peer, without a server.
//!
//! ```text
//!   tick --Desk--> mailboxes in memory <--Counter-- callbacks <--keys of Zenoh--> Peer on another machine
//! ```
//!
//! The frames are those of a socket, and so is what is said in them; only the way differs. Each mailbox has a key of its
//! own ([`keys`]), so that Zenoh's access control can say who may write which. On a network of publishers anybody may put
//! anything under a key: a frame travels in an [`envelope`] with its number and its seal, and what has no seal of the
//! connection changes nothing but a line of the log. The number tells as well whether frames were lost or overtaken; Zenoh
//! keeps the order of what one side publishes with one priority, and a connection in which it does not is over.
//!
//! * [`controller`] asks who comes, as a queryable of Zenoh, and lets him in;
//! * [`neighbour`] comes.
//!
//! A connection ends when its liveliness token goes, which is at once if a process dies, or when a pulse is not answered in
//! time, whatever is first.

pub mod controller;
pub mod envelope;
pub mod keys;
pub mod neighbour;

use std::io;

use zenoh::{
    Config, Session, Wait as _,
    pubsub::Publisher,
    qos::{CongestionControl, Priority},
};

use self::keys::Keys;
use super::{
    Role,
    frame::{Frame, LAST_WORDS, PULSE},
    seal::Seal,
    station::Station,
};

/// Who opens a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Controller,
    Neighbour,
}

/// Zenoh has one kind of error for everything.
fn failed(error: zenoh::Error) -> io::Error {
    io::Error::other(error.to_string())
}

/// Zenoh's configuration for a station: the endpoint of the address, what the file says, and what neither says as it is best
/// for two who know where they are.
fn configuration(station: &Station, side: Side) -> Result<Config, zenoh::Error> {
    let mut config = station.configuration().map_or_else(|| Ok(Config::default()), Config::from_file)?;
    let Some(endpoint) = station.endpoint() else { return Ok(config) };
    let (ours, theirs) = match side {
        Side::Controller => ("listen/endpoints", "connect/endpoints"),
        Side::Neighbour => ("connect/endpoints", "listen/endpoints"),
    };
    config.insert_json5(ours, &format!("[\"{endpoint}\"]"))?;
    let usual = Config::default();
    // Nobody need be looked for. The controller may come later, or come back: a second, as Zenoh would wait, is long.
    let retry = "{ period_init_ms: 100, period_max_ms: 1000, period_increase_factor: 2 }";
    let better = [
        (theirs, "[]"),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("connect/retry", retry),
    ];
    for (key, value) in better {
        if config.get_json(key)? == usual.get_json(key)? {
            config.insert_json5(key, value)?;
        }
    }
    Ok(config)
}

fn open(station: &Station, side: Side) -> io::Result<Session> {
    configuration(station, side).and_then(|config| zenoh::open(config).wait()).map_err(failed)
}

/// The keys that one side writes, for one role. Everything goes one way: with one priority, reliably, and nothing is dropped
/// for want of room, so that mailgrams stay in front of their pulse.
struct Posts(Vec<(u32, Publisher<'static>)>);

impl Posts {
    fn declare(session: &Session, keys: &Keys, role: Role, side: Side) -> io::Result<Self> {
        let addresses: Vec<u32> = match side {
            Side::Controller => {
                let places = role.from_controller().iter().map(|place| place.address);
                places.chain([PULSE, LAST_WORDS]).collect()
            }
            Side::Neighbour => {
                let places = role.to_controller().iter().map(|place| place.address);
                places.chain([PULSE]).collect()
            }
        };
        let declare = |address| {
            session
                .declare_publisher(keys.of(role, side == Side::Controller, address))
                .priority(Priority::InteractiveHigh)
                .congestion_control(CongestionControl::Block)
                .express(true)
                .wait()
                .map(|publisher| (address, publisher))
                .map_err(failed)
        };
        addresses.into_iter().map(declare).collect::<io::Result<_>>().map(Self)
    }

    /// Publish a frame under its key.
    fn put(&self, seal: &mut Seal, frame: &Frame) -> io::Result<()> {
        let publisher = self.0.iter().find(|(address, _)| *address == frame.address());
        let (_, publisher) = publisher.ok_or(io::ErrorKind::InvalidInput)?;
        publisher.put(envelope::close(seal, frame)).wait().map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_says_who_listens() {
        let station: Station = "t3@tcp/127.0.0.1:7447".parse().unwrap();
        let asked = |side, key: &str| configuration(&station, side).unwrap().get_json(key).unwrap();
        let place = "[\"tcp/127.0.0.1:7447\"]";
        assert_eq!(asked(Side::Controller, "listen/endpoints"), place);
        assert_eq!(asked(Side::Controller, "connect/endpoints"), "[]");
        assert_eq!(asked(Side::Neighbour, "listen/endpoints"), "[]");
        assert_eq!(asked(Side::Neighbour, "connect/endpoints"), place);
        assert_eq!(asked(Side::Neighbour, "scouting/multicast/enabled"), "false");
        let missing = "t3".parse::<Station>().unwrap().configured("no such file".into());
        assert!(configuration(&missing, Side::Neighbour).is_err());
    }
}
