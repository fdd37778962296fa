//! A Data System with a database on a thread.

use interfaces::{
    DataBaseCommand, DataBaseStatus,
    data_base::{DataBaseReport, DataBaseVerb},
};
use neighbours::data_system::{DataSystem as InMemory, command, status::STATUS};
use rcs_core::{
    name::{Name10, Name16},
    tick::Tick,
};

use super::*;

struct Client {
    system: DataSystem,
    command: DataBaseCommand,
    tick: Tick,
}

impl Client {
    fn new(answer_ticks: u64, pace: Pace) -> Self {
        let mut client = Self {
            system: here(Store::in_memory().unwrap(), answer_ticks, pace),
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

    fn write(&mut self, command: DataBaseVerb) {
        self.command = DataBaseCommand { number: self.command.number + 1, command, ..self.command };
    }

    fn ask(&mut self, command: DataBaseVerb) -> DataBaseReport {
        self.write(command);
        loop {
            let status = self.step();
            assert_eq!(status.echo, self.command.number);
            if status.report != DataBaseReport::Executing {
                return status.report;
            }
            std::thread::yield_now();
        }
    }

    fn connect(&mut self) {
        for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup] {
            assert_eq!(self.ask(verb), DataBaseReport::Done, "{verb}");
        }
    }
}

#[test]
fn answer_is_delayed_and_given_once() {
    let mut client = Client::new(10, Pace::Wait);
    client.write(DataBaseVerb::Abort);
    let busy = (0..10).filter(|_| client.step().report == DataBaseReport::Executing).count();
    assert_eq!((busy, client.step().report), (10, DataBaseReport::Done));
    let before = client.system.status();
    (0..50).for_each(|_| assert_eq!(client.step(), before));
}

#[test]
fn command_before_the_start_is_not_executed() {
    let mut system = here(Store::in_memory().unwrap(), 0, Pace::Wait);
    let command = DataBaseCommand { number: 9, command: DataBaseVerb::Abort, ..DataBaseCommand::default() };
    for tick in 1..10 {
        system.step(Tick(tick), &command);
        assert_eq!(system.status(), DataBaseStatus::default());
    }
}

#[test]
fn updates_reach_the_database_through_the_mailboxes() {
    for pace in [Pace::Wait, Pace::Poll] {
        let mut client = Client::new(2, pace);
        client.connect();
        client.command.item = Name16::new("LINKBAR1").unwrap();
        client.command.serial = Name16::new("17").unwrap();
        client.command.position = Name10::new("UNIT_1").unwrap();
        client.command.sector = Some(4);
        assert_eq!(client.ask(DataBaseVerb::Update), DataBaseReport::Done);
        assert_eq!(client.system.command_box().mailgram(), 4);
        assert_eq!(client.system.command_box().data().len(), command::DML);
        assert_eq!(client.system.status_box().data().len(), STATUS);
        let items = client.system.items().unwrap();
        assert_eq!((items.len(), items[0].number.as_str(), items[0].sector), (1, "17", 4));
        assert!(client.system.refusals().is_empty());
    }
}

#[test]
fn refusal_has_its_reason() {
    let mut client = Client::new(0, Pace::Wait);
    assert_eq!(client.ask(DataBaseVerb::Startup), DataBaseReport::Refused);
    assert_eq!(client.ask(DataBaseVerb::None), DataBaseReport::Refused);
    assert_eq!(
        client.system.refusals(),
        [
            "the connection is not in the state for this command: Startup from a client that is Closed",
            "no command"
        ]
    );
}

#[test]
fn overtaking_command_gets_its_own_answer() {
    let mut client = Client::new(5, Pace::Wait);
    client.write(DataBaseVerb::Startup);
    client.step();
    assert_eq!(client.ask(DataBaseVerb::Abort), DataBaseReport::Done);
    assert_eq!(client.ask(DataBaseVerb::Initiate), DataBaseReport::Done);
}

#[test]
fn copied_in_memory_data_system_answers_like_a_threaded_one() {
    let mut threaded = here(Store::in_memory().unwrap(), 3, Pace::Wait);
    let mut in_memory = InMemory::in_memory(3);
    let mut command = DataBaseCommand {
        item: Name16::new("LINKBAR1").unwrap(),
        position: Name10::new("UNIT_1").unwrap(),
        sector: Some(4),
        ..DataBaseCommand::default()
    };
    use DataBaseVerb::{Abort, Initiate, Startup, Update};
    for (tick, verb) in (1..).zip([Update, Abort, Initiate, Startup, Update, Update]) {
        command = DataBaseCommand { number: tick, command: verb, ..command };
        for within in 0..5 {
            let tick = Tick(u64::from(tick) * 5 + within);
            threaded.step(tick, &command);
            in_memory = in_memory.clone();
            in_memory.step(tick, &command);
            assert_eq!(in_memory.status(), threaded.status(), "{tick}, {verb}");
        }
    }
    assert_eq!(in_memory.refusals(), threaded.refusals());
    assert_eq!(in_memory.items(), threaded.items());
    assert_eq!(in_memory.items().unwrap().len(), 1);
}
