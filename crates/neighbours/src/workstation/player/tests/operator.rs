//! An operator intervenes.

use super::*;

const MOVE_AND_ACQUIRE: [&str; 2] = ["MOVE", "ACQUIRE"];

struct Stage {
    hwsc: Hwsc,
    task: Task,
    jaws: Vise,
    tick: u64,
}

impl Stage {
    fn new(steps: Vec<JobLine>) -> Self {
        let mut hwsc = Hwsc::new(steps, 100);
        hwsc.attend(true);
        Self { hwsc, task: Task::default(), jaws: Vise::default(), tick: 0 }
    }

    fn commands() -> Self {
        Self::new(MOVE_AND_ACQUIRE.into_iter().map(command).collect())
    }

    fn step(&mut self) {
        self.tick += 1;
        let status = self.task.step(&mut self.hwsc);
        self.hwsc.step(Tick(self.tick), &status, &mut self.jaws);
    }

    fn until(&mut self, what: impl Fn(&Self) -> bool) {
        for _ in 0..200 {
            if what(self) {
                return;
            }
            self.step();
        }
        panic!("{:?} {:?}", self.hwsc.begun_steps(), self.task.received);
    }

    fn order(&mut self, verb: &str) {
        let Step::Command(command) = command(verb).step else { panic!("it is a command") };
        self.hwsc.command_by_operator(Tick(self.tick), verb.to_owned(), command).unwrap();
    }

    fn received(&self) -> String {
        self.task.received.join(" ")
    }

    fn outcomes(&self) -> Vec<(&str, Outcome)> {
        self.hwsc.begun_steps().iter().map(|step| (step.text.as_str(), step.outcome)).collect()
    }

    fn go_on(&mut self) {
        self.hwsc.go_on(Tick(self.tick)).unwrap();
    }
}

#[test]
fn only_new_lines_advance_the_line_number() {
    let mut stage = Stage::commands();
    assert_eq!(stage.hwsc.place(), (0, 2));
    stage.until(|stage| stage.task.received.len() == 2);
    for verb in ["TRANSFER", "POSITION", "TRANSFER"] {
        stage.order(verb);
        stage.until(is_idle);
    }
    assert_eq!((stage.hwsc.begun_steps().len(), stage.hwsc.place()), (5, (1, 2)));
    stage.go_on();
    stage.hwsc.wait_for_operator().unwrap();
    stage.until(|stage| stage.hwsc.is_waiting());
    assert_eq!(stage.hwsc.place(), (1, 2), "the second line has not begun");
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.hwsc.place(), (2, 2));
}

fn is_over(stage: &Stage) -> bool {
    *stage.hwsc.progress() == Progress::Over
}

fn is_idle(stage: &Stage) -> bool {
    stage.hwsc.begun_steps().last().is_some_and(|step| step.outcome != Outcome::Executing)
}

#[test]
fn operator_command_replaces_the_job_command_until_go() {
    let mut stage = Stage::commands();
    stage.until(|stage| stage.task.received.len() == 2);
    stage.order("TRANSFER");
    assert_eq!(stage.hwsc.go_on(Tick(stage.tick)), Err(OperatorError::Executes("TRANSFER".into())));
    stage.until(is_idle);
    for _ in 0..20 {
        stage.step();
    }
    assert_eq!(stage.received(), "PAUSE MOVE TRANSFER", "the job waits");
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE TRANSFER PAUSE MOVE ACQUIRE");
    let (done, cut) = (Outcome::Finished, Outcome::Interrupted);
    let expected = [
        ("PAUSE", done),
        ("== MOVE", cut),
        ("TRANSFER", done),
        ("PAUSE", done),
        ("== MOVE", done),
        ("== ACQUIRE", done),
    ];
    assert_eq!(stage.outcomes(), expected);
    let numbers: Vec<u32> = stage.task.sent.clone();
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "one sequence: {numbers:?}");
}

#[test]
fn waiting_job_can_skip_a_line() {
    let mut stage = Stage::commands();
    stage.until(|stage| stage.task.received.len() == 2);
    stage.hwsc.wait_for_operator().unwrap();
    stage.until(|stage| stage.hwsc.is_waiting());
    assert_eq!((stage.received().as_str(), stage.outcomes().len()), ("PAUSE MOVE", 2), "MOVE has ended");
    let news = stage.hwsc.operator_news();
    assert!(news.as_ref().is_some_and(|news| news.to_string().contains("job go")), "{news:?}");
    assert_eq!(stage.hwsc.operator_news(), None);
    stage.hwsc.skip(Tick(stage.tick)).unwrap();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE PAUSE");
    assert_eq!(stage.hwsc.wait_for_operator(), Err(OperatorError::Ended));
}

#[test]
fn wait_can_be_cancelled_before_it_begins() {
    let mut stage = Stage::commands();
    stage.hwsc.wait_for_operator().unwrap();
    stage.go_on();
    assert_eq!(stage.hwsc.go_on(Tick(0)), Err(OperatorError::Plays));
    assert_eq!(stage.hwsc.skip(Tick(0)), Err(OperatorError::Plays));
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE ACQUIRE");
}

