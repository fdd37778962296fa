//! A part is fetched and clamped behind emulated couplers, whose connections are cut.

use std::path::Path;

use diagnostics::Source;
use interfaces::{Decided, ProcessId};
use taskdata::load::Job;

use super::{
    super::{
        branch::Facility,
        operator::Recovery,
        parent::Parent,
        pool,
        series::Series,
        tests,
        trial::{self, Observer, Procedure, Until},
        verdict::{BranchResult, Verdict},
    },
    *,
};

const STATION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/field/station.toml");
const PROCEDURE: Procedure = Procedure { recovery: Recovery::Pause, tries: 3, until: Until::Job };
const JOB: &str = "** tray UNIT_1 4 LINKBAR1_BH\n\
                   ** vise partial PFIXTURE\n\
                   == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0\n\
                   ** vise close PFIXTURE\n";
const CARRIES: u64 = 1900; // a tick of that job in which the fingers hold the part in the air

/// That job behind the couplers of the shipped mapping, with these entries of `[holds]`.
fn facility(holds: &str) -> Facility {
    let text = std::fs::read_to_string(STATION).expect("it is shipped");
    let text = text.replacen("\n[out]\n", &format!("\n[holds]\n{holds}\n[out]\n"), 1);
    let source = Source { name: STATION.to_owned(), text: text.into() };
    let mapping = Mapping::parse(&source).expect("it is right");
    let facility = tests::facility("linkbar");
    let source = Source { name: "try.job".into(), text: JOB.into() };
    let (job, _) = Job::from_source(source, &facility.store).expect("the job is right");
    Facility { job, ..facility }.with_mapping(Some(mapping))
}

/// The rows of each process, without repetition.
#[derive(Default, PartialEq, Debug)]
struct Rows(Vec<Vec<Option<Decided>>>);

impl Observer for Rows {
    fn tick(&mut self, branch: &Branch<'_>) {
        self.0.resize(ProcessId::ALL.len(), Vec::new());
        for (rows, process) in self.0.iter_mut().zip(ProcessId::ALL) {
            let decided = branch.memory().header(*process).decided;
            if rows.last() != Some(&decided) {
                rows.push(decided);
            }
        }
    }

    fn say(&mut self, _: Tick, _: &str) {}
}

fn judged(facility: &Facility, parent: &Parent, at: u64, text: &str) -> (BranchResult, Rows) {
    let fork = pool::fork_at(facility, at).expect("the run can be forked");
    let series = Series::named(text, Path::new(""), &facility.description).expect("it is known").remove(0);
    let mut rows = Rows::default();
    let result = trial::run(facility, parent, &fork, &series, PROCEDURE, None, &mut rows);
    (result.expect("the fork goes on"), rows)
}

#[test]
fn outage_text_names_its_devices_and_times() {
    let all = |text: &str| {
        let found = Outage::named(text).unwrap_or_default();
        found.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(all("arm:0.5"), ["outage:arm:0.5"]);
    let each = ["0.06", "0.2", "0.5", "2", "10"].map(|seconds| format!("outage:arm/robot:{seconds}"));
    assert_eq!(all("arm/robot"), each);
    for wrong in ["", "arm/", "arm:x", "arm:0", "arm:-1", "arm:1e9"] {
        assert_eq!(Outage::named(wrong), None, "{wrong}");
    }
    let facility = facility("");
    let refusal =
        |text: &str, mapping: Option<&Mapping>| Outage::named(text).expect(text)[0].refusal(mapping);
    let mapping = facility.mapping.as_deref();
    assert_eq!((refusal("arm/robot", mapping), refusal("robot", None)), (None, None));
    let unknown = refusal("leg:2", mapping).expect("there is no leg");
    assert!(unknown.contains("one of arm, fixture, pedestal; found leg"), "{unknown}");
    assert!(refusal("arm", None).expect("no couplers").contains("add --field sim:NAME"));
}

#[test]
fn outage_shorter_than_the_age_limit_changes_no_row() {
    let facility = facility("");
    let parent = Parent::run(&facility).expect("the job finishes");
    for at in [700, 1355, CARRIES] {
        let (_, undisturbed) = judged(&facility, &parent, at, "none");
        let (result, rows) = judged(&facility, &parent, at, "outage:arm/fixture/pedestal:0.06");
        let outage = result.outage.expect("there was one");
        assert_eq!(
            (result.verdict, outage.attended, outage.late),
            (Verdict::Done, false, Some(0)),
            "at {at}"
        );
        assert_eq!(rows, undisturbed, "at {at}");
    }
}

#[test]
fn long_outage_waits_for_a_release_and_drops_nothing() {
    let facility = facility("");
    let parent = Parent::run(&facility).expect("the job finishes");
    let vise = parent.end_of(3).0 + 3;
    for (at, text) in
        [(CARRIES, "outage:arm:2"), (CARRIES, "outage:arm/fixture:0.5"), (vise, "outage:fixture:2")]
    {
        let (result, _) = judged(&facility, &parent, at, text);
        assert_eq!((result.verdict, result.detail.as_str()), (Verdict::Done, ""), "{text} at {at}");
        assert!(result.outage.is_some_and(|outage| outage.attended), "{text} at {at}");
    }
    let (result, _) = judged(&facility, &parent, vise, "outage:fixture:2");
    let failed = result.ended.iter().filter(|ended| ended.contains("fixture is tripped")).count();
    assert_eq!(failed, 1, "the line of the vise fails once, and begins again: {:?}", result.ended);
}

#[test]
fn gripper_that_lets_go_drops_its_part_and_the_branch_is_hurt() {
    for (holds, verdict) in [("spring", Verdict::Done), ("nothing", Verdict::Hurt)] {
        let facility = facility(&format!("grip = \"{holds}\"\n"));
        let parent = Parent::run(&facility).expect("the job finishes");
        let (result, _) = judged(&facility, &parent, CARRIES, "outage:arm:2");
        assert_eq!(result.verdict, verdict, "{holds}: {}", result.detail);
        assert_eq!(verdict == Verdict::Hurt, result.detail.contains("LINKBAR1_BH"), "{}", result.detail);
    }
}

/// The emergency stop opens the safety circuit: all couplers trip, and are released after the start-up.
#[test]
fn emergency_stop_makes_all_outputs_safe_until_the_release() {
    let facility = facility("");
    let parent = Parent::run(&facility).expect("the job finishes");
    let (result, _) = judged(&facility, &parent, CARRIES, "estop");
    assert!(matches!(result.verdict, Verdict::Done | Verdict::Apart), "{}", result.detail);
    let (result, _) = judged(&facility, &parent, CARRIES, "pause");
    assert_eq!(result.verdict, Verdict::Done, "{}", result.detail);
}
