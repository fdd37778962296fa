//! The page of a run behind the gateway: logins, roles, attacks, and the run beside them.

use std::{
    fs::{self, File},
    io::{self, Read as _, Write as _},
    net::Ipv4Addr,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use serde_json::json;
use tungstenite::{Error, Message, protocol::frame::coding::CloseCode};

use crate::{
    browser::{Browser, HERE, Live, tcp},
    certificates::openssl,
    line::CutLine,
    shop::{CELL, Process, Shop, eventually, program},
};

const OTHER: Ipv4Addr = Ipv4Addr::new(127, 0, 0, 2);
const ATTACKER: Ipv4Addr = Ipv4Addr::new(127, 0, 0, 3);
/// Requests that an operator must hold, and the answer to `leave` if it was held.
const HELD: [&str; 3] = ["joystick velocity 0", "joystick frame WORLD", "joystick stick 0 300 36000"];
const RELEASED: &str = "stick and buttons are released";

/// A cell with a page: its keys, its gateway, and persons with their secrets.
struct Cell {
    gateway: Process,
    shop: Shop,
    secrets: Vec<String>,
}

impl Cell {
    /// A cell with an operator, anna, and a viewer, vera.
    fn new() -> Self {
        let shop = Shop::new(&[]);
        let secrets = vec![add(&shop, "anna", "operator"), add(&shop, "vera", "viewer")];
        let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
        command.args(["page", CELL, &shop.endpoint(), "--run"]);
        command.arg(format!("unix:{}", shop.run_socket().display()));
        command.arg("--keys").arg(shop.path("keys")).arg("--people").arg(shop.path("people"));
        let gateway = Process::start(&mut command, shop.path("page.err"));
        gateway.wait_for("page of t3 at https://127.0.0.1:");
        Self { gateway, shop, secrets }
    }

    fn run(&self, arguments: &[&str]) -> Process {
        let mut command = Command::new(program("rcs-run"));
        command.args(["linkbar", "--json", "--live", "0", "--log"]).arg(self.shop.path("run.mcap"));
        command.arg("--live-socket").arg(format!("unix:{}", self.shop.run_socket().display()));
        command.arg("--data").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../data")).args(arguments);
        command.current_dir(self.shop.directory.path());
        command.stdout(File::create(self.shop.path("run.json")).unwrap());
        let run = Process::start(&mut command, self.shop.path("run.err"));
        assert!(eventually(|| self.shop.run_socket().exists()), "no socket:\n{}", run.errors());
        run
    }

    fn operated_run(&self) -> Process {
        self.run(&["--clock", "real", "--operator", "network", "--overrun", "count"])
    }

    fn browser(&self) -> Browser {
        Browser::new(&self.shop.path("keys"), self.shop.port)
    }

    fn browser_at(&self, address: Ipv4Addr) -> Browser {
        Browser::from(&self.shop.path("keys"), self.shop.port, address)
    }

    fn logged_in(&self, name: &str) -> Browser {
        let mut browser = self.browser();
        let secret = &self.secrets[usize::from(name == "vera")];
        let answer = browser.log_in(name, secret);
        assert_eq!(answer.status, 303, "{answer:?}");
        browser
    }
}

fn person(shop: &Shop, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
    let output =
        command.arg("person").args(arguments).arg("--people").arg(shop.path("people")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn add(shop: &Shop, name: &str, role: &str) -> String {
    person(shop, &["add", name, "--role", role]).lines().next().unwrap().to_owned()
}

#[test]
fn person_sees_the_page_from_login_to_logout() {
    let cell = Cell::new();
    let mut browser = cell.browser();
    let first = browser.get("/");
    assert!(first.status == 303 && first.head.contains("Location: /login"), "{first:?}");
    let form = browser.get("/login");
    assert!(form.status == 200 && form.body.contains("<form") && !form.body.contains("<script"), "{form:?}");
    let wrong = browser.log_in("anna", "0000-0000-0000-0000");
    assert!(wrong.status == 401 && wrong.body.contains("Wrong name or secret"), "{wrong:?}");
    let answer = browser.log_in("anna", &cell.secrets[0].to_uppercase().replace('-', "+"));
    assert_eq!(answer.status, 303, "{answer:?}");
    for attribute in ["HttpOnly", "Secure", "SameSite=Strict", "Path=/", "Max-Age=43200"] {
        assert!(answer.head.contains(attribute), "{attribute}: {answer:?}");
    }
    let absent = browser.get("/");
    assert!(absent.status == 503 && absent.body.contains("No run listens"), "{absent:?}");
    let _run = cell.operated_run();
    assert!(eventually(|| browser.get("/").status == 200), "{}", cell.gateway.errors());
    let page = browser.get("/");
    assert!(page.head.contains("frame-ancestors 'none'") && page.body.contains("connect-src 'self'"));
    assert!(page.body.len() > 100_000 && page.body.ends_with("</html>\n"), "{} bytes", page.body.len());
    let mut live = browser.live().unwrap();
    assert!(live.sees_run());
    let cookie = browser.cookie.clone();
    let out = browser.post("/logout", &browser.origin(), "");
    assert!(out.status == 303 && out.head.contains("__Host-rcs=; Path=/; Max-Age=0"), "{out:?}");
    assert!(live.ends(), "still connected after the logout");
    browser.cookie = cookie;
    assert_eq!(
        (browser.get("/").status, browser.live().unwrap_err()),
        (303, 401),
        "a cookie after its logout"
    );
}

#[test]
fn operator_operates_under_its_name_and_viewer_does_not() {
    let cell = Cell::new();
    let run = cell.operated_run();
    let (anna, vera) = (cell.logged_in("anna"), cell.logged_in("vera"));
    let mut operator = anna.live().unwrap();
    assert_eq!(operator.parameter("/operator/access"), "granted");
    assert_eq!(operator.parameter("/viewer/name"), "page1.anna");
    let answer = operator.ask("PAUSE").unwrap();
    assert!(answer.starts_with("tick "), "{answer}\n{}", run.errors());
    // The gateway ignores a browser's headers that name a person.
    let claimed = [("origin", vera.origin()), ("rcs-role", "operator".into()), ("rcs-person", "anna".into())];
    let claimed = claimed.each_ref().map(|(name, value)| (*name, value.as_str()));
    for mut viewer in [vera.live().unwrap(), vera.upgrade(&claimed).unwrap()] {
        assert_eq!(viewer.parameter("/operator/access"), "none");
        assert!(viewer.parameter("/viewer/name").as_str().unwrap().ends_with(".vera"));
        for line in ["stop", "job go", "joystick velocity 0"] {
            assert!(viewer.ask(line).unwrap_err().contains("as a viewer"), "{line}");
        }
        let set = |name: &str, value| json!({ "op": "setParameters", "parameters": [{ "name": name, "value": value }] });
        for (name, value) in [("/operator/velocity", json!(0)), ("/operator/token", json!("0"))] {
            assert!(viewer.refusal(&set(name, value)).contains("as a viewer"), "{name}");
        }
        assert!(viewer.sees_run(), "the viewer no longer sees the run");
    }
    let status = operator.ask("status").unwrap();
    assert!(status.contains("page1.anna"), "{status}");
}

#[test]
fn requests_without_login_or_from_other_pages_are_refused() {
    let cell = Cell::new();
    let _run = cell.operated_run();
    let anna = cell.logged_in("anna");
    let own = anna.origin();
    // Pages of other sites are refused, even under the name of another host for this address.
    let plain = own.replace("https", "http");
    for origin in ["https://evil.example", "null", "http://127.0.0.1", "https://127.0.0.1", &plain] {
        assert_eq!(anna.upgrade(&[("origin", origin)]).unwrap_err(), 403, "{origin}");
        assert_eq!(anna.post("/login", origin, "name=anna&secret=x").status, 403, "{origin}");
        assert_eq!(anna.post("/logout", origin, "").status, 403, "{origin}");
    }
    assert_eq!(anna.upgrade(&[]).unwrap_err(), 403, "without an origin");
    for host in ["evil.example", "localhost", "127.0.0.1", ""] {
        let request = format!("GET / HTTP/1.1\r\nHost: {host}\r\nCookie: __Host-rcs={}\r\n\r\n", anna.cookie);
        assert_eq!(anna.exchange(request.as_bytes()).status, 421, "{host}");
    }
    let mut stranger = cell.browser();
    for cookie in [String::new(), "0".repeat(32), anna.cookie[1..].to_owned(), format!("{}0", anna.cookie)] {
        stranger.cookie = cookie;
        assert_eq!(
            (stranger.get("/").status, stranger.live().unwrap_err()),
            (303, 401),
            "{}",
            stranger.cookie
        );
    }
    for path in [
        "/../etc/passwd",
        "/%2e%2e/people",
        "//",
        "/people",
        "/keys/ca.key",
        "/login/",
        "/.",
        "*",
        "http://evil.example/",
    ] {
        assert_eq!(anna.get(path).status, 404, "{path}");
    }
    assert_eq!(anna.post("/", &own, "").status, 405);
    assert_eq!(anna.exchange(b"PUT / HTTP/1.1\r\n\r\n").status, 405);
    assert_eq!(anna.exchange(&[b"GET / HTTP/1.1\r\na: ", &[b'b'; 20_000][..]].concat()).status, 431);
    assert_eq!(anna.exchange(b"\0\0\0\0\r\n\r\n").status, 400);
    assert_eq!(anna.post("/login", &own, &"a".repeat(1025)).status, 413);
    assert!(anna.live().unwrap().sees_run(), "the page no longer works");
}

#[test]
fn failed_logins_are_limited_for_their_address() {
    let cell = Cell::new();
    let mut attacker = cell.browser_at(ATTACKER);
    let statuses: Vec<_> = (0..7).map(|_| attacker.log_in("anna", "0000-0000-0000-0000").status).collect();
    assert_eq!(statuses, [401, 401, 401, 401, 401, 429, 429]);
    assert_eq!(
        attacker.log_in("anna", &cell.secrets[0]).status,
        429,
        "the right secret among too many wrong ones"
    );
    assert_eq!(cell.browser_at(OTHER).log_in("anna", &cell.secrets[0]).status, 303);
    assert_eq!(cell.browser_at(OTHER).log_in("nobody", &cell.secrets[0]).status, 401);
    cell.gateway.wait_for("login of \"anna\" failed");
    assert!(!cell.gateway.errors().contains(&cell.secrets[0]));
}

#[test]
fn silent_and_slow_clients_neither_block_nor_disconnect_a_person() {
    let cell = Cell::new();
    let _run = cell.operated_run();
    let mut live = cell.logged_in("anna").live().unwrap();
    let silent: Vec<_> = (0..300).map(|_| tcp(ATTACKER, cell.shop.port).unwrap()).collect();
    let began = Instant::now();
    let mut other = cell.browser_at(OTHER);
    assert_eq!(other.log_in("anna", &cell.secrets[0]).status, 303);
    assert_eq!(other.get("/").status, 200);
    println!("with {} silent clients a login and the page take {:?}", silent.len(), began.elapsed());
    assert!(live.sees_run(), "the person no longer sees the run");
    drop(live);
    // These clients are disconnected, like a client that sends a request byte by byte.
    let mut slow = cell.browser().tls().unwrap();
    slow.write_all(b"GET / HTTP/1.1\r\n").unwrap();
    let is_ended = eventually(|| slow.write_all(b"a").and_then(|()| slow.flush()).is_err());
    assert!(is_ended, "a slow client stays");
    for mut client in silent {
        let read = client.read(&mut [0]);
        let is_ended =
            read.as_ref().map_or_else(|error| error.kind() != io::ErrorKind::WouldBlock, |&count| count == 0);
        assert!(is_ended, "{read:?}");
    }
    assert!(other.live().unwrap().sees_run(), "the person no longer sees the run");
}

#[test]
fn removed_or_changed_person_is_disconnected() {
    let cell = Cell::new();
    let _run = cell.operated_run();
    let (anna, mut vera) = (cell.logged_in("anna"), cell.logged_in("vera"));
    let (mut operator, mut viewer) = (anna.live().unwrap(), vera.live().unwrap());
    assert_eq!(person(&cell.shop, &["list"]), "anna             operator\nvera             viewer\n");
    person(&cell.shop, &["remove", "anna"]);
    assert!(operator.ends(), "still connected after the removal");
    assert_eq!((anna.get("/").status, anna.live().unwrap_err()), (303, 401));
    assert!(viewer.sees_run(), "another person was disconnected");
    // A renewed secret ends the old secret and its logins.
    person(&cell.shop, &["remove", "vera"]);
    let secret = add(&cell.shop, "vera", "operator");
    assert!(viewer.ends(), "still connected after its secret was renewed");
    assert!(eventually(|| vera.log_in("vera", &secret).status == 303));
    assert_eq!(vera.live().unwrap().parameter("/operator/access"), "granted");
    // With an unreadable file, nobody is admitted.
    let good = fs::read(cell.shop.path("people")).unwrap();
    fs::write(cell.shop.path("people"), "vera admin x\n").unwrap();
    cell.gateway.wait_for("people:1: expected NAME ROLE HASH");
    assert!(eventually(|| vera.get("/").status == 303));
    fs::write(cell.shop.path("people"), good).unwrap();
    assert!(eventually(|| vera.log_in("vera", &secret).status == 303));
}

#[test]
fn old_tls_is_refused_and_no_certificate_is_needed() {
    let cell = Cell::new();
    let old = openssl(&cell.shop, &["-tls1_2"]);
    assert!(old.contains("alert protocol version"), "{old}");
    let new = openssl(&cell.shop, &["-tls1_3", "-verify_return_error", "-verify_ip", "127.0.0.1"]);
    assert!(new.contains("Verify return code: 0 (ok)") && new.contains("TLSv1.3"), "{new}");
    let mut plain = tcp(HERE, cell.shop.port).unwrap();
    plain.write_all(b"GET / HTTP/1.1\r\nHost: a\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    // The connection may end with unread bytes.
    let _ = plain.read_to_end(&mut answer);
    assert!(!answer.starts_with(b"HTTP"), "{answer:?}");
}

#[test]
fn oversized_and_invalid_frames_end_only_their_connection() {
    let cell = Cell::new();
    let _run = cell.operated_run();
    let vera = cell.logged_in("vera");
    let mut bystander = vera.live().unwrap();
    let mut live = vera.live().unwrap();
    live.socket.write(Message::text("x".repeat(70_000))).unwrap();
    // The run may end the connection before it has read everything.
    let _ = live.socket.flush();
    let closed = live.next(|message| match message {
        Message::Close(frame) => Some(frame.clone().unwrap().code),
        _ => None,
    });
    assert!(matches!(closed, Ok(CloseCode::Size) | Err(Error::Io(_))), "{closed:?}");
    let mut invalid = vera.live().unwrap();
    invalid.socket.get_mut().write_all(&[0xff; 64]).unwrap();
    assert!(invalid.ends());
    assert!(bystander.sees_run());
}

#[test]
fn stick_behind_a_cut_line_is_released() {
    let cell = Cell::new();
    let _run = cell.run(&["--stand-by", "--clock", "real", "--operator", "network", "--overrun", "count"]);
    let mut anna = cell.logged_in("anna");
    let line = CutLine::to(cell.shop.port);
    anna.port = line.port;
    let mut operator = anna.live().unwrap();
    let hold = |operator: &mut Live| HELD.map(|request| operator.ask(request).unwrap());
    // On a busy machine an answer to a ping may be late.
    let held = eventually(|| {
        hold(&mut operator);
        operator.watch(Duration::from_millis(600));
        operator.ask("leave").unwrap().contains(RELEASED)
    });
    assert!(held, "the stick was released although the browser answers");
    hold(&mut operator);
    let cut = thread::spawn(move || line.cut(Duration::from_millis(700)));
    operator.watch(Duration::from_millis(1200));
    let left = operator.ask("leave").unwrap();
    assert!(!left.contains(RELEASED), "the stick was held behind a cut line: {left}");
    cut.join().unwrap();
}

#[test]
fn ten_viewers_beside_an_operator_change_no_bit() {
    let cell = Cell::new();
    let arguments = ["--clock", "5x", "--ticks", "700", "--overrun", "count"];
    let mut command = Command::new(program("rcs-run"));
    command.args(["linkbar", "--json", "--log", "none", "--operator", "none", "--data"]);
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../data")).args(arguments);
    let alone = command.stderr(Stdio::null()).current_dir(cell.shop.directory.path()).output().unwrap();
    let alone: serde_json::Value = serde_json::from_slice(&alone.stdout).unwrap();
    let (anna, vera, walter) = (cell.logged_in("anna"), cell.logged_in("vera"), cell.logged_in("vera"));
    let mut run = cell.run(&[&arguments[..], &["--operator", "network"]].concat());
    let mut operator = anna.live().unwrap();
    assert!(operator.ask("status").unwrap().starts_with("tick "));
    let viewers: Vec<_> = (0..10).map(|at| if at < 5 { vera.live() } else { walter.live() }).collect();
    let watching: Vec<_> = viewers
        .into_iter()
        .map(|viewer| {
            let mut viewer = viewer.unwrap();
            thread::spawn(move || viewer.ends())
        })
        .collect();
    assert!(operator.ends());
    for viewer in watching {
        assert!(viewer.join().unwrap());
    }
    assert!(run.finish().code().is_some(), "{}", run.errors());
    assert_eq!(cell.shop.digest(), alone["digest"].as_str().unwrap());
}
