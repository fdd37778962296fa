//! The command-line forms `egm:[ADDRESS:]PORT[,OPTION...]` and `egm:sim[,OPTION...]`.

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr},
    ops::RangeInclusive,
    path::Path,
    str::FromStr,
    time::Duration,
};

use depc::track::LAG_MS;
use diagnostics::{ROBOTS, alternatives};
use egm::host::Settings;

use crate::egm::{
    Placement,
    emulator::{EgmRobot, Tuning},
    network::{Network, Quality},
    placement::{PlacementError, RobotFile},
    simulated::SimulatedLine,
};

const LOOP_MS: u16 = 200; // time constant of the robot's position loop at the default gain of 5, ms
const SLACK_MS: RangeInclusive<u64> = 0..=200; // ms

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Over UDP: a robot or an emulator sends to this address.
    Udp(SocketAddr),
    /// Emulated in this process, in simulated time.
    Simulated,
}

#[derive(Clone, Debug, PartialEq)]
pub struct EgmOptions {
    pub peer: Peer,
    /// `robot=NAME|FILE`: the frames of the robot, from a file or by a name in `data/robots`.
    pub robot: Option<String>,
    /// `from=ADDRESS`: accept datagrams from this address only.
    pub from: Option<IpAddr>,
    /// `speed-ref=on|off`: send the speed of the target with the target.
    pub speed_ref: bool,
    pub slack_ms: u64, // `slack=MS`: how late a tick may be, ms
    /// Emulated robot only: settings of its program.
    pub tuning: Tuning,
    /// Emulated robot only: the network to it.
    pub quality: Quality,
    /// Emulated robot only: seed of the network.
    pub seed: u64,
}

impl EgmOptions {
    #[must_use]
    pub fn new(peer: Peer) -> Self {
        Self {
            peer,
            robot: None,
            from: None,
            speed_ref: true,
            slack_ms: 10,
            tuning: Tuning::default(),
            quality: Quality::default(),
            seed: 1,
        }
    }

    /// Parses the text after `egm:` for an emulator, which by default sends to this machine. Errors: the expected and
    /// the found text.
    pub fn to_emulate(text: &str) -> Result<Self, String> {
        let (place, options) = text.split_once(',').unwrap_or((text, ""));
        let mut emulated = Self::parse(place, Ipv4Addr::LOCALHOST)?;
        for option in options.split(',').filter(|option| !option.is_empty()) {
            match option.split_once('=') {
                Some(("robot", value)) => emulated.robot = Some(value.to_owned()),
                Some((name, value)) => emulated.emulate(name, value)?,
                None => return Err(format!("an EGM option is NAME=VALUE, found {option}")),
            }
        }
        Ok(emulated)
    }

    fn parse(text: &str, address: Ipv4Addr) -> Result<Self, String> {
        let mut parts = text.split(',');
        let place = parts.next().unwrap_or_default();
        let peer = if place == "sim" {
            Peer::Simulated
        } else {
            let port = place.parse().map(|port: u16| SocketAddr::from((address, port)));
            let full = port.ok().or_else(|| place.parse().ok()).filter(|address| address.port() != 0);
            Peer::Udp(full.ok_or_else(|| {
                format!("egm:[ADDRESS:]PORT or egm:sim was expected, such as egm:6510; found egm:{place}")
            })?)
        };
        let mut options = Self::new(peer);
        parts.try_for_each(|option| options.set(option))?;
        Ok(options)
    }

    fn set(&mut self, option: &str) -> Result<(), String> {
        let Some((name, value)) = option.split_once('=') else {
            return Err(format!("an EGM option is NAME=VALUE, found {option}"));
        };
        let emulated = self.peer == Peer::Simulated;
        match name {
            "robot" => self.robot = Some(value.to_owned()),
            "from" => {
                self.from = Some(value.parse().map_err(|_| format!("from is an address, found {value}"))?)
            }
            "speed-ref" => self.speed_ref = switch(name, value)?,
            "slack" => {
                let slack = value.parse().ok().filter(|slack| SLACK_MS.contains(slack));
                self.slack_ms = slack.ok_or_else(|| format!("slack is 0 to 200 ms, found {value}"))?;
            }
            _ if emulated => self.emulate(name, value)?,
            _ => {
                let near = alternatives(name, ["robot", "from", "speed-ref", "slack"], "it has");
                return Err(format!("EGM has no option {name}: {near}"));
            }
        }
        Ok(())
    }

    fn numbers(&mut self) -> [(&'static str, &mut f64, RangeInclusive<f64>); 12] {
        let (tuning, quality) = (&mut self.tuning, &mut self.quality);
        [
            ("gain", &mut tuning.gain, 0.0..=20.0),
            ("filter", &mut tuning.low_pass, 0.0..=100.0),
            ("ramp", &mut tuning.ramp_s, 0.005..=10.0),
            ("deviation", &mut tuning.max_speed_deviation, 0.0..=400.0),
            ("timeout", &mut tuning.comm_timeout_s, 0.01..=60.0),
            ("loss", &mut quality.loss, 0.0..=100.0),
            ("double", &mut quality.double, 0.0..=100.0),
            ("reorder", &mut quality.reorder, 0.0..=100.0),
            ("delay", &mut quality.delay_ms, 0.0..=1000.0),
            ("jitter", &mut quality.jitter_ms, 0.0..=1000.0),
            ("silent-at", &mut quality.silent_at_s, 0.0..=1e6),
            ("silent-for", &mut quality.silent_for_s, 0.0..=1e6),
        ]
    }

    fn emulate(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "do-not-restart" => self.tuning.do_not_restart = switch(name, value)?,
            "seed" => self.seed = value.parse().map_err(|_| format!("seed is a number, found {value}"))?,
            _ => {
                let mut numbers = self.numbers();
                let names = numbers.each_ref().map(|(name, ..)| *name);
                let Some((_, slot, range)) = numbers.iter_mut().find(|(known, ..)| *known == name) else {
                    let known = ["robot", "do-not-restart", "seed"].into_iter().chain(names);
                    let near = alternatives(name, known, "it has");
                    return Err(format!("an emulated EGM robot has no option {name}: {near}"));
                };
                let (low, high) = (range.start(), range.end());
                let number = value.parse().ok().filter(|number| range.contains(number));
                **slot = number
                    .ok_or_else(|| format!("{name} is a number from {low} to {high}, found {value}"))?;
            }
        }
        Ok(())
    }

