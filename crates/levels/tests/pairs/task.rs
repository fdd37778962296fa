//! Task and Subtask. Around them: the workstation controller, the Data System, E-move with the joystick box.

use interfaces::{
    CommonMemory, ExternalInputs, HwsCommand, Reason, StatusReport,
    data_base::{Carried, DataBaseCommand, DataBaseReport, DataBaseStatus, DataBaseVerb},
    emove::{EmoveCommand, EmoveStatus, EmoveVerb, Holding, ObjectGrip, Standing},
    hws::HwsReport,
    subtask::SubtaskCommand,
};
use levels::{
    execution::{Execution, Outcome},
    subtask::Subtask,
    task::{
        Task,
        data_system::{ANSWER_LIMIT, IN_HAND},
        plan::{Plan, TaskVerb},
        tables::TaskRecipient,
    },
};
use rcs_core::name::Name10;

use crate::{
    data::emove_command,
    emove_orders as emove,
    frame::{self, Choice, Event, Half, Scene},
    image::{Image, rebase, rebase_echoes},
    search::{DeliveryFault, Wrong},
};

const REPLACED: u8 = 6; // ticks for which E-move continues an order of a replaced command

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmoveDoes {
    /// Nothing new; a new order is taken.
    Goes,
    /// E-move ends the order, or gives it up if the operator controls the robot.
    Ends,
    /// The order fails. A held object stays, and a grasp has closed on an object.
    Fails,
    /// The order fails. A held object is lost, and a grasp has closed empty.
    Loses,
    /// E-move ends a pause, and the fingers have finished an earlier release.
    LetsGo,
    Silent,
}

#[derive(Clone, Copy, Debug)]
pub struct Does {
    pub emove: EmoveDoes,
    pub answer: Option<DataBaseReport>,
    pub switched: bool, // the joystick box is turned on or off
}

#[derive(Clone)]
pub struct Around {
    lets_go: bool,      // the fingers can finish a release in a pause
    emove: EmoveStatus, // E-move's status, without the joystick box
    silent: bool,       // E-move wrote nothing in the previous tick
    box_on: bool,
    data_base: DataBaseStatus,
    prompt: bool,             // the Data System accepts every request at once
    recorded: Option<Name10>, // location of an object in the Data System
    own: bool,                // E-move's order belongs to the current command
    reached: EmoveVerb,       // the last completed order of the current command
    answered: DataBaseVerb,   // the last completed request of the current command
    replaced: u8,             // ticks for which E-move has continued a replaced order
}

pub type Pair = frame::Pair<Around>;

