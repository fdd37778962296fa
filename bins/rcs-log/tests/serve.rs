//! Tests `rcs-log serve`: a viewer receives the whole log in order and with its time stamps.

use std::{
    io::{BufRead as _, BufReader},
    net::TcpStream,
    path::Path,
    process::{Child, Command, Stdio},
    time::Duration,
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::tick::Tick;
use record::{CellFrame, CellModel, End, Epoch, Log, Pace, Recorder, Setup};
use serde_json::{Value, json};
use taskdata::files::TaskData;
use tungstenite::{
    Message,
    client::IntoClientRequest,
    http::{HeaderValue, header},
};

const TICKS: u64 = 100;

fn record(path: &Path) {
    let setup = Setup { epoch: Epoch::Fixed, cell: Some(CellModel::default()), ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Wait, setup).expect("the log begins");
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    for tick in (1..=TICKS).map(Tick) {
        let (before, external) = (memory, ExternalInputs::default());
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        recorder.cell(&CellFrame::new(tick));
        recorder.tick(tick, &external, &memory, || ladder.state());
    }
    recorder.finish(End::default()).expect("the log ends");
}

fn serve(arguments: &[&str], log: &Path) -> (Child, impl Iterator<Item = String> + use<>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-log"));
    command.arg("serve").args(arguments).arg(log).stderr(Stdio::piped());
    let mut child = command.spawn().expect("rcs-log runs");
    let lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    (child, lines)
}

#[test]
fn viewer_receives_the_log_with_its_times() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.mcap");
    record(&path);
    let (mut child, mut said) = serve(&["--port", "0", "--rate", "20"], &path);
    let line = said.next().expect("it says where it serves");
    let address = line.split("ws://").nth(1).unwrap().split(';').next().unwrap();
    let mut request = format!("ws://{address}").into_client_request().unwrap();
    let subprotocol = HeaderValue::from_static("foxglove.sdk.v1");
    request.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, subprotocol);
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    let (mut socket, _) = tungstenite::client(request, stream).unwrap();
    let mut text = || loop {
        // The server sends pings to check whether the viewer reads.
        if let Message::Text(text) = socket.read().unwrap() {
            return serde_json::from_str::<Value>(&text).unwrap();
        }
    };
    let (info, channels) = (text(), text());
    assert_eq!((&info["name"], &info["capabilities"]), (&json!("log.mcap"), &json!(["time"])));
    let id = |topic: &str| {
        let all = channels["channels"].as_array().unwrap();
        all.iter().find(|channel| channel["topic"] == topic).unwrap()["id"].clone()
    };
    let subscriptions = json!([
        { "id": 1, "channelId": id("/replay") },
        { "id": 2, "channelId": id("/robot_description") },
    ]);
    socket
        .send(Message::text(json!({ "op": "subscribe", "subscriptions": subscriptions }).to_string()))
        .unwrap();
    let (mut seen, mut now, mut described) = (Vec::new(), 0, 0);
    let time = |bytes: &[u8]| u64::from_le_bytes(bytes.try_into().unwrap());
    while seen.len() < TICKS as usize {
        let Message::Binary(bytes) = socket.read().unwrap() else { continue };
        match bytes[..5] {
            [2, ..] => now = time(&bytes[1..]),
            [1, 1, 0, 0, 0] => {
                assert_eq!(time(&bytes[5..13]), now);
                seen.push((now, bytes[13..].to_vec()));
            }
            _ => described += 1,
        }
    }
    let log = Log::open(&path).unwrap();
    let logged: Vec<_> = log.messages("/replay").map(|(tick, data)| (Epoch::Fixed.of(tick), data)).collect();
    assert!(seen == logged, "the viewer sees what the log has");
    assert_eq!(described, 1);
    assert!(said.next().unwrap().contains("the log has ended"));
    socket.close(None).unwrap();
    while socket.read().is_ok() {}
    assert!(child.wait().unwrap().success());
}

#[test]
fn occupied_port_is_refused_with_a_message() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.mcap");
    record(&path);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let (mut child, mut said) = serve(&["--port", &port], &path);
    assert!(said.next().unwrap().contains("--port names another one"));
    assert_eq!(child.wait().unwrap().code(), Some(2));
}
