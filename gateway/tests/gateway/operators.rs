//! An operator at another machine.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    os::unix::net::UnixStream,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use neighbours::line::{Role, Session, session::Event};

use crate::shop::{Shop, TIME_LIMIT, eventually, program};

struct Operator {
    reader: BufReader<UnixStream>,
    number: u32,
    time: (u64, Instant),
}

impl Operator {
    fn connect(shop: &Shop) -> Option<Self> {
        let mut stream = UnixStream::connect(shop.path("op-1.sock")).unwrap();
        stream.set_read_timeout(Some(TIME_LIMIT)).unwrap();
        let mut session = Session::neighbour(Role::Operator, Instant::now());
        loop {
            match session.event(Instant::now()) {
                Ok(Some(Event::Welcome(_))) => break,
                Ok(Some(_)) => {}
                Err(error) => {
                    assert!(error.to_string().contains("has not begun"), "{error}");
                    return None;
                }
                Ok(None) => {
                    let bytes = std::mem::take(session.output());
                    stream.write_all(&bytes).unwrap();
                    let mut byte = [0];
                    std::io::Read::read_exact(&mut stream, &mut byte).unwrap();
                    session.receive(&byte, Instant::now());
                }
            }
        }
        stream.write_all(b"hello anna\n").unwrap();
        let mut operator = Self { reader: BufReader::new(stream), number: 0, time: (0, Instant::now()) };
        let greeting = operator.line();
        assert!(greeting.starts_with("rcs-operator 2 ") && greeting.contains("op-1.anna"), "{greeting}");
        operator.hear(&greeting);
        Some(operator)
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.reader.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    fn hear(&mut self, line: &str) {
        let time = line.split(' ').find_map(|word| word.strip_prefix('@')).unwrap();
        self.time = (time.parse().unwrap(), Instant::now());
    }

    /// Send a request; returns `ok …` or `refused …`.
    fn request(&mut self, text: &str) -> String {
        self.number += 1;
        let limit = self.time.0 + u64::try_from(self.time.1.elapsed().as_millis()).unwrap() + 9000;
        self.send(&format!("{} @{limit} {text}\n", self.number));
        let answer = self.line();
        self.hear(&answer);
        answer.splitn(3, ' ').nth(2).unwrap_or_default().to_owned()
    }

    fn send(&mut self, text: &str) {
        self.reader.get_mut().write_all(text.as_bytes()).unwrap();
    }
}

/// Requests that an operator must hold.
const HELD: [&str; 3] = ["joystick velocity 0", "joystick frame WORLD", "joystick stick 0 300 36000"];
const RELEASED: &str = "stick and buttons are released"; // the answer to `leave` if something was held

impl Operator {
    /// Hold the stick for some time, with or without keep-alives. Returns true if it was still held at the end.
    fn holds(&mut self, has_keep_alives: bool) -> bool {
        for request in HELD {
            let answer = self.request(request);
            assert!(answer.starts_with("ok"), "{request}: {answer}");
        }
        for _ in 0..12 {
            thread::sleep(Duration::from_millis(50));
            if has_keep_alives {
                self.send("\n");
            }
        }
        self.request("leave").contains(RELEASED)
    }
}

/// Without keep-alives of the operator the motion ends after 250 ms, because a gateway sends no keep-alives itself.
#[test]
fn stick_through_a_gateway_is_released_without_keep_alives() {
    let shop = Shop::new(&["op-1"]);
    let run = shop.run(&["--stand-by", "--clock", "real", "--operator", "network"]);
    let gateway = shop.serve(&["operator=op-1"]);
    let _connect = shop.connect("operator", "op-1");
    let mut connected = None;
    assert!(eventually(|| {
        connected = Operator::connect(&shop);
        connected.is_some()
    }));
    let mut operator = connected.unwrap();
    gateway.wait_for("operator op-1 has connected");
    let status = operator.request("status");
    assert!(status.contains("nobody commands"), "{status}\n{}", run.errors());
    assert!(!operator.holds(false), "the stick was held for 600 ms without a sign of life");
    // On a busy machine a keep-alive may be late.
    assert!(eventually(|| operator.holds(true)), "the stick was released in spite of keep-alives");
    drop(operator);
    gateway.wait_for("operator op-1 has disconnected");
}

/// `rcs-run send` at the socket of `rcs-gateway connect`.
fn send(shop: &Shop, name: &str, more: &[&str]) -> (bool, String) {
    let output = Command::new(program("rcs-run"))
        .args(["send", "--connect", &shop.socket_address(name), "--name", "anna"])
        .args(more)
        .output()
        .unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8_lossy(&said).into_owned())
}

#[test]
fn rcs_run_send_operates_a_run_through_a_gateway() {
    let shop = Shop::new(&["op-1", "op-2"]);
    let _run = shop.run(&["--stand-by", "--clock", "real", "--operator", "network"]);
    let gateway = shop.serve(&["operator=op-1,op-2"]);
    let (mut first, _second) = (shop.connect("operator", "op-1"), shop.connect("operator", "op-2"));
    let mut last = String::new();
    let answered = eventually(|| {
        let (is_taken, said) = send(&shop, "op-1", &["status"]);
        last = said;
        // A joystick box that is on would end the PAUSE at the start of the job.
        is_taken && last.contains("the job waits; nobody commands")
    });
    assert!(answered, "{last}");
    gateway.wait_for("operator op-1 has connected");
    // A motion by hand is held while `send` stays connected, and released when its gateway is killed.
    let held = Command::new(program("rcs-run"))
        .args(["send", "--connect", &shop.socket_address("op-1"), "--name", "anna", "--stay", "60"])
        .args(HELD)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut held = held.unwrap();
    let commanded = eventually(|| {
        let (_, said) = send(&shop, "op-2", &["status"]);
        last = said;
        last.contains("op-1.anna")
    });
    assert!(commanded, "{last}");
    thread::sleep(Duration::from_millis(600));
    assert!(!send(&shop, "op-2", &["joystick velocity 100"]).0, "`send` does not hold the stick");
    first.kill();
    let freed = eventually(|| {
        let (is_taken, said) = send(&shop, "op-2", &["joystick velocity 100"]);
        last = said;
        is_taken
    });
    assert!(freed, "another operator cannot command: {last}");
    assert!(!held.wait().unwrap().success(), "`send` has not noticed the end of its connection");
}
