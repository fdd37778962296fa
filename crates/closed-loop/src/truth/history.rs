use std::collections::BTreeMap;

use geometry::frame::{Frame, Vector};
use interfaces::{device::Picture, emove::EmoveVerb};
use plant::{Cell, t3::Stage};
use rcs_core::tick::Tick;

use super::{Level, NotSensed, Scene};

#[derive(Clone, Copy, Debug)]
pub struct Released {
    pub id: u32,
    /// Tick in which the fingers opened.
    pub tick: Tick,
    pub tool: Frame, // tool frame in the last tick of the hold, world, in
    pub part: Frame, // world, in
}

#[derive(Clone, Debug, Default)]
pub struct History {
    changed: BTreeMap<u32, Tick>, // last tick in which an operator changed a part, by its number
    delivered: BTreeMap<u32, Tick>, // tick in which the workstation delivered a part, by its number
    /// The part held after the last tick, with tool frame and part frame.
    held: Option<(u32, Frame, Frame)>,
    pub(super) released: Option<Released>,
    taken: Tick, // tick of the grasp of the held part
    /// Tick of the camera's last look, and the name of the part.
    pub(super) looked: Option<(Tick, String)>,
    look: u32, // number of that picture
    /// Parts off their places for a reason that no sensor shows, by number.
    displaced: BTreeMap<u32, NotSensed>,
    /// Last tick in which the arm had pressure and the robot controller executed the DEPC function.
    pub(super) up: Tick,
    pub(super) is_up: bool,
}

impl History {
    pub(super) fn note_changed(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.changed.extend(parts.into_iter().map(|id| (id, tick)));
    }

    pub(super) fn note_delivered(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.delivered.extend(parts.into_iter().map(|id| (id, tick)));
    }

    pub(super) fn look(&mut self, scene: &Scene<'_>) {
        let cell = scene.cell;
        let held = cell.held();
        if let Some((id, tool, part)) = self.held
            && held != Some(id)
        {
            self.released = Some(Released { id, tick: scene.tick, tool, part });
        }
        if held != self.held.map(|(id, ..)| id) {
            self.taken = scene.tick;
        }
        let frame = |id: u32| Some((id, cell.t3().arm().tool(), cell.part_frame(id)?));
        self.held = held.and_then(frame);
        let (command, picture) = (&scene.memory.subtask.emove, &scene.memory.emove.vision);
        let is_asked = picture.picture == Picture::Precise && picture.number != self.look;
        if let (true, EmoveVerb::LocateObj, Some(object)) = (is_asked, command.command, command.object) {
            self.look = picture.number;
            self.looked = Some((scene.tick, object.to_string()));
            let is_other = |id: &u32| cell.part_kind(*id).is_none_or(|kind| kind.name != object.as_str());
            self.displaced.retain(|id, _| is_other(id));
        }
        self.is_up = cell.t3().arm().has_pressure() && cell.t3().stage() == Stage::Depc;
        if self.is_up {
            self.up = scene.tick;
        }
    }

    /// Note that the held or last released part is off its place for a reason that no sensor shows.
    pub fn note_displaced(&mut self, cell: &Cell, why: NotSensed) {
        if let Some(id) = cell.held().or_else(|| self.released().map(|released| released.id)) {
            self.displaced.insert(id, why);
        }
    }

    /// Note that the held part is in its place in the fingers.
    pub fn note_in_place(&mut self, cell: &Cell) {
        if let Some(id) = cell.held() {
            self.displaced.remove(&id);
        }
    }

    pub fn displaced(&self, id: u32) -> Option<NotSensed> {
        self.displaced.get(&id).copied()
    }

    /// The reason why no sensor shows an obstacle of a part: an operator has put another part in its way.
    pub fn occupied(&self, cell: &Cell, id: u32) -> Option<NotSensed> {
        let half_diagonal = |id: u32| Some(Vector::from(cell.part_kind(id)?.size).norm() / 2.0);
        let middle = |id: u32| Some((cell.part_frame(id)?.position, half_diagonal(id)?));
        let (position, radius) = middle(id)?;
        let meets =
            |other: &u32| middle(*other).is_some_and(|(at, reach)| apart(&at, &position) <= radius + reach);
        self.changed.keys().filter(|other| **other != id).any(meets).then_some(NotSensed::Occupied)
    }

    /// True if the arm or the robot controller failed too recently for the process to have read it.
    pub const fn has_just_failed(&self, tick: Tick, level: Level) -> bool {
        !self.is_up && tick.since(self.up) <= level.hops()
    }

    /// The last released part, unless the robot holds it again.
    pub fn released(&self) -> Option<&Released> {
        self.released.as_ref().filter(|released| self.held.is_none_or(|(id, ..)| id != released.id))
    }

    /// True if an operator has changed the part since this tick.
    pub fn is_changed_since(&self, id: u32, tick: Tick) -> bool {
        self.changed.get(&id).is_some_and(|changed| *changed >= tick)
    }

    /// True if an operator has changed the part since its last release.
    pub fn is_changed(&self, id: u32) -> bool {
        let released = self.released.as_ref().filter(|released| released.id == id);
        self.is_changed_since(id, released.map_or(Tick(0), |released| released.tick))
    }

    /// True if an operator has changed any part since the grasp of the held one.
    pub fn is_any_changed_since_grasp(&self) -> bool {
        self.changed.values().any(|changed| *changed >= self.taken)
    }

    /// True if an operator has changed any part, or one was delivered, since the camera's last look for this object.
    pub fn is_any_changed_since_look(&self, object: &str) -> bool {
        self.looked.as_ref().filter(|(_, name)| name == object).is_some_and(|(tick, _)| {
            self.changed.values().chain(self.delivered.values()).any(|changed| changed >= tick)
        })
    }
}

pub fn apart(one: &Vector, other: &Vector) -> f64 {
    (one - other).norm()
}
