//! In the ideal cell the shipped jobs finish, over the same points as in the simulated cell without noise.

use std::{path::Path, sync::Arc, thread};

use closed_loop::{
    ClosedLoop, JobPlayer, Present, World, ideal::IdealWorkstation, workstation::SimulatedWorkstation,
};
use geometry::kinematics::Joints;
use interfaces::{
    emove::EmoveVerb,
    prim::{PrimReport, PrimVerb},
};
use neighbours::workstation::player::{Hwsc, Progress, TIME_LIMIT};
use plant::{Cell, CellDescription, Ideal, room::Room, t3::T3Controller};
use rcs_core::tick::Tick;
use taskdata::load::{Job, Store};

const LONGEST: Tick = Tick(60_000); // ticks
/// Greatest difference of a joint at the end of a point, rad. Paths and pictures agree to 1e-8.
const EXACT: f64 = 1e-6;
/// For a job with guarded moves, because the ideal cell has no friction at the drum.
const GUARDED: f64 = 1e-3;

#[derive(Debug)]
struct Point {
    emove: EmoveVerb,
    prim: PrimVerb,
    report: PrimReport,
    joints: Joints,
}

struct Played {
    progress: Progress,
    tick: Tick,
    points: Vec<Point>,
}

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn play<W: World>(store: &Store, job: &Job, world: W, t3: impl Fn(&W) -> &T3Controller) -> Played {
    let (store, reloads) = (Arc::new(store.clone()), Arc::new(job.reloads.clone()));
    let mut closed = ClosedLoop::in_world(Present::default(), store, reloads, world);
    let mut player = JobPlayer::new(Hwsc::new(job.steps.clone(), TIME_LIMIT));
    let (mut points, mut last) = (Vec::new(), 0);
    loop {
        let progress = player.step(&mut closed);
        let (status, order) = (closed.memory().prim.status, closed.memory().emove.prim);
        let is_over = !matches!(status.report, PrimReport::Idle | PrimReport::Executing);
        if is_over && status.echo == order.number && order.number != last {
            last = order.number;
            points.push(Point {
                emove: closed.memory().subtask.emove.command,
                prim: order.command,
                report: status.report,
                joints: *t3(&closed.workstation).arm().joints(),
            });
        }
        if progress != Progress::Running || closed.tick() > LONGEST {
            return Played { progress, tick: closed.tick(), points };
        }
    }
}

/// Play a shipped job in both cells, and compare the points.
fn compare(name: &str, greatest: f64) {
    let Ok((store, _)) = Store::load(data()) else { panic!("the shipped data load") };
    let path = data().join(format!("jobs/{name}.job"));
    let Ok((job, _)) = Job::load(&path, &store) else { panic!("{name}: the shipped job loads") };
    let shipped = CellDescription::load(&data().join("cell.toml")).expect("the cell is shipped");
    let ideal = Ideal::new(&Room::new(&shipped), 1).expect("the cell is sound");
    let ideal = play(&store, &job, IdealWorkstation::new(ideal), |world| world.cell.t3());
    let cell = Cell::new(&shipped.without_noise(), 1).expect("the cell is sound");
    let cell = play(&store, &job, SimulatedWorkstation::new(cell), |world| world.cell.t3());
    for played in [&ideal, &cell] {
        assert_eq!(played.progress, Progress::Over, "{name} at tick {}", played.tick);
    }
    assert_eq!(ideal.points.len(), cell.points.len(), "{name}");
    for (number, (one, other)) in ideal.points.iter().zip(&cell.points).enumerate() {
        let orders = [one, other].map(|point| (point.emove, point.prim, point.report));
        assert_eq!(orders[0], orders[1], "{name}: point {number}");
        let off = one.joints.iter().zip(other.joints).map(|(one, other)| (one - other).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off <= greatest, "{name}: point {number} is off by {off:e} rad: {one:?}");
    }
}

#[test]
fn a_job_in_the_ideal_cell_passes_the_points_of_a_run_without_noise() {
    let jobs = [
        ("linkbar", EXACT),
        ("clevis", EXACT),
        ("turned-part", EXACT),
        ("vise-and-back", EXACT),
        ("brush", EXACT),
        ("tool-change", GUARDED),
        ("shift", GUARDED),
    ];
    thread::scope(|scope| {
        jobs.into_iter().for_each(|(name, greatest)| drop(scope.spawn(move || compare(name, greatest))))
    });
}