#[test]
fn failure_ends_the_job_only_without_an_operator() {
    let mut stage = Stage::commands();
    stage.task.fails_at = Some(2);
    stage.until(|stage| stage.hwsc.is_waiting());
    assert_eq!(*stage.hwsc.progress(), Progress::Running);
    stage.task.fails_at = None;
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE PAUSE MOVE ACQUIRE");

    let mut stage = Stage::commands();
    stage.task.fails_at = Some(2);
    stage.until(|stage| stage.hwsc.is_waiting());
    stage.hwsc.attend(false);
    assert_eq!(*stage.hwsc.progress(), Progress::Failed(JobFailure::Command(Reason::GraspMissed)));
    stage.hwsc.attend(true); // every answer gives the same reason to another operator
    assert!(!stage.hwsc.is_waiting());
    assert_eq!(stage.hwsc.go_on(Tick(stage.tick)), Err(OperatorError::Ended));
}

#[test]
fn workstation_line_continues_during_operator_commands() {
    let steps = vec![vise(ViseOpening::Close), command("MOVE")];
    let mut stage = Stage::new(steps);
    stage.until(|stage| stage.jaws.told.len() == 1);
    stage.order("ACQUIRE");
    stage.until(is_idle);
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE ACQUIRE MOVE");
    assert_eq!(stage.jaws.told, [ViseOpening::Close], "not begun again");
    assert!(
        stage.outcomes().iter().all(|(_, outcome)| *outcome == Outcome::Finished),
        "{:?}",
        stage.outcomes()
    );
}

#[test]
fn second_operator_command_replaces_the_first() {
    let mut stage = Stage::commands();
    stage.until(|stage| stage.task.received.len() == 2);
    stage.order("TRANSFER");
    stage.step();
    stage.task.losing = 1;
    stage.order("PAUSE");
    stage.until(is_idle);
    assert_eq!(stage.received(), "PAUSE MOVE TRANSFER PAUSE");
    assert_eq!(stage.outcomes()[2..], [("TRANSFER", Outcome::Interrupted), ("PAUSE", Outcome::Finished)]);
}

#[test]
fn job_on_stand_by_begins_on_go() {
    let mut stage = Stage::commands();
    stage.hwsc.wait_for_operator().unwrap();
    for _ in 0..30 {
        stage.step();
    }
    assert_eq!(stage.received(), "PAUSE");
    stage.order("STARTUP");
    stage.until(is_idle);
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE STARTUP PAUSE MOVE ACQUIRE");
}

#[test]
fn job_waits_for_the_operator_in_an_emergency() {
    let mut stage = Stage::commands();
    stage.until(|stage| stage.task.received.len() == 2);
    stage.jaws.emergency = Some("the arm has no pressure");
    stage.until(|stage| stage.hwsc.is_waiting());
    stage.jaws.emergency = None;
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE PAUSE MOVE ACQUIRE");
}

#[test]
fn played_lines_replace_the_rest_of_the_job() {
    let mut stage = Stage::commands();
    assert_eq!(stage.hwsc.play(Tick(1), vec![command("POSITION")]), Err(OperatorError::Plays));
    stage.until(|stage| stage.received().contains("MOVE"));
    stage.order("TRANSFER");
    let executed = stage.hwsc.play(Tick(stage.tick), vec![command("POSITION")]);
    assert!(matches!(executed, Err(OperatorError::Executes(_))), "{executed:?}");
    stage.order("PAUSE");
    stage.until(|stage| stage.outcomes().last() == Some(&("PAUSE", Outcome::Finished)));
    stage.hwsc.play(Tick(stage.tick), vec![command("POSITION"), command("ACQUIRE")]).unwrap();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE PAUSE PAUSE POSITION ACQUIRE");
}

#[test]
fn job_continues_at_once_after_an_operator_pause() {
    for go_on in [Hwsc::go_on, Hwsc::skip] {
        let mut stage = Stage::commands();
        stage.until(|stage| stage.received().contains("MOVE"));
        stage.order("MOVE");
        assert!(matches!(go_on(&mut stage.hwsc, Tick(stage.tick)), Err(OperatorError::Executes(_))));
        stage.order("PAUSE");
        go_on(&mut stage.hwsc, Tick(stage.tick)).unwrap();
        stage.until(is_over);
        assert_eq!(stage.outcomes()[3], ("PAUSE", Outcome::Interrupted));
        assert!(
            stage.received().ends_with("PAUSE MOVE ACQUIRE") || stage.received().ends_with("PAUSE ACQUIRE")
        );
    }
}

#[test]
fn emulator_without_a_job_waits_again() {
    let mut stage = Stage::commands();
    stage.hwsc = Hwsc::stand_alone(41, 100);
    for _ in 0..5 {
        stage.step();
    }
    assert!(stage.hwsc.is_waiting() && stage.received().is_empty());
    stage.order("MOVE");
    stage.until(|stage| stage.outcomes().last() == Some(&("MOVE", Outcome::Finished)));
    assert!(stage.hwsc.command().number > 41, "the number follows the last one");
    stage.hwsc.play(Tick(stage.tick), vec![command("ACQUIRE")]).unwrap();
    stage.until(is_over);
    stage.hwsc.wait_without_job();
    stage.step();
    assert!(stage.hwsc.is_waiting());
    assert_eq!(stage.received(), "MOVE PAUSE ACQUIRE");
}

