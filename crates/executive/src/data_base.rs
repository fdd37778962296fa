//! The Data System, a stand-in: an honest one that keeps what it is told and says no when it must.
//!
//! Task reports where the items of the MBD are (V.4.1, IX.2). The real Data System is another computer on the
//! factory network; this one takes the same commands from the same buffer, a number of ticks later, and keeps
//! the items in memory, so that a run can say at its end what the data base believes. It is strict about the
//! order of a connection: an item is taken only from a client that has made itself known and begun (IV.4.2:
//! Abort, Initiate, Startup).
//!
//! ```text
//!            INITIATE              STARTUP
//!   Closed -----------> Initiated ---------> Started --.
//!     ^                     |                   |      | UPDATE
//!     `------- ABORT -------+------- ABORT -----'  <---'
//! ```

use std::collections::BTreeMap;

use rcs_core::{
    handshake::{Arrival, Receiver},
    interface::{
        DataBaseCommand, DataBaseStatus,
        data_base::{DataBaseReport, DataBaseVerb},
    },
    name::{Name10, Name16},
    tick::Tick,
};

/// Ticks for an answer unless a run asks for others: 1 s.
pub const ANSWER_TICKS: u64 = 25;

/// How far a client has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Session {
    /// It is not known.
    Closed,
    /// It is known.
    Initiated,
    /// Its commands are taken.
    Started,
}

/// An item as the data base knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// `ITEM-NAME`.
    pub name: Name16,
    /// `ITEM#`: its serial number; empty if none was given.
    pub serial: Name16,
    /// `STORAGE-POS`: where it is.
    pub position: Name10,
    /// `SECTOR#`: the sector there; 0 for none.
    pub sector: i32,
}

/// The Data System.
#[derive(Debug)]
pub struct DataSystem {
    answer_ticks: u64,
    receiver: Receiver,
    /// When the command that is being executed came; `None` if none is.
    since: Option<Tick>,
    session: Session,
    status: DataBaseStatus,
    /// By name and serial number, as `WHERE ITEM_NBR = …` finds them.
    items: BTreeMap<(Name16, Name16), Item>,
}

impl DataSystem {
    /// An empty data base that answers a command after so many ticks.
    #[must_use]
    pub fn new(answer_ticks: u64) -> Self {
        Self {
            answer_ticks,
            receiver: Receiver::default(),
            since: None,
            session: Session::Closed,
            status: DataBaseStatus::default(),
            items: BTreeMap::new(),
        }
    }

    /// What Task will read in the next tick.
    #[must_use]
    pub const fn status(&self) -> DataBaseStatus {
        self.status
    }

    /// The items that were reported, by name and serial number.
    pub fn items(&self) -> impl Iterator<Item = &Item> {
        self.items.values()
    }

    /// Once a tick, after the controller: read what Task wrote in `tick`.
    pub fn step(&mut self, tick: Tick, command: &DataBaseCommand) {
        if self.receiver.observe(command.number) == Arrival::New {
            self.since = Some(tick);
            self.status = DataBaseStatus { echo: self.receiver.echo, report: DataBaseReport::Executing };
        }
        if self.since.is_some_and(|since| tick.since(since) >= self.answer_ticks) {
            self.since = None;
            let taken = self.execute(command);
            self.status.report = if taken { DataBaseReport::Done } else { DataBaseReport::Refused };
        }
    }

    /// Execute a command; false if it is refused.
    fn execute(&mut self, command: &DataBaseCommand) -> bool {
        match (command.command, self.session) {
            (DataBaseVerb::Abort, _) => self.session = Session::Closed,
            (DataBaseVerb::Initiate, Session::Closed) => self.session = Session::Initiated,
            (DataBaseVerb::Startup, Session::Initiated) => self.session = Session::Started,
            (DataBaseVerb::Update, Session::Started) => return self.update(command),
            (
                DataBaseVerb::None | DataBaseVerb::Initiate | DataBaseVerb::Startup | DataBaseVerb::Update,
                _,
            ) => return false,
        }
        true
    }

    /// UPDATE EQUIP_ITEM_ACTION (IX.2): the item is where the robot says. An item or a position without a
    /// name is none.
    fn update(&mut self, command: &DataBaseCommand) -> bool {
        let DataBaseCommand { item: name, serial, position, sector, .. } = *command;
        if name.is_empty() || position.is_empty() || sector < 0 {
            return false;
        }
        self.items.insert((name, serial), Item { name, serial, position, sector });
        true
    }
}

