//! The operator of a run (IV): requests between two ticks, who may send them, and how they are carried out.
//!
//! A request is a line of text ([`Request`]). Switches go to the joystick box, which the controller reads
//! ([`Operator::at_the_box`]); entries at the terminals of the boards are a further input
//! ([`Operator::at_the_terminals`]); requests to the cell are applied to the cell; a command goes through the mailbox
//! of the job player and shares its command numbers. All of it happens in [`Run::operate`](crate::Run), after the cell
//! has moved and before the job player runs: the next tick is the first one that sees it. Every request is in the log
//! with that tick, so that the inputs can be replayed.
//!
//! One operator commands at a time: the first that sends a request that moves something, until it sends `leave` or
//! disconnects. Stops are accepted from every operator.

mod by_hand;
mod request;
mod source;
mod terminals;
mod written;

use std::path::{self, Path};

use ::operator::Event;
use interfaces::{
    CommonMemory, OperatorInputs,
    device::{JoystickBox, KNOB_FULL},
};
use neighbours::workstation::{Judge as _, player::Hwsc};
use plant::{BoxAction, Joystick};
use rcs_core::tick::Tick;
use serde::Serialize;
use taskdata::load::{BlockNumber, Store};

pub use self::source::{Input, Inputs, WORKSTATION};
use self::{request::Request, terminals::Terminals};
use crate::{judge::CommandJudge, neighbours::Neighbours, workstation::SimulatedWorkstation};

/// Largest number of requests carried out in a tick; others wait for the next one.
pub const A_TICK: usize = 16;

/// The operators of a run.
pub struct Operator {
    /// The operators' joystick box; the lines of the job have another one.
    hand: Joystick,
    /// State of that box in the next tick.
    shown: JoystickBox,
    /// Entries at the terminals of the boards.
    terminals: Terminals,
    /// Part of a request that the run must carry out.
    later: Option<Later>,
    /// True if the velocity knob is at zero until `go`.
    is_stopped: bool,
    /// Names of the connected operators.
    sessions: Vec<String>,
    /// Name of the operator in command.
    commander: Option<String>,
    /// True for a robot at a port: motion must stop when the operator is silent.
    robot_elsewhere: bool,
    counts: Requests,
}

/// Number of requests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Requests {
    /// All requests, except questions.
    pub requests: u64,
    /// Requests that were refused.
    pub refused: u64,
}

/// A request that the run itself must carry out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Later {
    /// Load a block.
    Load(BlockNumber),
    /// Play a job instead of the rest of the present one.
    Play(String),
}

/// The parts of a run that a request reads and changes.
pub struct Around<'a> {
    /// The last tick.
    pub tick: Tick,
    /// Common memory after that tick.
    pub memory: &'a CommonMemory,
    /// Task data, for reading lines of a job.
    pub store: &'a Store,
    /// Errors in the records that a command uses do not count.
    pub unchecked: bool,
    /// Directory of the task data.
    pub data: &'a Path,
    /// The source of Task's commands.
    pub neighbours: &'a mut Neighbours,
    /// The cell.
    pub workstation: &'a mut SimulatedWorkstation,
    /// True while a block is being checked: what moves the robot must wait.
    pub loading: bool,
}

impl Operator {
    /// No operator is connected, and the box is in its initial state.
    #[must_use]
    pub fn new(robot_elsewhere: bool) -> Self {
        Self {
            hand: Joystick::default(),
            shown: JoystickBox { velocity: KNOB_FULL, ..JoystickBox::default() },
            terminals: Terminals::default(),
            later: None,
            is_stopped: false,
            sessions: Vec::new(),
            commander: None,
            robot_elsewhere,
            counts: Requests::default(),
        }
    }

    /// The joystick box of the next tick, combined from that of the job's lines and that of the operators. The lower
    /// velocity counts; a moved stick and an enabled frame take precedence; switches and buttons are combined by OR.
    #[must_use]
    pub fn at_the_box(&self, job: JoystickBox) -> JoystickBox {
        let own = &self.shown;
        let stick = if (own.x, own.y) == (0, 0) { (job.x, job.y) } else { (own.x, own.y) };
        JoystickBox {
            velocity: if self.is_stopped { 0 } else { own.velocity.min(job.velocity) },
            x: stick.0,
            y: stick.1,
            up: own.up || job.up,
            down: own.down || job.down,
            roll_plus: own.roll_plus || job.roll_plus,
            roll_minus: own.roll_minus || job.roll_minus,
            open: own.open || job.open,
            close: own.close || job.close,
            frame: if own.frame == 0 { job.frame } else { own.frame },
            record: own.record || job.record,
            resume: own.resume || job.resume,
            hold: own.hold | job.hold,
            single_step: own.single_step | job.single_step,
        }
    }

