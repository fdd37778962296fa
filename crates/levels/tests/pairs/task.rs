//! Task and Subtask. Around them: the workstation controller, the Data System, E-move with the joystick box.

use std::sync::Arc;

use interfaces::{
    CommonMemory, ExternalInputs, HwsCommand, Reason, StatusReport, SubtaskOutputs, TaskOutputs,
    data_base::{Carried, DataBaseCommand, DataBaseReport, DataBaseStatus, DataBaseVerb},
    emove::{EmoveCommand, EmoveStatus, EmoveVerb, Holding, ObjectGrip, PlacedObject, Standing},
    hws::HwsReport,
    process::{Inputs, Process},
    subtask::SubtaskCommand,
};
use levels::{
    execution::{Execution, Outcome},
    subtask::{self, Subtask},
    task::{
        self, Task,
        data_system::{ANSWER_LIMIT, IN_HAND},
        plan::{Plan, TaskVerb},
        tables::Ordered,
    },
};
use rcs_core::{name::Name10, tick::Tick};

use crate::{
    data::{data, emove_command},
    image::{Image, rebase, rebase_echoes},
    search::{Mishap, World, Wrong, resumed},
};

/// Longer than the time in which the Data System is expected to answer.
const LONG: u64 = 300;
/// Ticks for which E-move can go on with an order of a command that was replaced, at most.
const REPLACED: u8 = 6;

/// What E-move does with its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmoveDoes {
    /// Nothing new; an order that has just come is taken.
    Goes,
    /// It ends the order: done, or given up if the operator has the robot.
    Ends,
    /// The order fails. What is held stays, and a grasp has closed on something.
    Fails,
    /// The order fails. What is held is lost, and a grasp has closed on nothing.
    Loses,
    /// It ends a pause, and the fingers have finished a release that came before it.
    LetsGo,
    /// It writes nothing.
    Silent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// A command that comes, from 0 in the list of commands.
    pub told: Option<usize>,
    pub emove: EmoveDoes,
    /// The Data System answers.
    pub answer: Option<DataBaseReport>,
    /// The joystick box is turned on or off.
    pub switched: bool,
    pub mishap: Mishap,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    mishaps: u8,
    /// The fingers can finish a release in a pause.
    lets_go: bool,
    commands: Arc<[HwsCommand]>,
    hws: HwsCommand,
    task: task::state::State,
    task_out: TaskOutputs,
    subtask: subtask::state::State,
    subtask_out: SubtaskOutputs,
    /// E-move's status, but for the joystick box.
    emove: EmoveStatus,
    /// E-move has written nothing in the last tick.
    silent: bool,
    /// The operator has the robot.
    box_on: bool,
    data_base: DataBaseStatus,
    /// The Data System takes everything at once.
    prompt: bool,
    /// Where the Data System has an object of which it is told.
    recorded: Option<Name10>,
    /// The order that E-move has is one of the current command.
    own: bool,
    /// The last order of the current command that E-move has done.
    reached: EmoveVerb,
    /// The last request of the current command that the Data System has done.
    answered: DataBaseVerb,
    /// Ticks for which E-move has gone on with an order of a command that was replaced.
    replaced: u8,
}

impl Pair {
    /// The first tick of a system that is booted, with the parts gripper on; so many mishaps can happen, and these
    /// commands can come.
    pub fn first(mishaps: u8, commands: Vec<HwsCommand>) -> Self {
        let mut pair = Self {
            tick: Tick(10_000),
            mishaps,
            lets_go: false,
            commands: commands.into(),
            hws: HwsCommand::default(),
            task: task::state::State::default(),
            task_out: TaskOutputs::default(),
            subtask: subtask::state::State::default(),
            subtask_out: SubtaskOutputs::default(),
            emove: EmoveStatus { end_effector_id: Some(1), ..EmoveStatus::default() },
            silent: false,
            box_on: false,
            data_base: DataBaseStatus::default(),
            prompt: false,
            recorded: None,
            own: false,
            reached: EmoveVerb::None,
            answered: DataBaseVerb::None,
            replaced: 0,
        };
        for stamp in [&mut pair.task_out.header.stamp, &mut pair.subtask_out.header.stamp] {
            *stamp = pair.tick;
        }
        pair
    }