    fn set_options(&self) -> Vec<(&'static str, String)> {
        let word = |on: bool| if on { "on" } else { "off" }.to_owned();
        let (mut own, mut new) = (self.clone(), Self::new(self.peer));
        let mut set: Vec<_> = self.robot.clone().map(|robot| ("robot", robot)).into_iter().collect();
        set.extend(self.from.map(|from| ("from", from.to_string())));
        set.extend((self.speed_ref != new.speed_ref).then(|| ("speed-ref", word(self.speed_ref))));
        set.extend((self.slack_ms != new.slack_ms).then(|| ("slack", self.slack_ms.to_string())));
        let restart = self.tuning.do_not_restart;
        set.extend((restart != new.tuning.do_not_restart).then(|| ("do-not-restart", word(restart))));
        set.extend((self.seed != new.seed).then(|| ("seed", self.seed.to_string())));
        let numbers = own.numbers().into_iter().zip(new.numbers());
        set.extend(numbers.filter_map(|((name, value, _), (_, usual, _))| {
            (*value != *usual).then(|| (name, value.to_string()))
        }));
        set
    }

    /// The robot's file. If none is named, the frames of `same.toml`: a robot that replaces the T3.
    pub fn file(&self, data: &Path) -> Result<RobotFile, PlacementError> {
        let Some(robot) = &self.robot else { return Ok(RobotFile::default()) };
        RobotFile::load(&ROBOTS.find(Path::new(robot), data)?)
    }

    pub fn placement(&self, data: &Path) -> Result<Placement, PlacementError> {
        self.file(data).map(|file| file.placement)
    }

    /// Expected lag, ms, of a robot whose file states none. If targets are sent without their speed, it includes the
    /// time constant of a position loop with a gain of 5.
    #[must_use]
    pub const fn lag_ms(&self) -> u16 {
        if self.speed_ref { LAG_MS } else { LAG_MS + LOOP_MS }
    }

    #[must_use]
    pub fn settings(&self, placement: &Placement) -> Settings {
        let mut settings = Settings::new(placement.limits());
        let slack = Duration::from_millis(self.slack_ms).as_nanos();
        settings.times.slack = u64::try_from(slack).unwrap_or(settings.times.slack);
        settings.speed_ref = self.speed_ref;
        settings
    }

    /// An emulated robot, and the network to it, in simulated time.
    #[must_use]
    pub fn simulated(&self, placement: &Placement) -> SimulatedLine {
        let robot = EgmRobot::new(self.tuning, *placement);
        let [to_host, to_robot] = self.networks();
        SimulatedLine::new(self.settings(placement), robot, to_host, to_robot)
    }

    #[must_use]
    pub fn networks(&self) -> [Network; 2] {
        [0, 1].map(|direction| Network::new(self.quality, self.seed.wrapping_mul(2).wrapping_add(direction)))
    }
}

fn switch(name: &str, value: &str) -> Result<bool, String> {
    match value {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("{name} is on or off, found {value}")),
    }
}

impl FromStr for EgmOptions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::parse(text, Ipv4Addr::UNSPECIFIED)
    }
}

impl std::fmt::Display for EgmOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.peer {
            Peer::Udp(address) => write!(f, "egm:{address}"),
            Peer::Simulated => f.write_str("egm:sim"),
        }?;
        self.set_options().iter().try_for_each(|(name, value)| write!(f, ",{name}={value}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_is_at_a_port_or_simulated() {
        let parse = |text: &str| text.parse::<EgmOptions>();
        let at = |text: &str| parse(text).map(|options| options.peer);
        assert_eq!(at("6510"), Ok(Peer::Udp("0.0.0.0:6510".parse().unwrap())));
        assert_eq!(at("192.168.125.2:6510"), Ok(Peer::Udp("192.168.125.2:6510".parse().unwrap())));
        assert_eq!(at("[::1]:6510"), Ok(Peer::Udp("[::1]:6510".parse().unwrap())));
        assert_eq!(at("sim"), Ok(Peer::Simulated));
        let options = parse("6510,robot=irb,from=192.168.125.1,speed-ref=off,slack=15").unwrap();
        assert_eq!((options.robot.as_deref(), options.speed_ref, options.slack_ms), (Some("irb"), false, 15));
        let options = parse("sim,gain=10,loss=20,jitter=20,seed=7,do-not-restart=off").unwrap();
        assert_eq!((options.tuning.gain, options.quality.loss, options.seed), (10.0, 20.0, 7));
        assert!(!options.tuning.do_not_restart);
        for text in [
            "egm:sim",
            "egm:[::1]:6510,robot=irb,from=192.168.125.1,speed-ref=off,slack=15",
            "egm:sim,do-not-restart=off,seed=7,gain=10,loss=20,jitter=0.25",
        ] {
            let options = parse(text.trim_start_matches("egm:")).unwrap();
            assert_eq!(options.to_string(), text);
        }
        for wrong in [
            "",
            "0",
            "70000",
            "host:x",
            "6510,gain=5",
            "6510,robot",
            "sim,gain=21",
            "sim,slack=x",
            "sim,loss=-1",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
