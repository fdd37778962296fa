//! Exhaustive search of the handshake between [`Commander`] and [`Receiver`], breadth first. In every tick the
//! commander may restart and may send a command, up to five; the receiver may step, restart, be held or be silent, and
//! may finish its command. Either may read values that are one or two ticks old. A restart loses the state of the
//! process, but not its output buffer.
//!
//! Commands are distinguished by *content*, which the code does not see. Ages replace ticks, up to the largest that
//! the code distinguishes, so the search is finite.

use std::collections::{HashMap, VecDeque};

use rcs_core::{
    handshake::{Arrival, Commander, ECHO_LIMIT, Lower, Receiver},
    header::Header,
    tick::Tick,
};

const COMMANDS: u8 = 5;
const OLD: u8 = 5; // larger ages are equivalent
const NOW: Tick = Tick(1000);

/// Where a starting commander continues.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    Buffer, // its own output buffer: commanders of processes
    Echo,   // the subordinate's echo: commanders of devices and other systems
}

/// Number, and content from 1, or 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Written {
    number: u32,
    content: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
enum Report {
    #[default]
    Done,
    Executing,
    Error,
}

impl Report {
    const fn lower(self) -> Lower {
        match self {
            Self::Done => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::Error => Lower::Error,
        }
    }
}