    /// The robot stands at PFIXTURE and holds the object of a command there, and the Data System has been told so.
    pub fn carrying(mut self, command: &HwsCommand) -> Self {
        let object = command.object.expect("a command about an object");
        let place = emove_command(EmoveVerb::Release, object.as_str(), command.source_grip, "PFIXTURE");
        self.emove.held = Holding::Object(ObjectGrip { object, grip: place.grip });
        self.emove.at = Some(Standing { site: place.site, grip: Some(place.grip) });
        let carried = Some(Carried { item: object, told: true, ..Carried::default() });
        self.task_out.beliefs.carried = carried;
        self.connected(IN_HAND)
    }

    /// The Data System is connected, and has the object of the commands at a position; the fingers can finish a release
    /// in a pause.
    pub fn connected(mut self, position: &str) -> Self {
        self.task_out.beliefs.connected = true;
        self.task.data_system.beliefs = self.task_out.beliefs;
        (self.lets_go, self.recorded) = (true, Some(Name10::clipped(position)));
        self
    }

    /// The Data System takes everything at once, and never refuses.
    pub const fn promptly(mut self, prompt: bool) -> Self {
        self.prompt = prompt;
        self
    }

    fn tell(&mut self, nth: usize) {
        self.hws = HwsCommand { number: self.hws.number + 1, ..self.commands[nth] };
        (self.own, self.reached, self.answered) = (false, EmoveVerb::None, DataBaseVerb::None);
    }

    /// What E-move reports: *joystick-on* as long as the operator has the robot, whatever was done before.
    fn emove_status(&self) -> EmoveStatus {
        let report = match self.emove.report {
            StatusReport::Done | StatusReport::JoystickOn if self.box_on => StatusReport::JoystickOn,
            StatusReport::JoystickOn => StatusReport::Error,
            report => report,
        };
        EmoveStatus { report, at: self.emove.at.filter(|_| !self.box_on), ..self.emove }
    }

    fn emove_does(&mut self, does: EmoveDoes) {
        let order = self.subtask_out.emove;
        if does == EmoveDoes::Silent {
            return;
        }
        if self.box_on {
            self.emove.at = None;
        }
        if order.number != self.emove.echo && order.number != 0 {
            (self.emove.echo, self.emove.report) = (order.number, StatusReport::Executing);
            self.own = self.task_out.status.echo == self.hws.number
                && self.subtask_out.status.echo == self.task_out.subtask.number;
            if moves(order.command) {
                self.emove.at = None;
            }
        }
        match does {
            EmoveDoes::Goes | EmoveDoes::Silent => {}
            EmoveDoes::Ends if self.box_on => self.emove.report = StatusReport::JoystickOn,
            EmoveDoes::Ends | EmoveDoes::LetsGo => {
                self.emove.report = StatusReport::Done;
                self.effect(&order);
                if does == EmoveDoes::LetsGo {
                    self.let_go();
                }
                if self.own {
                    self.reached = order.command;
                }
            }
            EmoveDoes::Fails | EmoveDoes::Loses => {
                self.emove.report = StatusReport::Error;
                match (order.command, does) {
                    (EmoveVerb::GraspObj, EmoveDoes::Fails) => self.emove.held = Holding::Something,
                    (_, EmoveDoes::Loses) => self.emove.held = Holding::Nothing,
                    _ => {}
                }
            }
        }
    }

    /// The effect of an order that is done.
    fn effect(&mut self, order: &EmoveCommand) {
        let (emove, object) = (&mut self.emove, order.object.unwrap_or_default());
        match order.command {
            EmoveVerb::GraspObj => {
                emove.held = Holding::Object(ObjectGrip { object, grip: order.grip });
                emove.placed = None;
            }
            EmoveVerb::Release => self.let_go(),
            verb if moves(verb) => {
                emove.at = Some(Standing {
                    site: order.site,
                    grip: Some(order.grip).filter(|_| verb != EmoveVerb::MovToLoc),
                });
            }
            _ => {}
        }
    }

    /// The fingers let go of what they hold.
    fn let_go(&mut self) {
        let (at, emove) = (self.emove.at.unwrap_or_default(), &mut self.emove);
        if let Holding::Object(ObjectGrip { object, grip }) = emove.held {
            emove.placed = Some(PlacedObject { object, grip, site: at.site });
        }
        emove.held = Holding::Nothing;
    }

