//! Every remedy of docs/reasons.md works: a scenario produces the failure in the simulated cell, follows the remedy
//! with the means of an operator, and the job finishes. In the fast clock a request is executed after a tick and
//! visible in the next one, as in a session.

use std::fs;

use interfaces::{
    CommonMemory, Reason, StatusReport,
    emove::{EmoveVerb, Holding},
    hws::HwsReport,
    pedestal::{PedestalReport, PedestalVerb},
    subtask::SubtaskVerb,
};
use plant::Cell;
use runtime::{LogTarget, Run, RunConfig, RunOutcome};
use sessions::operator::Event;
use tempfile::TempDir;
use whole_system_tests::root;

const LIMIT: u32 = 24_000; // per action: 16 minutes of the robot's time
const WHO: &str = "anna";

struct Operated {
    run: Option<Run>, // `None` after its end
    _directory: TempDir,
}

impl Operated {
    fn start(job: &str) -> Self {
        Self::with_faults(job, "")
    }

    fn with_faults(job: &str, faults: &str) -> Self {
        Self::with(job, faults, |config| config)
    }

    fn with(job: &str, faults: &str, change: impl FnOnce(RunConfig) -> RunConfig) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("remedy.job");
        fs::write(&path, job).unwrap();
        let plan = directory.path().join("faults.toml");
        fs::write(&plan, faults).unwrap();
        let config = RunConfig {
            shared_memory: false,
            log: LogTarget::None,
            faults: (!faults.is_empty()).then_some(plan),
            ..RunConfig::new(root().join("data"), path.to_string_lossy())
        };
        let mut run = Run::new(change(config), Box::new(())).unwrap_or_else(|error| panic!("{error:?}"));
        run.ask(WHO, Event::Connected).unwrap();
        Self { run: Some(run), _directory: directory }
    }

    fn run(&self) -> &Run {
        self.run.as_ref().unwrap()
    }

    fn memory(&self) -> &CommonMemory {
        self.run().memory()
    }

    fn cell(&mut self) -> &mut Cell {
        self.run.as_mut().unwrap().cell_mut()
    }

    fn tick(&self) -> u64 {
        self.run().last_tick().0
    }

    fn ask(&mut self, line: &str) -> Result<String, String> {
        let answer = self.run.as_mut().unwrap().ask(WHO, Event::Line(line.to_owned()));
        if answer.as_ref().is_err_and(|why| why.starts_with("the run has ended")) {
            self.panic_at_the_end(line);
        }
        answer
    }

    fn step(&mut self, what: &str) {
        if !self.run.as_mut().unwrap().step() {
            self.panic_at_the_end(what);
        }
    }

    fn panic_at_the_end(&mut self, what: &str) -> ! {
        let outcome = self.run.take().unwrap().finish();
        panic!("{what}: the run has ended at tick {}: {}", outcome.result.ticks, story(&outcome));
    }

    fn please(&mut self, lines: &[&str]) -> &mut Self {
        for line in lines {
            if let Err(why) = self.ask(line) {
                panic!("tick {}: {line}: {why}", self.tick());
            }
        }
        self
    }

    fn wait(&mut self, ticks: u32) -> &mut Self {
        for _ in 0..ticks {
            self.step("wait");
        }
        self
    }

    fn until(&mut self, what: &str, holds: impl Fn(&CommonMemory) -> bool) -> &mut Self {
        for _ in 0..LIMIT {
            if holds(self.memory()) {
                return self;
            }
            self.step(what);
        }
        panic!("{what}: not by tick {}", self.tick());
    }

    fn until_it_waits(&mut self) -> &mut Self {
        for _ in 0..LIMIT {
            let status = self.ask("status").unwrap();
            let executes = self.memory().task.status.report == HwsReport::Executing;
            if status.starts_with("the job waits") && !executes {
                return self;
            }
        }
        panic!("the job continues at tick {}", self.tick());
    }

    fn fails(&mut self, reason: Reason) -> &mut Self {
        self.until_it_waits();
        let status = self.memory().task.status;
        let remedy = reason.remedy();
        assert_eq!((status.report, status.reason), (HwsReport::Error, reason), "tick {}", self.tick());
        assert!(remedy.is_some(), "{reason:?} needs a person");
        self
    }

    fn send(&mut self, command: &str) -> (HwsReport, Reason) {
        self.please(&[command]).wait(4).until_it_waits();
        let status = self.memory().task.status;
        (status.report, status.reason)
    }

    fn does(&mut self, commands: &[&str]) -> &mut Self {
        for command in commands {
            assert_eq!(self.send(command), (HwsReport::Finished, Reason::None), "{command}");
        }
        self
    }

    fn go(&mut self) -> &mut Self {
        for _ in 0..LIMIT {
            match self.ask("job go") {
                Ok(_) => return self,
                Err(why) => assert!(why.contains("is still executed"), "{why}"),
            }
        }
        panic!("job go is refused");
    }

    /// Every part is where its last command should have left it.
    fn finishes(self) -> RunOutcome {
        let outcome = self.ends();
        assert!(outcome.is_finished(), "{}", story(&outcome));
        outcome
    }

    /// All lines finish. A part that the operator took from the gripper falls, which the check of the parts reports.
    fn finishes_without_the_part(self) {
        let outcome = self.ends();
        let last = outcome.steps.last().map(|step| step.outcome.text());
        assert_eq!(last, Some("finished"), "{}", story(&outcome));
        let held = outcome.result.parts.iter().any(|part| part.held);
        assert!(!held, "{:?}", outcome.result.parts);
        if let Some(failure) = &outcome.result.failure {
            assert_eq!(failure.account.first.process, "cell", "{failure:?}");
        }
    }

    fn ends(mut self) -> RunOutcome {
        for _ in 0..LIMIT {
            if !self.run.as_mut().unwrap().step() {
                return self.run.take().unwrap().finish();
            }
        }
        let status = self.memory().task.status;
        panic!("the job does not finish: {status:?}, {:?}", self.ask("status"));
    }
}

