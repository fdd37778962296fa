//! Compares the cell with that of the undisturbed run, and watches for harm.

use neighbours::data_system::Item;
use os_io::text::amount;
use plant::{CellEvent, t3::Stage};
use rcs_core::tick::Tick;

use super::branch::Branch;
use closed_loop::contacts::{Collision, Commands};

const PART: f64 = 0.5; // greatest distance of a part from its position in the undisturbed run, in
const HAND: f64 = 0.5; // greatest distance of the hand from its position in the undisturbed run, in

#[must_use]
pub fn is_commanded(branch: &Branch<'_>) -> bool {
    let t3 = branch.closed.workstation.cell.t3();
    t3.stage() == Stage::Depc && t3.cut().is_none()
}

/// Parts, gripper, hand and the items of the Data System at the end of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    parts: Vec<PartAt>,
    gripper: Option<u8>, // end effector id of the gripper on the robot, if there is one
    hand: [f64; 3],      // middle between the fingertips, world coordinates, in
    items: Result<Vec<Item>, String>,
}

#[derive(Clone, Debug, PartialEq)]
struct PartAt {
    name: String,
    location: String,
    sector: u16,
    clamped: bool,
    at: [f64; 3],
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

impl World {
    #[must_use]
    pub fn of(branch: &mut Branch<'_>) -> Self {
        let items = branch.items();
        let cell = &branch.closed.workstation.cell;
        let parts = cell.parts().into_iter().map(|part| PartAt {
            name: part.name,
            location: part.location,
            sector: part.sector,
            clamped: part.clamped,
            at: part.position,
        });
        Self { parts: parts.collect(), gripper: cell.gripper(), hand: cell.tool().position.into(), items }
    }