    /// What is reported finished is done, by the orders of this command; and what a command has replaced stops.
    ///
    /// `before` is the pair as it was when the processes read it.
    fn judge(&self, before: &Self) -> Result<(), Wrong> {
        if self.replaced > REPLACED {
            return Err("what a command replaced goes on");
        }
        let ended = |it: &Self| {
            it.task.execution.outcome == Outcome::Done && it.task.execution.receiver.echo == self.hws.number
        };
        if !ended(self) || ended(before) {
            return Ok(());
        }
        let (emove, at) = (&before.emove, before.emove.at.map(|at| at.site.location));
        let is_at = |name: Option<_>| at.map(|at| at.as_str().to_owned()) == name;
        let name = |name: Option<rcs_core::name::Name16>| name.map(|name| name.as_str().to_owned());
        let is_placed = emove.placed.is_some_and(|placed| {
            Some(placed.object) == self.hws.object && placed.grip == self.hws.destination_grip
        });
        match TaskVerb::of(&self.hws.command) {
            Some(TaskVerb::Transfer) if !is_placed => Err("finished, and the object is not placed"),
            Some(TaskVerb::Transfer) if !before.box_on && !is_at(name(self.hws.end_at)) => {
                Err("finished, and the robot is not at the end-at location")
            }
            Some(TaskVerb::Transfer | TaskVerb::Move) if before.reached != EmoveVerb::MovToLoc => {
                Err("finished, and this command has not moved the robot")
            }
            Some(TaskVerb::Position)
                if !matches!(before.reached, EmoveVerb::MovToLoc | EmoveVerb::MovToObj) =>
            {
                Err("finished, and this command has not moved the robot")
            }
            Some(TaskVerb::Position) if emove.held.is_held() => Err("finished, and something is held"),
            Some(TaskVerb::Position | TaskVerb::Transfer) if self.is_untold(before) => {
                Err("finished, and the data base has an object elsewhere")
            }
            Some(TaskVerb::Acquire) if emove.held.object() != self.hws.object => {
                Err("finished, and the object is not held")
            }
            Some(TaskVerb::Pause) if before.reached != EmoveVerb::Pause => {
                Err("finished, and E-move has not paused")
            }
            Some(TaskVerb::Startup) if before.answered == DataBaseVerb::None => {
                Err("finished, and the Data System has done nothing")
            }
            None | Some(TaskVerb::None) => Err("an unknown command is finished"),
            _ => Ok(()),
        }
    }
}

/// Does the robot leave its place for an order?
const fn moves(verb: EmoveVerb) -> bool {
    matches!(
        verb,
        EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol
    )
}