#[test]
fn resumed_job_waits_and_repeats_its_line() {
    let mut before = Stage::commands();
    before.until(|stage| stage.received() == "PAUSE MOVE");
    let place = before.hwsc.place_in_job();
    assert_eq!((place.line, place.is_begun), (1, true));
    let mut stage = Stage::commands();
    stage.task.receiver.observe(before.hwsc.command().number);
    stage.hwsc = Hwsc::new(before.hwsc.lines().to_vec(), 100).resumed_at(place, Tick(40));
    stage.hwsc.attend(true);
    stage.tick = 40;
    for _ in 0..30 {
        stage.step();
    }
    assert!(stage.received().is_empty() && stage.hwsc.operator_news() == Some(WaitReason::Resumed));
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE ACQUIRE");
}

#[test]
fn resumed_job_without_line_continues_with_a_named_line() {
    let place = PlaceInJob { line: 1, is_begun: true, is_asked: true, ..PlaceInJob::default() };
    let mut stage = Stage::commands();
    stage.hwsc = Hwsc::new(stage.hwsc.lines().to_vec(), 100).resumed_at(place, Tick(40));
    stage.hwsc.attend(true);
    stage.tick = 40;
    stage.step();
    assert_eq!(stage.hwsc.operator_news(), Some(WaitReason::ResumedWithoutLine(1)));
    let tick = Tick(stage.tick);
    assert_eq!(stage.hwsc.go_on(tick), Err(OperatorError::LineNotKnown(1)));
    assert_eq!(stage.hwsc.skip(tick), Err(OperatorError::LineNotKnown(1)));
    for line in [0, 99] {
        let last = stage.hwsc.lines().len();
        assert_eq!(stage.hwsc.name_line(line), Err(OperatorError::NoSuchLine { found: line, last }));
    }
    assert!(stage.hwsc.place_in_job().is_asked);
    assert!(stage.hwsc.name_line(2).is_ok_and(|text| text.contains("ACQUIRE")));
    assert_eq!(stage.hwsc.name_line(1), Err(OperatorError::LineKnown));
    assert_eq!(stage.hwsc.place_in_job(), PlaceInJob { line: 2, ..PlaceInJob::default() });
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE ACQUIRE");
}

#[test]
fn resumed_job_does_not_repeat_a_finished_line() {
    let mut before = Stage::commands();
    before.hwsc.wait_for_operator().unwrap();
    before.go_on();
    before.until(|stage| stage.received() == "PAUSE MOVE");
    before.hwsc.wait_for_operator().unwrap();
    before.until(|stage| stage.hwsc.is_waiting());
    let place = before.hwsc.place_in_job();
    assert_eq!((place.line, place.is_begun), (2, false), "the first line is finished");
    let mut stage = Stage::commands();
    stage.hwsc = Hwsc::new(before.hwsc.lines().to_vec(), 100).resumed_at(place, Tick(40));
    stage.tick = 40;
    stage.step();
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE ACQUIRE");
}

#[test]
fn delayed_actions_that_have_started_do_not_start_again() {
    let delayed = |ticks| JobLine {
        step: Step::After { ticks, action: RESET },
        text: format!("** after {ticks} panel fault-reset"),
        ..command("MOVE")
    };
    let lines = || vec![delayed(2), delayed(90), command("MOVE")];
    let mut before = Stage::new(lines());
    before.until(|stage| stage.jaws.lines.len() == 1);
    let place = before.hwsc.place_in_job();
    assert_eq!((place.line, place.delayed), (3, 1), "only the nearest waits");
    let resumed = Hwsc::new(lines(), 100).resumed_at(place, Tick(40));
    assert_eq!(resumed.later.iter().map(|later| later.ticks).collect::<Vec<_>>(), [90]);
}

#[test]
fn line_that_may_have_begun_needs_a_second_go() {
    let place = PlaceInJob { line: 1, is_begun: false, delayed: 0, is_asked: false };
    let resumed = || {
        let mut stage = Stage::commands();
        let lines = stage.hwsc.lines().to_vec();
        let question = Some("whether it has begun is not known".to_owned());
        stage.hwsc = Hwsc::new(lines, 100).resumed_at(place, Tick(40)).with_question(question);
        stage.tick = 40;
        stage.step();
        stage
    };
    let mut stage = resumed();
    let refused = stage.hwsc.go_on(Tick(41)).unwrap_err().to_string();
    assert!(refused.contains("`job go` again") && stage.hwsc.is_waiting(), "{refused}");
    stage.go_on();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE MOVE ACQUIRE");
    let mut stage = resumed();
    stage.hwsc.skip(Tick(41)).unwrap();
    stage.until(is_over);
    assert_eq!(stage.received(), "PAUSE ACQUIRE");
}
