//! A copy of a closed loop continues bit for bit like the original, and neither disturbs the other.

use std::{path::Path, sync::Arc};

use closed_loop::{ClosedLoop, JobPlayer, Present};
use depc::fault::{FaultKind, Plan, Rule};
use interfaces::DeviceOutputs;
use neighbours::workstation::player::{Hwsc, TIME_LIMIT};
use plant::{Cell, CellDescription};
use rcs_core::tick::Tick;
use taskdata::load::{Job, Store};

#[derive(Clone)]
struct Run {
    closed: ClosedLoop,
    player: JobPlayer,
}

impl Run {
    /// The job `linkbar` before its first tick.
    fn start() -> Self {
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
        let Ok((store, _)) = Store::load(data) else { panic!("the shipped data load") };
        let Ok((job, _)) = Job::load(&data.join("jobs/linkbar.job"), &store) else {
            panic!("the shipped job loads")
        };
        let description = CellDescription::load(&data.join("cell.toml")).expect("the cell is shipped");
        let cell = Cell::new(&description, 1).expect("the cell is sound");
        Self {
            closed: ClosedLoop::new(Present::default(), Arc::new(store), Arc::new(job.reloads), cell),
            player: JobPlayer::new(Hwsc::new(job.steps, TIME_LIMIT)),
        }
    }

    fn run_to(&mut self, tick: u64) {
        while self.closed.tick() < Tick(tick) {
            self.player.step(&mut self.closed);
        }
    }

    /// All results of the ticks: digests of the buffers and of the bodies in the cell.
    fn bits(&self) -> (String, u64) {
        (self.closed.digest().to_string(), self.closed.workstation.cell.digest())
    }
}

#[test]
fn a_copy_continues_like_the_original_from_every_stage_of_a_job() {
    let mut original = Run::start();
    for fork in (100..2000).step_by(317) {
        original.run_to(fork);
        let mut copy = original.clone();
        let end = fork + 150;
        copy.run_to(end);
        original.run_to(end);
        assert_eq!(copy.bits(), original.bits(), "from tick {fork}");
    }
}

#[test]
fn faults_on_the_line_of_a_copy_do_not_reach_the_original() {
    let mut original = Run::start();
    original.run_to(400);
    let (mut undisturbed, mut cut) = (original.clone(), original.clone());
    let now = cut.closed.tick();
    cut.closed.line_mut().cut(now);
    let mut plan = Plan::new(1);
    plan.add(Rule::new(FaultKind::Drop).window(401, 402)).expect("one rule fits");
    assert!(!cut.closed.line_mut().apply_faults(&plan), "it has a plan already");
    for run in [&mut original, &mut undisturbed, &mut cut] {
        run.run_to(500);
    }
    assert_eq!(undisturbed.bits(), original.bits());
    assert_ne!(cut.bits(), original.bits());
    assert!(!cut.closed.memory().t3i.status.link_running);
    assert!(original.closed.memory().t3i.status.link_running);
}

#[test]
fn a_controller_without_power_has_zero_outputs_and_starts_from_its_buffers() {
    let mut run = Run::start();
    run.run_to(1350);
    assert_ne!(run.closed.outputs(), DeviceOutputs::default(), "the gripper holds the part");
    let held = run.closed.memory().emove;
    run.closed.course_mut().levels_mut().switch_off();
    run.run_to(1400);
    assert_eq!(run.closed.outputs(), DeviceOutputs::default());
    assert_eq!(run.closed.memory().emove, held, "no process writes its buffer");
    run.closed.course_mut().levels_mut().switch_on();
    run.run_to(1401);
    assert_ne!(run.closed.outputs(), DeviceOutputs::default());
    assert_eq!(run.closed.memory().emove.status.held, held.status.held);
}
