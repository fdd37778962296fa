//! Forks are exact, and the monitor finds planted harm. tests/campaign.rs compares a branch with an ordinary run.

use std::{fs, path::Path};

use geometry::frame::Frame;
use interfaces::HwsCommand;
use neighbours::workstation::{Status, player::Hwsc};
use plant::{Placement, WorkstationAction};
use rcs_core::{digest::Digest, tick::Tick};
use taskdata::load::{Job, Source};

use super::{
    branch::{Branch, Facility},
    coverage::Coverage,
    interruption::Kind,
    journal::{self, Journal},
    known::Known,
    operator::Recovery,
    parent::{Parent, Ticks, emulator},
    pool::{self, Plan},
    random::{self, Draw, Settings},
    series::Series,
    trial::{self, NoObserver, Procedure, Until},
    verdict::{BranchResult, Verdict},
};
use closed_loop::{Commander, workstation::SimulatedWorkstation};
use runtime::setup::{CellFile, TaskFiles};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data");
const PROCEDURE: Procedure = Procedure { recovery: Recovery::Pause, tries: 3, until: Until::Next };

pub(super) fn facility(job: &str) -> Facility {
    let data = Path::new(DATA);
    let mut files = TaskFiles::load(data, Some(job), false).expect("the job is shipped");
    let CellFile { description, .. } = CellFile::load(data, &mut files, false).expect("the cell is shipped");
    let TaskFiles { store, job, .. } = files;
    Facility::new(store, job, description, 1)
}

fn with_job(text: &str) -> Facility {
    let shipped = facility("linkbar");
    let source = Source { name: "try.job".into(), text: text.into() };
    let (job, _) = Job::from_source(source, &shipped.store).expect("the job is right");
    Facility { job, ..shipped }
}

fn series(facility: &Facility, text: &str) -> Series {
    let mut all = Series::named(text, Path::new(DATA), &facility.description).expect("it is known");
    all.remove(0)
}

/// The emulator, with a record of its commands for another branch.
struct Tape<'h> {
    hwsc: &'h mut Hwsc,
    sent: Option<HwsCommand>,
}

impl Commander for Tape<'_> {
    fn step(
        &mut self,
        tick: Tick,
        status: &Status<'_>,
        workstation: &mut SimulatedWorkstation,
    ) -> Option<HwsCommand> {
        self.sent = Commander::step(self.hwsc, tick, status, workstation);
        self.sent
    }
}

struct Playback(Option<HwsCommand>);

impl Commander for Playback {
    fn step(&mut self, _: Tick, _: &Status<'_>, _: &mut SimulatedWorkstation) -> Option<HwsCommand> {
        self.0
    }
}

/// Digest of all ticks so far, and digest of the cell's state.
fn fingerprint(branch: &Branch<'_>) -> (Digest, u64) {
    (branch.closed.digest(), branch.closed.workstation.cell.digest())
}

#[test]
fn fork_continues_bit_for_bit_like_its_parent() {
    // STARTUP sends a statement about the robot to the Data System, so an answer is pending at one of the forks.
    let facility = with_job(
        "== STARTUP -- +0 -- 0 +0 -- 0 -- 0\n\
         ** tray UNIT_1 4 LINKBAR1_BH\n\
         == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0 #17\n",
    );
    let mut branch = Branch::start(&facility).expect("the cell is sound");
    let mut hwsc = emulator(&facility);
    for fork_at in [1, 72, 107, 160, 700, 1600] {
        while branch.at() < Tick(fork_at) {
            branch.step(&mut hwsc);
        }
        let fork = branch.clone();
        let mut other = fork.clone();
        assert_eq!(fingerprint(&other), fingerprint(&branch), "at tick {fork_at}");
        for _ in 0..35 {
            let mut tape = Tape { hwsc: &mut hwsc, sent: None };
            branch.step(&mut tape);
            let sent = tape.sent;
            other.step(&mut Playback(sent));
            let tick = branch.at().0;
            assert_eq!(
                other.closed.external(),
                branch.closed.external(),
                "in tick {tick} of the fork of {fork_at}"
            );
            assert_eq!(fingerprint(&other), fingerprint(&branch), "after tick {tick}");
        }
    }
}

fn empty_move() -> (Facility, Parent) {
    let facility = with_job("== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n");
    let parent = Parent::run(&facility).expect("the job finishes");
    (facility, parent)
}

