//! The emulator against a Task with scripted answers.

use super::*;
use geometry::frame::Frame;
use interfaces::{Reason, hws::HwsStatus, station::ViseOpening};
use rcs_core::{
    handshake::{Arrival, Receiver},
    name::Name10,
};
use taskdata::{
    files::{Location, Place},
    load::verdict::TASK_COMMANDS,
};

#[derive(Default)]
struct Task {
    receiver: Receiver,
    left: u64,
    received: Vec<String>,
    fails_at: Option<usize>,
    failing: usize,         // commands from `fails_at` on; 0 means one
    reason: Option<Reason>, // `None`: `GraspMissed`
    silent: bool,
    joystick: bool,
    losing: u32,
    sent: Vec<u32>,
    command: HwsCommand,
}

impl Task {
    fn fails(&self) -> bool {
        let last = |from: usize| from + self.failing.max(1);
        self.fails_at.is_some_and(|from| (from..last(from)).contains(&self.received.len()))
    }

    /// Task gets the command in the next tick, unless it is lost.
    fn step(&mut self, hwsc: &mut Hwsc) -> Status<'static> {
        let mut status = HwsStatus::default();
        if let Some(command) = hwsc.mailgram() {
            self.sent.push(command.number);
            if self.losing == 0 {
                self.command = *command;
            }
            self.losing = self.losing.saturating_sub(1);
        }
        if self.silent {
            return answer(&status);
        }
        match self.receiver.observe(self.command.number) {
            Arrival::New => {
                self.received.push(self.command.command.to_string());
                self.left = 4;
            }
            _ => self.left = self.left.saturating_sub(1),
        }
        status.echo = self.receiver.echo;
        status.report = match self.left {
            0 if self.receiver.echo == 0 => HwsReport::Idle,
            0 if self.fails() => HwsReport::Error,
            0 => HwsReport::Finished,
            _ => HwsReport::Executing,
        };
        if self.joystick {
            status.report = HwsReport::JoystickOn;
        }
        if status.report == HwsReport::Error {
            status.reason = self.reason.unwrap_or(Reason::GraspMissed);
        }
        answer(&status)
    }
}

fn answer(status: &HwsStatus) -> Status<'static> {
    Status {
        command: status.command,
        report: status.report,
        echo: command_number(status.echo),
        mailgram_echo: 0,
        verdict: 0,
        code: status.reason,
        task: TaskState::Runs,
        unconfirmed: status.unconfirmed,
        reason: status.reason.text(),
    }
}

/// Each action takes six calls of `busy`. Records the received lines.
#[derive(Default)]
struct Vise {
    busy: std::cell::Cell<u32>,
    told: Vec<ViseOpening>,
    lines: Vec<String>,
    fault: Option<&'static str>,
    emergency: Option<&'static str>,
}

impl Workstation for Vise {
    fn begin(&mut self, action: &Action, line: &str) -> Result<(), String> {
        self.lines.push(line.to_owned());
        if *action == RESET {
            self.emergency = None;
            return Ok(());
        }
        let Action::Vise { opening, location, .. } = action else { return Err("this is a vise".into()) };
        if location.name.as_str() != "PFIXTURE" {
            return Err(format!("there is no vise at {}", location.name));
        }
        self.told.push(*opening);
        self.busy.set(6);
        Ok(())
    }

    fn busy(&self) -> bool {
        self.busy.set(self.busy.get().saturating_sub(1));
        self.busy.get() > 0
    }

    fn fault(&self) -> Option<String> {
        self.fault.map(str::to_owned)
    }

    fn emergency(&self) -> Option<String> {
        self.emergency.map(str::to_owned)
    }
}

const RESET: Action = Action::Panel(Key::FaultReset); // ends the emergency of a `Vise`

fn command(verb: &str) -> JobLine {
    let command = HwsCommand { command: Name16::clipped(verb), ..HwsCommand::default() };
    JobLine { step: Step::Command(command), text: format!("== {verb}"), line: 1, expects_error: false }
}

fn action(opening: ViseOpening, name: &str) -> JobLine {
    let name = Name10::new(name).unwrap();
    let location = Location { name, place: Place::default(), sector: None, frame: Frame::identity() };
    let text = format!("** vise {opening:?} {name}");
    JobLine {
        step: Step::Workstation(Action::Vise { opening, location, program: None }),
        text,
        line: 1,
        expects_error: false,
    }
}

