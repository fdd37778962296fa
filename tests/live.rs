//! The live view: viewers receive the contents of the log, and change nothing.

use std::{
    collections::BTreeMap,
    io::{BufRead as _, BufReader},
    net::TcpStream,
    path::Path,
    process::{Command, Stdio},
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};

use executive::memory::{Attached, RunName};
use record::Log;
use runtime::{ClockKind, LogTarget, Observer, OperatorAccess, Run, RunConfig, RunOutcome, StartError};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};
use tungstenite::{
    Message, WebSocket,
    client::IntoClientRequest,
    http::{HeaderValue, header},
};
use whole_system_tests::rcs_run;

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action
const ONCE: [&str; 4] = ["/robot_description", "/tf_static", "/meshes", "/names"]; // at the start

#[derive(Clone, Default)]
struct Said(Arc<Mutex<Vec<String>>>);

impl Observer for Said {
    fn message(&mut self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

impl Said {
    fn address(&self) -> String {
        let lines = self.0.lock().unwrap();
        let line = lines.iter().find_map(|line| line.split_once("viewers can connect at ws://"));
        let (_, rest) = line.expect("the run says where viewers can connect");
        rest.split([' ', ';']).next().unwrap().to_owned()
    }
}

fn config(directory: &TempDir, ticks: u64) -> RunConfig {
    RunConfig {
        clock: ClockKind::Real,
        speed: 20,
        ticks: Some(ticks),
        live: Some(0),
        operator: OperatorAccess::None,
        shared_memory: false,
        log: LogTarget::File(directory.path().join("log.mcap")),
        ..RunConfig::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("../data"), "linkbar")
    }
}

struct Viewer {
    socket: WebSocket<TcpStream>,
    info: Value,
    topics: BTreeMap<u64, String>,
}

enum Got {
    Message(String, u64, Vec<u8>),
    Time(u64),
}

impl Viewer {
    fn connect(address: &str, subprotocol: &'static str) -> Self {
        let mut request = format!("ws://{address}").into_client_request().unwrap();
        let wanted = HeaderValue::from_static(subprotocol);
        request.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, wanted);
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let (socket, response) = tungstenite::client(request, stream).unwrap();
        assert_eq!(response.headers()[header::SEC_WEBSOCKET_PROTOCOL], subprotocol);
        let mut viewer = Self { socket, info: Value::Null, topics: BTreeMap::new() };
        viewer.info = viewer.text();
        let channels = viewer.text();
        for channel in channels["channels"].as_array().unwrap() {
            let topic = channel["topic"].as_str().unwrap().to_owned();
            assert!(!channel["schema"].as_str().unwrap().is_empty(), "{topic}");
            viewer.topics.insert(channel["id"].as_u64().unwrap(), topic);
        }
        viewer
    }

    fn text(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                return serde_json::from_str(&text).unwrap();
            }
        }
    }

    /// The next reply. The operators' channel starts with the first reply.
    fn answer(&mut self) -> Value {
        std::iter::repeat_with(|| self.text()).find(|text| text["op"] != "advertise").unwrap()
    }

    fn subscribe(&mut self, wanted: impl Fn(&str) -> bool) {
        let channels = self.topics.iter().filter(|(_, topic)| wanted(topic));
        let subscriptions: Vec<Value> =
            channels.map(|(channel, _)| json!({ "id": channel + 1000, "channelId": channel })).collect();
        let text = json!({ "op": "subscribe", "subscriptions": subscriptions }).to_string();
        self.socket.send(Message::text(text)).unwrap();
    }

    fn rest(&mut self) -> impl Iterator<Item = Got> {
        std::iter::from_fn(|| {
            loop {
                match self.socket.read().expect("the run closes the connection") {
                    Message::Binary(bytes) => return Some(self.read(&bytes)),
                    Message::Text(text) => panic!("{text}"),
                    Message::Close(_) => return None,
                    _ => {}
                }
            }
        })
    }

    fn read(&self, bytes: &[u8]) -> Got {
        let time = |bytes: &[u8]| u64::from_le_bytes(bytes.try_into().unwrap());
        match bytes[0] {
            1 => {
                let subscription = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
                let topic = &self.topics[&(u64::from(subscription) - 1000)];
                Got::Message(topic.clone(), time(&bytes[5..13]), bytes[13..].to_vec())
            }
            2 => Got::Time(time(&bytes[1..])),
            code => panic!("operation code {code}"),
        }
    }
}