/// A state of [`empty_move`] that a test can change.
fn under_way(facility: &Facility) -> Branch<'_> {
    pool::fork_at(facility, 120).expect("the run can be forked")
}

fn judged(facility: &Facility, parent: &Parent, fork: &Branch<'_>, text: &str) -> BranchResult {
    let series = series(facility, text);
    trial::run(facility, parent, fork, &series, PROCEDURE, None, &mut NoObserver).expect("the fork continues")
}

#[test]
fn undisturbed_branch_is_done() {
    let (facility, parent) = empty_move();
    let fork = under_way(&facility);
    let result = judged(&facility, &parent, &fork, "none");
    assert_eq!((result.verdict, result.detail.as_str()), (Verdict::Done, ""));
    assert_eq!((result.at, result.until), (120, parent.ticks));
    assert!(result.doing[0].starts_with("Task: MOVE"), "{:?}", result.doing);
}

#[test]
fn command_finished_during_interruption_is_not_repeated() {
    let (facility, parent) = empty_move();
    let fork = under_way(&facility);
    let last =
        (1..parent.ticks).rfind(|tick| parent.line_at(Tick(*tick)).0 == 1).expect("it has a first line");
    let at_end = pool::fork_at(&facility, last).expect("the run can be forked");
    let sent_again = |fork: &Branch<'_>, interruption: &str| {
        let result = judged(&facility, &parent, fork, interruption);
        assert_eq!((result.verdict, result.detail.as_str()), (Verdict::Done, ""));
        result.ended.iter().any(|ended| ended.contains("SAFE"))
    };
    for interruption in ["pause", "replaced", "nudge"] {
        assert!(sent_again(&fork, interruption) && !sent_again(&at_end, interruption), "{interruption}");
    }
}

/// SHUTDOWN moves nothing, so the hand stays where a MOVE has left it.
#[test]
fn shutdown_replaced_by_a_move_is_done() {
    let facility = with_job("== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n== SHUTDOWN -- +0 -- 0 +0 -- 0 -- 0\n");
    let parent = Parent::run(&facility).expect("the job finishes");
    let at = parent.ticks - 3;
    assert_eq!(parent.line_at(Tick(at)).0, 2, "SHUTDOWN is under way");
    let fork = pool::fork_at(&facility, at).expect("the run can be forked");
    let result = judged(&facility, &parent, &fork, "replaced");
    assert_eq!((result.verdict, result.detail.as_str()), (Verdict::Done, ""));
    assert!(result.ended.iter().any(|ended| ended.contains("MOVE")), "{result:?}");
}

/// A part in the path of the hand: the report names the contact, the tick and the command.
#[test]
fn monitor_finds_a_planted_contact() {
    let (facility, parent) = empty_move();
    let fork = under_way(&facility);
    let mut branch = fork.clone();
    let ahead = {
        let mut commander = Playback(None);
        let mut scout = fork.clone();
        (0..60).for_each(|_| scout.step(&mut commander));
        scout.closed.workstation.cell.tool().position
    };
    let frame = Frame { position: ahead, ..Frame::identity() };
    let put = WorkstationAction::Put { part: "LCLEVIS_BH".into(), frame };
    branch.closed.workstation.cell.workstation(&put).expect("there is room for it");
    let planted = branch.clone();
    let result = judged(&facility, &parent, &planted, "none");
    assert_eq!(result.verdict, Verdict::Hurt);
    assert!(result.detail.contains("LCLEVIS_BH") && result.detail.contains("MOV-TO-LOC"), "{result:?}");
    assert!(result.detail.starts_with("tick 1"), "{result:?}");
}

/// A part at a place where no command has put it: every command finishes, but the world differs.
#[test]
fn monitor_reports_world_contradicting_a_finished_command() {
    let (facility, parent) = empty_move();
    let fork = under_way(&facility);
    let mut branch = fork.clone();
    let place = WorkstationAction::Place {
        part: "LINKBAR1_BH".into(),
        unit: "UNIT_1".into(),
        sector: 4,
        placement: Placement::Random,
    };
    branch.closed.workstation.cell.workstation(&place).expect("the tray is empty");
    let planted = branch.clone();
    let result = judged(&facility, &parent, &planted, "none");
    assert_eq!(result.verdict, Verdict::Hurt);
    assert_eq!(result.reason, "MOVE is finished, but 1 part in the cell, not 0");
}

