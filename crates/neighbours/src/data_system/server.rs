//! The server: from the bytes of a command to those of a status. It accepts an item only from a client that has
//! connected by the steps of IV.4.2 (Abort, Initiate, Startup). A client can repeat a step whose answer was lost. The
//! database stores the state of a client, so that a restarted server continues.
//!
//! ```text
//!            INITIATE              STARTUP
//!   Closed -----------> Initiated ---------> Started --.
//!     ^                     |                   |      | UPDATE
//!     `------- ABORT -------+------- ABORT -----'  <---'
//! ```

use super::{
    books::Books,
    command::{self, Transaction},
    records::{Item, LastStatement, Records},
    statement::{self, Column, Update},
    status::{Refusal, ServerStatus, Status, Summary},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Session {
    Closed = 0, // the client is unknown
    Initiated = 1,
    Started = 2,
}

impl Session {
    const fn from_code(code: u8) -> Self {
        match code {
            1 => Self::Initiated,
            2 => Self::Started,
            _ => Self::Closed,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    pub status: Status,
    pub why: String, // for the log, if refused; else empty
}

#[derive(Clone, Debug, Default)]
pub struct Server<R = Books> {
    records: R,
}

impl Server<Books> {
    /// A server without items, to which a client is connected.
    pub(super) fn started(client: &[u8]) -> Self {
        let mut records = Books::default();
        let client = String::from_utf8_lossy(client);
        let Ok(()) = records.set_session(client.trim_end(), Session::Started as u8);
        Self { records }
    }
}

impl<R: Records> Server<R> {
    #[must_use]
    pub const fn new(records: R) -> Self {
        Self { records }
    }

    #[must_use]
    pub const fn records(&self) -> &R {
        &self.records
    }

    pub fn execute(&mut self, bytes: &[u8]) -> Answer {
        let (command_id, outcome) = match command::decode(bytes) {
            Ok(received) => (received.command_id, self.carry_out(&received)),
            Err(error) => (0, Err((Refusal::Protocol, error.to_string()))),
        };
        let (summary, why) = match outcome {
            Ok(()) => (Summary::Done, String::new()),
            Err((refusal, why)) => (Summary::Refused(refusal), why),
        };
        Answer { status: Status { command_id, server: ServerStatus::Ready, summary }, why }
    }

    fn carry_out(&mut self, received: &command::Received<'_>) -> Result<(), (Refusal, String)> {
        let kept = |error: R::Error| (Refusal::Store, error.to_string());
        let session = Session::from_code(self.records.session(received.client).map_err(kept)?);
        let session = match (received.transaction, session) {
            (Transaction::Abort, _) => Session::Closed,
            // A client that repeats a step has not received the answer.
            (Transaction::Initiate, Session::Closed | Session::Initiated) => Session::Initiated,
            (Transaction::Startup, Session::Initiated | Session::Started) => Session::Started,
            (Transaction::Dml, Session::Started) => return self.update(received),
            (asked, state) => {
                return Err((Refusal::Sequence, format!("{asked:?} from a client that is {state:?}")));
            }
        };
        self.records.set_session(received.client, session as u8).map_err(kept)
    }

    fn update(&mut self, received: &command::Received<'_>) -> Result<(), (Refusal, String)> {
        let update =
            statement::parse(received.statement).map_err(|error| (Refusal::Statement, error.to_string()))?;
        let item = item(&update).map_err(|why| (Refusal::Value, why))?;
        let said = LastStatement { number: received.transaction_id, statement: received.statement };
        self.records
            .report(received.client, said, &item)
            .map_err(|error| (Refusal::Store, error.to_string()))?;
        Ok(())
    }
}

/// The error names the first empty or wrong value.
fn item(update: &Update<'_>) -> Result<Item, String> {
    let value = |column: Column| {
        let value = update.value(column).unwrap_or_default();
        if value.is_empty() { Err(format!("{} is empty", column.text())) } else { Ok(value.to_owned()) }
    };
    let sector = value(Column::Sector)?;
    let number = sector.strip_prefix("SECTOR-").and_then(one_digit).ok_or_else(|| {
        format!("SECTOR-0 to SECTOR-9 or SECTOR-A to SECTOR-Z was expected for SECTOR, found {sector}")
    })?;
    Ok(Item {
        number: update.number.to_owned(),
        name: value(Column::ItemName)?,
        kind: value(Column::ItemType)?,
        device: value(Column::Device)?,
        position: value(Column::StoragePosition)?,
        sector: number,
    })
}

fn one_digit(text: &str) -> Option<u8> {
    let mut characters = text.chars();
    let digit = characters.next()?.to_digit(36)?;
    if characters.next().is_some() { None } else { u8::try_from(digit).ok() }
}

#[cfg(test)]
mod tests {
    use interfaces::{DataBaseCommand, data_base::DataBaseVerb};
    use rcs_core::name::{Name10, Name16};

    use super::*;

    struct Client {
        server: Server,
        number: u32,
    }

    impl Client {
        fn new() -> Self {
            Self { server: Server::default(), number: 0 }
        }

        fn send(&mut self, command: DataBaseCommand) -> Answer {
            self.number += 1;
            let (bytes, length) =
                command::encode(&DataBaseCommand { number: self.number, ..command }).unwrap();
            let answer = self.server.execute(&bytes[..length]);
            assert_eq!(u32::from(answer.status.command_id), self.number);
            answer
        }

        fn ask(&mut self, command: DataBaseVerb) -> Summary {
            self.send(DataBaseCommand { command, ..DataBaseCommand::default() }).status.summary
        }

        fn tell(&mut self, item: &str, serial: &str, position: &str, sector: i32) -> Answer {
            self.send(DataBaseCommand {
                command: DataBaseVerb::Update,
                item: Name16::new(item).unwrap(),
                serial: Name16::new(serial).unwrap(),
                position: Name10::new(position).unwrap(),
                sector: Some(sector),
                ..DataBaseCommand::default()
            })
        }

        fn connect(&mut self) {
            for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup] {
                assert_eq!(self.ask(verb), Summary::Done, "{verb}");
            }
        }

        fn items(&self) -> Vec<String> {
            let line = |i: Item| format!("{} {} {} {} {}", i.name, i.number, i.device, i.position, i.sector);
            self.server.records().items().unwrap_or_default().into_iter().map(line).collect()
        }
    }

    const SEQUENCE: Summary = Summary::Refused(Refusal::Sequence);

    #[test]
    fn item_has_its_last_reported_position() {
        let mut client = Client::new();
        client.connect();
        for (serial, position, sector) in [("17", "UNIT_1", 4), ("18", "UNIT_1", 2), ("17", "H_ROBOT", 0)] {
            assert_eq!(client.tell("LINKBAR1", serial, position, sector).status.summary, Summary::Done);
        }
        assert_eq!(client.items(), ["LINKBAR1 17 H_ROBOT H_ROBOT 0", "LINKBAR1 18 HWS UNIT_1 2"]);
        assert_eq!(client.ask(DataBaseVerb::Abort), Summary::Done);
        assert_eq!(client.items().len(), 2, "reported items remain after the connection");
    }

    #[test]
    fn client_without_a_connection_is_refused() {
        let mut client = Client::new();
        let told = client.tell("LINKBAR1", "", "UNIT_1", 4);
        assert_eq!((told.status.summary, told.why.as_str()), (SEQUENCE, "Dml from a client that is Closed"));
        assert_eq!(client.ask(DataBaseVerb::Startup), SEQUENCE);
        assert_eq!(client.ask(DataBaseVerb::Initiate), Summary::Done);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_1", 4).status.summary, SEQUENCE);
        assert_eq!(client.ask(DataBaseVerb::Startup), Summary::Done);
        assert_eq!(client.ask(DataBaseVerb::Initiate), SEQUENCE);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_1", 4).status.summary, Summary::Done);
        assert_eq!(client.ask(DataBaseVerb::Abort), Summary::Done);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_2", 1).status.summary, SEQUENCE);
        assert_eq!(client.items(), ["LINKBAR1  HWS UNIT_1 4"]);
    }

    #[test]
    fn connection_step_can_be_repeated() {
        let mut client = Client::new();
        for verb in [DataBaseVerb::Initiate, DataBaseVerb::Startup, DataBaseVerb::Abort] {
            assert_eq!((client.ask(verb), client.ask(verb)), (Summary::Done, Summary::Done), "{verb}");
        }
    }

    #[test]
    fn empty_items_and_places_are_refused() {
        let mut client = Client::new();
        client.connect();
        for (item, position, why) in
            [("", "UNIT_1", "ITEM_NAME is empty"), ("LINKBAR1", "", "STORAGE_POS is empty")]
        {
            let told = client.tell(item, "", position, 1);
            assert_eq!((told.status.summary, told.why.as_str()), (Summary::Refused(Refusal::Value), why));
        }
        assert!(client.items().is_empty());
    }

    #[test]
    fn invalid_command_bytes_are_refused_without_effect() {
        let mut client = Client::new();
        client.connect();
        let answer = client.server.execute(b"hello");
        assert_eq!(answer.status.summary, Summary::Refused(Refusal::Protocol));
        assert_eq!(answer.why, "a command of 28 or 240 bytes was expected, found 5");
        let update = DataBaseCommand {
            number: 9,
            command: DataBaseVerb::Update,
            item: Name16::new("A").unwrap(),
            position: Name10::new("B").unwrap(),
            ..DataBaseCommand::default()
        };
        let (mut bytes, _) = command::encode(&update).unwrap();
        bytes[32..38].copy_from_slice(b"DELETE");
        let answer = client.server.execute(&bytes);
        assert_eq!(answer.status.summary, Summary::Refused(Refusal::Statement));
        assert_eq!(answer.why, "UPDATE expected at character 1, found DELETE");
        assert_eq!(client.tell("A", "", "B", 0).status.summary, Summary::Done, "the connection stands");
    }
}