fn digest_without_viewers(ticks: u64) -> String {
    let directory = tempdir().unwrap();
    let config = RunConfig { clock: ClockKind::Fast, speed: 1, live: None, ..config(&directory, ticks) };
    Run::new(config, Box::new(())).unwrap().complete().result.digest
}

#[test]
fn viewers_of_both_subprotocols_get_the_messages_of_the_log() {
    let directory = tempdir().unwrap();
    let said = Said::default();
    let config = config(&directory, 400);
    let run = Run::new(config, Box::new(said.clone())).unwrap();
    let address = said.address();
    let early = ["foxglove.sdk.v1", "foxglove.websocket.v1"].map(|subprotocol| {
        let mut viewer = Viewer::connect(&address, subprotocol);
        assert_eq!(viewer.info["op"], "serverInfo");
        assert_eq!(
            (&viewer.info["name"], &viewer.info["metadata"]["job"]),
            (&json!("rcs-run linkbar"), &json!("linkbar"))
        );
        assert!(viewer.info["capabilities"].as_array().unwrap().contains(&json!("time")));
        viewer.subscribe(|_| true);
        thread::spawn(move || (viewer.rest().collect::<Vec<_>>(), viewer.topics))
    });
    thread::sleep(Duration::from_millis(300)); // they are subscribed before the first tick
    let late = thread::spawn(move || {
        thread::sleep(Duration::from_millis(300));
        let mut viewer = Viewer::connect(&address, "foxglove.sdk.v1");
        viewer.subscribe(|topic| ONCE.contains(&topic) || topic == "/tf");
        viewer.rest().collect::<Vec<_>>()
    });
    assert_eq!(run.complete().result.ticks, 400);
    let log = Log::open(&directory.path().join("log.mcap")).unwrap();
    let early = early.map(|viewer| viewer.join().unwrap());
    let Some(Got::Time(start)) = early[0].0.first() else { panic!("the time comes first") };
    for (got, topics) in &early {
        let mut now = 0;
        let mut by_topic: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
        for item in got {
            match item {
                Got::Time(time) => {
                    assert!(*time > now, "time increases");
                    now = *time;
                }
                Got::Message(topic, time, data) => {
                    assert!(*time <= now, "a message of {topic} comes before its time");
                    by_topic.entry(topic.clone()).or_default().push(data.clone());
                }
            }
        }
        assert!(topics.len() > 40, "{topics:?}");
        for topic in topics.values() {
            let logged: Vec<Vec<u8>> = log.messages(topic).map(|(_, data)| data).collect();
            let seen = by_topic.remove(topic).unwrap_or_default();
            assert!(logged == seen, "{topic}: {} messages in the log, {} seen", logged.len(), seen.len());
        }
    }
    let late = late.join().unwrap();
    let first = |wanted: &str| {
        late.iter().find_map(|item| match item {
            Got::Message(topic, time, data) if topic == wanted => Some((*time, data.clone())),
            _ => None,
        })
    };
    for topic in ONCE {
        let (_, logged) = log.messages(topic).next().unwrap();
        let (time, seen) = first(topic).expect("what was sent once is sent again");
        assert!(seen == logged, "{topic}");
        assert!(time > *start, "{topic} comes with the present time");
    }
    let links = |data: &[u8]| record::proto::foxglove::take_transforms(data).len();
    let (_, logged) = log.messages("/tf").next().unwrap();
    assert_eq!(links(&first("/tf").unwrap().1), links(&logged), "the places of all links");
}