/// A pair before its first tick, with the parts gripper attached.
pub fn first(mishaps: u8, commands: Vec<HwsCommand>) -> Pair {
    let around = Around {
        lets_go: false,
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
    Pair::new(commands, (None, mishaps), Half::default(), around)
}

impl Pair {
    /// The robot is at PFIXTURE and holds the object of a command there, which the Data System has at this place.
    pub fn carrying(mut self, command: &HwsCommand) -> Self {
        let object = command.object.expect("a command about an object");
        let place = emove_command(EmoveVerb::Release, object.as_str(), command.source_grip, "PFIXTURE");
        self.scene.emove.held = Holding::Object(ObjectGrip { object, grip: place.grip });
        self.scene.emove.at = Some(Standing { site: place.site, grip: Some(place.grip) });
        let carried = Some(Carried { item: object, followed: true, ..Carried::default() });
        self.upper.out.updates.carried = carried;
        self.connected(IN_HAND)
    }

    /// The Data System has the object at a position; the fingers can finish a release in a pause.
    pub fn connected(mut self, position: &str) -> Self {
        self.upper.out.updates.connected = true;
        self.upper.state.data_system.updates = self.upper.out.updates;
        (self.scene.lets_go, self.scene.recorded) = (true, Some(Name10::clipped(position)));
        self
    }

    /// If `prompt`, the Data System accepts every request at once.
    pub const fn promptly(mut self, prompt: bool) -> Self {
        self.scene.prompt = prompt;
        self
    }

    fn emove_does(&mut self, does: EmoveDoes, order: &EmoveCommand) {
        if does == EmoveDoes::Silent {
            return;
        }
        if self.scene.box_on {
            self.scene.emove.at = None;
        }
        if order.number != self.scene.emove.echo && order.number != 0 {
            emove::take(&mut self.scene.emove, order.number);
            self.scene.own = self.upper.out.status.echo == self.command.number
                && self.lower.out.status.echo == self.upper.out.subtask.number;
            if emove::moves(order.command) {
                self.scene.emove.at = None;
            }
        }
        match does {
            EmoveDoes::Goes | EmoveDoes::Silent => {}
            EmoveDoes::Ends if self.scene.box_on => self.scene.emove.report = StatusReport::JoystickOn,
            EmoveDoes::Ends | EmoveDoes::LetsGo => {
                self.scene.emove.report = StatusReport::Done;
                emove::effect(&mut self.scene.emove, order);
                if does == EmoveDoes::LetsGo {
                    emove::release(&mut self.scene.emove);
                }
                if self.scene.own {
                    self.scene.reached = order.command;
                }
            }
            EmoveDoes::Fails | EmoveDoes::Loses => {
                self.scene.emove.report = StatusReport::Error;
                match (order.command, does) {
                    (EmoveVerb::GraspObj, EmoveDoes::Fails) => self.scene.emove.held = Holding::Something,
                    (_, EmoveDoes::Loses) => self.scene.emove.held = Holding::Nothing,
                    _ => {}
                }
            }
        }
    }
}

impl Around {
    /// E-move reports *joystick-on* while the operator controls the robot, regardless of other results.
    fn emove_status(&self) -> EmoveStatus {
        let report = match self.emove.report {
            StatusReport::Done | StatusReport::JoystickOn if self.box_on => StatusReport::JoystickOn,
            StatusReport::JoystickOn => StatusReport::Error,
            report => report,
        };
        EmoveStatus { report, at: self.emove.at.filter(|_| !self.box_on), ..self.emove }
    }
}

/// The process has read the last command, and has none to accept or execute.
fn is_over(execution: &Execution, number: u32) -> bool {
    execution.receiver.echo == number && execution.outcome != Outcome::Executing && !execution.waiting
}

impl Scene for Around {
    type Upper = Half<Task>;
    type Lower = Half<Subtask>;
    type Line = HwsCommand;
    type Command = HwsCommand;
    type Does = Does;
    /// Longer than the time limit of the Data System.
    const LONG: u64 = 300;

    fn choices(pair: &Pair) -> Vec<Choice<Does>> {
        let busy = pair.is_busy();
        let mut emove = vec![EmoveDoes::Goes];
        if busy {
            emove.extend([EmoveDoes::Ends, EmoveDoes::Fails]);
            if matches!(pair.lower.out.emove.command, EmoveVerb::GraspObj | EmoveVerb::MovObjTo) {
                emove.push(EmoveDoes::Loses);
            }
            if pair.scene.lets_go && pair.lower.out.emove.command == EmoveVerb::Pause {
                emove.push(EmoveDoes::LetsGo);
            }
        }
        emove.push(EmoveDoes::Silent);
        let asked = pair.upper.out.data_base.number != pair.scene.data_base.echo;
        let answers: &[Option<DataBaseReport>] = match (asked, pair.scene.prompt) {
            (true, true) => &[Some(DataBaseReport::Done)],
            (true, false) => &[None, Some(DataBaseReport::Done), Some(DataBaseReport::Refused)],
            (false, _) => &[None],
        };
        let mut choices = Vec::new();
        for emove in emove {
            for &answer in answers {
                let does = Does { emove, answer, switched: false };
                let waits = asked && answer.is_none();
                let ends = !busy || emove != EmoveDoes::Goes;
                let mishaps = u8::from(emove == EmoveDoes::Silent);
                let long = waits && !busy && pair.is_settled() && pair.awaits_data_base();
                choices.push(Choice { mishaps, long, ..Choice::new(does, ends && !waits) });
                if answer.is_none() {
                    let does = Does { switched: true, ..does };
                    choices.push(Choice { mishaps, quiet: true, ..Choice::new(does, false) });
                }
            }
        }
        choices
    }

    fn has_ended(pair: &Pair) -> bool {
        is_over(&pair.upper.state.execution, pair.command.number)
            && pair.upper.out.status.report != HwsReport::Executing
    }

    fn is_other(pair: &Pair, line: &HwsCommand) -> bool {
        line.command != pair.command.command
    }

    fn command(pair: &mut Pair, nth: usize) {
        pair.command = HwsCommand { number: pair.command.number + 1, ..pair.lines[nth] };
        let around = &mut pair.scene;
        (around.own, around.reached, around.answered) = (false, EmoveVerb::None, DataBaseVerb::None);
    }

    fn begin(pair: &mut Pair, event: &Event<Does>) {
        pair.scene.own &= event.mishap == DeliveryFault::None;
    }

    fn inputs(pair: &Pair) -> (CommonMemory, ExternalInputs) {
        let before = pair.tick.previous();
        let mut memory = CommonMemory::default();
        (memory.task, memory.subtask) = (pair.upper.out, pair.lower.out);
        (memory.task.header.stamp, memory.subtask.header.stamp) = (before, before);
        memory.emove.status = pair.scene.emove_status();
        memory.emove.header.stamp = if pair.scene.silent { before.previous() } else { before };
        memory.pedestal.header.stamp = before;
        let mut external = ExternalInputs { hws: pair.command, ..ExternalInputs::default() };
        external.data_base = pair.scene.data_base;
        (memory, external)
    }

    fn act(pair: &mut Pair, event: &Event<Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        let Does { emove, answer, switched } = event.does;
        pair.scene.box_on ^= switched;
        pair.emove_does(emove, &memory.subtask.emove);
        if switched && !pair.scene.box_on && pair.lower.out.emove.command == EmoveVerb::Pause {
            pair.scene.emove.report = match pair.scene.emove.report {
                StatusReport::JoystickOn => StatusReport::Done,
                report => report,
            };
        }
        pair.scene.silent = emove == EmoveDoes::Silent;
        if let Some(report) = answer {
            pair.scene.data_base = DataBaseStatus { echo: pair.upper.out.data_base.number, report };
            let DataBaseCommand { command, position, .. } = pair.upper.out.data_base;
            if (report, command) == (DataBaseReport::Done, DataBaseVerb::Update) {
                pair.scene.recorded = pair.scene.recorded.map(|_| position);
            }
            if report == DataBaseReport::Done && pair.upper.out.status.echo == pair.command.number {
                pair.scene.answered = command;
            }
        }
        let has_next = pair.scene.emove.report == StatusReport::Executing
            && pair.scene.emove.echo == memory.subtask.emove.number
            && memory.subtask.emove.command != EmoveVerb::Pause;
        pair.scene.replaced =
            if has_next && !pair.scene.own && !pair.scene.box_on { pair.scene.replaced + 1 } else { 0 };
        Ok(())
    }

    fn judge(pair: &Pair, before: &Pair, _: &Event<Does>) -> Result<(), Wrong> {
        if pair.scene.replaced > REPLACED {
            return Err("a replaced command continues");
        }
        let ended = |it: &Pair| {
            it.upper.state.execution.outcome == Outcome::Done
                && it.upper.state.execution.receiver.echo == pair.command.number
        };
        if !ended(pair) || ended(before) {
            return Ok(());
        }
        let (emove, at) = (&before.scene.emove, before.scene.emove.at.map(|at| at.site.location));
        let is_at = |name: Option<_>| at.map(|at| at.as_str().to_owned()) == name;
        let name = |name: Option<rcs_core::name::Name16>| name.map(|name| name.as_str().to_owned());
        let is_placed = emove.placed.is_some_and(|placed| {
            Some(placed.object) == pair.command.object && placed.grip == pair.command.destination_grip
        });
        match TaskVerb::of(&pair.command.command) {
            Some(TaskVerb::Transfer) if !is_placed => Err("finished, and the object is not placed"),
            Some(TaskVerb::Transfer) if !before.scene.box_on && !is_at(name(pair.command.end_at)) => {
                Err("finished, and the robot is not at the end-at location")
            }
            Some(TaskVerb::Transfer | TaskVerb::Move) if before.scene.reached != EmoveVerb::MovToLoc => {
                Err("finished, and this command has not moved the robot")
            }
            Some(TaskVerb::Position)
                if !matches!(before.scene.reached, EmoveVerb::MovToLoc | EmoveVerb::MovToObj) =>
            {
                Err("finished, and this command has not moved the robot")
            }
            Some(TaskVerb::Position) if emove.held.is_held() => Err("finished, and something is held"),
            Some(TaskVerb::Position | TaskVerb::Transfer) if pair.is_untold(before) => {
                Err("finished, and the database has an object elsewhere")
            }
            Some(TaskVerb::Acquire) if emove.held.object() != pair.command.object => {
                Err("finished, and the object is not held")
            }
            Some(TaskVerb::Pause) if before.scene.reached != EmoveVerb::Pause => {
                Err("finished, and E-move has not paused")
            }
            Some(TaskVerb::Startup) if before.scene.answered == DataBaseVerb::None => {
                Err("finished, and the Data System has not acknowledged")
            }
            None | Some(TaskVerb::None) => Err("an unknown command is finished"),
            _ => Ok(()),
        }
    }

    fn renumber(pair: &mut Pair) {
        let (task, out, subtask) = (&mut pair.upper.state, &mut pair.upper.out, &mut pair.lower.state);
        let echo = &mut task.execution.receiver.echo;
        rebase_echoes(&mut [&mut pair.command.number, echo, &mut out.status.echo]);
        let echo = &mut subtask.execution.receiver.echo;
        rebase(&mut task.subtask, &mut [&mut out.subtask.number, echo, &mut pair.lower.out.status.echo]);
        rebase(&mut subtask.emove, &mut [&mut pair.lower.out.emove.number, &mut pair.scene.emove.echo]);
        // The Data System answers the last request, so the number of missed ones does not matter.
        let asked = &mut task.data_system;
        if asked.commander.number != 0 {
            pair.scene.data_base.echo =
                if pair.scene.data_base.echo == asked.commander.number { 2 } else { 1 };
            for number in [&mut asked.commander.number, &mut asked.request.number, &mut out.data_base.number]
            {
                *number = 2;
            }
        }
    }

    /// Omits what no row tests: reasons, numbers of poses, the text of a command that has ended, and step and command
    /// of an idle process.
    fn image(pair: &Pair) -> Vec<u8> {
        let mut image = Image::new(pair.tick, ANSWER_LIMIT, &[]);
        let mut it = pair.clone();
        let task_over = is_over(&it.upper.state.execution, it.command.number);
        let subtask_over = is_over(&it.lower.state.execution, it.upper.out.subtask.number);
        if task_over {
            it.command = HwsCommand { number: it.command.number, ..HwsCommand::default() };
            (it.scene.reached, it.scene.answered) = (EmoveVerb::None, DataBaseVerb::None);
        }
        if it.upper.state.execution.outcome != Outcome::Executing || it.upper.state.execution.waiting {
            (it.upper.state.step, it.upper.state.ordered, it.upper.state.plan) = Default::default();
            it.forget_request();
        }
        if it.lower.state.execution.outcome != Outcome::Executing || it.lower.state.execution.waiting {
            (it.lower.state.step, it.lower.state.ordered, it.lower.state.aims) = Default::default();
            it.lower.state.execution.last_order = None;
        }
        if subtask_over {
            let number = it.upper.out.subtask.number;
            it.upper.out.subtask = SubtaskCommand { number, ..SubtaskCommand::default() };
        }
        if !it.is_busy() {
            it.scene.own = false;
            let EmoveCommand { number, command, .. } = it.lower.out.emove;
            it.lower.out.emove = EmoveCommand { number, command, ..EmoveCommand::default() };
        }
        it.without_poses();
        (it.upper.state.execution.reason, it.lower.state.execution.reason) = (Reason::None, Reason::None);
        image.add(&it.command);
        image.add(&it.upper.state.execution);
        image.add(&it.upper.state.step);
        image.add(&it.upper.state.ordered);
        image.add(&it.upper.state.control);
        image.add(&it.upper.state.plan);
        image.add(&it.upper.state.subtask);
        image.add(&it.upper.state.data_system);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.subtask);
        image.add(&it.upper.out.ledger);
        image.add(&it.lower.state);
        image.add(&it.lower.out.emove);
        image.add(&it.lower.out.status);
        image.add(&it.scene.emove);
        image.add(&it.scene.data_base);
        image.add(&it.scene.recorded);
        image.add(&it.scene.reached);
        image.add(&it.scene.answered);
        image.bytes.extend([it.scene.silent, it.scene.box_on, it.scene.own].map(u8::from));
        image.bytes.extend([it.scene.replaced, it.mishaps]);
        image.bytes
    }

    fn rests(pair: &Pair) -> bool {
        is_over(&pair.upper.state.execution, pair.command.number)
            && is_over(&pair.lower.state.execution, pair.upper.out.subtask.number)
            && pair.lower.out.status.echo == pair.upper.out.subtask.number
            && !pair.is_busy()
    }

    fn pauses(pair: &Pair) -> bool {
        TaskVerb::of(&pair.command.command) == Some(TaskVerb::Pause)
    }
}

