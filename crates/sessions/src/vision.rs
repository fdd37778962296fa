//! READ-VISION-DATA and WRITE-VISION-REQUEST (IV.4.4, IX.4): the handshake with vision, once per tick.
//!
//! | event                                          | effect                                                        |
//! |------------------------------------------------|---------------------------------------------------------------|
//! | E-move has a new request                       | written once `vision-ready-output` is 2                       |
//! | vision is not connected, or has connected again | "not ready" until it writes; an open request is written again |
//! | a response while `vision-ready-input` is 2     | E-move reads it if it echoes the present request              |
//! | a response to another request                  | not read: E-move would take it for the answer                 |
//! | a response while `vision-ready-input` is 1     | not read                                                      |
//! | data that are not a response                   | not read; the ready words keep their values                   |
//!
//! If a response is not read, E-move keeps the earlier one, until its time limit. Invalid data are reported once.

use std::fmt;

use interfaces::device::{Picture as Kind, VisionRequest, VisionResponse, VisionStatus};

use crate::network::{Endpoint, NetEvent};
use neighbours::vision::{Areas, Picture, Ready, VisionError, picture::Part, request};
use neighbours::{
    fields::command_number,
    mailbox::{MailboxError, VISION_PICTURE, VISION_REQUEST, VISION_RESPONSE},
};

#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    Network(NetEvent),
    Refused(VisionError),
    /// Vision has answered another request than the present one.
    Stranger {
        echo: u16,
        expected: u16, // number of the present request; 0 without one
    },
    /// Vision has written an answer while `vision-ready-input` is not ready.
    Unread {
        echo: u16,
    },
    Waits {
        number: u16,
        connected: bool, // true if vision is connected but not ready
    },
    /// The picture has more parts than its mailbox holds; this is the number of omitted parts.
    Cropped(usize),
    Mailbox(MailboxError),
}

impl Remark {
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Network(event) => event.code(),
            Self::Refused(_) => "vision.garbled",
            Self::Stranger { .. } => "vision.stranger",
            Self::Unread { .. } => "vision.unread",
            Self::Waits { .. } => "vision.waits",
            Self::Cropped(_) => "vision.cropped",
            Self::Mailbox(_) => "vision.unsent",
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(event) => event.fmt(f),
            Self::Refused(error) => write!(f, "what vision has written is refused: {error}"),
            Self::Stranger { echo, expected: 0 } => {
                write!(
                    f,
                    "an answer of vision is refused: no request was expected to be answered, found {echo}"
                )
            }
            Self::Stranger { echo, expected } => {
                write!(f, "an answer of vision is refused: request {expected} was expected, found {echo}")
            }
            Self::Unread { echo } => write!(
                f,
                "vision's answer to request {echo} is not read: vision-ready-input 2 (ready) was expected, found 1"
            ),
            Self::Waits { number, connected: true } => write!(
                f,
                "request {number} to vision waits: vision-ready-output 2 (ready) was expected, found 1"
            ),
            Self::Waits { number, connected: false } => {
                write!(f, "request {number} to vision waits: no vision system is connected")
            }
            Self::Cropped(count) => {
                write!(f, "the {count} parts farthest from the optical axis are left out of the picture")
            }
            Self::Mailbox(error) => error.fmt(f),
        }
    }
}

/// E-move's end of the interface to a vision system in another process.
pub struct Port {
    endpoint: Endpoint,
    /// Seed of the run, and fingerprint of the entries of its cell description on which vision depends.
    run: (u64, u64),
    wanted: VisionRequest, // E-move's present request; number 0 for none
    written: bool,         // true if the present request was written to the mailbox
    output: Ready,
    response: VisionResponse,     // the response that E-move reads
    found: VisionResponse,        // the last content of the response area
    refused: Option<VisionError>, // the last reported error of reading the mailbox
    waits: bool,
    remarks: Vec<Remark>,
}