#[test]
fn ten_stalled_viewers_do_not_change_the_run() {
    let directory = tempdir().unwrap();
    let said = Said::default();
    let config = RunConfig { clock: ClockKind::Fast, speed: 1, ..config(&directory, 3000) };
    let run = Run::new(config, Box::new(said.clone())).unwrap();
    let silent: Vec<Viewer> = (0..10)
        .map(|_| {
            let mut viewer = Viewer::connect(&said.address(), "foxglove.sdk.v1");
            viewer.subscribe(|_| true);
            viewer
        })
        .collect();
    let outcome: RunOutcome = run.complete();
    drop(silent);
    assert_eq!(outcome.result.digest, digest_without_viewers(3000));
    let log = Log::open(&directory.path().join("log.mcap")).unwrap();
    assert_eq!((log.ticks().count(), log.complete), (3000, true));
}

impl Said {
    fn token(&self) -> Option<String> {
        let lines = self.0.lock().unwrap();
        let line = lines.iter().find_map(|line| line.strip_prefix("requests of viewers need the token "));
        line.map(str::to_owned)
    }
}

fn call(viewer: &mut Viewer, service: u32, payload: &Value) -> Result<Value, String> {
    let mut bytes = vec![2];
    [service, 77, 4].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes.extend(b"json");
    bytes.extend(payload.to_string().into_bytes());
    viewer.socket.send(Message::binary(bytes)).unwrap();
    loop {
        match viewer.socket.read().unwrap() {
            Message::Text(text) => {
                let failure: Value = serde_json::from_str(&text).unwrap();
                if failure["op"] == "advertise" || failure["op"] == "parameterValues" {
                    continue;
                }
                assert_eq!((&failure["op"], &failure["callId"]), (&json!("serviceCallFailure"), &json!(77)));
                return Err(failure["message"].as_str().unwrap().to_owned());
            }
            Message::Binary(bytes) if bytes[0] == 3 => {
                assert_eq!((&bytes[5..9], &bytes[13..17]), (&[77, 0, 0, 0][..], &b"json"[..]));
                return Ok(serde_json::from_slice(&bytes[17..]).unwrap());
            }
            _ => {}
        }
    }
}

fn operate(mut viewer: Viewer, token: &str) {
    let services = viewer.answer();
    assert_eq!(services["op"], "advertiseServices");
    let number = |name: &str| {
        let all = services["services"].as_array().unwrap();
        let found = all.iter().find(|service| service["name"] == name).unwrap();
        u32::try_from(found["id"].as_u64().unwrap()).unwrap()
    };
    let (pause, knob_to_zero) = (number("/operator/pause"), number("/operator/stop"));
    let refused = call(&mut viewer, pause, &json!({})).unwrap_err();
    assert!(refused.contains("the token"), "{refused}");
    assert!(call(&mut viewer, pause, &json!({ "token": "0".repeat(32) })).is_err());
    let say =
        |viewer: &mut Viewer, message: Value| viewer.socket.send(Message::text(message.to_string())).unwrap();
    let set = |name: &str, value: Value| json!({ "op": "setParameters", "parameters": [{ "name": name, "value": value }], "id": "set" });
    say(&mut viewer, set("/operator/velocity", json!(400)));
    assert_eq!(viewer.answer()["op"], "status", "without the token the knob stays");
    // With the token.
    let answer = call(&mut viewer, pause, &json!({ "token": token })).unwrap();
    assert!(answer["answer"].as_str().unwrap().contains("command"), "{answer}");
    say(&mut viewer, set("/operator/token", json!(token)));
    assert_eq!(viewer.answer()["parameters"][0], json!({ "name": "/operator/token", "value": "accepted" }));
    say(&mut viewer, json!({ "op": "subscribeParameterUpdates", "parameterNames": ["/operator/velocity"] }));
    say(&mut viewer, set("/operator/velocity", json!(400)));
    let answers = [viewer.answer(), viewer.answer()];
    for answer in &answers {
        assert_eq!(
            answer["parameters"][0],
            json!({ "name": "/operator/velocity", "value": 400 }),
            "{answers:?}"
        );
    }
    assert_eq!(answers.iter().filter(|answer| answer["id"] == "set").count(), 1, "one answer, one change");
    call(&mut viewer, knob_to_zero, &json!({ "token": token })).unwrap();
    let refused = call(&mut viewer, number("/operator/request"), &json!({ "token": token, "line": "fly" }));
    assert!(refused.is_err());
}

