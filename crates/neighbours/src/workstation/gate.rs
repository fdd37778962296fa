//! Task's end of the workstation controller's mailboxes: READ-HWS-COMMAND, WRITE-HWS-STATUS and UPDATE-MAILGRAM?
//! (Figure IV.1, IX.1).
//!
//! A command is executed once, depending on its number:
//!
//! | number of the mailgram                    | result                                                               |
//! |-------------------------------------------|----------------------------------------------------------------------|
//! | the last one, and the same fields         | repeated: answered with the present status, not executed again       |
//! | the last one, and other fields            | refused                                                              |
//! | the one after the last                    | accepted                                                             |
//! | any other                                 | refused; accepted as the first since the mailboxes were initialized  |
//!
//! An accepted command is checked against the task data ([`Judge`]). A failed command goes to Task with that verdict,
//! and Task refuses it: the status echoes its number with `error` and the reason. A workstation controller that
//! (re)connects reads `command-#-echo` and continues after it (IX.1).

use std::fmt;

use interfaces::{
    CommonMemory, Detail, HwsCommand,
    hws::{Checked, HwsReport, HwsStatus},
};

use super::{
    command::{self, CommandError},
    status::{self, TaskState, Why},
};
use crate::{
    fields::successor,
    mailbox::{HWSC_COMMAND, HWSC_STATUS, Mailbox},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    Garbled(CommandError), // the bytes cannot be decoded
    /// The number belongs to another command.
    Changed {
        number: u16,
    },
    /// The number is not the next one.
    OutOfOrder {
        expected: u16,
        found: u16,
    },
}

impl Refusal {
    #[must_use]
    pub const fn code(&self) -> u16 {
        match self {
            Self::Garbled(_) => 1,
            Self::Changed { .. } => 2,
            Self::OutOfOrder { .. } => 3,
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Garbled(error) => error.fmt(f),
            Self::Changed { number } => {
                write!(
                    f,
                    "command {number} was given before with other fields; {} comes next",
                    successor(*number)
                )
            }
            Self::OutOfOrder { expected, found } => {
                write!(f, "command {expected} comes next, found {found}")
            }
        }
    }
}

pub trait Judge {
    fn verdict(&self, command: &HwsCommand) -> Option<String>; // `None`: the command passes
}

#[derive(Clone, Copy, Debug)]
pub struct Unchecked; // Task alone decides

impl Judge for Unchecked {
    fn verdict(&self, _: &HwsCommand) -> Option<String> {
        None
    }
}

/// The gate allocates only for a command that fails its check.
#[derive(Clone, Debug)]
pub struct Gate {
    read: u16, // last mailgram number
    refused: Option<Refusal>,
    command: HwsCommand,
    wrong: Option<String>,     // if the command fails its check
    fresh: bool,               // no command accepted since the initialization
    told: (HwsStatus, Detail), // with the details of its reason on arrival
    status_box: Mailbox,
}

impl Default for Gate {
    fn default() -> Self {
        Self {
            read: 0,
            refused: None,
            command: HwsCommand::default(),
            wrong: None,
            fresh: true,
            told: (HwsStatus::default(), Detail::None),
            status_box: Mailbox::initialized(HWSC_STATUS),
        }
    }
}

impl Gate {
    /// A controller that starts with its last command does not execute it. The next may have any other number.
    #[must_use]
    pub fn resumed(command: &HwsCommand) -> Self {
        Self { command: *command, ..Self::default() }
    }

    #[must_use]
    pub const fn command(&self) -> &HwsCommand {
        &self.command
    }

    #[must_use]
    pub const fn refused(&self) -> Option<&Refusal> {
        self.refused.as_ref()
    }

    #[must_use]
    pub fn wrong(&self) -> Option<&str> {
        self.wrong.as_deref()
    }

