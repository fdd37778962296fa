//! Tests sessions over a real socket, with correct and with hostile clients.

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    os::unix::{fs::PermissionsExt as _, net::UnixStream},
    path::PathBuf,
    sync::mpsc,
    thread,
    time::{Duration, Instant},
};

use sessions::operator::{
    ALIVE, Client, ClientError, Event, Given, Late, Listener, Name,
    protocol::{GREETING, SILENCE},
};
use tempfile::TempDir;

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action, for a busy machine
const IN_TIME: Duration = Duration::from_secs(9); // limit of a request that must not be late

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
            assert!(started.elapsed() < TIME_LIMIT, "no event has arrived");
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// The next event. On a busy machine a session may be silent between two of its lines.
    fn expect(&self, name: &str, event: Event) -> Given {
        let mut given = self.next();
        while given.event == Event::Silent && event != Event::Silent {
            given = self.next();
        }
        assert_eq!((given.source.as_str(), &given.event), (name, &event));
        given
    }

    /// The run's answer, after its greeting, to a client that violates the protocol.
    fn said_to(&self, bytes: &[u8]) -> String {
        let mut stream = UnixStream::connect(&self.path).unwrap();
        stream.write_all(bytes).unwrap();
        let mut said = String::new();
        stream.set_read_timeout(Some(TIME_LIMIT)).unwrap();
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
    let [first, second] = ["stop", "go"].map(|line| client.send_within(IN_TIME, line).unwrap());
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
    thread::sleep(2 * SILENCE);
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
    good.send_within(IN_TIME, "stop").unwrap();
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
        assert!(started.elapsed() < TIME_LIMIT, "the name is free");
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
    thread::sleep(Duration::from_millis(1300));
    assert_eq!(next_line(&bench), Event::Late(Late::GivenUp, "PAUSE".into()));
    client.send_within(IN_TIME, "PAUSE").unwrap();
    thread::sleep(Duration::from_millis(1300));
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

/// Reads keep-alive lines, which are empty.
fn read_keep_alives(lines: &mut impl Iterator<Item = String>) {
    assert_eq!(lines.take(3).collect::<Vec<_>>(), [""; 3]);
}

#[test]
fn waiting_client_sends_keep_alive_lines() {
    assert!(2 * ALIVE < SILENCE);
    let (near, far) = UnixStream::pair().unwrap();
    writeln!(&far, "{GREETING} linkbar-1 console @0").unwrap();
    let client = thread::spawn(move || {
        let mut client = Client::over(near, &"console".parse().unwrap()).unwrap();
        // Of all answers, a client waits longest for that to a load.
        let answer = client.ask("load 21000 610").unwrap();
        (answer, client.stay(TIME_LIMIT))
    });
    far.set_read_timeout(Some(TIME_LIMIT)).unwrap();
    let mut lines = BufReader::new(&far).lines().map(Result::unwrap);
    assert_eq!(lines.next().unwrap(), "hello console");
    assert!(lines.next().unwrap().ends_with(" load 21000 610"));
    read_keep_alives(&mut lines);
    writeln!(&far, "1 @0 ok tick 7").unwrap();
    read_keep_alives(&mut lines);
    drop(lines);
    drop(far);
    let (answer, stayed) = client.join().unwrap();
    assert_eq!(answer, Ok("tick 7".into()));
    assert!(matches!(stayed, Err(ClientError::Lost(_))), "{stayed:?}");
}

#[test]
fn client_that_reads_no_answers_does_not_delay_the_run() {
    let bench = Bench::new();
    let mut stream = UnixStream::connect(&bench.path).unwrap();
    stream.write_all(b"hello deaf\n").unwrap();
    bench.expect("deaf", Event::Connected);
    let (ended, has_ended) = mpsc::channel();
    thread::spawn(move || {
        loop {
            // The session may already have ended.
            let _ = stream.write_all(b"1 stop\n");
            let given = bench.next();
            match given.event {
                Event::Disconnected => return ended.send(()),
                Event::Silent => {}
                Event::Late(Late::Unlimited | Late::Ended, _) => given.answer(Err("x".repeat(2000))),
                other => panic!("{other:?}"),
            }
        }
    });
    has_ended.recv_timeout(TIME_LIMIT).expect("no answer waits for its reader, and the session ends");
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
        assert!(started.elapsed() < TIME_LIMIT, "its place is free");
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
        assert!(started.elapsed() < TIME_LIMIT, "the session ends");
    }
    assert!(!path.exists());
    let gone = Client::connect(&path, &"console".parse().unwrap()).unwrap_err();
    assert!(gone.to_string().contains("--operator owner"), "{gone}");
}