/// The process has read the last command, and has neither to accept nor to execute one.
fn is_over(execution: &Execution, number: u32) -> bool {
    execution.receiver.echo == number && execution.outcome != Outcome::Executing && !execution.waiting
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let busy = self.is_busy();
        let mut emove = vec![EmoveDoes::Goes];
        if busy {
            emove.extend([EmoveDoes::Ends, EmoveDoes::Fails]);
            if matches!(self.subtask_out.emove.command, EmoveVerb::GraspObj | EmoveVerb::MovObjTo) {
                emove.push(EmoveDoes::Loses);
            }
            if self.lets_go && self.subtask_out.emove.command == EmoveVerb::Pause {
                emove.push(EmoveDoes::LetsGo);
            }
        }
        if self.mishaps > 0 {
            emove.push(EmoveDoes::Silent);
        }
        let asked = self.task_out.data_base.number != self.data_base.echo;
        let answers: &[Option<DataBaseReport>] = match (asked, self.prompt) {
            (true, true) => &[Some(DataBaseReport::Done)],
            (true, false) => &[None, Some(DataBaseReport::Done), Some(DataBaseReport::Refused)],
            (false, _) => &[None],
        };
        let mut events = Vec::new();
        for mishap in Mishap::choices(self.mishaps, Mishap::RESTARTS) {
            for told in self.commands() {
                for (&emove, &answer) in
                    emove.iter().flat_map(|emove| answers.iter().map(move |answer| (emove, answer)))
                {
                    let mishaps = u8::from(emove == EmoveDoes::Silent) + u8::from(mishap != Mishap::None);
                    if mishaps > self.mishaps || (mishaps > 0 && told.is_some()) {
                        continue;
                    }
                    let event = Event { told, emove, answer, switched: false, mishap, long: false };
                    let quiet = told.is_none() && mishaps == 0;
                    let ends = !busy || emove != EmoveDoes::Goes;
                    let waits = asked && answer.is_none();
                    events.push((event, quiet && ends && !waits));
                    if quiet && waits && !busy && self.is_settled() && self.awaits_data_base() {
                        events.push((Event { long: true, ..event }, true));
                    }
                    if quiet && answer.is_none() {
                        events.push((Event { switched: true, ..event }, false));
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut upper: Task = resumed(self.task, event.mishap == Mishap::RestartUpper);
        let mut lower: Subtask = resumed(self.subtask, event.mishap == Mishap::RestartLower);
        self.mishaps -= u8::from(event.mishap != Mishap::None) + u8::from(event.emove == EmoveDoes::Silent);
        self.own &= event.mishap == Mishap::None;
        if let Some(nth) = event.told {
            self.tell(nth);
        }
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        (memory.task, memory.subtask) = (self.task_out, self.subtask_out);
        (memory.task.header.stamp, memory.subtask.header.stamp) = (before, before);
        memory.emove.status = self.emove_status();
        memory.emove.header.stamp = if self.silent { Tick(before.0 - 1) } else { before };
        memory.pedestal.header.stamp = before;
        let mut external = ExternalInputs { hws: self.hws, ..ExternalInputs::default() };
        external.data_base = self.data_base;
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        let (mut task_out, mut subtask_out) = (self.task_out, self.subtask_out);
        upper.step(&inputs, &mut task_out);
        lower.step(&inputs, &mut subtask_out);
        // E-move and the Data System read what was written in the tick before.
        self.box_on ^= event.switched;
        self.emove_does(event.emove);
        if event.switched && !self.box_on && self.subtask_out.emove.command == EmoveVerb::Pause {
            self.emove.report = match self.emove.report {
                StatusReport::JoystickOn => StatusReport::Done,
                report => report,
            };
        }
        self.silent = event.emove == EmoveDoes::Silent;
        if let Some(report) = event.answer {
            self.data_base = DataBaseStatus { echo: self.task_out.data_base.number, report };
            let DataBaseCommand { command, position, .. } = self.task_out.data_base;
            if (report, command) == (DataBaseReport::Done, DataBaseVerb::Update) {
                self.recorded = self.recorded.map(|_| position);
            }
            if report == DataBaseReport::Done && self.task_out.status.echo == self.hws.number {
                self.answered = command;
            }
        }
        (self.task_out, self.subtask_out) = (task_out, subtask_out);
        (self.task, self.subtask) = (*upper.state(), *lower.state());
        let goes_on = self.emove.report == StatusReport::Executing
            && self.emove.echo == old.subtask_out.emove.number
            && old.subtask_out.emove.command != EmoveVerb::Pause;
        self.replaced = if goes_on && !self.own && !self.box_on { self.replaced + 1 } else { 0 };
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    /// Without what no row asks for any more: reasons; numbers of poses; the command and the step of a process that
    /// executes nothing; the text of a command that has ended.
    fn image(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, ANSWER_LIMIT, &[]);
        let mut it = self.clone();
        let task_over = is_over(&it.task.execution, it.hws.number);
        let subtask_over = is_over(&it.subtask.execution, it.task_out.subtask.number);
        if task_over {
            it.hws = HwsCommand { number: it.hws.number, ..HwsCommand::default() };
            (it.reached, it.answered) = (EmoveVerb::None, DataBaseVerb::None);
        }
        if it.task.execution.outcome != Outcome::Executing || it.task.execution.waiting {
            (it.task.step, it.task.ordered, it.task.plan) = Default::default();
            it.forget_request();
        }
        if it.subtask.execution.outcome != Outcome::Executing || it.subtask.execution.waiting {
            (it.subtask.step, it.subtask.ordered, it.subtask.aims) = Default::default();
            it.subtask.execution.last_order = None;
        }
        if subtask_over {
            let number = it.task_out.subtask.number;
            it.task_out.subtask = SubtaskCommand { number, ..SubtaskCommand::default() };
        }
        if !it.is_busy() {
            it.own = false;
            let EmoveCommand { number, command, .. } = it.subtask_out.emove;
            it.subtask_out.emove = EmoveCommand { number, command, ..EmoveCommand::default() };
        }
        it.without_poses();
        (it.task.execution.reason, it.subtask.execution.reason) = (Reason::None, Reason::None);
        image.add(&it.hws);
        image.add(&it.task.execution);
        image.add(&it.task.step);
        image.add(&it.task.ordered);
        image.add(&it.task.control);
        image.add(&it.task.plan);
        image.add(&it.task.subtask);
        image.add(&it.task.data_system);
        image.add(&it.task_out.status.echo);
        image.add(&it.task_out.subtask);
        image.add(&it.task_out.ledger);
        image.add(&it.subtask);
        image.add(&it.subtask_out.emove);
        image.add(&it.subtask_out.status);
        image.add(&it.emove);
        image.add(&it.data_base);
        image.add(&it.recorded);
        image.add(&it.reached);
        image.add(&it.answered);
        image.bytes.extend([it.silent, it.box_on, it.own].map(u8::from));
        image.bytes.extend([it.replaced, it.mishaps]);
        image.bytes
    }

    fn rests(&self) -> bool {
        is_over(&self.task.execution, self.hws.number)
            && is_over(&self.subtask.execution, self.task_out.subtask.number)
            && self.subtask_out.status.echo == self.task_out.subtask.number
            && !self.is_busy()
    }

    fn pauses(&self) -> bool {
        TaskVerb::of(&self.hws.command) == Some(TaskVerb::Pause)
    }
}

impl Pair {
    /// Any command can come when the last one has ended, and another one than it before.
    fn commands(&self) -> Vec<Option<usize>> {
        let ended = is_over(&self.task.execution, self.hws.number)
            && self.task_out.status.report != HwsReport::Executing;
        let may = |nth: &usize| ended || self.commands[*nth].command != self.hws.command;
        core::iter::once(None).chain((0..self.commands.len()).filter(may).map(Some)).collect()
    }

    /// E-move has not ended its last order.
    fn is_busy(&self) -> bool {
        let number = self.subtask_out.emove.number;
        (number != self.emove.echo && number != 0) || self.emove.report == StatusReport::Executing
    }

    /// Every command is echoed, and its commander has read the echo.
    fn is_settled(&self) -> bool {
        let number = self.task_out.subtask.number;
        self.task_out.status.echo == self.hws.number
            && self.subtask_out.status.echo == number
            && self.subtask.execution.receiver.echo == number
    }

    /// Has the Data System an object elsewhere than where it was let go, if that is known?
    fn is_untold(&self, before: &Self) -> bool {
        let placed = before.emove.placed.map(|placed| placed.site.location).filter(|at| !at.is_empty());
        self.task_out.beliefs.connected
            && placed.zip(before.recorded).is_some_and(|(at, recorded)| at != recorded)
    }

    /// Task waits for the Data System.
    fn awaits_data_base(&self) -> bool {
        self.task.execution.outcome == Outcome::Executing && self.task.ordered == Ordered::DataSystem
    }

    /// While no command waits for the Data System, its last answer counts only if it takes an update that is owed.
    fn forget_request(&mut self) {
        let asked = &mut self.task.data_system;
        (asked.tries, asked.commander.sent) = (0, self.tick);
        if asked.request.command != DataBaseVerb::Update || asked.beliefs.owed[0].is_none() {
            let number = asked.request.number;
            asked.request = DataBaseCommand { number, ..DataBaseCommand::default() };
            self.data_base.report = DataBaseReport::Idle;
        }
    }

    /// Record numbers of poses count without end, and no row asks for them.
    fn without_poses(&mut self) {
        (self.task.last_pose, self.subtask.last_pose) = (0, 0);
        let Plan { source, destination, end_at, .. } = &mut self.task.plan;
        for site in [source, destination, end_at] {
            if let Some(location) = &mut site.location {
                location.pose.number = None;
            }
        }
        for aim in [&mut self.subtask.aims.first, &mut self.subtask.aims.second, &mut self.subtask.aims.third]
        {
            aim.pose = None;
        }
        (self.task_out.subtask.pose, self.subtask_out.emove.pose) = (None, None);
        self.subtask_out.status.reason = Reason::None;
        let sent = &mut self.task.data_system.commander.sent;
        if self.tick.since(*sent) <= ANSWER_LIMIT {
            *sent = self.tick;
        }
    }

    /// What does not count any more begins again.
    fn renumber(&mut self) {
        let (task, out, subtask) = (&mut self.task, &mut self.task_out, &mut self.subtask);
        let echo = &mut task.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.hws.number, echo, &mut out.status.echo]);
        let echo = &mut subtask.execution.receiver.echo;
        rebase(&mut task.subtask, &mut [&mut out.subtask.number, echo, &mut self.subtask_out.status.echo]);
        rebase(&mut subtask.emove, &mut [&mut self.subtask_out.emove.number, &mut self.emove.echo]);
        // The Data System answers the last request: by how many it is behind does not matter.
        let asked = &mut task.data_system;
        if asked.commander.number != 0 {
            self.data_base.echo = if self.data_base.echo == asked.commander.number { 2 } else { 1 };
            for number in [&mut asked.commander.number, &mut asked.request.number, &mut out.data_base.number]
            {
                *number = 2;
            }
        }
    }
}