    #[must_use]
    pub fn unread<'b>(&self, command_box: &'b Mailbox) -> Option<&'b [u8]> {
        (command_box.mailgram() != self.read).then(|| command_box.data())
    }

    #[must_use]
    pub const fn status_box(&self) -> &Mailbox {
        &self.status_box
    }

    /// Block 641, IX.1: the next command may have any number except the last. Task keeps its command.
    pub fn initialize(&mut self) {
        (self.read, self.refused, self.fresh) = (0, None, true);
        self.status_box.initialize();
    }

    /// Skips a command that was sent while the mailbox was not read, and must not be executed.
    pub fn pass_over(&mut self, command_box: &Mailbox) {
        self.read = command_box.mailgram();
    }

    /// READ-HWS-COMMAND, once per tick. Returns `Some` if a mailgram is refused.
    pub fn read(&mut self, command_box: &Mailbox, judge: &impl Judge) -> Option<Refusal> {
        debug_assert_eq!(command_box.place(), HWSC_COMMAND);
        let mailgram = command_box.mailgram();
        if mailgram == 0 || mailgram == self.read {
            return None;
        }
        self.read = mailgram;
        self.refused = self.take(command_box.data(), judge).err();
        self.refused
    }

    fn take(&mut self, data: &[u8], judge: &impl Judge) -> Result<(), Refusal> {
        let command = command::decode(data).map_err(Refusal::Garbled)?;
        let (last, found) = (self.command.number, command.number);
        if found == last {
            if command == (HwsCommand { checked: Checked::Passes, ..self.command }) {
                return Ok(());
            }
            return Err(Refusal::Changed { number: word(found) });
        }
        let expected = successor(word(last));
        if !self.fresh && word(found) != expected {
            return Err(Refusal::OutOfOrder { expected, found: word(found) });
        }
        self.wrong = judge.verdict(&command);
        let checked = if self.wrong.is_some() { Checked::Fails } else { Checked::Passes };
        (self.command, self.fresh) = (HwsCommand { checked, ..command }, false);
        Ok(())
    }

    /// WRITE-HWS-STATUS and UPDATE-MAILGRAM?, once per tick. True if Task's status has changed.
    pub fn write(&mut self, memory: &CommonMemory, state: TaskState) -> bool {
        let task = memory.task.status;
        if task != self.told.0 {
            self.told = (task, Detail::of_command(task.reason, &self.command, memory));
        }
        let is_refused = task.echo == self.command.number && task.report == HwsReport::Error;
        let why = match (&self.refused, self.wrong.as_deref().filter(|_| is_refused)) {
            (Some(refusal), _) => Why::Mailgram(refusal),
            (None, Some(wrong)) => Why::Command(wrong),
            (None, None) => Why::Reason(self.told.1),
        };
        let bytes = status::encode(&task, why, state, self.read);
        if self.status_box.data() == bytes {
            return false;
        }
        self.status_box.write(&bytes).is_ok()
    }
}