fn story(outcome: &RunOutcome) -> String {
    let steps: Vec<_> = outcome.steps.iter().map(|step| (&step.text, step.outcome)).collect();
    format!("{:?}\n{steps:#?}", outcome.result.failure)
}

const TO_VISE: &str = "** tray UNIT_1 4 LINKBAR1_BH 0 0 0
** vise partial PFIXTURE
== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0
";
/// A shaft goes from the tray to the turning machine, with the v-gripper.
const SHAFT: &str = "** tray UNIT_2 7 SHAFT_BH
== TRANSFER SHAFT_BH +1 UNIT_2 7 +1 V-VFIXTURE 0 HOME 0
";
const TO_SAFE: &str = "** wait 100\n== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n"; // after 4 s at HOME
const TO_HOME: &str = "** tray UNIT_1 4 LINKBAR1_BH 0 0 0
== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0
== MOVE -- +0 -- 0 +0 HOME 0 -- 0
";
const HOME: &str = "MOVE -- +0 -- 0 +0 HOME 0 -- 0";
const LEAVE: &str = "== POSITION -- +0 -- 0 +0 HOME 0 -- 0\n";

fn executes(memory: &CommonMemory, verb: EmoveVerb) -> bool {
    let (order, status) = (&memory.subtask.emove, &memory.emove.status);
    order.command == verb && status.echo == order.number && status.report == StatusReport::Executing
}

fn turns(memory: &CommonMemory) -> bool {
    let (order, status) = (&memory.subtask.pedestal, &memory.pedestal.status);
    order.command == PedestalVerb::Flip
        && status.echo == order.number
        && status.report == PedestalReport::Executing
}