fn later(ticks: u32, opening: ViseOpening) -> JobLine {
    let JobLine { step: Step::Workstation(action), text, .. } = vise(opening) else { unreachable!() };
    JobLine { step: Step::After { ticks, action }, text, line: 1, expects_error: false }
}

fn vise(opening: ViseOpening) -> JobLine {
    action(opening, "PFIXTURE")
}

/// Plays a job for at most 200 ticks; returns the last.
fn play(hwsc: &mut Hwsc, task: &mut Task, vise: &mut Vise) -> u64 {
    play_on(hwsc, task, vise, 1)
}

fn play_on(hwsc: &mut Hwsc, task: &mut Task, vise: &mut Vise, from: u64) -> u64 {
    for tick in from..200 {
        let outputs = task.step(hwsc);
        if *hwsc.step(Tick(tick), &outputs, vise) != Progress::Running {
            return tick;
        }
    }
    200
}

#[test]
fn job_is_played_in_order_after_a_pause() {
    let (partial, close) = (ViseOpening::Partial, ViseOpening::Close);
    let steps = vec![vise(partial), command("MOVE"), vise(close), command("MOVE")];
    let (mut hwsc, mut task, mut jaws) = (Hwsc::new(steps, 100), Task::default(), Vise::default());
    play(&mut hwsc, &mut task, &mut jaws);
    assert_eq!(*hwsc.progress(), Progress::Over);
    assert_eq!(task.received, ["PAUSE", "MOVE", "MOVE"]);
    assert_eq!(jaws.told, [partial, close]);
    let texts: Vec<_> =
        hwsc.begun_steps().iter().map(|r| (r.text.as_str(), r.is_command, r.outcome)).collect();
    let finished = Outcome::Finished;
    assert_eq!(
        texts,
        [
            ("PAUSE", true, finished),
            ("** vise Partial PFIXTURE", false, finished),
            ("== MOVE", true, finished),
            ("** vise Close PFIXTURE", false, finished),
            ("== MOVE", true, finished)
        ]
    );
    // A command is written in one tick, read in the next, and executed for four. The end is detected in its last tick.
    assert!(
        hwsc.begun_steps().iter().filter(|r| r.is_command).all(|r| r.ticks == 5),
        "{:?}",
        hwsc.begun_steps()
    );
    assert!(
        hwsc.begun_steps().iter().filter(|r| !r.is_command).all(|r| r.ticks == 6),
        "{:?}",
        hwsc.begun_steps()
    );
}

#[test]
fn line_is_inserted_and_command_replaced() {
    let (partial, close) = (ViseOpening::Partial, ViseOpening::Close);
    let steps = vec![command("MOVE"), vise(partial), command("MOVE")];
    let (mut hwsc, mut task, mut jaws) = (Hwsc::new(steps, 100), Task::default(), Vise::default());
    let mut tick = 1;
    while hwsc.begun_steps().len() < 2 {
        let outputs = task.step(&mut hwsc);
        hwsc.step(Tick(tick), &outputs, &mut jaws);
        tick += 1;
    }
    hwsc.insert(vise(close));
    assert!(hwsc.replace_command(command("ACQUIRE")));
    let end = play_on(&mut hwsc, &mut task, &mut jaws, tick);
    assert_eq!(*hwsc.progress(), Progress::Over);
    assert_eq!(
        (task.received.join(" ").as_str(), &jaws.told[..]),
        ("PAUSE MOVE ACQUIRE", &[close, partial][..])
    );
    assert!(!hwsc.replace_command(command("MOVE")), "no command comes after tick {end}");
}

#[test]
fn every_command_is_sent_as_in_the_job() {
    let steps: Vec<_> = TASK_COMMANDS.iter().map(|verb| command(verb)).collect();
    let (mut hwsc, mut task) = (Hwsc::new(steps, 100), Task::default());
    play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Over);
    assert_eq!(task.received[1..], *TASK_COMMANDS);
}

