//! Compares the planned routes of the shipped jobs with those that the ladder orders in the ideal cell.

use std::{path::Path, sync::Arc, thread};

use closed_loop::{ClosedLoop, JobPlayer, Present, ideal::IdealWorkstation};
use geometry::frame::Frame;
use interfaces::emove::EmoveVerb;
use levels::places::pose_of;
use neighbours::workstation::player::{Hwsc, Progress, TIME_LIMIT};
use paths::job::walk_job_once;
use plant::{CellDescription, Ideal, room::Room};
use taskdata::load::{
    Job, Step, Store,
    job::{Offset, Workstation},
};

const SAME: (f64, f64) = (0.02, 0.002); // inches and radians: the accuracy of vision

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn job(name: &str, store: &Store) -> Job {
    let path = data().join("jobs").join(format!("{name}.job"));
    let (mut job, _) = Job::load(&path, store).unwrap_or_else(|report| panic!("{report}"));
    for line in &mut job.steps {
        if let Step::Workstation(Workstation::Tray { offset, .. }) = &mut line.step {
            *offset = offset.or(Some(Offset { x: 0, y: 0, angle: 0 }));
        }
    }
    job
}

const fn has_route(verb: EmoveVerb) -> bool {
    matches!(
        verb,
        EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToLoc
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol
    )
}

/// The points that E-move orders, each with its command.
fn ordered(job: &Job, store: &Store, room: &Room) -> Vec<(&'static str, Frame)> {
    let world = IdealWorkstation::new(Ideal::new(room, 1).expect("the cell is sound"));
    let (data, reloads) = (Arc::new(store.clone()), Arc::new(job.reloads.clone()));
    let mut closed = ClosedLoop::in_world(Present::default(), data, reloads, world);
    let mut player = JobPlayer::new(Hwsc::new(job.steps.clone(), TIME_LIMIT));
    let (mut points, mut last) = (Vec::new(), 0);
    loop {
        let progress = player.step(&mut closed);
        let (memory, data) = (closed.memory(), store.view());
        let (command, order) = (memory.subtask.emove, memory.emove.prim);
        if order.number != last && has_route(command.command) && memory.emove.status.echo == command.number {
            let base = pose_of(order.pose, memory, &data).expect("the order has a pose");
            let movetable = order.movetable;
            points.push((command.command.text(), data.moved(&base, movetable)));
        }
        last = order.number;
        if progress != Progress::Running {
            assert_eq!(progress, Progress::Over);
            return points;
        }
    }
}

fn planned(job: &Job, store: &Store, room: &Room) -> Vec<(&'static str, Frame)> {
    let walked = walk_job_once(job, store, room);
    let phases = walked.lines.iter().flat_map(|line| &line.phases).map(|phase| &phase.plan);
    let verb =
        |what: &str| EmoveVerb::ALL.iter().find(|verb| what.split(' ').next() == Some(verb.text())).copied();
    let routes = phases.filter_map(|phase| Some((verb(&phase.what).filter(|verb| has_route(*verb))?, phase)));
    routes.flat_map(|(verb, phase)| phase.legs.iter().map(move |leg| (verb.text(), leg.frame))).collect()
}

fn compare(name: &str) {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let job = job(name, &store);
    let (planned, ordered) = (planned(&job, &store, &room), ordered(&job, &store, &room));
    for (number, (one, other)) in planned.iter().zip(&ordered).enumerate() {
        let off = one.1.distance(&other.1);
        let is_same = one.0 == other.0 && off.inches < SAME.0 && off.radians < SAME.1;
        assert!(is_same, "{name}: point {number} is planned as {one:?}, and ordered as {other:?}");
    }
    assert_eq!(planned.len(), ordered.len(), "{name}");
}

#[test]
fn planned_routes_are_those_that_the_ladder_orders() {
    thread::scope(|scope| {
        for name in ["linkbar", "clevis", "turned-part", "vise-and-back", "brush", "tool-change", "shift"] {
            scope.spawn(move || compare(name));
        }
    });
}