#[test]
fn active_joystick_is_switched_off() {
    let mut it = Operated::start(TO_SAFE);
    it.wait(50).please(&["joystick frame WORLD", "joystick stick 0 1 1"]).until_it_waits();
    assert_eq!(it.memory().task.status.reason, Reason::JoystickOn);
    it.please(&["joystick frame OFF"]).wait(20).go();
    it.finishes();
}

#[test]
fn a_disabled_link_restarts_with_hold() {
    let mut it = Operated::start(TO_SAFE);
    it.wait(50).please(&["panel hold on"]).fails(Reason::LinkOff);
    it.please(&["panel hold off"]).wait(100).go();
    it.finishes();
}

#[test]
fn gripper_that_holds_another_object_places_it_first() {
    let job = format!(
        "** tray UNIT_1 3 LCLEVIS_BH 0 0 0\n{TO_VISE}== ACQUIRE LCLEVIS_BH +2 UNIT_1 3 +0 -- 0 -- 0\n"
    );
    // The check of the paths would find the collision of the two objects.
    let mut it = Operated::with(&job, "", |config| RunConfig { unchecked: true, ..config });
    it.fails(Reason::AlreadyHolding);
    it.does(&["TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 4 -- 0"]).go();
    it.finishes();
}

#[test]
fn object_held_in_mid_air_is_placed_with_transfer() {
    let mut it = Operated::start(&format!("{TO_HOME}{LEAVE}"));
    it.fails(Reason::HeldElsewhere);
    it.does(&["TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 4 HOME 0"]).go();
    it.finishes();
}

#[test]
fn object_held_in_mid_air_is_released_by_hand() {
    let mut it = Operated::start(&format!("{TO_HOME}{LEAVE}"));
    it.fails(Reason::HeldElsewhere);
    let refused = it.ask("confirm clamped").unwrap_err();
    assert!(refused.contains("does not hold an object at a vise"), "{refused}");
    it.please(&["confirm by hand"]).go();
    it.finishes_without_the_part();
}

/// The object is "immediately released" (V.4.1) in the vise that clamps it.
#[test]
fn object_in_a_closed_vise_is_released_by_position() {
    let outcome = Operated::start(&format!("{TO_VISE}** vise close PFIXTURE\n{LEAVE}")).finishes();
    let part = &outcome.result.parts[0];
    assert!(!part.held && part.location == "PFIXTURE", "{part:?}");
}

#[test]
fn object_in_an_open_vise_is_released_after_the_vise_is_closed() {
    let mut it = Operated::start(&format!("{TO_VISE}{LEAVE}"));
    it.fails(Reason::NotClamped);
    assert!(matches!(it.memory().emove.status.held, Holding::Object(_)));
    it.please(&["vise close PFIXTURE"]).wait(200).go();
    let outcome = it.finishes();
    assert_eq!(outcome.result.parts[0].location, "PFIXTURE");
}

/// The operator looks at the vise and confirms. The log contains the confirmation.
#[test]
fn object_in_a_vise_is_released_after_a_confirmation() {
    let mut it = Operated::start(&format!("{TO_VISE}{LEAVE}"));
    it.fails(Reason::NotClamped);
    let answer = it.ask("confirm clamped").unwrap();
    assert!(answer.contains("LINKBAR1_BH is treated as clamped at PFIXTURE"), "{answer}");
    it.go();
    it.finishes();
}

fn is_held_at_home(memory: &CommonMemory) -> bool {
    let status = &memory.emove.status;
    matches!(status.held, Holding::Object(_))
        && status.at.is_some_and(|at| at.site.location.as_str() == "HOME")
}

fn without_name(it: &mut Operated) {
    it.please(&["board 2 stop"]).wait(4).please(&["write emove.estimates.held NONE"]).wait(4);
    it.please(&["board 2 go"]).wait(8);
    assert_eq!(it.memory().emove.status.held, Holding::Something);
}

