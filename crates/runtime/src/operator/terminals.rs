//! Entries at the terminals of the boards (IV.2.6, IV.3.2, IV.3.3): they stop and start boards, execute a level
//! once, and initialize the link. The record is one of the controller's inputs in a tick.

use std::{collections::VecDeque, mem};

use interfaces::{
    CommonMemory, OperatorInputs, ProcessId,
    emove::EmoveVerb,
    operator::{BOARDS, HandOrder, Support, WRITES, Write, board_bit, process_bit},
    pedestal::PedestalVerb,
};
use rcs_core::{handshake::successor, tick::Tick};
use taskdata::files::TaskData;

use super::{by_hand, knowledge, written};

pub const PASSES: u8 = 100; // largest number of passes of a process in one request

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    Stop(u8),               // `^C`: stop the processes of the board; on board 0, the pulse
    Go(u8),                 // `GO`, on board 0 `SSGO`
    Execute(ProcessId, u8), // `PRIM-LEVEL` and similar: a number of passes of a process, one per tick
    RobotInit,
    DbDone(bool), // DB-DONE of block 903; true if the block contains it
    Write(Write), // `<= VALUE` for a variable
    Name(Write),  // the object in the gripper, named by a person while E-move runs
    Pedestal(HandOrder),
    Confirm(Support), // support that keeps the object from falling when the gripper opens
}

fn name(process: ProcessId) -> String {
    process.field().to_uppercase().replace('_', "-")
}

impl Entry {
    /// Read the words of a request; `None` if they begin another request.
    pub fn read(words: &[&str]) -> Option<Result<Self, String>> {
        Some(match *words {
            ["board", number, verb @ ("stop" | "go")] => board(number).map(|board| match verb {
                "stop" => Self::Stop(board),
                _ => Self::Go(board),
            }),
            ["board", ..] => Err(format!("board NUMBER stop or go was expected; found {}", words.join(" "))),
            ["execute", process] => named(process).map(|process| Self::Execute(process, 1)),
            ["execute", process, passes] => named(process).and_then(|process| {
                let passes = passes.parse().ok().filter(|passes| (1..=PASSES).contains(passes));
                let passes = passes.ok_or_else(|| format!("1 to {PASSES} passes were expected"))?;
                Ok(Self::Execute(process, passes))
            }),
            ["execute", ..] => {
                Err("execute PROCESS [PASSES] was expected, such as execute PRIM 2".to_owned())
            }
            ["robot-init"] => Ok(Self::RobotInit),
            ["db-done", "on"] => Ok(Self::DbDone(true)),
            ["db-done", "off"] => Ok(Self::DbDone(false)),
            ["db-done", ..] => Err(format!("db-done on or off was expected; found {}", words.join(" "))),
            ["write", ref rest @ ..] => written::read(rest).map(Self::Write),
            ["resume", ref rest @ ..] => knowledge::read(rest).map(Self::Name),
            ["pedestal", ref rest @ ..] => by_hand::order(rest).map(Self::Pedestal),
            ["confirm", ref rest @ ..] => by_hand::confirmation(rest).map(Self::Confirm),
            _ => return None,
        })
    }

    /// True if it can only bring the robot or the pedestal to rest.
    pub const fn is_stop(self) -> bool {
        match self {
            Self::Stop(board) => board == 2,
            Self::Pedestal(order) => matches!(order.command, PedestalVerb::Pause),
            _ => false,
        }
    }
}

fn board(number: &str) -> Result<u8, String> {
    let found = number.parse().ok().filter(|number| BOARDS.contains(number));
    found.ok_or_else(|| format!("board 0, 2, 4, 6 or 8 was expected (IV.2.2); found {number}"))
}

fn named(word: &str) -> Result<ProcessId, String> {
    let found = ProcessId::ALL.iter().copied().find(|process| name(*process) == word);
    found.ok_or_else(|| {
        let known: Vec<String> = ProcessId::ALL.iter().map(|process| name(*process)).collect();
        format!("one of {} was expected; found {word}", known.join(", "))
    })
}

#[derive(Debug, Default)]
pub struct Terminals {
    shown: OperatorInputs,
    passes: VecDeque<u16>, // processes to execute in the next ticks, one entry per tick
    writes: [Option<Write>; WRITES], // values to write in the next tick
    /// Name of the held object, and its age, ticks. E-move stops for two ticks, in which the name can be written.
    naming: Option<(Write, u8)>,
    order: Option<HandOrder>,   // order to the pedestal in the next tick
    confirmed: Option<Support>, // statement about the object in the gripper, for the next tick
}

impl Terminals {
    #[must_use]
    pub const fn inputs(&self) -> &OperatorInputs {
        &self.shown
    }