#[test]
fn error_of_task_ends_the_job_with_its_reason() {
    let steps = vec![command("MOVE"), command("ACQUIRE")];
    let mut task = Task { fails_at: Some(2), ..Task::default() };
    let mut hwsc = Hwsc::new(steps, 100);
    let last = play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::Command(Reason::GraspMissed)));
    assert_eq!(task.received, ["PAUSE", "MOVE"]);
    assert_eq!(hwsc.begun_steps().last().map(|r| r.outcome), Some(Outcome::Failed));
    let number = hwsc.command().number;
    let outputs = task.step(&mut hwsc);
    hwsc.step(Tick(last + 1), &outputs, &mut Vise::default());
    assert_eq!(hwsc.command().number, number);
}

#[test]
fn failed_command_is_repeated_after_a_pause() {
    // A completed delayed action is not repeated.
    let steps = vec![later(1, ViseOpening::Open), command("MOVE"), command("ACQUIRE")];
    let mut task = Task { fails_at: Some(2), ..Task::default() };
    let (mut hwsc, mut jaws) = (Hwsc::new(steps, 100).with_retries(1), Vise::default());
    play(&mut hwsc, &mut task, &mut jaws);
    assert_eq!(*hwsc.progress(), Progress::Over);
    assert_eq!(task.received, ["PAUSE", "MOVE", "PAUSE", "MOVE", "ACQUIRE"]);
    assert_eq!(jaws.told, [ViseOpening::Open]);
    let [retry] = hwsc.retried() else { panic!("{:?}", hwsc.retried()) };
    assert_eq!(
        retry.to_string(),
        "`== MOVE` failed: the fingers closed on nothing; PAUSE and the same command again, retry 1 of 1"
    );
    let outcomes: Vec<_> =
        hwsc.begun_steps().iter().filter(|step| step.is_command).map(|step| step.outcome).collect();
    let (finished, failed) = (Outcome::Finished, Outcome::Failed);
    assert_eq!(outcomes, [finished, failed, finished, finished, finished]);
}

/// A failed PAUSE does not prevent the retry, because the command itself shows whether it can be executed.
#[test]
fn retries_are_counted_per_line() {
    let received = |failing: usize| {
        let mut task = Task { fails_at: Some(2), failing, ..Task::default() };
        let mut hwsc = Hwsc::new(vec![command("MOVE"), command("ACQUIRE")], 100).with_retries(2);
        play(&mut hwsc, &mut task, &mut Vise::default());
        (task.received.join(" "), hwsc.progress().clone(), hwsc.retried().len())
    };
    assert_eq!(received(4), ("PAUSE MOVE PAUSE MOVE PAUSE MOVE ACQUIRE".into(), Progress::Over, 2));
    let failed = Progress::Failed(JobFailure::Command(Reason::GraspMissed));
    assert_eq!(received(5), ("PAUSE MOVE PAUSE MOVE PAUSE MOVE".into(), failed, 2));
    let mut task = Task { fails_at: Some(2), failing: 1, ..Task::default() };
    let mut hwsc = Hwsc::new(vec![command("MOVE"), command("ACQUIRE")], 100).with_retries(1);
    for tick in 1..200 {
        // The first command of either line fails.
        if task.received.len() == 5 {
            task.fails_at = Some(5);
        }
        let outputs = task.step(&mut hwsc);
        hwsc.step(Tick(tick), &outputs, &mut Vise::default());
    }
    assert_eq!(task.received, ["PAUSE", "MOVE", "PAUSE", "MOVE", "ACQUIRE", "PAUSE", "ACQUIRE"]);
    assert_eq!(*hwsc.progress(), Progress::Over);
}

#[test]
fn failures_with_a_remedy_are_not_retried() {
    for reason in Reason::ALL.iter().filter(|reason| reason.remedy().is_some()) {
        let mut task = Task { fails_at: Some(2), reason: Some(*reason), ..Task::default() };
        let mut hwsc = Hwsc::new(vec![command("MOVE")], 100).with_retries(3);
        play(&mut hwsc, &mut task, &mut Vise::default());
        let failure = JobFailure::Command(*reason);
        assert_eq!(failure.remedy(), reason.remedy());
        assert_eq!(*hwsc.progress(), Progress::Failed(failure));
        assert_eq!(task.received, ["PAUSE", "MOVE"], "{reason:?}");
    }
    let mut task = Task { joystick: true, ..Task::default() };
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 100).with_retries(3);
    play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::Joystick));
    assert_eq!(JobFailure::Joystick.remedy(), Some("switch the frame at the joystick box off"));
}

