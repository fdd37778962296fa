//! A client of Zenoh without the gateway's program: an honest one that holds a claim, and an attacker without access
//! control.

use std::{
    path::Path,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
        mpsc::channel,
    },
    thread,
    time::Duration,
};

use neighbours::line::frame::{DISCONNECT, Frame, PULSE};
use serde_json::json;
use zenoh::{
    Config, Session, Wait as _,
    liveliness::LivelinessToken,
    pubsub::Subscriber,
    qos::{CongestionControl, Priority},
    sample::Sample,
};

use crate::shop::{TIME_LIMIT, eventually};

/// Connect to a gateway with the certificate `name`, as a client without access control.
pub fn connect(keys: &Path, name: &str, endpoint: &str) -> Result<Session, zenoh::Error> {
    let file = |name: String| keys.join(name);
    let mut config = Config::default();
    let tls = json!({
        "root_ca_certificate": file("ca.pem".into()),
        "connect_private_key": file(format!("{name}.key")),
        "connect_certificate": file(format!("{name}.pem")),
        "enable_mtls": true,
    });
    for (key, value) in [
        ("mode", json!("client")),
        ("connect/endpoints", json!([endpoint])),
        ("connect/timeout_ms", json!(5000)),
        ("scouting/multicast/enabled", json!(false)),
        ("transport/link/tls", tls),
    ] {
        config.insert_json5(key, &value.to_string())?;
    }
    zenoh::open(config).wait()
}

pub struct Claim {
    pub id: String,
    pub pulse: Arc<AtomicU64>,
    pub sample: Arc<Mutex<Vec<u8>>>,
    _token: LivelinessToken,
    _subscriber: Subscriber<()>,
    _session: Session,
}

impl Claim {
    pub fn open(session: Session, cell: &str, name: &str, id: &str) -> Result<Self, String> {
        let front = format!("rcs/{cell}/workstation/{name}/{id}");
        let (samples, received) = channel::<Vec<u8>>();
        let take = move |sample: Sample| {
            // The thread ends with the test.
            let _ = samples.send(sample.payload().to_bytes().into_owned());
        };
        let subscriber = session.declare_subscriber(format!("{front}/out")).callback(take).wait().unwrap();
        let token = session.liveliness().declare_token(format!("{front}/alive")).wait().unwrap();
        let replies = session.get(format!("rcs/{cell}/open/workstation/{name}")).payload(id);
        let replies = replies.timeout(TIME_LIMIT).wait().unwrap();
        match replies.into_iter().next().map(zenoh::query::Reply::into_result) {
            Some(Ok(_)) => {}
            Some(Err(error)) => return Err(String::from_utf8_lossy(&error.payload().to_bytes()).into_owned()),
            None => return Err("no answer".to_owned()),
        }
        let (pulse, sample) = (Arc::new(AtomicU64::new(0)), Arc::new(Mutex::default()));
        let publisher = session
            .declare_publisher(format!("{front}/in"))
            .priority(Priority::InteractiveHigh)
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait()
            .unwrap();
        let (seen, last) = (Arc::clone(&pulse), Arc::clone(&sample));
        thread::spawn(move || {
            for bytes in received {
                let mut rest = &bytes[..];
                while let Ok(Some(frame)) = Frame::first(rest) {
                    if let Ok(Some(tick)) = frame.as_pulse() {
                        seen.store(tick, Ordering::SeqCst);
                        // A session that is closed ends the test.
                        let _ = publisher.put(frame.bytes()).wait();
                    }
                    rest = &rest[frame.bytes().len()..];
                }
                *last.lock().unwrap() = bytes;
            }
        });
        Ok(Self {
            id: id.to_owned(),
            pulse,
            sample,
            _token: token,
            _subscriber: subscriber,
            _session: session,
        })
    }

    /// The frames of the last sample: address and data.
    pub fn frames(&self) -> Vec<(u32, Vec<u8>)> {
        let sample = self.sample.lock().unwrap();
        let (mut rest, mut found) = (&sample[..], Vec::new());
        while let Ok(Some(frame)) = Frame::first(rest) {
            found.push((frame.address(), frame.data().to_vec()));
            rest = &rest[frame.bytes().len()..];
        }
        found
    }

    pub fn is_alive(&self) -> bool {
        let before = self.pulse.load(Ordering::SeqCst);
        // An attack takes some time to have an effect.
        thread::sleep(Duration::from_millis(500));
        let continues = eventually(|| self.pulse.load(Ordering::SeqCst) > before);
        let frames = self.frames();
        continues
            && frames.iter().any(|(address, _)| *address == PULSE)
            && frames.iter().all(|(address, _)| *address != DISCONNECT)
    }
}

/// A peer that listens in the place of a gateway, with another certificate and without access control.
pub fn rogue_gateway(keys: &Path, name: &str, endpoint: &str) -> Result<Session, zenoh::Error> {
    listening("peer", keys, name, endpoint)
}

pub fn router(keys: &Path, name: &str, endpoint: &str) -> Result<Session, zenoh::Error> {
    listening("router", keys, name, endpoint)
}

fn listening(mode: &str, keys: &Path, name: &str, endpoint: &str) -> Result<Session, zenoh::Error> {
    let mut config = Config::default();
    let tls = json!({
        "root_ca_certificate": keys.join("ca.pem"),
        "listen_private_key": keys.join(format!("{name}.key")),
        "listen_certificate": keys.join(format!("{name}.pem")),
        "enable_mtls": true,
    });
    for (key, value) in [
        ("mode", json!(mode)),
        ("listen/endpoints", json!([endpoint])),
        ("scouting/multicast/enabled", json!(false)),
        ("transport/link/tls", tls),
    ] {
        config.insert_json5(key, &value.to_string())?;
    }
    zenoh::open(config).wait()
}