    /// Input of the controller from the terminals in the next tick.
    #[must_use]
    pub const fn at_the_terminals(&self) -> &OperatorInputs {
        self.terminals.inputs()
    }

    /// Called once per tick, after all requests: sets the box and the terminals for the next tick.
    pub fn end_tick(&mut self) {
        self.shown = self.hand.read();
        self.terminals.end_tick();
    }

    /// The part of the last request that the run must carry out.
    pub const fn take_later(&mut self) -> Option<Later> {
        self.later.take()
    }

    /// Count an answered request.
    pub fn count(&mut self, input: &Input, verdict: &Result<String, String>) {
        if matches!(input.event(), Event::Line(_)) && !input.is_question() {
            self.counts.requests += 1;
            self.counts.refused += u64::from(verdict.is_err());
        }
    }

    /// Number of requests; `None` if no operator has connected.
    #[must_use]
    pub fn requests(&self) -> Option<Requests> {
        (self.counts != Requests::default()).then_some(self.counts)
    }

    /// Carry out an event. Returns the text of the answer, or the reason of the refusal.
    pub fn carry_out(&mut self, input: &Input, around: &mut Around<'_>) -> Result<String, String> {
        let who = input.source();
        match input.event() {
            Event::Connected => self.connected(who, around),
            Event::Silent => self.is_silent(who),
            Event::Disconnected => self.disconnected(who, around),
            Event::Line(line) => {
                let request = Request::read(line, around.store);
                match request {
                    Ok(Request::Status) => return Ok(self.status(around)),
                    Ok(Request::Data) => return Ok(directory(around.data)),
                    Ok(Request::Pedestal) => return Ok(by_hand::state(around.memory)),
                    _ => {}
                }
                request.and_then(|request| self.obey(who, request, around))
            }
        }
    }

    fn connected(&mut self, who: &str, around: &mut Around<'_>) -> Result<String, String> {
        self.sessions.push(who.to_owned());
        self.attend(around);
        Ok(String::new())
    }

    /// Release stick and buttons because the operator is silent. A robot at a port comes to rest.
    fn is_silent(&mut self, who: &str) -> Result<String, String> {
        if self.commander.as_deref() == Some(who) && self.hand.busy() {
            self.hand.let_go();
            self.is_stopped |= self.robot_elsewhere;
        }
        Ok(String::new())
    }

    fn disconnected(&mut self, who: &str, around: &mut Around<'_>) -> Result<String, String> {
        if let Some(at) = self.sessions.iter().position(|session| session == who) {
            self.sessions.remove(at);
        }
        if self.commander.as_deref() == Some(who) && !self.sessions.iter().any(|session| session == who) {
            self.is_silent(who)?;
            self.commander = None;
            self.hand.act(BoxAction::Frame(0));
        }
        self.attend(around);
        Ok(String::new())
    }

    /// Tell the job whether an operator is connected: only then it waits for one.
    fn attend(&self, around: &mut Around<'_>) {
        if let Ok(job) = around.neighbours.job_under_way() {
            job.attend(!self.sessions.is_empty());
        }
    }

    fn obey(&mut self, who: &str, request: Request, around: &mut Around<'_>) -> Result<String, String> {
        if !request.is_stop() {
            self.take_command(who)?;
            if around.loading && request.is_of_the_job() {
                return Err(
                    "a block is being checked, which counts from the next command on: ask again".to_owned()
                );
            }
        }
        let done = String::new();
        let tick = around.tick;
        match request {
            Request::Status => Ok(self.status(around)),
            Request::Data => Ok(directory(around.data)),
            Request::Pedestal => Ok(by_hand::state(around.memory)),
            Request::Stop => {
                self.is_stopped = true;
                Ok("the velocity knob is at 0; `go` turns it back".to_owned())
            }
            Request::Go => {
                self.is_stopped = false;
                Ok(format!("the velocity knob is at {} of {KNOB_FULL}", self.shown.velocity))
            }
            Request::Leave => {
                if self.commander.as_deref() == Some(who) {
                    self.commander = None;
                }
                Ok(done)
            }
            Request::Note => Ok(done),
            Request::Wait => {
                job(around)?.wait_for_operator().map(|()| done).map_err(|error| error.to_string())
            }
            Request::GoOn => job(around)?.go_on(tick).map(|()| done).map_err(|error| error.to_string()),
            Request::Skip => job(around)?.skip(tick).map(|()| done).map_err(|error| error.to_string()),
            Request::Command(text, command) => {
                let (store, memory, unchecked) = (around.store, around.memory, around.unchecked);
                if let Some(wrong) = (CommandJudge { store, memory, unchecked }).verdict(&command) {
                    return Err(wrong);
                }
                let number = job(around)?.command_by_operator(tick, text, command);
                number.map(|number| format!("command {number}")).map_err(|error| error.to_string())
            }
            Request::Box(action) => {
                self.hand.act(action);
                Ok(done)
            }
            Request::Load(block) => {
                self.later = Some(Later::Load(block));
                Ok(done)
            }
            Request::Play(job) => {
                self.later = Some(Later::Play(job));
                Ok(done)
            }
            Request::StandAlone { now } => around.neighbours.take_command(tick, around.memory, now),
            Request::Workstation => around.neighbours.give_command(tick, around.memory),
            Request::Terminal(entry) => {
                self.terminals.enter(entry, tick, around.memory, &around.store.view())
            }
            Request::Cell(action, line) => around.workstation.begin_line(&action, &line).map(|()| done),
        }
    }