fn word(number: u32) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use interfaces::{Reason, emove::NearPlace, hws::HwsReport};
    use rcs_core::name::{Name10, Name16};

    use super::{super::command::tests::transfer, *};

    struct Vise; // rejects commands to VISE

    impl Judge for Vise {
        fn verdict(&self, command: &HwsCommand) -> Option<String> {
            let wrong = command.destination == Some(Name16::clipped("VISE"));
            wrong.then(|| "no location is named VISE".to_owned())
        }
    }

    struct Bench {
        gate: Gate,
        command_box: Mailbox,
    }

    impl Bench {
        fn new() -> Self {
            Self { gate: Gate::default(), command_box: Mailbox::initialized(HWSC_COMMAND) }
        }

        fn send(&mut self, data: &[u8]) -> Option<String> {
            self.command_box.write(data).unwrap();
            let refused = self.gate.read(&self.command_box, &Vise);
            assert_eq!(self.gate.read(&self.command_box, &Vise), None, "a mailgram is judged once");
            refused.map(|refusal| refusal.to_string())
        }

        fn command(&mut self, command: &HwsCommand) -> Option<String> {
            self.send(&command::encode(command).unwrap())
        }

        fn status(&mut self, echo: u32, report: HwsReport) -> status::Status<'_> {
            let mut memory = CommonMemory::default();
            (memory.task.status.echo, memory.task.status.report) = (echo, report);
            self.gate.write(&memory, TaskState::Runs);
            status::decode(self.gate.status_box().data()).unwrap()
        }
    }

    #[test]
    fn commands_are_taken_in_their_order() {
        let mut bench = Bench::new();
        for number in [40, 41, 42] {
            assert_eq!(bench.command(&transfer(number)), None);
            assert_eq!(*bench.gate.command(), transfer(number));
        }
    }

    #[test]
    fn refused_command_does_not_reach_task() {
        let mut bench = Bench::new();
        bench.command(&transfer(7));
        let other = HwsCommand { source_sector: Some(1), ..transfer(7) };
        let good = command::encode(&transfer(8)).unwrap();
        let refused = [
            (bench.send(b"hello"), 1, "a command of 126 bytes was expected, found 5"),
            (bench.send(&good[..100]), 1, "a command of 126 bytes was expected, found 100"),
            (bench.command(&other), 2, "command 7 was given before with other fields; 8 comes next"),
            (bench.command(&transfer(6)), 3, "command 8 comes next, found 6"),
            (bench.command(&transfer(9)), 3, "command 8 comes next, found 9"),
        ];
        for (at, (said, _, why)) in refused.iter().enumerate() {
            assert_eq!(said.as_deref(), Some(*why), "{at}");
        }
        assert_eq!(*bench.gate.command(), transfer(7));
        bench.send(b"hello");
        let status = bench.status(7, HwsReport::Executing);
        assert_eq!((status.echo, status.report), (7, HwsReport::Executing), "it continues");
        assert_eq!((status.verdict, status.mailgram_echo), (1, 7));
        assert_eq!(status.reason, "a command of 126 bytes was expected, found 5");
        assert_eq!(bench.command(&transfer(8)), None);
        let status = bench.status(8, HwsReport::Executing);
        assert_eq!((status.verdict, status.reason), (0, ""));
    }

    #[test]
    fn command_failing_its_check_reaches_task_with_the_verdict() {
        let mut bench = Bench::new();
        let wrong = HwsCommand { destination: Some(Name16::clipped("VISE")), ..transfer(7) };
        assert_eq!(bench.command(&wrong), None, "the mailgram is in order");
        assert_eq!(*bench.gate.command(), HwsCommand { checked: Checked::Fails, ..wrong });
        assert_eq!(bench.gate.wrong(), Some("no location is named VISE"));
        assert_eq!(bench.status(7, HwsReport::Error).reason, "no location is named VISE");
        assert_eq!(bench.command(&wrong), None, "it is repeated");
        assert_eq!(bench.command(&transfer(8)), None);
        assert_eq!((bench.gate.command(), bench.gate.wrong()), (&transfer(8), None));
        assert_eq!(bench.status(8, HwsReport::Error).reason, "");
    }

    #[test]
    fn repeated_command_is_answered_but_not_executed() {
        let mut bench = Bench::new();
        bench.command(&transfer(7));
        let before = bench.status(7, HwsReport::Finished).mailgram_echo;
        assert_eq!(bench.command(&transfer(7)), None);
        let after = bench.status(7, HwsReport::Finished);
        assert_eq!((after.report, after.verdict), (HwsReport::Finished, 0));
        assert_ne!(after.mailgram_echo, before, "a new mailgram answers it");
    }

    #[test]
    fn mailbox_is_written_on_change() {
        let mut bench = Bench::new();
        let memory = CommonMemory::default();
        assert!(bench.gate.write(&memory, TaskState::Runs));
        assert!(!bench.gate.write(&memory, TaskState::Runs));
        assert!(bench.gate.write(&memory, TaskState::Held));
        assert_eq!(bench.gate.status_box().mailgram(), 2);
    }

    #[test]
    fn failure_distances_are_those_of_its_tick() {
        let mut bench = Bench::new();
        let mut memory = CommonMemory::default();
        let near = |inches| {
            [
                Some(NearPlace { location: Name10::clipped("HOME"), inches, degrees: 0.0, offset: [0.0; 3] }),
                None,
            ]
        };
        (memory.task.status.report, memory.task.status.reason) = (HwsReport::Error, Reason::UnknownStart);
        memory.emove.nearest = near(2.5);
        assert!(bench.gate.write(&memory, TaskState::Runs));
        let told = status::decode(bench.gate.status_box().data()).unwrap().reason.to_owned();
        assert!(told.ends_with(": HOME is 2.50 in and 0.0 degrees away"), "{told}");
        memory.emove.nearest = near(3.5);
        assert!(!bench.gate.write(&memory, TaskState::Runs), "an unchanged status is not written");
    }

    #[test]
    fn initialization_synchronizes_numbers() {
        let mut bench = Bench::new();
        bench.command(&transfer(7));
        bench.gate.initialize();
        bench.command_box.initialize();
        assert_eq!(bench.gate.read(&bench.command_box, &Vise), None);
        assert_eq!(*bench.gate.command(), transfer(7), "Task continues its command");
        assert!(bench.command(&HwsCommand { serial: Default::default(), ..transfer(7) }).is_some());
        assert_eq!(bench.command(&transfer(300)), None);
        assert_eq!(bench.command(&transfer(302)).as_deref(), Some("command 301 comes next, found 302"));
    }

    #[test]
    fn numbers_run_round() {
        let mut bench = Bench::new();
        assert_eq!(bench.command(&transfer(65_535)), None);
        assert_eq!(bench.command(&transfer(1)), None);
    }
}