#[test]
fn unanswered_command_is_repeated_once_before_task_is_lost() {
    for (ticks, limit) in [(ECHO_LIMIT, 10), (20, 45)] {
        let mut task = Task { silent: true, ..Task::default() };
        let mut hwsc = Hwsc::new(vec![command("MOVE")], 100).with_answer_ticks(ticks);
        let last = play(&mut hwsc, &mut task, &mut Vise::default());
        assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::Lost));
        assert!((2 * ticks..limit).contains(&last), "{last}");
        assert_eq!(task.sent, [4, 4], "the same number");
    }
}

#[test]
fn lost_command_is_repeated_and_executed_once() {
    let mut task = Task { losing: 1, ..Task::default() };
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 100);
    play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Over);
    assert_eq!((task.received, task.sent), (vec!["PAUSE".to_owned(), "MOVE".to_owned()], vec![4, 4, 5]));
}

#[test]
fn command_refused_by_the_mailbox_ends_the_job() {
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 100);
    let refused =
        Status { verdict: 3, reason: "command 8 comes next, found 4", ..answer(&HwsStatus::default()) };
    for tick in 1..4 {
        hwsc.step(Tick(tick), &refused, &mut Vise::default());
    }
    let failure = JobFailure::Refused("command 8 comes next, found 4".into());
    assert_eq!(*hwsc.progress(), Progress::Failed(failure));
}

#[test]
fn workstation_gets_the_line_without_its_delay() {
    let mut later = later(2, ViseOpening::Open);
    later.text = "**  after 2   vise open  PFIXTURE".into();
    let mut jaws = Vise::default();
    let mut hwsc = Hwsc::new(vec![vise(ViseOpening::Close), later, command("MOVE")], 100);
    play(&mut hwsc, &mut Task::default(), &mut jaws);
    assert_eq!(jaws.lines, ["vise Close PFIXTURE", "vise open  PFIXTURE"]);
}

#[test]
fn commands_and_actions_have_a_time_limit() {
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 3);
    play(&mut hwsc, &mut Task::default(), &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::TimeLimit(3)));
    let mut hwsc = Hwsc::new(vec![vise(ViseOpening::Close)], 5);
    play(&mut hwsc, &mut Task::default(), &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::TimeLimit(5)));
    assert_eq!(hwsc.begun_steps().len(), 2, "PAUSE is finished within five ticks");
}

#[test]
fn wait_takes_exactly_its_ticks() {
    let step = Step::Workstation(Action::Wait { ticks: 30 });
    let wait = JobLine { step, text: "** wait 30".into(), line: 1, expects_error: false };
    let mut hwsc = Hwsc::new(vec![wait, command("MOVE")], 10);
    play(&mut hwsc, &mut Task::default(), &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Over, "the time limit is not for waiting");
    assert_eq!(hwsc.begun_steps()[1].ticks, 30);
}

#[test]
fn delayed_actions_happen_during_the_command() {
    let steps = vec![later(2, ViseOpening::Open), command("MOVE")];
    let (mut hwsc, mut task, mut jaws) = (Hwsc::new(steps, 100), Task::default(), Vise::default());
    let mut tick = 0;
    while jaws.told.is_empty() {
        tick += 1;
        let outputs = task.step(&mut hwsc);
        assert_eq!(*hwsc.step(Tick(tick), &outputs, &mut jaws), Progress::Running);
    }
    assert_eq!(task.received, ["PAUSE", "MOVE"]);
    assert_eq!(hwsc.begun_steps().last().map(|r| (r.outcome, r.ticks)), Some((Outcome::Executing, 2)));
    play_on(&mut hwsc, &mut task, &mut jaws, tick + 1);
    assert_eq!(*hwsc.progress(), Progress::Over);
}

#[test]
fn job_waits_for_delayed_actions() {
    let steps = vec![later(90, ViseOpening::Open), command("MOVE")];
    let (mut hwsc, mut task, mut jaws) = (Hwsc::new(steps, 100), Task::default(), Vise::default());
    let last = play(&mut hwsc, &mut task, &mut jaws);
    assert_eq!((hwsc.progress(), jaws.told.as_slice()), (&Progress::Over, &[ViseOpening::Open][..]));
    assert!(last > 90, "{last}");
}