impl Port {
    /// `cell` is the fingerprint of the entries of the cell description on which vision depends.
    #[must_use]
    pub const fn new(endpoint: Endpoint, seed: u64, cell: u64) -> Self {
        Self {
            endpoint,
            run: (seed, cell),
            wanted: VisionRequest {
                number: 0,
                picture: Kind::None,
                object_id: 0,
                grip: 0,
                range_mm: 0,
                variation: 0,
            },
            written: false,
            output: Areas::INITIALIZED.output,
            response: Areas::INITIALIZED.response,
            found: Areas::INITIALIZED.response,
            refused: None,
            waits: false,
            remarks: Vec::new(),
        }
    }

    #[must_use]
    pub const fn response(&self) -> &VisionResponse {
        &self.response
    }

    /// The remarks since the last call.
    pub fn remarks(&mut self) -> Vec<Remark> {
        std::mem::take(&mut self.remarks)
    }

    /// Call it once per tick, after E-move and the cell. It calls `picture` for the parts in the picture in the tick in
    /// which it writes the request.
    pub fn step(&mut self, tick: u64, wanted: &VisionRequest, picture: impl FnOnce() -> Vec<Part>) {
        if wanted.number != self.wanted.number {
            (self.wanted, self.written, self.waits) = (*wanted, false, false);
        }
        if self.is_open() && self.output == Ready::Ready {
            self.write(picture());
        }
        let presence = self.endpoint.exchange(tick);
        let events = std::iter::from_fn(|| self.endpoint.event());
        self.remarks.extend(events.map(Remark::Network));
        if presence.new || !presence.connected {
            self.initialize();
        }
        if presence.connected {
            self.read();
        } else {
            // The next vision system must not find a request to the previous one.
            self.endpoint.outgoing(VISION_PICTURE).initialize();
            self.endpoint.outgoing(VISION_REQUEST).initialize();
        }
        if self.is_open() && self.output == Ready::NotReady && !self.waits {
            self.waits = true;
            let number = command_number(self.wanted.number);
            self.remarks.push(Remark::Waits { number, connected: presence.connected });
        }
    }

    /// True if a request was not written, and no vision system answered it before disconnecting.
    fn is_open(&self) -> bool {
        let answered = self.response.echo == self.wanted.number && is_final(&self.response);
        self.wanted.number != 0 && self.wanted.picture != Kind::None && !self.written && !answered
    }

    /// Initialize the ready words and the response area like blocks 984-986. Keep the response that E-move has read.
    fn initialize(&mut self) {
        self.output = Areas::INITIALIZED.output;
        self.found = Areas::INITIALIZED.response;
        (self.written, self.refused) = (false, None);
    }

    fn write(&mut self, parts: Vec<Part>) {
        let (seed, cell) = self.run;
        let mut picture = Picture { number: command_number(self.wanted.number), seed, cell, parts };
        let cropped = picture.crop();
        if cropped > 0 {
            self.remarks.push(Remark::Cropped(cropped));
        }
        let picture = self.endpoint.outgoing(VISION_PICTURE).write(&picture.encode());
        let request = self.endpoint.outgoing(VISION_REQUEST).write(&request::encode(&self.wanted));
        self.remarks.extend([picture, request].into_iter().filter_map(Result::err).map(Remark::Mailbox));
        self.written = true;
    }

    fn read(&mut self) {
        let mailbox = self.endpoint.incoming(VISION_RESPONSE);
        if mailbox.data().is_empty() {
            return;
        }
        match Areas::decode(mailbox.data()) {
            Ok(areas) => {
                self.refused = None;
                self.output = areas.output;
                self.take(&areas);
            }
            Err(error) if self.refused == Some(error) => {}
            Err(error) => {
                self.refused = Some(error);
                self.remarks.push(Remark::Refused(error));
            }
        }
    }

    fn take(&mut self, areas: &Areas) {
        let expected = if self.written { command_number(self.wanted.number) } else { 0 };
        let echo = command_number(areas.response.echo);
        // An old response is not new.
        let news = areas.response != self.found && is_final(&areas.response);
        self.found = areas.response;
        if echo != expected || echo == 0 {
            if news {
                self.remarks.push(Remark::Stranger { echo, expected });
            }
        } else if areas.input == Ready::Ready {
            self.response = VisionResponse { echo: self.wanted.number, ..areas.response };
        } else if news {
            self.remarks.push(Remark::Unread { echo });
        }
    }
}