#[test]
fn unknown_object_is_taken_out_by_hand_and_put_back() {
    let mut it = Operated::start(&format!(
        "{TO_HOME}** wait 100\n== TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 3 HOME 0\n"
    ));
    it.until("the blank is at HOME", is_held_at_home);
    without_name(&mut it);
    it.fails(Reason::UnknownHeld);
    assert_eq!(it.send("POSITION -- +0 -- 0 +0 HOME 0 -- 0"), (HwsReport::Error, Reason::UnknownHeld));
    it.please(&["confirm by hand"]).does(&["POSITION -- +0 -- 0 +0 HOME 0 -- 0"]);
    it.please(&["tray UNIT_1 4 LINKBAR1_BH 0 0 0"]).go();
    it.finishes_without_the_part();
}

#[test]
fn gripper_without_calibration_is_opened_by_hand() {
    let mut it = Operated::start(&format!(
        "{TO_HOME}** wait 100\n== TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 3 HOME 0\n"
    ));
    it.until("the blank is at HOME", is_held_at_home);
    without_name(&mut it);
    it.please(&["board 8 stop"]).wait(4).please(&["write grip.calibration NONE"]).wait(4);
    it.please(&["board 8 go"]).fails(Reason::HeldNotKnown);
    it.please(&["confirm by hand"]).does(&["POSITION -- +0 -- 0 +0 HOME 0 -- 0"]);
    it.please(&["tray UNIT_1 4 LINKBAR1_BH 0 0 0"]).go();
    it.finishes_without_the_part();
}

#[test]
fn tool_command_waits_for_the_command_before_it() {
    let mut it = Operated::start(
        "** tray UNIT_2 1 ENDMILL-1 0 0 0
== MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0
** wait 100
== INSERT-TOOL ENDMILL-1 +1 -- 0 +1 TOOL-SAFE 0 -- 0
** drum grip
== RELEASE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0
",
    );
    it.until("the tool is near the drum", |memory| {
        memory.emove.status.at.is_some_and(|at| at.site.location.as_str() == "TOOL-SAFE")
            && memory.task.status.report == HwsReport::Finished
    });
    it.does(&[HOME]).go().fails(Reason::NotPrepared);
    it.does(&["MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0"]).go();
    it.finishes();
}

#[test]
fn transfer_to_the_pedestal_is_refused_without_motion() {
    let mut it = Operated::start("** wait 10\n== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n");
    let line = "TRANSFER LCLEVIS_IH +1 PFIXTURE 0 +1 PEDESTAL 0 HOME 0";
    it.wait(5);
    let sent = it.memory().subtask.emove.number;
    match it.ask(line) {
        Err(why) => assert!(why.contains("PEDESTAL"), "{why}"),
        Ok(_) => {
            it.wait(4).fails(Reason::PedestalOnly);
            let order = it.memory().subtask.emove;
            assert!(order.number == sent || order.command == EmoveVerb::Pause, "{order:?}");
            it.go();
        }
    }
    it.finishes();
}

fn clevis() -> String {
    fs::read_to_string(root().join("data/jobs/clevis.job")).unwrap()
}

/// A command is interrupted while only the pedestal's hand holds the part and the table turns.
fn flipping() -> Operated {
    let mut it = Operated::start(&clevis());
    it.until("the table turns", turns).wait(10).please(&["PAUSE"]).until_it_waits();
    it
}

#[test]
fn part_in_the_pedestal_is_regripped_by_the_command_sent_again() {
    let mut it = Operated::start(&clevis());
    it.until("the robot releases the part at the pedestal", |memory| {
        executes(memory, EmoveVerb::Release) && memory.task.subtask.command == SubtaskVerb::FixGrip
    });
    it.please(&["PAUSE"]).until_it_waits();
    assert_eq!(it.send(HOME), (HwsReport::Error, Reason::PartInPedestal));
    it.go();
    it.finishes();
}