    /// Called once per tick, after all requests.
    pub fn end_tick(&mut self) {
        let board = board_bit(ProcessId::Emove.board());
        match self.naming.take() {
            Some((write, 0)) => {
                self.shown.stopped |= board;
                self.naming = Some((write, 1));
            }
            Some((write, 1)) => {
                if let Some(free) = self.writes.iter_mut().find(|slot| slot.is_none()) {
                    *free = Some(write);
                }
                self.naming = Some((write, 2));
            }
            Some(_) => self.shown.stopped &= !board,
            None => {}
        }
        self.shown.executed = self.passes.pop_front().unwrap_or_default();
        self.shown.writes = mem::take(&mut self.writes);
        self.shown.pedestal = self.order.take();
        self.shown.confirmed = self.confirmed.take();
    }

    /// Discard the remaining passes. Returns true if there were any.
    pub fn drop_passes(&mut self) -> bool {
        let had_some = !self.passes.is_empty();
        self.passes.clear();
        had_some
    }

    /// Makes an entry. `memory` is common memory after `tick`; `data` are the task data of the next tick.
    pub fn enter(
        &mut self,
        entry: Entry,
        tick: Tick,
        memory: &CommonMemory,
        data: &TaskData<'_>,
    ) -> Result<String, String> {
        match entry {
            Entry::Stop(board) => {
                self.shown.stopped |= board_bit(board);
                Ok(what_stops(board).to_owned())
            }
            Entry::Go(board) => {
                self.shown.stopped &= !board_bit(board);
                let waits = if board != 0 && self.shown.is_stopped(board) {
                    ": it waits for the pulse, which `board 0 go` gives"
                } else {
                    ""
                };
                Ok(format!("board {board} runs{waits}"))
            }
            Entry::Execute(process, passes) => self.execute(process, passes),
            Entry::RobotInit => self.initialize(memory),
            Entry::DbDone(on) => self.db_done(on, memory),
            Entry::Write(write) => self.write(write, memory, data),
            Entry::Name(write) => {
                let answer = knowledge::check(&write, memory, data)?;
                if self.naming.is_some() || self.shown.is_stopped(ProcessId::Emove.board()) {
                    return Err("E-move is stopped: `board 2 go` and `board 0 go` start it, then ask again"
                        .to_owned());
                }
                self.naming = Some((write, 0));
                Ok(answer)
            }
            Entry::Pedestal(order) => {
                let answer = by_hand::check_order(&order, tick.next(), memory, data)?;
                if self.order.is_some() {
                    return Err("an order is sent in the next tick already: ask again".to_owned());
                }
                self.order = Some(order);
                Ok(answer)
            }
            Entry::Confirm(by) => {
                let answer = by_hand::check_confirmation(by, memory, data)?;
                self.confirmed = Some(by);
                Ok(answer)
            }
        }
    }

    fn execute(&mut self, process: ProcessId, passes: u8) -> Result<String, String> {
        let board = process.board();
        if !self.shown.is_stopped(board) {
            return Err(format!(
                "{process} runs; `board {board} stop` stops it, then it can be executed singly"
            ));
        }
        if self.passes.len() + usize::from(passes) > usize::from(PASSES) {
            return Err(format!("{} passes are waiting; {PASSES} can", self.passes.len()));
        }
        self.passes.extend(std::iter::repeat_n(process_bit(process), passes.into()));
        Ok(format!("{process} is executed, passes: {passes}"))
    }

    /// Edit block 903, whose board must be stopped (IV.2.3, IV.3.2 step 1).
    fn db_done(&mut self, on: bool, memory: &CommonMemory) -> Result<String, String> {
        written::stands(ProcessId::Task, memory)?;
        self.shown.db_done = on;
        Ok(if on {
            "Task treats its requests to the Data System as done: the database may lack moves from now on"
        } else {
            "Task waits for the Data System"
        }
        .to_owned())
    }

    /// Write a value in the next tick, before the process runs again.
    fn write(&mut self, write: Write, memory: &CommonMemory, data: &TaskData<'_>) -> Result<String, String> {
        let answer = written::check(&write, memory, data)?;
        let free = self.writes.iter_mut().find(|slot| slot.is_none());
        *free.ok_or_else(|| format!("{WRITES} values are written in the next tick: ask again"))? =
            Some(write);
        Ok(answer)
    }

    /// E-move sends ROBOT-INIT to Prim during E-PAUSE; on a stopped board each process is executed as often as needed.
    fn initialize(&mut self, memory: &CommonMemory) -> Result<String, String> {
        let command = memory.subtask.emove.command;
        if !matches!(command, EmoveVerb::None | EmoveVerb::Pause) {
            return Err(format!("E-move executes {command}: PAUSE first, since ROBOT-INIT drops the motion"));
        }
        self.shown.robot_init = successor(self.shown.robot_init);
        if self.shown.is_stopped(ProcessId::Prim.board()) {
            self.passes.extend([ProcessId::Emove, ProcessId::Prim].map(process_bit));
        }
        Ok("Prim gets ROBOT-INIT, which restarts the link".to_owned())
    }
}