#[test]
fn a_viewer_with_the_token_operates_the_run() {
    let directory = tempdir().unwrap();
    let said = Said::default();
    let config = RunConfig {
        operator: OperatorAccess::Network,
        shared_memory: true,
        speed: 5,
        ..config(&directory, 2000)
    };
    let stop = config.stop.clone();
    let run = Run::new(config, Box::new(said.clone())).unwrap();
    let token = said.token().expect("the run prints a token");
    let viewer = Viewer::connect(&said.address(), "foxglove.sdk.v1");
    let operating = thread::spawn(move || {
        operate(viewer, &token);
        thread::sleep(Duration::from_millis(200));
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    let _ = run.complete();
    operating.join().unwrap();
    let log = Log::open(&directory.path().join("log.mcap")).unwrap();
    let lines: Vec<_> = log.operator_lines().map(|line| (line.line, line.refused.is_some())).collect();
    let expected = [
        ("(connected)", false),
        ("PAUSE", false),
        ("joystick velocity 400", false),
        ("stop", false),
        ("fly", true),
        ("(disconnected)", false),
    ];
    let lines: Vec<_> = lines.iter().map(|(line, refused)| (line.as_str(), *refused)).collect();
    let said: Vec<_> = lines.into_iter().filter(|(line, _)| *line != "(silent)").collect();
    assert_eq!(said, expected);
}

struct Operated {
    viewer: Viewer,
    token: String,
    request: u32,
}

impl Operated {
    fn ask(&mut self, line: &str) -> Result<Value, String> {
        call(&mut self.viewer, self.request, &json!({ "token": self.token, "line": line }))
    }

    fn read_for(&mut self, time: Duration) {
        let end = Instant::now() + time;
        while Instant::now() < end {
            self.viewer.socket.read().unwrap(); // pings arrive all the time
        }
    }
}

#[test]
fn a_viewer_holds_a_stick_while_it_answers_and_a_delayed_request_is_refused() {
    let directory = tempdir().unwrap();
    let said = Said::default();
    let name: RunName = format!("viewed-{}", std::process::id()).parse().unwrap();
    let config = RunConfig {
        operator: OperatorAccess::Network,
        shared_memory: true,
        stand_by: true,
        name: Some(name.clone()),
        ..config(&directory, 1_000_000)
    };
    let stop = config.stop.clone();
    let run = Run::new(config, Box::new(said.clone())).unwrap();
    let token = said.token().expect("the run prints a token");
    let mut viewer = Viewer::connect(&said.address(), "foxglove.sdk.v1");
    let operating = thread::spawn(move || {
        let services = viewer.answer();
        let all = services["services"].as_array().unwrap();
        let found = all.iter().find(|service| service["name"] == "/operator/request").unwrap();
        let request = u32::try_from(found["id"].as_u64().unwrap()).unwrap();
        let mut operated = Operated { viewer, token, request };
        let run = Attached::open(&name).unwrap();
        let stick = || {
            let shown = run.external().unwrap().devices.joystick;
            (shown.x, shown.y)
        };
        let begun = Instant::now();
        // On a busy machine the viewer may answer too late.
        loop {
            for line in ["joystick frame WORLD", "joystick velocity 10", "joystick stick 0 300 36000"] {
                operated.ask(line).unwrap();
            }
            operated.read_for(Duration::from_millis(700));
            if stick() == (0, 300) {
                break;
            }
            assert!(begun.elapsed() < TIME_LIMIT, "a viewer that answers keeps the stick");
        }
        let hangs = Instant::now(); // the viewer hangs
        while stick() != (0, 0) {
            assert!(begun.elapsed() < TIME_LIMIT, "a viewer that does not answer releases the stick");
            thread::sleep(Duration::from_millis(10));
        }
        // Its late request is not executed.
        thread::sleep(Duration::from_secs(3).saturating_sub(hangs.elapsed()));
        // On a busy machine the run may not have pinged the viewer that early; then the viewer must hang again.
        let refused = loop {
            match operated.ask("joystick velocity 1000") {
                Err(refused) => break refused,
                Ok(_) => assert!(begun.elapsed() < TIME_LIMIT, "a late request is refused"),
            }
            thread::sleep(Duration::from_secs(3));
        };
        assert!(refused.contains("its sender had stopped waiting"), "{refused}");
        operated.read_for(Duration::from_millis(300));
        while operated.ask("joystick velocity 500").is_err() {
            assert!(begun.elapsed() < TIME_LIMIT);
            operated.read_for(Duration::from_millis(300));
        }
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    let _ = run.complete();
    operating.join().unwrap();
    let log = Log::open(&directory.path().join("log.mcap")).unwrap();
    let lines: Vec<_> = log.operator_lines().collect();
    let released = |line: &&record::OperatorLine| line.answer.contains("stick and buttons are released");
    assert!(lines.iter().filter(released).any(|line| line.line == "(silent)"), "{lines:?}");
    assert!(lines.iter().any(|line| line.line == "(given up) joystick velocity 1000"), "{lines:?}");
}

#[test]
fn a_run_without_operators_prints_no_token_and_offers_no_service() {
    let directory = tempdir().unwrap();
    let said = Said::default();
    let run = Run::new(config(&directory, 25), Box::new(said.clone())).unwrap();
    assert_eq!(said.token(), None);
    let mut viewer = Viewer::connect(&said.address(), "foxglove.sdk.v1");
    assert!(!viewer.info["capabilities"].as_array().unwrap().contains(&json!("services")));
    let refused = thread::spawn(move || call(&mut viewer, 4, &json!({ "token": "" })).unwrap_err());
    assert!(refused.join().unwrap().contains("accepts no requests of viewers"));
    let _ = run.complete();
}

#[test]
fn a_view_needs_a_log_and_a_port() {
    let directory = tempdir().unwrap();
    let without = RunConfig { log: LogTarget::None, ..config(&directory, 1) };
    let error = Run::new(without, Box::new(())).map(|_| ()).unwrap_err();
    assert!(matches!(error, StartError::LiveWithoutLog), "{error}");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let error = Run::new(RunConfig { live: Some(port), ..config(&directory, 1) }, Box::new(()))
        .map(|_| ())
        .unwrap_err();
    assert!(error.to_string().contains("--live PORT names another port"), "{error}");
    assert!(!directory.path().join("log.mcap").exists(), "a run that cannot begin leaves no log");
}

/// Ctrl-Z, a debugger or a full disk can stop the run for longer than a viewer may be silent.
#[test]
fn frozen_run_keeps_its_viewers() {
    let arguments =
        ["linkbar", "--clock", "real", "--log", "run.mcap", "--live", "0", "--shared-memory", "off"];
    let directory = tempdir().unwrap();
    let mut child = Command::new(rcs_run())
        .args(arguments)
        .current_dir(directory.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let line = lines.find(|line| line.contains("viewers can connect at ws://")).unwrap();
    let address = line.split("ws://").nth(1).unwrap().split([' ', ';']).next().unwrap().to_owned();
    let mut viewer = Viewer::connect(&address, "foxglove.sdk.v1");
    viewer.subscribe(|topic| topic == "/tf");
    let pid = Pid::from_child(&child);
    kill_process(pid, Signal::STOP).unwrap();
    thread::sleep(Duration::from_secs(7));
    kill_process(pid, Signal::CONT).unwrap();
    // The viewer is served in each of 100 ticks after the gap of four seconds.
    let got = viewer.rest().filter(|got| matches!(got, Got::Time(_))).take(100).count();
    kill_process(pid, Signal::TERM).unwrap();
    assert_eq!(got, 100);
    let said: Vec<_> = lines.collect();
    assert!(!said.iter().any(|line| line.contains("is disconnected")), "{said:?}");
    child.wait().unwrap();
}