/// The robot is empty and clear of the pedestal, so it moves away.
#[test]
fn part_in_the_pedestal_is_released_by_hand() {
    let mut it = flipping();
    assert!(it.memory().subtask.status.pedestal_part);
    let refused = it.ask("pedestal release").unwrap_err();
    assert!(refused.contains("would fall"), "{refused}");
    let refused = it.ask("pedestal pre-grip LCLEVIS_IH").unwrap_err();
    assert!(refused.contains("RELEASE comes first"), "{refused}");
    it.does(&[HOME]);
    assert!(it.memory().subtask.status.pedestal_part, "the pedestal keeps it");
    let state = it.ask("pedestal").unwrap();
    assert!(state.contains("holds LCLEVIS_IH"), "{state}");
    it.please(&["pedestal release by hand"]).until("the hand is open", |memory| {
        !memory.subtask.status.pedestal_part && memory.subtask.regrip.is_none()
    });
    it.please(&["run clevis"]);
    it.finishes_without_the_part();
}

/// The joystick box controls the robot while the pedestal alone holds the part, and releases it.
#[test]
fn robot_clear_of_the_pedestal_leaves_and_the_regrip_continues() {
    let mut it = flipping();
    it.please(&["joystick frame WORLD", "joystick stick 0 1 1"]).wait(20);
    it.please(&["joystick frame OFF"]).wait(20);
    it.does(&[HOME, "MOVE -- +0 -- 0 +0 PED-SAFE 0 -- 0"]).go();
    it.finishes();
}

/// The operator names the part with `write subtask.regrip`.
#[test]
fn part_in_the_pedestal_is_named_by_the_person() {
    let mut it = flipping();
    it.please(&["board 6 stop"]).wait(4).please(&["write subtask.regrip LCLEVIS"]).wait(4);
    it.please(&["board 6 go"]).wait(4).go().fails(Reason::PedestalHoldsOther);
    it.please(&["board 6 stop"]).wait(4).please(&["write subtask.regrip LCLEVIS_IH"]).wait(4);
    it.please(&["board 6 go"]).wait(4).go();
    it.finishes();
}

#[test]
fn regrip_continues_after_a_person_turned_the_table() {
    let mut it = flipping();
    it.please(&["pedestal flip -20"])
        .wait(4)
        .until("the table stands", |memory| memory.pedestal.status.report == PedestalReport::Done);
    let refused = it.ask("pedestal flip far").unwrap_err();
    assert!(refused.contains("degrees"), "{refused}");
    it.go();
    it.finishes();
}

#[test]
fn table_without_a_known_angle_is_calibrated_after_the_part_is_taken_out() {
    let mut it = flipping();
    it.please(&["table power off", "table power on", "table mode manual"]).wait(50);
    it.please(&["table reset", "table mode prog", "table power off", "table power on"]).wait(10);
    it.go().fails(Reason::TableAngleUnknown);
    it.does(&[HOME]).please(&["pedestal release by hand"]);
    it.until("the hand is open", |memory| !memory.subtask.status.pedestal_part);
    it.please(&["run clevis"]).until_it_waits();
    // The counter was set at a wrong angle, so the table stops at its limit, and PRE-GRIP calibrates it.
    assert_eq!(it.memory().task.status.reason, Reason::TableStuck);
    it.go();
    it.finishes_without_the_part();
}

/// RELEASE-TOOL without a tool.
#[test]
fn release_tool_moves_the_robot_out_of_an_empty_drum() {
    let mut it = Operated::start(
        "== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0\n** drum release
== REMOVE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n",
    );
    it.fails(Reason::NoToolInDrum);
    assert_eq!(it.send(HOME), (HwsReport::Error, Reason::InDrum));
    it.does(&["RELEASE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0"]);
    it.please(&["drum tool DRILL-2"]).go();
    it.finishes();
}