impl Pair {
    fn is_busy(&self) -> bool {
        let number = self.lower.out.emove.number;
        (number != self.scene.emove.echo && number != 0) || self.scene.emove.report == StatusReport::Executing
    }

    /// Every command is echoed, and its commander has read the echo.
    fn is_settled(&self) -> bool {
        let number = self.upper.out.subtask.number;
        self.upper.out.status.echo == self.command.number
            && self.lower.out.status.echo == number
            && self.lower.state.execution.receiver.echo == number
    }

    /// True if the Data System has another location of an object than its known place of release.
    fn is_untold(&self, before: &Self) -> bool {
        let placed = before.scene.emove.placed.map(|placed| placed.site.location).filter(|at| !at.is_empty());
        self.upper.out.updates.connected
            && placed.zip(before.scene.recorded).is_some_and(|(at, recorded)| at != recorded)
    }

    fn awaits_data_base(&self) -> bool {
        self.upper.state.execution.outcome == Outcome::Executing
            && self.upper.state.ordered == TaskRecipient::DataSystem
    }

    /// While no command waits for the Data System, its last answer counts only if it accepts a pending update.
    fn forget_request(&mut self) {
        let asked = &mut self.upper.state.data_system;
        (asked.tries, asked.commander.sent) = (0, self.tick);
        if asked.request.command != DataBaseVerb::Update || asked.updates.pending[0].is_none() {
            let number = asked.request.number;
            asked.request = DataBaseCommand { number, ..DataBaseCommand::default() };
            self.scene.data_base.report = DataBaseReport::Idle;
        }
    }

    /// Record numbers of poses increase without limit, and no row tests them.
    fn without_poses(&mut self) {
        (self.upper.state.last_pose, self.lower.state.last_pose) = (0, 0);
        let Plan { source, destination, end_at, .. } = &mut self.upper.state.plan;
        for site in [source, destination, end_at] {
            if let Some(location) = &mut site.location {
                location.pose.number = None;
            }
        }
        for aim in [
            &mut self.lower.state.aims.first,
            &mut self.lower.state.aims.second,
            &mut self.lower.state.aims.third,
        ] {
            aim.pose = None;
        }
        (self.upper.out.subtask.pose, self.lower.out.emove.pose) = (None, None);
        self.lower.out.status.reason = Reason::None;
        let sent = &mut self.upper.state.data_system.commander.sent;
        if self.tick.since(*sent) <= ANSWER_LIMIT {
            *sent = self.tick;
        }
    }
}