    /// The first difference from the undisturbed run, if any. The position of the hand matters only if the command
    /// `moves` the robot.
    #[must_use]
    pub fn unlike(&self, undisturbed: &Self, moves: bool) -> Option<String> {
        if self.gripper != undisturbed.gripper {
            let worn = |gripper: Option<u8>| gripper.map_or("none".to_owned(), |id| id.to_string());
            let (is, was) = (worn(self.gripper), worn(undisturbed.gripper));
            return Some(format!("the robot has gripper {is}, not {was}"));
        }
        if self.parts.len() != undisturbed.parts.len() {
            return Some(format!(
                "{} in the cell, not {}",
                amount(self.parts.len(), "part"),
                undisturbed.parts.len()
            ));
        }
        let parts = self.parts.iter().zip(&undisturbed.parts);
        let part = parts.filter_map(|(one, other)| one.unlike(other)).next();
        let away = distance(&self.hand, &undisturbed.hand);
        let moved = part.or_else(|| {
            (moves && away > HAND)
                .then(|| format!("the hand is {away:.2} in from where the command leaves it"))
        });
        moved.or_else(|| {
            (self.items != undisturbed.items).then(|| {
                format!("the Data System has {}, not {}", listed(&self.items), listed(&undisturbed.items))
            })
        })
    }
}

fn listed(items: &Result<Vec<Item>, String>) -> String {
    let items = match items {
        Ok(items) if items.is_empty() => return "no item".to_owned(),
        Ok(items) => items,
        Err(why) => return format!("no list of items ({why})"),
    };
    let at = |item: &Item| match item.sector {
        0 => format!("{} at {}", item.name, item.position),
        sector => format!("{} at {} {sector}", item.name, item.position),
    };
    items.iter().map(at).collect::<Vec<_>>().join(" and ")
}

impl PartAt {
    fn unlike(&self, other: &Self) -> Option<String> {
        let place = |part: &Self| match part.sector {
            0 => part.location.clone(),
            sector => format!("{} {sector}", part.location),
        };
        if self.name != other.name {
            return Some(format!("{} is in the cell, not {}", self.name, other.name));
        }
        if (&self.location, self.sector) != (&other.location, other.sector) {
            return Some(format!("{} is at {}, not at {}", self.name, place(self), place(other)));
        }
        if self.clamped != other.clamped {
            let not = if self.clamped { "" } else { "not " };
            return Some(format!("{} is {not}clamped in the vise", self.name));
        }
        let away = distance(&self.at, &other.at);
        (away > PART)
            .then(|| format!("{} is {away:.2} in from where it should be in {}", self.name, place(self)))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Damage {
    pub tick: Tick,
    pub what: String,
    /// The sentence without numbers, by which harms are counted.
    pub kind: String,
    /// False if an arm without pressure, a person at the joystick box, or the travel to HOME caused the harm.
    pub commanded: bool,
    contact: Option<usize>,
}

pub struct HarmMonitor {
    seen: usize,
    harms: Vec<Damage>,
    /// The first part that has slid in the fingers while no point was commanded, such as at the start-up.
    slide: Option<(String, Damage)>,
    moved: Vec<String>, // parts in contacts that no commanded point has caused
}

impl HarmMonitor {
    #[must_use]
    pub fn from_now(branch: &Branch<'_>) -> Self {
        Self {
            seen: branch.closed.contacts().collisions().len(),
            harms: Vec::new(),
            slide: None,
            moved: Vec::new(),
        }
    }

    #[must_use]
    pub const fn has_seen_nothing(&self) -> bool {
        self.harms.is_empty() && self.slide.is_none() && self.moved.is_empty()
    }

    /// The first harm that a commanded point has caused, or else the first harm.
    #[must_use]
    pub fn worst(&self) -> Option<&Damage> {
        self.harms.iter().find(|harm| harm.commanded).or_else(|| self.harms.first())
    }

    /// True if the difference `unlike` of a part results from a slide. The slide then is harm, because no sensor shows
    /// where in the fingers the part is.
    pub fn attribute_to_slide(&mut self, unlike: &str) -> bool {
        match self.slide.take_if(|(part, _)| unlike.is_empty() || unlike.starts_with(part.as_str())) {
            Some((_, harm)) => {
                self.harms.push(harm);
                true
            }
            None => false,
        }
    }

    /// Record a violation, such as a broken invariant.
    pub fn note(&mut self, tick: Tick, what: String) {
        let commanded = !self.is_displaced();
        self.harms.push(Damage { tick, kind: what.clone(), what, commanded, contact: None });
    }

    pub fn look(&mut self, branch: &Branch<'_>, person: bool) {
        let tick = branch.at();
        let commanded = is_commanded(branch) && !person;
        let contacts = branch.closed.contacts().collisions();
        for (at, contact) in contacts.iter().enumerate().skip(self.seen) {
            let Collision { mover, obstacle, commands, .. } = contact;
            let kind = format!("{mover} runs into {obstacle} during {commands}");
            let harmless = if contact.is_of_robot() { self.is_moved(obstacle) } else { self.is_displaced() };
            let commanded = commanded && !harmless;
            self.harms.push(Damage { tick, what: contact.to_string(), kind, commanded, contact: Some(at) });
            if !commanded {
                let parts = branch.closed.workstation.cell.parts().into_iter().map(|part| part.name);
                self.moved.extend(parts.filter(|part| part == mover || part == obstacle));
            }
        }
        self.seen = contacts.len();
        // The consequence of a contact is detected after the contact.
        for harm in &mut self.harms {
            if let Some(contact) = harm.contact.and_then(|at| contacts.get(at)) {
                harm.what = contact.to_string();
            }
        }
        let commands = Commands::from(branch.memory());
        for event in branch.events.iter().filter(|_| !commanded) {
            if let CellEvent::Slipped { part, .. } = event {
                let kind = format!("{part} slides in the fingers while no point is commanded");
                let harm = Damage { tick, what: event.to_string(), kind, commanded, contact: None };
                self.slide.get_or_insert((part.clone(), harm));
            }
        }
        for event in branch.events.iter().filter(|event| event.is_harm()) {
            let kind = format!("{event} during {commands}");
            let commanded = commanded && !self.is_displaced();
            self.harms.push(Damage { tick, what: kind.clone(), kind, commanded, contact: None });
        }
    }

    /// True if the part has slid in the fingers, or was in a contact without a commanded cause.
    fn is_moved(&self, part: &str) -> bool {
        self.slide.as_ref().is_some_and(|(slid, _)| slid == part)
            || self.moved.iter().any(|moved| moved == part)
    }

    /// True if an arm without pressure or a person has touched something: the controller cannot know the positions of
    /// parts then.
    fn is_displaced(&self) -> bool {
        self.slide.is_some() || self.harms.iter().any(|harm| !harm.commanded)
    }
}
