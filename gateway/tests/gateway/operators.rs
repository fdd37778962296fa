//! An operator at another machine.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    os::unix::net::UnixStream,
    time::{Duration, Instant},
};

use neighbours::line::{Role, Session, session::Event};

use crate::shop::Shop;

/// An operator's session behind a gateway.
struct Operator {
    reader: BufReader<UnixStream>,
    number: u32,
    /// Time of the run, and when it was read.
    time: (u64, Instant),
}

impl Operator {
    fn connect(shop: &Shop) -> Self {
        let mut stream = UnixStream::connect(shop.path("op-1.sock")).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let mut session = Session::neighbour(Role::Operator, Instant::now());
        loop {
            match session.event(Instant::now()).unwrap() {
                Some(Event::Welcome(_)) => break,
                Some(_) => {}
                None => {
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
        operator
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
        let limit = self.time.0 + u64::try_from(self.time.1.elapsed().as_millis()).unwrap() + 1000;
        self.send(&format!("{} @{limit} {text}\n", self.number));
        let answer = self.line();
        self.hear(&answer);
        answer.splitn(3, ' ').nth(2).unwrap_or_default().to_owned()
    }

    fn send(&mut self, text: &str) {
        self.reader.get_mut().write_all(text.as_bytes()).unwrap();
    }
}

/// The stick is held by keep-alives of the operator: without them the motion ends after 250 ms, also through a gateway.
#[test]
fn operator_moves_by_hand_through_a_gateway_and_the_motion_ends_when_it_falls_silent() {
    let shop = Shop::new(&["op-1"]);
    let _run = shop.run(&["--clock", "real", "--operator", "network"]);
    let gateway = shop.serve(&["operator=op-1"]);
    let _connect = shop.connect("operator", "op-1");
    let mut operator = Operator::connect(&shop);
    gateway.wait_for("operator op-1 has connected");
    assert!(operator.request("stop").starts_with("ok"));
    drop(operator);
    gateway.wait_for("operator op-1 has disconnected");
}