impl Default for DataSystem {
    fn default() -> Self {
        Self::new(ANSWER_TICKS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A client with its command buffer.
    struct Client {
        system: DataSystem,
        command: DataBaseCommand,
        tick: Tick,
    }

    impl Client {
        fn new(answer_ticks: u64) -> Self {
            let mut client = Self {
                system: DataSystem::new(answer_ticks),
                command: DataBaseCommand::default(),
                tick: Tick::BEFORE_START,
            };
            client.step();
            client
        }

        fn step(&mut self) -> DataBaseStatus {
            self.tick = self.tick.next();
            self.system.step(self.tick, &self.command);
            self.system.status()
        }

        /// Write a command, and what becomes of it within so many ticks.
        fn ask(&mut self, command: DataBaseVerb) -> DataBaseReport {
            self.command = DataBaseCommand { number: self.command.number + 1, command, ..self.command };
            for _ in 0..100 {
                let status = self.step();
                assert_eq!(status.echo, self.command.number);
                if status.report != DataBaseReport::Executing {
                    return status.report;
                }
            }
            panic!("no answer to {command}");
        }

        fn tell(&mut self, item: &str, serial: &str, position: &str, sector: i32) -> DataBaseReport {
            self.command.item = Name16::new(item).unwrap();
            self.command.serial = Name16::new(serial).unwrap();
            self.command.position = Name10::new(position).unwrap();
            self.command.sector = sector;
            self.ask(DataBaseVerb::Update)
        }

        fn connect(&mut self) {
            for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup] {
                assert_eq!(self.ask(verb), DataBaseReport::Done, "{verb}");
            }
        }

        fn items(&self) -> Vec<String> {
            let line = |i: &Item| format!("{} {} {} {}", i.name, i.serial, i.position, i.sector);
            self.system.items().map(line).collect()
        }
    }

    const DONE: DataBaseReport = DataBaseReport::Done;
    const REFUSED: DataBaseReport = DataBaseReport::Refused;

    #[test]
    fn an_item_is_where_it_was_last_reported() {
        let mut client = Client::new(3);
        client.connect();
        assert_eq!(client.tell("LINKBAR1", "17", "UNIT_1", 4), DONE);
        assert_eq!(client.tell("LINKBAR1", "18", "UNIT_1", 2), DONE);
        assert_eq!(client.tell("LINKBAR1", "17", "H_ROBOT", 0), DONE);
        assert_eq!(client.items(), ["LINKBAR1 17 H_ROBOT 0", "LINKBAR1 18 UNIT_1 2"]);
        assert_eq!(client.ask(DataBaseVerb::Abort), DONE);
        assert_eq!(client.items().len(), 2, "what was told stays after the connection has ended");
    }

    #[test]
    fn a_client_that_has_not_begun_is_refused() {
        let mut client = Client::new(0);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_1", 4), REFUSED);
        assert_eq!(client.ask(DataBaseVerb::Startup), REFUSED);
        assert_eq!(client.ask(DataBaseVerb::Initiate), DONE);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_1", 4), REFUSED);
        assert_eq!(client.ask(DataBaseVerb::Initiate), REFUSED);
        assert_eq!(client.ask(DataBaseVerb::Startup), DONE);
        assert_eq!(client.ask(DataBaseVerb::Startup), REFUSED);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_1", 4), DONE);
        assert_eq!(client.ask(DataBaseVerb::Abort), DONE);
        assert_eq!(client.tell("LINKBAR1", "", "UNIT_2", 1), REFUSED);
        assert_eq!(client.items(), ["LINKBAR1  UNIT_1 4"]);
    }

    #[test]
    fn an_update_that_says_nothing_is_refused() {
        let mut client = Client::new(0);
        client.connect();
        for (item, position, sector) in [("", "UNIT_1", 1), ("LINKBAR1", "", 1), ("LINKBAR1", "UNIT_1", -1)] {
            assert_eq!(client.tell(item, "", position, sector), REFUSED);
        }
        assert_eq!(client.ask(DataBaseVerb::None), REFUSED);
        assert!(client.items().is_empty());
    }

    #[test]
    fn an_answer_takes_its_time_and_is_given_once() {
        let mut client = Client::new(10);
        client.command.number = 1;
        client.command.command = DataBaseVerb::Abort;
        let busy = (0..10).filter(|_| client.step().report == DataBaseReport::Executing).count();
        assert_eq!((busy, client.step().report), (10, DONE));
        let before = client.system.status();
        (0..50).for_each(|_| assert_eq!(client.step(), before));
    }

    #[test]
    fn a_command_that_stands_there_at_the_start_is_not_executed() {
        let mut system = DataSystem::new(0);
        let command =
            DataBaseCommand { number: 9, command: DataBaseVerb::Abort, ..DataBaseCommand::default() };
        for tick in 1..10 {
            system.step(Tick(tick), &command);
            assert_eq!(system.status(), DataBaseStatus::default());
        }
    }
}
