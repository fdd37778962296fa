//! The operator of a run (IV): requests between two ticks, their permitted senders, and their execution.
//!
//! A request is a line of text ([`Request`]). Switches go to the joystick box ([`Operator::at_the_box`]), entries at
//! terminals to another input of the controller ([`Operator::at_the_terminals`]), and commands to the mailbox, with the
//! numbers of the job player. [`Run::operate`](crate::Run) executes requests after the motion of the cell and before
//! the job player, so a request takes effect in the next tick. The log contains it with that tick, for a replay.
//!
//! One operator commands: the first that sends a request for a motion, until it sends `leave` or disconnects. Every
//! operator may send a stop.
//!
//! Commands by hand (stick, buttons, frame, single steps, passes of a stopped process, keys of the rotary table's
//! panel) end with `leave`, with the session, and with its silence ([`Operator::end_hold`]); knob, stops and holding
//! switches stay. A request whose sender no longer waits is discarded unless it is a stop ([`Event::Late`]). Both
//! rules apply to all kinds of connections.

mod by_hand;
mod hold;
mod knowledge;
mod obstacles;
mod request;
mod source;
mod terminals;
mod written;

use std::path::{self, Path};

use closed_loop::{
    field::{Field, FieldController},
    workstation::SimulatedWorkstation,
};
use interfaces::{
    CommonMemory, DeviceInputs, OperatorInputs,
    device::{JoystickBox, KNOB_FULL},
    station::TableKey,
};
use neighbours::workstation::{
    Gate,
    player::{Hwsc, Progress},
};
use plant::Joystick;
use rcs_core::tick::Tick;
use serde::Serialize;
use sessions::operator::Event;
use taskdata::load::{BlockNumber, Store, job::Workstation};

use self::{hold::Ended, request::Request, terminals::Terminals};
pub use self::{
    obstacles::is_moved_by_hand,
    request::first_words,
    source::{Input, Inputs, WORKSTATION},
};
use crate::{judge, neighbours::Neighbours};

pub const A_TICK: usize = 16; // largest number of requests executed in a tick; others wait for the next one

pub struct Operator {
    hand: Joystick,     // the operators' joystick box; the lines of the job have another one
    shown: JoystickBox, // state of that box in the next tick
    terminals: Terminals,
    later: Option<Later>, // part of a request that the run must execute
    /// A request that waits until the commands control the robot again, and the tick in which it arrived.
    awaiting: Option<(Input, Tick)>,
    is_stopped: bool, // the velocity knob is at zero until `go`
    sessions: Vec<String>,
    commander: Option<String>, // name of the operator in command
    turns_table: bool,         // while the rotary table moves by a key that the commander has pressed
    /// True for a robot at a port. If a session ends during motion by hand, its knob then goes to 0.
    robot_elsewhere: bool,
    counts: Requests,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Requests {
    pub requests: u64,
    pub refused: u64,
}

/// A request that the run itself must execute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Later {
    Load(BlockNumber),
    Play(String), // play a job instead of the rest of the present one
    Withdraw,     // withdraw a load that the session has requested and that is still pending
    Await,        // execute the request when the commands control the robot again
}

pub struct RequestContext<'a> {
    pub tick: Tick,
    pub memory: &'a CommonMemory,
    pub inputs: &'a DeviceInputs,
    pub store: &'a Store, // Task data of the next tick, for reading lines of a job
    pub unchecked: bool,  // ignore errors in the records that a command uses
    pub data: &'a Path,
    pub gate: &'a mut Gate,
    pub neighbours: &'a mut Neighbours,
    pub workstation: &'a mut SimulatedWorkstation,
    pub loading: bool, // while a block is being checked: requests for a motion must wait
}

impl Operator {
    #[must_use]
    pub fn new(robot_elsewhere: bool) -> Self {
        Self {
            hand: Joystick::default(),
            shown: JoystickBox { velocity: KNOB_FULL, ..JoystickBox::default() },
            terminals: Terminals::default(),
            later: None,
            awaiting: None,
            is_stopped: false,
            sessions: Vec::new(),
            commander: None,
            turns_table: false,
            robot_elsewhere,
            counts: Requests::default(),
        }
    }

    #[must_use]
    pub fn at_the_box(&self) -> JoystickBox {
        let velocity = if self.is_stopped { 0 } else { self.shown.velocity };
        JoystickBox { velocity, ..self.shown }
    }

    #[must_use]
    pub const fn at_the_terminals(&self) -> &OperatorInputs {
        self.terminals.inputs()
    }

