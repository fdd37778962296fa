//! Branches of a campaign of confirmations: a person disturbs the cell at a drawn tick, and the judge of
//! [`closed_loop::truth`] checks every report of a finished command. In half of the branches a person moves the robot
//! aside, by 0.05 to 6 in; in the others a part is changed. One in [`WHOLE`] runs to the end of the job: if a command
//! is refused there, the person undoes the disturbance, and the job must finish.

use std::collections::BTreeSet;

use rand::{RngExt as _, SeedableRng as _, seq::IndexedRandom as _};
use rand_chacha::ChaCha8Rng;
use taskdata::load::job::{Step, Workstation};

use super::{
    branch::Facility,
    disturbance::{Disturbance, DisturbanceKind, Follow},
    interruption::Kind,
    parent::{Parent, Ticks},
    pool::Plan,
    series::Series,
    trial::{Procedure, Until},
};

/// One branch in this number runs to the end of the job.
pub const WHOLE: usize = 10;
/// Least and greatest distance by which the joystick moves the robot aside, in.
const JOG: [f64; 2] = [0.05, 6.0];
const MOVED: [f64; 2] = [0.05, 4.0]; // least and greatest distance by which a part is moved, in
const PARTS: usize = 4; // number of parts of the cell that may be chosen, from the first
/// Percentage of the branches in which the previous command follows, and of the others in which the next one does.
const AGAIN: u32 = 33;
const NEXT: u32 = 33;
const OF_JOB: u32 = 75; // percentage of the parts and places that are those of the job

struct Choice {
    kinds: [Vec<String>; 2], // kinds of parts of the job, and all of the cell
    /// Places of parts as kind, location and sector: first those of the job, then all of the cell.
    places: [Vec<(String, String, u16)>; 2],
}

impl Choice {
    fn of(facility: &Facility) -> Self {
        let cell = &facility.description;
        let (mut names, mut locations) = (BTreeSet::new(), BTreeSet::new());
        for line in &facility.job.steps {
            let sector = |sector: Option<i32>| sector.and_then(|one| u16::try_from(one).ok()).unwrap_or(0);
            match &line.step {
                Step::Command(command) => {
                    names.extend(command.object.map(|object| object.to_string()));
                    for (name, number) in [
                        (command.source, command.source_sector),
                        (command.destination, command.destination_sector),
                    ] {
                        locations.extend(name.map(|name| (name.to_string(), sector(number))));
                    }
                }
                Step::Workstation(Workstation::Tray { object, .. }) => {
                    names.insert(object.to_string());
                }
                _ => {}
            }
        }
        let all: Vec<String> = cell.part.iter().map(|kind| kind.name.clone()).collect();
        let kinds = all.iter().filter(|name| names.contains(*name)).cloned().collect();
        let place = |kind: &plant::description::PartType| {
            let drum = kind.tool.then(|| (cell.drum.location.clone(), 0));
            let lies = cell.places_of(kind).into_iter().map(|(location, sector, _)| (location, sector));
            let name = kind.name.clone();
            lies.chain(drum).map(|(at, sector)| (name.clone(), at, sector)).collect::<Vec<_>>()
        };
        let places: Vec<_> = cell.part.iter().flat_map(place).collect();
        let of_job = |(kind, location, sector): &&(String, String, u16)| {
            let there = locations.contains(&(location.clone(), *sector));
            names.contains(kind) && (there || *location == cell.drum.location)
        };
        let near = places.iter().filter(of_job).cloned().collect();
        Self { kinds: [kinds, all], places: [near, places] }
    }
}

struct Draw {
    random: ChaCha8Rng,
    choice: Choice,
}

impl Draw {
    fn percent(&mut self, share: u32) -> bool {
        self.random.random_range(0..100_u32) < share
    }

    fn length(&mut self, [least, greatest]: [f64; 2]) -> f64 {
        let share = self.random.random_range(0.0..1.0);
        least * (greatest / least).powf(share)
    }

    /// A vector of this length in a random direction, 0.01 in.
    fn vector(&mut self, length: f64) -> [i32; 3] {
        loop {
            let way: [f64; 3] = core::array::from_fn(|_| self.random.random_range(-1.0..1.0));
            let norm = way.iter().map(|one| one * one).sum::<f64>().sqrt();
            if (0.1..=1.0).contains(&norm) {
                return way.map(|one| (one / norm * length * 100.0).round() as i32);
            }
        }
    }

    fn one_of<T: Clone>(&mut self, [of_job, all]: &[Vec<T>; 2]) -> Option<T> {
        let few = self.percent(OF_JOB) && !of_job.is_empty();
        if few { of_job } else { all }.choose(&mut self.random).cloned()
    }

    fn what(&mut self) -> Option<DisturbanceKind> {
        let part = self.random.random_range(1..=PARTS);
        Some(match self.random.random_range(0..8) {
            0..4 => {
                let length = self.length(JOG);
                DisturbanceKind::Jog(self.vector(length))
            }
            4 => DisturbanceKind::Take(part),
            5 => {
                let length = self.length(MOVED);
                let [x, y, _] = self.vector(length);
                DisturbanceKind::Move(part, [x, y])
            }
            6 => {
                let kinds = self.choice.kinds.clone();
                DisturbanceKind::Swap(part, self.one_of(&kinds)?)
            }
            _ => {
                let places = self.choice.places.clone();
                let (kind, location, sector) = self.one_of(&places)?;
                DisturbanceKind::Add(kind, location, sector)
            }
        })
    }
}

/// Draw the branches of a campaign of confirmations. Half of them begin in ticks in which something changes.
#[must_use]
pub fn plans(
    facility: &Facility,
    parent: &Parent,
    procedure: Procedure,
    branches: usize,
    seed: u64,
) -> Vec<Plan> {
    let mut draw = Draw { random: ChaCha8Rng::seed_from_u64(seed), choice: Choice::of(facility) };
    let changes = parent.forks(&Ticks::Changes);
    let plan = |number: usize| {
        let change = changes.choose(&mut draw.random).copied();
        let any = draw.random.random_range(1..parent.ticks);
        let at = change.filter(|_| draw.percent(50)).unwrap_or(any);
        let whole = number % WHOLE == WHOLE - 1;
        let what = draw.what()?;
        let then = match (draw.percent(AGAIN), draw.percent(NEXT)) {
            (true, _) => Follow::Again,
            (false, true) if !whole => Follow::Next,
            _ => Follow::Same,
        };
        let series = Series::from(Kind::Disturbed(Disturbance { what, then }));
        let until = if whole { Until::Job } else { procedure.until };
        Some(Plan { at, series, procedure: Procedure { until, ..procedure } })
    };
    (0..branches).filter_map(plan).collect()
}