/// The arm jumps when the pressure returns, and the clevis slides in the fingers, which no sensor shows.
#[test]
fn slide_without_commanded_point_is_counted_apart() {
    let facility = facility("clevis");
    let parent = Parent::run(&facility).expect("the job finishes");
    let fork = pool::fork_at(&facility, 5082).expect("the run can be forked");
    let result = judged(&facility, &parent, &fork, "estop");
    assert_eq!(result.verdict, Verdict::Apart, "{result:?}");
    assert_eq!(result.reason, "LCLEVIS_IH slides in the fingers while no point is commanded");
    assert!(result.ended.iter().any(|ended| ended.contains("REFIXTURE") && ended.ends_with("finished")));
}

fn plans(facility: &Facility, parent: &Parent, texts: &[&str], step: u64) -> Vec<Plan> {
    let of_text = |text: &&str| {
        let series = series(facility, text);
        let plan = move |at| Plan { at, series: series.clone(), procedure: PROCEDURE };
        parent.forks(&Ticks::Every(step)).into_iter().map(plan)
    };
    texts.iter().flat_map(of_text).collect()
}

#[test]
fn judgements_do_not_depend_on_thread_count() {
    let (facility, parent) = empty_move();
    let plans = plans(&facility, &parent, &["pause", "refused", "hold+5:pause"], 60);
    let campaign = |threads: usize| {
        let run = pool::run(&facility, &parent, &plans, threads, None, &|result, met| Ok((result, met)));
        let mut all = Coverage::default();
        let results = run.expect("the branches can be run").into_iter().map(|(one, met)| {
            let new = all.take_in(met);
            (one.interruption, one.at, one.state, new.counts())
        });
        (results.collect::<Vec<_>>(), all)
    };
    let one = campaign(1);
    assert_eq!(one.0.len(), plans.len());
    assert!(one.0.is_sorted_by_key(|(interruption, ..)| {
        plans.iter().position(|plan| plan.series.to_string() == *interruption)
    }));
    let (rows, missing) = one.1.missing();
    assert!(missing.len() < rows && missing.iter().all(|row| row.contains(": ")), "{missing:?}");
    assert_eq!(one, campaign(3));
}

#[test]
fn branch_in_a_known_state_has_the_same_end() {
    let (facility, parent) = empty_move();
    let quiet = ["fault:camera-blind", "fault:bytes-lost", "restart:tool_grip", "held:task"];
    let delayed = ["hold", "answer-lost", "restart:prim", "restart:table", "pause", "pause+9:hold"];
    let plans = plans(&facility, &parent, &[&quiet[..], &delayed].concat(), 30);
    let campaign = |known: Option<&Known>| {
        let run = pool::run(&facility, &parent, &plans, 1, known, &|result, met| Ok((result, met)));
        let (mut all, mut states) = (Coverage::default(), 0);
        let results = run.expect("the branches can be run").into_iter().map(|(result, met)| {
            states += met.counts().1;
            all.take_in(met);
            serde_json::to_value(result).expect("a result can be written")
        });
        (results.collect::<Vec<_>>(), all, states)
    };
    let (whole, joined) = (campaign(None), campaign(Some(&Known::default())));
    assert_eq!((&joined.0, &joined.1), (&whole.0, &whole.1));
    assert!(joined.2 < whole.2 * 9 / 10, "{} of {} states: hardly a branch was cut", joined.2, whole.2);
}

/// A campaign that was killed while it wrote a line continues after the last complete line.
#[test]
fn campaign_resumes_from_its_journal() {
    let (facility, parent) = empty_move();
    let plan = |at| Plan { at, series: series(&facility, "pause"), procedure: PROCEDURE };
    let plans = [60, 120].map(plan);
    let directory = tempfile::tempdir().expect("there is room");
    let path = directory.path().join("journal");
    let campaign = journal::campaign(&facility, &parent, PROCEDURE, false);
    let journal = Journal::open(&path, &campaign).expect("the journal is made");
    let done = |result: BranchResult, met: Coverage| {
        journal.write(&result, &met)?;
        Ok((result, met))
    };
    let run = pool::run(&facility, &parent, &plans[..1], 1, None, &done).expect("the branch can be run");
    let (first, met) = &run[0];
    let whole = fs::read(&path).expect("the journal is there");

    let other = Journal::open(&path, "another campaign").expect("the journal is read");
    assert!(other.known(&plans[0]).is_none(), "a branch of another campaign counts");

    fs::write(&path, [&whole[..], &whole[..whole.len() / 2]].concat()).expect("the journal can be written");
    let again = Journal::open(&path, &campaign).expect("a torn line is cut off");
    let known = again.known(&plans[0]).map(|(known, met)| (&known.state, known.verdict, met));
    assert_eq!(known, Some((&first.state, first.verdict, met)));
    assert!(again.known(&plans[1]).is_none());
    assert_eq!(fs::read(&path).expect("the journal is there"), whole);

    fs::write(&path, [b"{}\n", &whole[..]].concat()).expect("the journal can be written");
    let error = Journal::open(&path, &campaign).expect_err("a line is not a branch").to_string();
    assert!(error.contains("journal:1: expected a branch of a campaign"), "{error}");
}