    /// The operator in command, all connected operators, and true if one of them has stopped the robot.
    #[must_use]
    pub fn present(&self) -> (Option<&str>, &[String], bool) {
        (self.commander.as_deref(), &self.sessions, self.is_stopped)
    }

    /// Sets box and terminals for the next tick. `is_table_led`: a key of its panel moves the rotary table.
    pub fn end_tick(&mut self, is_table_led: bool) {
        self.shown = self.hand.read();
        self.terminals.end_tick();
        self.turns_table &= is_table_led;
    }

    pub const fn take_later(&mut self) -> Option<Later> {
        self.later.take()
    }

    /// Store a request for execution when the commands control the robot again.
    pub fn keep(&mut self, input: Input, tick: Tick) {
        self.awaiting = Some((input, tick));
    }

    /// The waiting request, to be tried again in this tick. It is late if its sender no longer waits.
    pub fn awaited(&mut self) -> Option<(Input, Tick)> {
        self.awaiting.take().map(|(input, since)| (input.judged(), since))
    }

    pub fn count(&mut self, input: &Input, verdict: &Result<String, String>) {
        if input.event().line().is_some() && !input.is_question() {
            self.counts.requests += 1;
            self.counts.refused += u64::from(verdict.is_err());
        }
    }

    /// Number of requests; `None` if no operator has connected.
    #[must_use]
    pub fn requests(&self) -> Option<Requests> {
        (self.counts != Requests::default()).then_some(self.counts)
    }

    /// Execute an event. Returns the text of the answer, or the reason of the refusal.
    pub fn carry_out(&mut self, input: &Input, around: &mut RequestContext<'_>) -> Result<String, String> {
        let who = input.source();
        match input.event() {
            Event::Connected => self.connected(who, around),
            Event::Silent => Ok(self.end_hold(who, around)),
            Event::Disconnected => self.disconnected(who, around),
            Event::Line(line) => {
                Request::read(line, around.store).and_then(|request| self.run_line(who, request, around))
            }
            Event::Late(late, line) => Request::read(line, around.store).and_then(|request| {
                if request.is_stop() { self.run_line(who, request, around) } else { Err(late.to_string()) }
            }),
        }
    }

    fn connected(&mut self, who: &str, around: &mut RequestContext<'_>) -> Result<String, String> {
        self.sessions.push(who.to_owned());
        self.attend(around);
        Ok(String::new())
    }

    /// End the commands by hand of an operator who leaves, is silent, or has disconnected. This never
    /// accelerates a motion; the knob of a robot at a port goes to 0. Returns the ended motions as text.
    fn end_hold(&mut self, who: &str, around: &mut RequestContext<'_>) -> String {
        let ended = self.release(who);
        if ended.turns_table {
            around.workstation.cell.release_table_keys();
        }
        ended.to_string()
    }

    /// The part of [`Operator::end_hold`] that does not need the cell.
    fn release(&mut self, who: &str) -> Ended {
        if self.commander.as_deref() != Some(who) {
            return Ended::default();
        }
        let ended = Ended {
            joystick: self.hand.is_held(),
            passes: self.terminals.drop_passes(),
            turns_table: std::mem::take(&mut self.turns_table),
            knob: false,
        };
        self.hand.release();
        let knob = self.robot_elsewhere && (ended.joystick || ended.passes);
        self.is_stopped |= knob;
        Ended { knob, ..ended }
    }

    fn disconnected(&mut self, who: &str, around: &mut RequestContext<'_>) -> Result<String, String> {
        self.sessions.retain(|session| session != who);
        let ended = self.leave(who, around);
        self.attend(around);
        Ok(ended)
    }

    /// End an operator's commands by hand, withdraw its load, and take the command from it.
    fn leave(&mut self, who: &str, around: &mut RequestContext<'_>) -> String {
        let ended = self.end_hold(who, around);
        if self.commander.as_deref() == Some(who) {
            self.commander = None;
        }
        self.later = Some(Later::Withdraw);
        ended
    }

    /// Set whether an operator is connected in the job, which waits only for a connected one.
    fn attend(&self, around: &mut RequestContext<'_>) {
        if let Ok(job) = around.neighbours.job_under_way() {
            job.attend(!self.sessions.is_empty());
        }
    }