#[test]
fn joystick_ends_a_command_but_not_an_action() {
    let mut task = Task { joystick: true, ..Task::default() };
    let mut hwsc = Hwsc::new(vec![vise(ViseOpening::Open)], 100);
    hwsc.current = 1;
    hwsc.began = Some(Tick(0));
    play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Over);
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 100);
    play(&mut hwsc, &mut task, &mut Vise::default());
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::Joystick));
}

#[test]
fn impossible_workstation_action_ends_the_job() {
    let mut hwsc = Hwsc::new(vec![action(ViseOpening::Open, "TABLE")], 100);
    play(&mut hwsc, &mut Task::default(), &mut Vise::default());
    assert_eq!(
        *hwsc.progress(),
        Progress::Failed(JobFailure::Workstation("there is no vise at TABLE".into()))
    );
    let mut jaws = Vise { fault: Some("no oil pressure"), ..Vise::default() };
    let mut hwsc = Hwsc::new(vec![command("MOVE")], 100);
    play(&mut hwsc, &mut Task::default(), &mut jaws);
    assert_eq!(*hwsc.progress(), Progress::Failed(JobFailure::Workstation("no oil pressure".into())));
}
#[test]
fn emergency_ends_the_job_at_once_in_every_state() {
    for steps in [vec![command("MOVE")], vec![vise(ViseOpening::Open)], vec![]] {
        let mut jaws = Vise { emergency: Some("the hand is caught"), ..Vise::default() };
        let mut hwsc = Hwsc::new(steps, 100);
        assert_eq!(play(&mut hwsc, &mut Task::default(), &mut jaws), 1);
        let stopped = JobFailure::Emergency("the hand is caught".into());
        assert_eq!(*hwsc.progress(), Progress::Failed(stopped));
    }
}

#[test]
fn job_that_resets_an_emergency_continues() {
    let reset =
        JobLine { step: Step::Workstation(RESET), text: "** reset".into(), line: 1, expects_error: false };
    let played = |last: &str| {
        let steps = vec![command("MOVE"), reset.clone(), command(last)];
        let mut jaws = Vise { emergency: Some("the hand is caught"), ..Vise::default() };
        let mut task = Task { fails_at: Some(2), ..Task::default() };
        let mut hwsc = Hwsc::new(steps, 100);
        play(&mut hwsc, &mut task, &mut jaws);
        assert_eq!(task.received, ["PAUSE", "MOVE", last]);
        let outcomes: Vec<_> = hwsc.begun_steps().iter().map(|step| step.outcome).collect();
        let (finished, failed) = (Outcome::Finished, Outcome::Failed);
        assert_eq!(outcomes, [finished, failed, finished, finished]);
        hwsc.progress().clone()
    };
    assert_eq!(played("MOVE"), Progress::Over, "the last attempt counts");
    let (line, tick, why) = ("== MOVE".to_owned(), Tick(11), Reason::GraspMissed.text());
    let unfinished = JobFailure::Unfinished { line, tick, why };
    assert_eq!(played("ACQUIRE"), Progress::Failed(unfinished), "MOVE has never finished");
}

#[test]
fn command_expected_to_fail_must_fail() {
    let played = |fails_at: Option<usize>, joystick: bool| {
        let expecting = JobLine { expects_error: true, ..command("MOVE") };
        let mut task = Task { fails_at, ..Task::default() };
        let mut hwsc = Hwsc::new(vec![expecting, command("ACQUIRE")], 100);
        let mut jaws = Vise::default();
        for tick in 1..100 {
            let is_move = task.received.last().is_some_and(|last| last == "MOVE");
            task.joystick = joystick && is_move && hwsc.command().command.as_str() == "MOVE";
            let status = task.step(&mut hwsc);
            if *hwsc.step(Tick(tick), &status, &mut jaws) != Progress::Running {
                break;
            }
        }
        let outcomes: Vec<_> = hwsc.begun_steps().iter().map(|step| step.outcome).collect();
        (hwsc.progress().clone(), outcomes)
    };
    let (finished, failed) = (Outcome::Finished, Outcome::Failed);
    let as_it_should = (Progress::Over, vec![finished, Outcome::FailedAsExpected, finished]);
    assert_eq!(played(Some(2), false), as_it_should);
    assert_eq!(played(None, true), as_it_should, "the joystick box ends a command as well");
    assert_eq!(played(None, false), (Progress::Failed(JobFailure::Unexpected), vec![finished, failed]));
}

mod operator;
