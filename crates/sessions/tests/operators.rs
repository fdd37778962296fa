//! Tests sessions over a real socket, with correct and with hostile clients.

use std::{
    io::{Read as _, Write as _},
    os::unix::{fs::PermissionsExt as _, net::UnixStream},
    path::PathBuf,
    time::{Duration, Instant},
};

use sessions::operator::{Client, ClientError, Event, Given, Late, Listener, Name};
use tempfile::TempDir;

struct Bench {
    _directory: TempDir,
    path: PathBuf,
    listener: Listener,
}

impl Bench {
    fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("socket");
        let listener = Listener::start(&path, "linkbar-1").unwrap();
        Self { _directory: directory, path, listener }
    }

    fn client(&self, name: &str) -> Client {
        Client::connect(&self.path, &name.parse().unwrap()).unwrap()
    }

    fn next(&self) -> Given {
        let started = Instant::now();
        loop {
            if let Some(given) = self.listener.try_next() {
                return given;
            }
            assert!(started.elapsed() < Duration::from_secs(2), "no event has arrived");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn expect(&self, name: &str, event: Event) -> Given {
        let given = self.next();
        assert_eq!((given.source.as_str(), &given.event), (name, &event));
        given
    }

    /// The run's answer, after its greeting, to a client that violates the protocol.
    fn said_to(&self, bytes: &[u8]) -> String {
        let mut stream = UnixStream::connect(&self.path).unwrap();
        stream.write_all(bytes).unwrap();
        let mut said = String::new();
        stream.set_read_timeout(Some(Duration::from_secs(4))).unwrap();
        stream.read_to_string(&mut said).unwrap();
        said
    }
}

#[test]
fn request_reaches_the_run_and_is_answered() {
    let bench = Bench::new();
    let mut client = bench.client("console");
    assert_eq!(client.run(), "linkbar-1");
    bench.expect("console", Event::Connected);
    let first = client.send("stop").unwrap();
    let second = client.send("go").unwrap();
    bench.expect("console", Event::Line("stop".into())).answer(Ok("tick 7".into()));
    bench.expect("console", Event::Line("go".into())).answer(Err("no".into()));
    let mut answers = Vec::new();
    while answers.len() < 2 {
        answers.extend(client.poll().unwrap());
    }
    let found: Vec<_> = answers.into_iter().map(|answer| (answer.number, answer.verdict)).collect();
    assert_eq!(found, [(first, Ok("tick 7".into())), (second, Err("no".into()))]);
    drop(client);
    bench.expect("console", Event::Disconnected);
}

#[test]
fn silent_session_is_reported_once_until_it_answers() {
    let bench = Bench::new();
    let mut client = bench.client("console");
    bench.expect("console", Event::Connected);
    bench.expect("console", Event::Silent);
    std::thread::sleep(Duration::from_millis(600));
    assert!(bench.listener.try_next().is_none(), "once");
    client.keep_alive().unwrap();
    bench.expect("console", Event::Silent);
}

#[test]
fn protocol_error_ends_only_its_session() {
    let bench = Bench::new();
    let mut good = bench.client("good");
    bench.expect("good", Event::Connected);
    let long = [&b"hello x\n7 "[..], &[b'x'; 300], b"\n"].concat();
    for (bytes, why) in [
        (&b"stop\n"[..], "hello NAME was expected"),
        (b"hello a b\n", "the name of an operator"),
        (b"\xff\xfe\n", "printable UTF-8 was expected"),
        (b"hello x\nstop\n", "a number and a line were expected"),
        (b"hello x\n1 (silent)\n", "a number and a line were expected"),
        (&long, "a line of at most 260 bytes"),
    ] {
        let said = bench.said_to(bytes);
        assert!(said.contains(why), "{said}");
    }
    assert!(bench.said_to(b"").contains("hello NAME was expected"));
    good.send("stop").unwrap();
    loop {
        let given = bench.next();
        if given.source.as_str() == "good" && given.event == Event::Line("stop".into()) {
            break;
        }
    }
}

#[test]
fn sessions_with_equal_names_are_renamed() {
    let bench = Bench::new();
    let clients = ["send", "send", "send-2", "send"].map(|name| bench.client(name));
    let names = ["send", "send-2", "send-2-2", "send-3"];
    assert_eq!(clients.each_ref().map(Client::name), names);
    for name in names {
        bench.expect(name, Event::Connected);
    }
    let [first, ..] = clients;
    drop(first);
    // The name is free once the run has been notified of the end.
    loop {
        let given = bench.next();
        if given.event == Event::Disconnected {
            assert_eq!(given.source.as_str(), "send");
            break;
        }
    }
    let started = Instant::now();
    while bench.client("send").name() != "send" {
        assert!(started.elapsed() < Duration::from_secs(2), "the name is free");
    }
}

fn next_line(bench: &Bench) -> Event {
    loop {
        let event = bench.next().event;
        if event.line().is_some() {
            return event;
        }
    }
}

#[test]
fn request_is_late_after_its_sender_stopped_waiting() {
    let bench = Bench::new();
    let mut client = bench.client("console");
    client.send("PAUSE").unwrap();
    // The run is suspended for longer than the client waits.
    std::thread::sleep(Duration::from_millis(1300));
    assert_eq!(next_line(&bench), Event::Late(Late::GivenUp, "PAUSE".into()));
    client.send_within(Duration::from_secs(9), "PAUSE").unwrap();
    std::thread::sleep(Duration::from_millis(1300));
    assert_eq!(next_line(&bench), Event::Line("PAUSE".into()), "this one waits longer");
    client.send_within(Duration::from_secs(3600), "PAUSE").unwrap();
    assert_eq!(next_line(&bench), Event::Late(Late::Unlimited, "PAUSE".into()));
}

#[test]
fn requests_of_an_ended_session_are_late() {
    let bench = Bench::new();
    let mut stream = UnixStream::connect(&bench.path).unwrap();
    // The lines do not fit into the queue to the run, so the session cannot read all of them.
    let lines: String = (1..=100).map(|number| format!("{number} @5000 PAUSE\n")).collect();
    stream.write_all(format!("hello killed\n{lines}").as_bytes()).unwrap();
    bench.expect("killed", Event::Connected);
    drop(stream);
    for _ in 1..=100 {
        assert_eq!(next_line(&bench), Event::Late(Late::Ended, "PAUSE".into()));
    }
    bench.expect("killed", Event::Disconnected);
}

#[test]
fn waiting_client_sends_keep_alive_lines() {
    let bench = Bench::new();
    let mut client = bench.client("console");
    bench.expect("console", Event::Connected);
    std::thread::scope(|scope| {
        scope.spawn(|| client.ask("stop"));
        let asked = bench.expect("console", Event::Line("stop".into()));
        std::thread::sleep(Duration::from_millis(600));
        asked.answer(Ok(String::new()));
    });
    std::thread::scope(|scope| {
        scope.spawn(|| client.stay(Duration::from_millis(600)));
    });
    let rest: Vec<Event> =
        std::iter::from_fn(|| bench.listener.try_next()).map(|given| given.event).collect();
    assert_eq!(rest, [], "it was never silent");
}

#[test]
fn client_that_reads_no_answers_does_not_delay_the_run() {
    let bench = Bench::new();
    let mut stream = UnixStream::connect(&bench.path).unwrap();
    stream.write_all(b"hello deaf\n").unwrap();
    bench.expect("deaf", Event::Connected);
    let started = Instant::now();
    loop {
        // The session may already have ended.
        let _ = stream.write_all(b"1 stop\n");
        let given = bench.next();
        if given.event == Event::Disconnected {
            break;
        }
        let before = Instant::now();
        assert!(matches!(given.event, Event::Late(Late::Unlimited, _)), "{given:?}");
        given.answer(Err("x".repeat(2000)));
        assert!(before.elapsed() < Duration::from_millis(500));
        assert!(started.elapsed() < Duration::from_secs(60), "its session ends");
    }
}

#[test]
fn ninth_client_is_refused_with_the_reason() {
    let bench = Bench::new();
    let mut clients: Vec<_> = (0..8).map(|number| bench.client(&format!("c{number}"))).collect();
    let name: Name = "ninth".parse().unwrap();
    let refused = Client::connect(&bench.path, &name).unwrap_err();
    assert!(matches!(&refused, ClientError::Refused(why) if why.contains("8 operators")), "{refused}");
    clients.pop();
    let started = Instant::now();
    while Client::connect(&bench.path, &name).is_err() {
        assert!(started.elapsed() < Duration::from_secs(2), "its place is free");
    }
}

#[test]
fn ended_run_closes_its_sessions_and_socket() {
    let bench = Bench::new();
    let mut client = bench.client("console");
    let mode = std::fs::metadata(&bench.path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    let path = bench.path.clone();
    drop(bench);
    let started = Instant::now();
    while client.poll().is_ok() {
        assert!(started.elapsed() < Duration::from_secs(2), "the session ends");
    }
    assert!(!path.exists());
    let gone = Client::connect(&path, &"console".parse().unwrap()).unwrap_err();
    assert!(gone.to_string().contains("--operator owner"), "{gone}");
}