    fn run_line(
        &mut self,
        who: &str,
        request: Request,
        around: &mut RequestContext<'_>,
    ) -> Result<String, String> {
        if !request.is_stop() {
            self.take_command(who)?;
            if around.loading && request.is_of_the_job() {
                return Err(
                    "a block is being checked, and takes effect at the next command: ask again".to_owned()
                );
            }
            if self.awaiting.is_some() {
                return Err("a request before it waits for the robot: ask again".to_owned());
            }
            if request.needs_the_robot() && !self.hand.is_held() && obstacles::is_moved_by_hand(around.memory)
            {
                self.later = Some(Later::Await);
                return Err(obstacles::STILL_SETTLING.to_owned());
            }
        }
        let done = String::new();
        let tick = around.tick;
        match request {
            Request::Status => Ok(self.status(around)),
            Request::Data => Ok(directory(around.data)),
            Request::Pedestal => Ok(by_hand::state(around.memory)),
            Request::Field => field(around).map(|field| format!("io {}", field.status())),
            Request::Point(point) => {
                let inputs = *around.inputs;
                field(around)?
                    .show(&point, &inputs)
                    .ok_or_else(|| format!("the mapping has no point {point}"))
            }
            Request::Knowledge => {
                let asks = around.neighbours.job().filter(|job| job.asks_line());
                let line =
                    asks.map_or("", |_| "; line of the job: not known: name it with `resume line NUMBER`");
                Ok(knowledge::state(around.memory) + line)
            }
            Request::NameLine(line) => {
                job(around)?.name_line(line).map(str::to_owned).map_err(|error| error.to_string())
            }
            Request::Release(device) => {
                let field = field(around)?;
                if !field.release(&device) {
                    return Err(no_device(field, &device));
                }
                Ok(format!("{device} is released when it answers and asks for no output but at rest"))
            }
            Request::MakeSafe(device) => {
                obstacles::check_safe(around.memory)?;
                let field = field(around)?;
                if !field.make_safe(&device) {
                    return Err(no_device(field, &device));
                }
                Ok(format!("the outputs of {device} are safe until `io go {device}`"))
            }
            Request::Stop => {
                self.is_stopped = true;
                Ok("the velocity knob is at 0; `go` turns it back".to_owned())
            }
            Request::Go => {
                self.is_stopped = false;
                Ok(format!("the velocity knob is at {} of {KNOB_FULL}", self.shown.velocity))
            }
            Request::Leave => Ok(self.leave(who, around)),
            Request::Note => Ok(done),
            Request::Wait => {
                job(around)?.wait_for_operator().map(|()| done).map_err(|error| error.to_string())
            }
            Request::GoOn => {
                obstacles::check_job(around)?;
                job(around)?.go_on(tick).map_err(|error| error.to_string())?;
                Ok(self.hold_reasons(around))
            }
            Request::Skip => {
                obstacles::check_job(around)?;
                job(around)?.skip(tick).map_err(|error| error.to_string())?;
                Ok(self.hold_reasons(around))
            }
            Request::Command(text, command) => {
                let present = judge::present(around.memory);
                if let Some(wrong) = judge::verdict(&command, around.store, &present, around.unchecked) {
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
            Request::StandAlone { now } => {
                around.neighbours.take_command(tick, around.memory, around.gate, now)
            }
            Request::Workstation => around.neighbours.give_command(tick, around.memory, around.gate),
            Request::Terminal(entry) => {
                self.terminals.enter(entry, tick, around.memory, &around.store.view())
            }
            Request::Cell(action, line) => {
                around.workstation.begin_line(&action, &line)?;
                self.turns_table |=
                    matches!(action, Workstation::Table(TableKey::Run { .. } | TableKey::Step { .. }));
                Ok(done)
            }
        }
    }

    fn take_command(&mut self, who: &str) -> Result<(), String> {
        match &self.commander {
            Some(other) if other != who => Err(format!(
                "{other} commands this run: everybody may stop it; other requests are refused until it sends `leave`"
            )),
            _ => {
                self.commander = Some(who.to_owned());
                Ok(())
            }
        }
    }

    fn status(&self, around: &mut RequestContext<'_>) -> String {
        let (stand_alone, is_ending) = (around.neighbours.is_stand_alone(), around.neighbours.is_ending());
        let job = match around.neighbours.job_under_way() {
            Ok(job) => match job.progress() {
                Progress::Over => "the job is over".to_owned(),
                Progress::Failed(why) => format!("the job has ended, the run ends at rest: {why}"),
                Progress::Running if job.is_waiting() && stand_alone => {
                    "stand-alone, no job plays".to_owned()
                }
                Progress::Running if job.is_waiting() => "the job waits".to_owned(),
                Progress::Running => "the job plays".to_owned(),
            },
            Err(_) if is_ending => "the run is about to end".to_owned(),
            Err(_) => "the workstation controller commands".to_owned(),
        };
        let commander = self.commander.as_deref().unwrap_or("nobody");
        let knob = if self.is_stopped { 0 } else { self.shown.velocity };
        let (number, names) = (self.sessions.len(), self.sessions.join(", "));
        let held =
            obstacles::emergency(around.workstation).map_or_else(String::new, |why| format!("; {why}"));
        let field = field(around).map_or_else(|_| String::new(), |field| format!("; io {}", field.status()));
        format!("{job}; {commander} commands; knob {knob}; connected {number}: {names}{held}{field}")
    }

    /// The obstacles to the robot's motion although the job plays, as text; empty if there are none.
    fn hold_reasons(&self, around: &RequestContext<'_>) -> String {
        let knob = if self.is_stopped { 0 } else { self.shown.velocity };
        obstacles::of_the_robot(around.memory, knob, &self.shown, self.terminals.inputs())
    }
}

fn directory(data: &Path) -> String {
    let absolute = if data.is_dir() { path::absolute(data) } else { Ok(data.to_owned()) };
    absolute.unwrap_or_else(|_| data.to_owned()).display().to_string()
}

fn job<'a>(around: &'a mut RequestContext<'_>) -> Result<&'a mut Hwsc, String> {
    around.neighbours.job_under_way()
}

fn no_device(field: &FieldController, name: &str) -> String {
    let names: Vec<_> = field.mapping().devices.iter().map(|device| device.name.as_str()).collect();
    format!("there is no device {name}; expected one of {}", names.join(", "))
}

/// The couplers of the run. Errors: a message if the run has no couplers.
fn field<'a>(around: &'a mut RequestContext<'_>) -> Result<&'a mut FieldController, String> {
    let field = around.workstation.field.as_deref_mut();
    field.map(Field::desk_mut).ok_or_else(|| "this run has no couplers: --field".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{ProcessId, device::joystick_frame};
    use plant::BoxAction;
    use taskdata::files::TaskData;

    use super::terminals::Entry;

    #[test]
    fn first_operator_commands_until_it_leaves() {
        let mut operator = Operator::new(false);
        assert_eq!(operator.take_command("a"), Ok(()));
        assert_eq!(operator.take_command("a"), Ok(()));
        let refused = operator.take_command("b").unwrap_err();
        assert!(refused.starts_with("a commands this run"), "{refused}");
    }

    fn holding(robot_elsewhere: bool) -> Operator {
        let mut operator = Operator::new(robot_elsewhere);
        operator.take_command("a").unwrap();
        for action in [
            BoxAction::Velocity(400),
            BoxAction::Frame(joystick_frame::WORLD),
            BoxAction::Stick { x: 900, y: 0, ticks: 36_000 },
            BoxAction::Hold(1),
        ] {
            operator.hand.act(action);
        }
        let (memory, data) = (CommonMemory::default(), TaskData::default());
        for entry in [Entry::Stop(2), Entry::Execute(ProcessId::Prim, 100)] {
            operator.terminals.enter(entry, Tick(0), &memory, &data).unwrap();
        }
        operator.end_tick(false);
        operator
    }

    #[test]
    fn session_end_stops_motion_by_hand() {
        for elsewhere in [false, true] {
            let mut operator = holding(elsewhere);
            assert_eq!(operator.release("b"), Ended::default(), "another session ends");
            assert!(operator.hand.is_held());
            let ended = operator.release("a");
            assert_eq!(ended, Ended { joystick: true, passes: true, turns_table: false, knob: elsewhere });
            operator.end_tick(false);
            let shown = operator.at_the_box();
            let velocity = if elsewhere { 0 } else { 400 };
            assert_eq!(shown, JoystickBox { velocity, hold: 1, ..JoystickBox::default() });
            let inputs = operator.at_the_terminals();
            assert!(!inputs.executes(ProcessId::Prim) && inputs.is_stopped(2), "the board stays stopped");
            assert_eq!(operator.release("a"), Ended::default(), "nothing is left");
        }
    }

    #[test]
    fn session_without_motion_keeps_the_knob_at_a_port() {
        let mut operator = Operator::new(true);
        operator.take_command("a").unwrap();
        operator.hand.act(BoxAction::Velocity(400));
        assert_eq!(operator.release("a"), Ended::default());
        assert!(!operator.is_stopped);
    }

    #[test]
    fn stop_remains_after_its_session() {
        let mut operator = holding(false);
        operator.is_stopped = true;
        operator.release("a");
        assert!(operator.is_stopped);
    }
}