#[test]
fn robot_in_the_drum_continues_with_the_tool_command() {
    let mut it = Operated::start(
        "** drum tool DRILL-2\n== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0\n** drum release
== REMOVE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n",
    );
    it.until("the robot is in the drum", |memory| memory.subtask.status.drum)
        .please(&["PAUSE"])
        .until_it_waits();
    assert_eq!(it.send(HOME), (HwsReport::Error, Reason::InDrum));
    it.go();
    it.finishes();
}

#[test]
fn gripper_change_continues_with_the_same_command() {
    let mut it =
        Operated::start("** drum tool DRILL-2\n== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0\n");
    it.until("the gripper comes off", |memory| executes(memory, EmoveVerb::QcDetach)).wait(40);
    it.please(&["PAUSE"]).until_it_waits();
    let (report, reason) = it.send(HOME);
    assert_eq!(report, HwsReport::Error);
    assert!(matches!(reason, Reason::InHolster | Reason::RingNotLocked), "{reason:?}");
    it.go();
    it.finishes();
}

#[test]
fn seat_motion_continues_with_the_same_command() {
    let job = fs::read_to_string(root().join("data/jobs/linkbar.job")).unwrap();
    let mut it = Operated::start(&job);
    it.until("the robot is on its way to the seat", |memory| {
        let order = &memory.subtask.emove;
        executes(memory, EmoveVerb::MovToObj)
            && order.object.is_some_and(|name| name.as_str().starts_with("S-"))
    });
    it.wait(6).please(&["PAUSE"]).until_it_waits();
    let (report, reason) = it.send("POSITION H-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0");
    assert_eq!((report, reason), (HwsReport::Error, Reason::ForwardOnly));
    it.go();
    it.finishes();
}

#[test]
fn gripper_change_continues_after_the_eye_of_the_holster_is_repaired() {
    let job = "** drum tool DRILL-2\n== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0\n";
    let faults =
        "[[fault]]\nkind = \"off\"\nsensor = \"holster.right.large-1\"\nfrom = 0\nuntil = 4000\n\n[[fault]]
kind = \"off\"\nsensor = \"holster.right.large-2\"\nfrom = 0\nuntil = 4000\n";
    let mut it = Operated::with_faults(job, faults);
    it.fails(Reason::NotDetected);
    let ticks = 4100_u64.saturating_sub(it.tick());
    it.wait(u32::try_from(ticks).unwrap()).go();
    it.finishes();
}

#[test]
fn wrong_command_is_replaced_by_the_right_one() {
    let mut it = Operated::start(
        "** drum tool DRILL-2\n** wait 200\n== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0\n** drum release
== REMOVE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n",
    );
    it.wait(100);
    match it.ask("ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 HOME 0 -- 0") {
        Err(why) => assert!(why.contains("TOOL-SAFE"), "{why}"),
        Ok(_) => {
            it.wait(4).fails(Reason::NotNearDrum);
        }
    }
    it.does(&["ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0"]).go();
    it.finishes();
}

#[test]
fn release_without_air_is_completed_by_the_command_sent_again() {
    let job = fs::read_to_string(root().join("data/jobs/linkbar.job")).unwrap();
    let faults = "[[fault]]\nkind = \"air-lost\"\nfrom = 1500\nuntil = 3500\n";
    let mut it = Operated::with_faults(&job, faults);
    it.until_it_waits();
    assert_eq!(it.memory().task.status.report, HwsReport::Error);
    assert_eq!(it.send(HOME), (HwsReport::Error, Reason::ReleaseNotEnded));
    let ticks = 3520_u64.saturating_sub(it.tick());
    it.wait(u32::try_from(ticks).unwrap()).go();
    it.finishes();
}

#[test]
fn robot_off_its_path_continues_after_a_pause_that_adopts_its_position() {
    let faults = "[[fault]]\nkind = \"stuck\"\nsensor = \"resolver.elbow\"\nfrom = 200\nuntil = 400\n";
    let mut it = Operated::with_faults(TO_SAFE, faults);
    it.fails(Reason::OffPath);
    let ticks = 420_u64.saturating_sub(it.tick());
    it.wait(u32::try_from(ticks).unwrap()).go();
    it.finishes();
}