    /// Give the command to an operator, if no other one has it.
    fn take_command(&mut self, who: &str) -> Result<(), String> {
        match &self.commander {
            Some(other) if other != who => Err(format!(
                "{other} commands this run; stops are for everybody, the rest when it says `leave`"
            )),
            _ => {
                self.commander = Some(who.to_owned());
                Ok(())
            }
        }
    }

    /// The status of the run in one line.
    fn status(&self, around: &mut Around<'_>) -> String {
        let stand_alone = around.neighbours.is_stand_alone();
        let job = match around.neighbours.job_under_way() {
            Ok(job) if job.is_waiting() && stand_alone => "stand-alone, no job plays",
            Ok(job) if job.is_waiting() => "the job waits",
            Ok(_) => "the job plays",
            Err(_) => "the workstation controller commands",
        };
        let commander = self.commander.as_deref().unwrap_or("nobody");
        let knob = if self.is_stopped { 0 } else { self.shown.velocity };
        format!("{job}; {commander} commands; knob {knob}; connected {}", self.sessions.len())
    }
}

/// An absolute path, for a program in another directory; data built into the program keep their name.
fn directory(data: &Path) -> String {
    let absolute = if data.is_dir() { path::absolute(data) } else { Ok(data.to_owned()) };
    absolute.unwrap_or_else(|_| data.to_owned()).display().to_string()
}

/// The job, if it is the source of commands.
fn job<'a>(around: &'a mut Around<'_>) -> Result<&'a mut Hwsc, String> {
    around.neighbours.job_under_way()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::device::joystick_frame;

    #[test]
    fn the_lower_knob_holds_and_switches_add_up() {
        let mut operator = Operator::new(false);
        let job =
            JoystickBox { velocity: 700, hold: 1, frame: joystick_frame::WORLD, x: 5, ..Default::default() };
        assert_eq!(operator.at_the_box(job), job, "nobody has done anything");
        operator.hand.act(BoxAction::Velocity(800));
        operator.hand.act(BoxAction::Hold(2));
        operator.hand.act(BoxAction::Stick { x: 0, y: -30, ticks: 1 });
        operator.end_tick();
        let both = operator.at_the_box(job);
        assert_eq!((both.velocity, both.hold, both.x, both.y), (700, 3, 0, -30));
        operator.hand.act(BoxAction::Velocity(100));
        operator.end_tick();
        assert_eq!((operator.at_the_box(job).velocity, operator.at_the_box(job).x), (100, 5));
        operator.is_stopped = true;
        assert_eq!(operator.at_the_box(job).velocity, 0);
    }

    #[test]
    fn one_commands_until_it_leaves() {
        let mut operator = Operator::new(false);
        assert_eq!(operator.take_command("a"), Ok(()));
        assert_eq!(operator.take_command("a"), Ok(()));
        let refused = operator.take_command("b").unwrap_err();
        assert!(refused.starts_with("a commands this run"), "{refused}");
    }

    #[test]
    fn who_is_silent_lets_go_and_a_robot_at_a_port_stops() {
        for elsewhere in [false, true] {
            let mut operator = Operator::new(elsewhere);
            operator.take_command("a").unwrap();
            operator.hand.act(BoxAction::Stick { x: 900, y: 0, ticks: 1000 });
            operator.is_silent("b").unwrap();
            assert!(operator.hand.busy(), "another one is silent");
            operator.is_silent("a").unwrap();
            assert_eq!((operator.hand.busy(), operator.is_stopped), (false, elsewhere));
        }
    }
}