#[test]
fn every_interruption_name_parses_back() {
    let facility = facility("linkbar");
    let all = Kind::named("all", Path::new(DATA), &facility.description).expect("there are some");
    for kind in &all {
        let again = Kind::named(&kind.to_string(), Path::new(DATA), &facility.description);
        assert_eq!(again.expect("it is known"), std::slice::from_ref(kind));
    }
    let unknown = Kind::named("pauze", Path::new(DATA), &facility.description).expect_err("it is misspelt");
    assert!(unknown.to_string().contains("the nearest is pause"), "{unknown}");
}

/// docs/campaign.md lists the fault files that do not work as interruptions.
#[test]
fn page_lists_the_faults_without_a_time_limit() {
    let facility = facility("linkbar");
    let page = std::fs::read_to_string(Path::new(DATA).join("../docs/campaign.md")).expect("there is a page");
    let switchable = Kind::named("fault", Path::new(DATA), &facility.description).expect("there are some");
    let switchable: Vec<String> = switchable.iter().map(ToString::to_string).collect();
    for entry in std::fs::read_dir(Path::new(DATA).join("faults")).expect("there are faults") {
        let path = entry.expect("the directory can be read").path();
        let name = path.file_stem().and_then(|name| name.to_str()).expect("names are text");
        let can = switchable.contains(&format!("fault:{name}"));
        let is_listed = page.contains(&format!("\n| `{name}` |"));
        assert_ne!(can, is_listed, "docs/campaign.md lists the faults that cannot be switched on: {name}");
    }
}

/// Ticks in which the robot ramps down from the greatest speed of a job, or fingers finish their command: 3 s.
const STOPS: u64 = 75;

/// Ticks in which gripper and pedestal calibrate themselves after a start, under any command.
const CALIBRATED: u64 = 150;

#[test]
fn every_stop_in_every_state_ends_at_rest() {
    let (facility, parent) = empty_move();
    let procedure = Procedure { until: Until::Rest, ..PROCEDURE };
    let forks = parent.forks(&Ticks::States);
    assert!(forks.len() > 20, "{} states", forks.len());
    for at in forks.into_iter().filter(|at| *at > CALIBRATED) {
        let fork = pool::fork_at(&facility, at).expect("the run can be forked");
        for stop in
            ["pause", "hold", "cut", "lost:task", "lost:subtask", "lost:emove", "lost:prim", "lost:t3i"]
        {
            let series = series(&facility, stop);
            let result = trial::run(&facility, &parent, &fork, &series, procedure, None, &mut NoObserver);
            let result = result.expect("the fork continues");
            let rest = result.rest_after.expect("it is judged at rest");
            assert!(result.verdict == Verdict::Done && rest <= STOPS, "{stop} at {at}: {result:?}");
        }
    }
}

#[test]
fn branch_judged_at_rest_ends_with_a_stop() {
    let (facility, parent) = empty_move();
    let named = |text| Kind::named(text, Path::new(DATA), &facility.description).expect("it is known");
    let kinds = [named("all"), named("cut"), named("lost")].concat();
    let procedure = Procedure { until: Until::Rest, ..PROCEDURE };
    let settings = Settings { branches: 50, longest: 3, seed: 7 };
    let plans = Draw::new(&parent, &kinds, procedure, settings).round();
    assert_eq!(plans.len(), 50);
    for plan in plans {
        let (last, others) = plan.series.interruptions().split_last().expect("there are some");
        assert!(last.kind.is_stop() && !others.is_empty());
        assert!(others.iter().all(|one| !one.kind.is_for_good()), "{}", plan.series);
    }
}