fn stuck_open(valves: &[&str], from: u64, until: u64) -> String {
    let fault = |valve: &&str| {
        format!(
            "[[fault]]\nkind = \"stuck\"\nvalve = \"{valve}\"\nvalue = \"open\"\nfrom = {from}\nuntil = {until}\n"
        )
    };
    valves.iter().map(fault).collect()
}

/// The gripper opens during the motion, and the blank falls to the floor.
#[test]
fn lost_object_is_fetched_again_from_its_source() {
    let faults = stuck_open(&["grip.open-coarse", "grip.supply"], 1700, 1760);
    let mut it = Operated::with_faults(&format!("{TO_VISE}** vise close PFIXTURE\n{LEAVE}"), &faults);
    it.fails(Reason::ObjectLost);
    it.wait(100).please(&["tray UNIT_1 4 LINKBAR1_BH 0 0 0"]).go();
    it.finishes_without_the_part();
}

#[test]
fn object_at_the_edge_of_its_tray_is_moved_to_the_middle() {
    let mut it = Operated::start(&TO_VISE.replace("0 0 0", "0 400 0"));
    it.fails(Reason::AtTrayEdge);
    let part = it.cell().parts()[0].id;
    it.cell().take_part(part).unwrap();
    it.please(&["tray UNIT_1 4 LINKBAR1_BH 0 0 0"]).go();
    it.finishes();
}

/// The hand opens while the table turns. The whole job starts again from the tray.
#[test]
fn object_lost_by_the_pedestal_is_delivered_again() {
    let faults = stuck_open(&["pedestal.open-coarse", "pedestal.supply"], 5700, 5760);
    let mut it = Operated::with_faults(&clevis(), &faults);
    it.fails(Reason::HandLost);
    it.wait(100).does(&[HOME]).please(&["run clevis"]);
    it.finishes_without_the_part();
}

#[test]
fn hand_of_the_pedestal_calibrates_after_its_potentiometer_is_repaired() {
    let faults =
        "[[fault]]\nkind = \"stuck\"\nsensor = \"pedestal.potentiometer\"\nvalue = 500\nuntil = 4800\n";
    let mut it = Operated::with_faults(&clevis(), faults);
    it.fails(Reason::HandNotCalibrated);
    let ticks = 4820_u64.saturating_sub(it.tick());
    it.wait(u32::try_from(ticks).unwrap()).go();
    it.finishes();
}

/// The v-gripper is missing when the shaft is fetched.
#[test]
fn missing_gripper_is_fetched_after_its_return_to_the_holster() {
    let mut it = Operated::start(SHAFT);
    it.cell().hang_gripper(2, None).unwrap();
    it.fails(Reason::HolsterEmpty);
    it.cell().hang_gripper(2, Some(1)).unwrap();
    it.go();
    it.finishes();
}

/// The tool gripper hangs in the holster of the parts gripper.
#[test]
fn gripper_is_put_away_after_its_holster_was_emptied() {
    let mut it = Operated::start(SHAFT);
    it.cell().hang_gripper(3, Some(0)).unwrap();
    it.fails(Reason::HolsterOccupied);
    it.cell().hang_gripper(3, Some(2)).unwrap();
    it.go();
    it.finishes();
}