/// The status, with the content to which it belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Answered {
    age: u8, // ticks since its stamp, minus the one of every reading
    republished: bool,
    echo: u32,
    report: Report,
    about: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct State {
    commander: (u32, u8, bool),  // number, ticks since it was sent, started
    receiver: (u32, bool, bool), // echo, started, adopted
    current: u8,                 // to which the receiver's report belongs
    written: [Written; 2],       // in the last tick and the one before
    answered: [Answered; 2],
    sent: u8, // number, and a bit per executed command
    executed: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Commanding {
    restarts: bool,
    sends: bool,
    late: bool, // values one tick older
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Receiving {
    Steps { restarts: bool, late: bool, finishes: bool },
    Held, // last outputs republished
    Silent,
}

type Event = (Commanding, Receiving);

const QUIET: Commanding = Commanding { restarts: false, sends: false, late: false };
const STEP: Receiving = Receiving::Steps { restarts: false, late: false, finishes: false };

type Wrong = &'static str;

impl State {
    /// Returns the state and the commander's reading.
    fn tick(&mut self, (commanding, receiving): Event, start: Start) -> Result<Lower, Wrong> {
        let before = *self;
        let reading = self.command(&before, commanding, start)?;
        self.receive(&before, receiving)?;
        Ok(reading)
    }

    fn command(&mut self, before: &Self, event: Commanding, start: Start) -> Result<Lower, Wrong> {
        let (number, age, started) = before.commander;
        let mut commander = Commander { number, sent: Tick(NOW.0 - u64::from(age)), started };
        if event.restarts {
            commander = Commander::default();
        }
        let status = before.answered[usize::from(event.late)];
        match start {
            Start::Buffer => commander.start_from(NOW, before.written[0].number, status.echo),
            Start::Echo => commander.start(status.echo),
        }
        let header = Header {
            stamp: Tick(NOW.0 - 1 - u64::from(status.age)),
            republished: status.republished,
            ..Header::default()
        };
        let reading = commander.read(NOW, &header, status.echo, status.report.lower());
        let believed = matches!(reading, Lower::Done | Lower::Executing | Lower::Error);
        // A commander that has sent no command since its start uses no status.
        if believed && commander.started && status.about != before.written[0].content {
            return Err("a status of another command is accepted");
        }
        let mut written = before.written[0];
        if event.sends {
            self.sent += 1;
            written = Written { number: commander.send(NOW), content: self.sent };
        }
        self.written = [written, before.written[0]];
        let age = u8::try_from(NOW.since(commander.sent) + 1).unwrap_or(OLD).min(OLD);
        self.commander = (commander.number, age, commander.started);
        Ok(reading)
    }

    fn receive(&mut self, before: &Self, event: Receiving) -> Result<(), Wrong> {
        let last = before.answered[0];
        let older = Answered { age: (last.age + 1).min(OLD), ..last };
        let new = match event {
            Receiving::Silent => older,
            Receiving::Held => Answered { age: 0, republished: true, ..last },
            Receiving::Steps { restarts, late, finishes } => {
                let (echo, started, adopted) = before.receiver;
                let mut receiver = Receiver { echo, started, adopted };
                if restarts {
                    receiver = Receiver::default();
                }
                let command = before.written[usize::from(late)];
                let going = if finishes { Report::Done } else { Report::Executing };
                let report = match receiver.observe(command.number) {
                    Arrival::New => {
                        let bit = 1 << command.content;
                        if self.executed & bit != 0 {
                            return Err("a command is executed twice");
                        }
                        self.executed |= bit;
                        self.current = command.content;
                        going
                    }
                    Arrival::Restarted => {
                        self.current = command.content;
                        Report::Error
                    }
                    Arrival::Nothing => Report::Done,
                    Arrival::Same if last.report == Report::Executing => going,
                    Arrival::Same => last.report,
                };
                self.receiver = (receiver.echo, receiver.started, receiver.adopted);
                Answered { age: 0, republished: false, echo: receiver.echo, report, about: self.current }
            }
        };
        self.answered = [new, older];
        Ok(())
    }

    /// True if, without further faults, the last command is answered or a vanished receiver is detected.
    fn is_answered(mut self, start: Start) -> Result<(), Wrong> {
        let mut gone = self;
        let (mut reading, mut lost) = (Lower::Pending, Lower::Pending);
        for _ in 0..ECHO_LIMIT + 2 {
            reading = self.tick((QUIET, STEP), start)?;
            lost = gone.tick((QUIET, Receiving::Silent), start)?;
        }
        let content = self.written[0].content;
        if content != 0 && !matches!(reading, Lower::Done | Lower::Executing | Lower::Error) {
            return Err("a command is not answered");
        }
        if self.commander.2 && self.answered[0].about != content {
            return Err("a command is neither executed nor adopted");
        }
        if lost != Lower::Lost {
            return Err("a receiver that has gone is not reported lost");
        }
        Ok(())
    }
}

fn events(state: &State) -> Vec<Event> {
    let three = || (0_u8..8).map(|bits| (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0));
    let steps = three().map(|(restarts, late, finishes)| Receiving::Steps { restarts, late, finishes });
    let receiving: Vec<Receiving> = steps.chain([Receiving::Held, Receiving::Silent]).collect();
    let commanding = three().map(|(restarts, late, sends)| Commanding { restarts, sends, late });
    let possible = commanding.filter(|commanding| !commanding.sends || state.sent < COMMANDS);
    possible.flat_map(|commanding| receiving.iter().map(move |receiving| (commanding, *receiving))).collect()
}

/// The size, or the shortest path to an error.
struct Found {
    states: usize,
    ticks: u64,
    wrong: Option<(Vec<Event>, Wrong)>,
}

/// The known states, each with its predecessor and the tick between.
type Known = HashMap<State, Option<(State, Event)>>;

fn way(known: &Known, mut state: State, last: Option<Event>) -> Vec<Event> {
    let mut events = Vec::from_iter(last);
    while let Some(Some((before, event))) = known.get(&state) {
        events.push(*event);
        state = *before;
    }
    events.reverse();
    events
}

fn search(start: Start) -> Found {
    let mut known: Known = HashMap::from([(State::default(), None)]);
    let mut open = VecDeque::from([State::default()]);
    let mut ticks = 0;
    while let Some(state) = open.pop_front() {
        if let Err(wrong) = state.is_answered(start) {
            return Found { states: known.len(), ticks, wrong: Some((way(&known, state, None), wrong)) };
        }
        for event in events(&state) {
            ticks += 1;
            let mut next = state;
            if let Err(wrong) = next.tick(event, start) {
                let way = way(&known, state, Some(event));
                return Found { states: known.len(), ticks, wrong: Some((way, wrong)) };
            }
            known.entry(next).or_insert_with(|| {
                open.push_back(next);
                Some((state, event))
            });
        }
    }
    Found { states: known.len(), ticks, wrong: None }
}

#[test]
fn commands_between_processes_are_executed_once_with_their_own_status() {
    let found = search(Start::Buffer);
    assert!(found.wrong.is_none(), "{:#?}", found.wrong);
    assert_eq!((found.states, found.ticks), (292_636, 15_443_840), "the size that docs/evidence.md states");
}

/// A known limit: after a restart before the first echo, a number is sent twice. This is the shortest path.
#[test]
fn commander_following_the_echo_repeats_a_number_after_an_early_restart() {
    let sends = Commanding { sends: true, ..QUIET };
    let restarts = Commanding { restarts: true, ..sends };
    let wrong = "a status of another command is accepted";
    assert_eq!(search(Start::Echo).wrong, Some((vec![(sends, STEP), (restarts, STEP)], wrong)));
}