/// True if vision has finished a request.
fn is_final(response: &VisionResponse) -> bool {
    !matches!(response.status, VisionStatus::Idle | VisionStatus::Busy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{ClockKind, Disconnect, Role, endpoint::tests::TestSession};
    use neighbours::mailbox::{Mailbox, Place};

    struct Bench {
        session: Option<TestSession>, // First, because a dropped endpoint waits for its session
        port: Port,
        response_box: Mailbox,
        tick: u64,
        wanted: VisionRequest,
    }

    impl Bench {
        fn new() -> Self {
            let port = Port::new(Endpoint::new(Role::Vision, ClockKind::Real).unwrap(), 7, 9);
            let response_box = Mailbox::initialized(VISION_RESPONSE);
            Self { port, session: None, response_box, tick: 0, wanted: VisionRequest::default() }
        }

        /// A bench whose vision system has established communications.
        fn connected() -> Self {
            let mut bench = Self::new();
            bench.come();
            bench.say(&Areas { output: Ready::Ready, ..Areas::INITIALIZED });
            bench.step();
            bench.port.remarks();
            bench
        }

        fn come(&mut self) {
            self.session = Some(TestSession::begin(&self.port.endpoint.handle()));
        }

        fn go(&mut self) {
            let session = self.session.take().expect("it is connected");
            session.end(Disconnect::Lost("the cable was cut".to_owned()));
        }

        fn step(&mut self) {
            self.tick += 1;
            self.port.step(self.tick, &self.wanted, || vec![Part { reflectance: 0.5, ..Part::default() }]);
        }

        fn ask(&mut self, number: u32) {
            let picture = Kind::Precise;
            self.wanted =
                VisionRequest { number, picture, object_id: 17, grip: 2, range_mm: 605, variation: 0 };
            self.step();
        }

        fn write(&mut self, data: &[u8]) {
            self.response_box.write(data).unwrap();
            self.session.as_ref().expect("it is connected").deliver(&self.response_box);
        }

        fn say(&mut self, areas: &Areas) {
            self.write(&areas.encode().unwrap());
        }

        fn outgoing(&mut self, place: Place) -> Vec<u8> {
            self.port.endpoint.outgoing(place).data().to_vec()
        }

        fn said(&mut self) -> Vec<String> {
            self.port.remarks().iter().map(ToString::to_string).collect()
        }
    }

    fn answer(echo: u32) -> Areas {
        let status = VisionStatus::Done;
        let response = VisionResponse { echo, status, y: 10, z: -5, angle: 300, recognised: Some(17) };
        Areas { input: Ready::Ready, output: Ready::Ready, response }
    }

    #[test]
    fn request_is_sent_with_its_picture_and_answered() {
        let mut bench = Bench::connected();
        bench.ask(65_539);
        let request = request::decode(&bench.outgoing(VISION_REQUEST)).unwrap();
        assert_eq!((request.number, request.object_id), (4, 17));
        let picture = Picture::decode(&bench.outgoing(VISION_PICTURE)).unwrap();
        assert_eq!((picture.number, picture.seed, picture.cell, picture.parts.len()), (4, 7, 9, 1));
        bench.say(&answer(4));
        bench.step();
        assert_eq!(*bench.port.response(), VisionResponse { echo: 65_539, ..answer(4).response });
        assert!(bench.said().is_empty());
        let mailgram = bench.port.endpoint.outgoing(VISION_REQUEST).mailgram();
        bench.step();
        assert_eq!(bench.port.endpoint.outgoing(VISION_REQUEST).mailgram(), mailgram, "written once");
    }

    #[test]
    fn request_waits_until_vision_is_ready() {
        let mut bench = Bench::new();
        bench.ask(4);
        bench.step();
        assert_eq!(bench.said(), ["request 4 to vision waits: no vision system is connected"]);
        bench.come();
        bench.step();
        assert_eq!(bench.outgoing(VISION_REQUEST), b"", "it has not established communications");
        bench.say(&Areas::INITIALIZED);
        bench.step();
        assert_eq!(bench.outgoing(VISION_REQUEST), b"");
        bench.say(&Areas { output: Ready::Ready, ..Areas::INITIALIZED });
        bench.step();
        bench.step();
        assert_eq!(request::decode(&bench.outgoing(VISION_REQUEST)).unwrap().number, 4);
        bench.said();
        bench.say(&Areas { output: Ready::NotReady, ..answer(4) });
        bench.step();
        bench.ask(5);
        bench.step();
        let waits = "request 5 to vision waits: vision-ready-output 2 (ready) was expected, found 1";
        assert_eq!(bench.said(), [waits]);
        assert_eq!(request::decode(&bench.outgoing(VISION_REQUEST)).unwrap().number, 4);
    }

    #[test]
    fn answer_is_read_only_with_vision_ready_input_set() {
        let mut bench = Bench::connected();
        bench.ask(4);
        bench.say(&Areas { input: Ready::NotReady, ..answer(4) });
        for _ in 0..3 {
            bench.step();
            assert_eq!(*bench.port.response(), VisionResponse::default());
        }
        let unread =
            "vision's answer to request 4 is not read: vision-ready-input 2 (ready) was expected, found 1";
        assert_eq!(bench.said(), [unread]);
        bench.say(&answer(4));
        bench.step();
        assert_eq!(*bench.port.response(), answer(4).response);
    }

    #[test]
    fn wrong_and_garbled_answers_are_reported_once_and_ignored() {
        let mut bench = Bench::connected();
        bench.ask(4);
        bench.say(&answer(9));
        bench.step();
        bench.step();
        let stranger = "an answer of vision is refused: request 4 was expected, found 9";
        assert_eq!(bench.said(), [stranger]);
        let good = answer(4).encode().unwrap();
        for _ in 0..3 {
            bench.write(&good[..14]);
            bench.step();
        }
        let short = "what vision has written is refused: a response of 18 bytes was expected, found 14";
        assert_eq!(bench.said(), [short]);
        assert_eq!(*bench.port.response(), VisionResponse::default());
        bench.say(&answer(4));
        bench.step();
        // The answer to the last request is still in the mailbox when the next request is made.
        bench.ask(5);
        bench.step();
        assert_eq!(bench.port.response().echo, 4);
        bench.say(&Areas { response: VisionResponse { y: 11, ..answer(4).response }, ..answer(4) });
        bench.step();
        assert_eq!((bench.port.response().echo, bench.port.response().y), (4, 10));
        assert_eq!(bench.said(), ["an answer of vision is refused: request 5 was expected, found 4"]);
    }

    #[test]
    fn new_vision_system_gets_the_unanswered_request() {
        let mut bench = Bench::connected();
        bench.ask(4);
        bench.go();
        bench.step();
        assert_eq!(bench.outgoing(VISION_REQUEST), b"", "none finds what was meant for another");
        bench.come();
        bench.say(&Areas { output: Ready::Ready, ..Areas::INITIALIZED });
        bench.step();
        bench.step();
        assert_eq!(request::decode(&bench.outgoing(VISION_REQUEST)).unwrap().number, 4);
        bench.say(&answer(4));
        bench.step();
        assert_eq!(bench.port.response().echo, 4);
        bench.go();
        bench.step();
        bench.come();
        bench.say(&Areas { output: Ready::Ready, ..Areas::INITIALIZED });
        bench.step();
        bench.step();
        assert_eq!(bench.outgoing(VISION_REQUEST), b"", "it has been answered");
        assert_eq!(*bench.port.response(), answer(4).response, "what was read was read");
    }

    #[test]
    fn unrequested_answer_is_refused() {
        let mut bench = Bench::connected();
        bench.say(&answer(4));
        bench.step();
        assert_eq!(*bench.port.response(), VisionResponse::default());
        let refused = "an answer of vision is refused: no request was expected to be answered, found 4";
        assert_eq!(bench.said(), [refused]);
    }
}