const SCENARIOS: &[(Reason, &str)] = &[
    (Reason::JoystickOn, "active_joystick_is_switched_off"),
    (Reason::LinkOff, "a_disabled_link_restarts_with_hold"),
    (Reason::AlreadyHolding, "gripper_that_holds_another_object_places_it_first"),
    (Reason::HeldElsewhere, "object_held_in_mid_air_is_placed_with_transfer"),
    (Reason::NotClamped, "object_in_an_open_vise_is_released_after_the_vise_is_closed"),
    (Reason::UnknownHeld, "unknown_object_is_taken_out_by_hand_and_put_back"),
    (Reason::HeldNotKnown, "gripper_without_calibration_is_opened_by_hand"),
    (Reason::NotPrepared, "tool_command_waits_for_the_command_before_it"),
    (Reason::PedestalOnly, "transfer_to_the_pedestal_is_refused_without_motion"),
    (Reason::PartInPedestal, "part_in_the_pedestal_is_regripped_by_the_command_sent_again"),
    (Reason::PedestalHoldsOther, "part_in_the_pedestal_is_named_by_the_person"),
    (Reason::TableAngleUnknown, "table_without_a_known_angle_is_calibrated_after_the_part_is_taken_out"),
    (Reason::InDrum, "robot_in_the_drum_continues_with_the_tool_command"),
    (Reason::NoToolInDrum, "release_tool_moves_the_robot_out_of_an_empty_drum"),
    (Reason::InHolster, "gripper_change_continues_with_the_same_command"),
    (Reason::ForwardOnly, "seat_motion_continues_with_the_same_command"),
    (Reason::NotDetected, "gripper_change_continues_after_the_eye_of_the_holster_is_repaired"),
    (Reason::NotNearDrum, "wrong_command_is_replaced_by_the_right_one"),
    (Reason::ReleaseNotEnded, "release_without_air_is_completed_by_the_command_sent_again"),
    (Reason::OffPath, "robot_off_its_path_continues_after_a_pause_that_adopts_its_position"),
    (Reason::ObjectLost, "lost_object_is_fetched_again_from_its_source"),
    (Reason::AtTrayEdge, "object_at_the_edge_of_its_tray_is_moved_to_the_middle"),
    (Reason::HandLost, "object_lost_by_the_pedestal_is_delivered_again"),
    (Reason::HolsterEmpty, "missing_gripper_is_fetched_after_its_return_to_the_holster"),
    (Reason::HolsterOccupied, "gripper_is_put_away_after_its_holster_was_emptied"),
    (Reason::HandNotCalibrated, "hand_of_the_pedestal_calibrates_after_its_potentiometer_is_repaired"),
];

const ELSEWHERE: &[(Reason, &str)] = &[
    (Reason::UnknownObject, "a block is corrected and loaded in tests/operator.rs"),
    (Reason::UnknownStart, "tests/jobs.rs and tests/operator.rs move the robot with the joystick box"),
    (Reason::RobotElsewhere, "tests/operator.rs starts a robot that has sunk up again"),
    (Reason::OffPlace, "tests/jogs.rs moves the robot off its place and back"),
    (Reason::DrumOccupied, "tests/drum.rs follows the remedy"),
    (Reason::ForceUncalibrated, "tests/drum.rs follows the remedy"),
    (Reason::NeighbourLost, "tests/boards.rs replaces lost boards"),
    (
        Reason::GripperGone,
        "in the cell a ring that opens takes the air from the fingers first: the object is lost before",
    ),
    (Reason::DeviceTripped, "crates/closed-loop/src/field/tests.rs releases a tripped device"),
    (Reason::SentAway, "the levels send the robot away in every tick (task recovery)"),
];

#[test]
fn every_remedy_text_has_a_scenario_or_an_exemption() {
    let source = include_str!("remedies.rs");
    for (reason, scenario) in SCENARIOS {
        assert!(source.contains(&format!("#[test]\nfn {scenario}()")), "{reason:?}: no test {scenario}");
    }
    let listed: Vec<_> = SCENARIOS.iter().chain(ELSEWHERE).map(|(reason, _)| reason.remedy()).collect();
    for reason in Reason::ALL {
        let count = listed.iter().filter(|remedy| **remedy == reason.remedy()).count();
        assert_eq!(count, usize::from(reason.remedy().is_some()), "{reason:?}: {:?}", reason.remedy());
    }
}