#[test]
fn forks_follow_the_selected_changes() {
    let (_, parent) = empty_move();
    let (every, changes) = (parent.forks(&Ticks::Every(50)), parent.forks(&Ticks::Changes));
    assert!(every.iter().all(|tick| tick % 50 == 0) && changes.len() > 10);
    let both = parent.forks(&Ticks::Both(50));
    assert!(every.iter().chain(&changes).all(|tick| both.contains(tick)));
    assert!(both.is_sorted_by(|a, b| a < b) && both.iter().all(|tick| *tick < parent.ticks));
}

#[test]
fn second_interruption_follows_the_first() {
    let (facility, parent) = empty_move();
    let fork = under_way(&facility);
    let result = judged(&facility, &parent, &fork, "pause+20:refused+3:hold");
    assert_eq!((result.verdict, result.detail.as_str()), (Verdict::Done, ""));
    let refused = result.ended.iter().position(|ended| ended.contains("is not known"));
    let paused = result.ended.iter().position(|ended| ended.contains("PAUSE: finished"));
    assert!(paused.expect("PAUSE ended") < refused.unwrap_or(usize::MAX), "{:?}", result.ended);
}

#[test]
fn series_name_parses_back() {
    let facility = facility("linkbar");
    let named = |text: &str| Series::named(text, Path::new(DATA), &facility.description);
    let text = "held:prim+12:fault:air-lost+0:estop";
    let series = named(text).expect("its words are known");
    assert_eq!(series.iter().map(ToString::to_string).collect::<Vec<_>>(), [text]);
    assert_eq!(named("held+3:restart").expect("words stand for several").len(), 4 * 12);
    for wrong in ["pause+hold", "pause+x:hold", "pause+3:pauze", "+3:pause"] {
        let error = named(wrong).expect_err(wrong).to_string();
        assert!(error.contains("expected") || error.contains("the nearest is pause"), "{error}");
    }
}

#[test]
fn draw_depends_on_its_seed_alone() {
    let (facility, parent) = empty_move();
    let kinds = Kind::named("all", Path::new(DATA), &facility.description).expect("there are some");
    // Each branch is treated as covering only its own tick.
    let draw = |seed, learns: bool| {
        let mut draw = Draw::new(&parent, &kinds, PROCEDURE, Settings { branches: 200, longest: 3, seed });
        let mut plans = Vec::new();
        loop {
            let round = draw.round();
            if round.is_empty() {
                return plans;
            }
            for plan in round.iter().filter(|_| learns) {
                draw.learn(plan, Coverage::of_states([plan.at]));
            }
            plans.extend(round);
        }
    };
    let plans = draw(7, true);
    assert_eq!(plans.len(), 200);
    assert_eq!(plans, draw(7, true));
    assert_ne!(plans, draw(8, true));
    let (first, later) = plans.split_at(64);
    assert_eq!(first, &draw(7, false)[..64]);
    let is_near = |plan: &Plan| {
        first.iter().any(|known| known.at.abs_diff(plan.at) <= 12 && shares_a_kind(known, plan))
    };
    let near = later.iter().filter(|plan| is_near(plan)).count();
    let anew = draw(7, false)[64..].iter().filter(|plan| is_near(plan)).count();
    assert!(near > later.len() / 2 && near > anew, "{near} and {anew} of {} are near", later.len());
    let counts =
        |count: usize| plans.iter().filter(|plan| plan.series.interruptions().len() == count).count();
    assert!([1, 2, 3].map(counts).iter().all(|branches| *branches > 40));
    assert!(plans.iter().all(|plan| (1..parent.ticks).contains(&plan.at)));
}

fn shares_a_kind(a: &Plan, b: &Plan) -> bool {
    let of = |plan: &Plan| plan.series.interruptions().to_vec();
    of(a).iter().any(|one| of(b).iter().any(|other| one.kind == other.kind))
}

#[test]
fn failing_series_is_minimised() {
    let facility = facility("linkbar");
    let drawn = series(&facility, "hold+100:pause+70:nudge");
    // The test fails with a nudge at least 10 ticks after another interruption.
    let fails = |series: &Series| {
        let all = series.interruptions();
        let nudge = all.iter().position(|one| one.kind == Kind::Nudge);
        Ok::<bool, ()>(nudge.is_some_and(|at| at > 0 && all[at].after >= 10))
    };
    let smallest = random::smallest(&drawn, fails).expect("it cannot fail");
    assert_eq!(smallest.to_string(), "pause+17:nudge");
}