const fn what_stops(board: u8) -> &'static str {
    match board {
        0 => "there is no pulse: no process is stepped, and the robot holds its last commanded position",
        2 => "E-move and Prim are stopped: the robot holds its last commanded position",
        4 => "T3 Interface is stopped: the robot gets no frame, and holds its last commanded position",
        6 => "Task and Subtask are stopped; what E-move has started continues",
        _ => "Quick Change and the grippers are stopped: valves stay as they are",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use interfaces::{emove::Located, grip::Felt};
    use rcs_core::name::Name16;
    use taskdata::load::Store;

    fn entry(line: &str) -> Result<Entry, String> {
        Entry::read(&line.split(' ').collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn requests_are_read() {
        assert_eq!(entry("board 2 stop"), Ok(Entry::Stop(2)));
        assert_eq!(entry("board 0 go"), Ok(Entry::Go(0)));
        assert_eq!(entry("execute PRIM"), Ok(Entry::Execute(ProcessId::Prim, 1)));
        assert_eq!(entry("execute QUICK-CHANGE 3"), Ok(Entry::Execute(ProcessId::QuickChange, 3)));
        assert_eq!(entry("robot-init"), Ok(Entry::RobotInit));
        assert_eq!(Entry::read(&["stop"]), None);
        for (line, word) in [
            ("board 12 go", "0, 2, 4, 6 or 8"),
            ("board 2", "board NUMBER stop or go"),
            ("execute PRIMS", "TASK, SUBTASK"),
            ("execute PRIM 0", "1 to 100"),
            ("execute", "execute PROCESS"),
            ("db-done", "db-done on or off"),
            ("write", "write VARIABLE VALUE"),
            ("write emove.status.held NONE", "task.ledger, task.updates.pending, subtask.regrip"),
            (
                "write emove.estimates.placed BLOCK",
                "write emove.estimates.placed NONE was expected; found BLOCK",
            ),
            ("write emove.estimates.held BLOCK", "NONE or OBJECT GRIP"),
            ("write emove.estimates.held BLOCK 100", "found BLOCK 100"),
            ("write subtask.regrip BLOCK 1", "NONE or OBJECT was expected"),
        ] {
            assert!(entry(line).unwrap_err().contains(word), "{line}: {:?}", entry(line));
        }
    }

    #[test]
    fn pass_takes_one_tick_on_a_stopped_board() {
        let (mut terminals, memory) = (Terminals::default(), CommonMemory::default());
        let prim = Entry::Execute(ProcessId::Prim, 2);
        assert!(
            terminals.enter(prim, Tick(1), &memory, &TaskData::default()).unwrap_err().contains("Prim runs")
        );
        terminals.enter(Entry::Stop(2), Tick(1), &memory, &TaskData::default()).unwrap();
        terminals.enter(prim, Tick(1), &memory, &TaskData::default()).unwrap();
        let executed = [1, 2, 3].map(|_| {
            terminals.end_tick();
            terminals.inputs().executes(ProcessId::Prim)
        });
        assert_eq!(executed, [true, true, false]);
        assert!(
            terminals
                .enter(Entry::Execute(ProcessId::Emove, PASSES), Tick(1), &memory, &TaskData::default())
                .is_ok()
        );
        assert!(
            terminals
                .enter(prim, Tick(1), &memory, &TaskData::default())
                .unwrap_err()
                .contains("100 passes are waiting")
        );
    }

    #[test]
    fn board_starts_only_with_the_pulse() {
        let (mut terminals, memory) = (Terminals::default(), CommonMemory::default());
        let mut enter = |entry| terminals.enter(entry, Tick(1), &memory, &TaskData::default());
        assert_eq!(enter(Entry::Go(6)).unwrap(), "board 6 runs", "it did before");
        enter(Entry::Stop(6)).unwrap();
        enter(Entry::Stop(0)).unwrap();
        assert!(enter(Entry::Go(6)).unwrap().contains("waits for the pulse"));
        assert_eq!(enter(Entry::Go(0)).unwrap(), "board 0 runs");
    }

    #[test]
    fn link_is_initialized_during_e_pause() {
        let (mut terminals, mut memory) = (Terminals::default(), CommonMemory::default());
        terminals.enter(Entry::RobotInit, Tick(1), &memory, &TaskData::default()).unwrap();
        assert_eq!(terminals.inputs().robot_init, 1);
        terminals.enter(Entry::Stop(2), Tick(1), &memory, &TaskData::default()).unwrap();
        terminals.enter(Entry::RobotInit, Tick(1), &memory, &TaskData::default()).unwrap();
        terminals.end_tick();
        assert!(terminals.inputs().executes(ProcessId::Emove) && terminals.inputs().robot_init == 2);
        memory.subtask.emove.command = EmoveVerb::MovToLoc;
        assert!(
            terminals
                .enter(Entry::RobotInit, Tick(1), &memory, &TaskData::default())
                .unwrap_err()
                .contains("PAUSE first")
        );
    }

    /// A common memory in which these processes have not run.
    fn standing(processes: &[ProcessId]) -> CommonMemory {
        let mut memory = CommonMemory::default();
        processes.iter().for_each(|process| memory.header_mut(*process).republished = true);
        memory
    }

    #[test]
    fn written_value_applies_for_one_tick_and_is_logged() {
        let mut terminals = Terminals::default();
        let mut memory = standing(&[ProcessId::Emove]);
        let located = Located { object: Name16::clipped("LINKBAR1"), ..Located::default() };
        memory.emove.estimates.located = Some(located);
        let mut enter = |line: &str, memory: &CommonMemory| {
            terminals.enter(entry(line).unwrap(), Tick(1), memory, &TaskData::default())
        };
        let located = "write emove.estimates.located NONE";
        assert_eq!(enter(located, &memory).unwrap(), "emove.estimates.located was LINKBAR1, is NONE");
        for line in ["placed", "held", "placed"] {
            let line = format!("write emove.estimates.{line} NONE");
            assert!(enter(&line, &memory).unwrap().ends_with("was NONE, is NONE"), "{line}");
        }
        assert!(enter(located, &memory).unwrap_err().contains("4 values are written"));
        let why = enter("write task.ledger NONE", &memory).unwrap_err();
        assert!(why.contains("Task runs: `board 6 stop` or `joystick hold TASK`"), "{why}");
        let shown = [(); 2].map(|()| {
            terminals.end_tick();
            terminals.inputs().writes_to(ProcessId::Emove).count()
        });
        assert_eq!(shown, [4, 0]);
    }

    #[test]
    fn db_done_changes_while_task_is_stopped() {
        let mut terminals = Terminals::default();
        let mut enter = |line: &str, memory: &CommonMemory| {
            terminals.enter(entry(line).unwrap(), Tick(1), memory, &TaskData::default())?;
            Ok::<_, String>(terminals.inputs().db_done)
        };
        assert!(enter("db-done on", &standing(&[])).unwrap_err().contains("Task runs: `board 6 stop`"));
        let memory = standing(&[ProcessId::Task]);
        assert_eq!(enter("db-done on", &memory), Ok(true));
        assert_eq!(enter("db-done off", &memory), Ok(false));
    }

    #[test]
    fn name_is_accepted_only_for_a_sensed_object() {
        let (store, _) = Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))).unwrap();
        let mut memory = standing(&[ProcessId::Emove, ProcessId::Subtask]);
        let ask = |line: &str, memory: &CommonMemory| {
            Terminals::default().enter(entry(line).unwrap(), Tick(1), memory, &store.view())
        };
        let held = "write emove.estimates.held LINKBAR1_BH 2";
        assert!(ask(held, &memory).unwrap_err().contains("the gripper holds nothing"));
        memory.quick_change.status.end_effector_id = Some(1);
        memory.grip.status.felt = Felt::NotKnown;
        assert!(ask(held, &memory).unwrap_err().contains("board 8"));
        memory.grip.status.felt = Felt::Something;
        (memory.grip.status.initialized, memory.grip.status.position) = (true, 20);
        assert!(ask(held, &memory).unwrap_err().contains("they are at 0.20 in"));
        memory.grip.status.position = 400;
        assert_eq!(ask(held, &memory).unwrap(), "emove.estimates.held was NONE, is LINKBAR1_BH 2");
        memory.grip.header.republished = true;
        assert!(ask(held, &memory).unwrap_err().contains("run its process"), "its sensors are not read");
        for (line, why) in [
            ("write emove.estimates.held LINKBAR9 2", "no object form"),
            ("write emove.estimates.held LINKBAR1_BH 9", "a grip of LINKBAR1_BH was expected: +2; found +9"),
            ("write subtask.regrip LCLEVIS_IH", "the pedestal's hand holds nothing"),
        ] {
            let found = ask(line, &memory).unwrap_err();
            assert!(found.contains(why), "{line}: {found}");
        }
        memory.pedestal.status.felt = Felt::Something;
        assert!(
            ask("write subtask.regrip LCLEVIS_IH", &memory).is_err(),
            "the pedestal has no order to grip"
        );
        memory.pedestal.status.gripped = true;
        assert_eq!(
            ask("write subtask.regrip LCLEVIS_IH", &memory).unwrap(),
            "subtask.regrip was NONE, is LCLEVIS_IH"
        );
    }
}
